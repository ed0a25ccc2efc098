"""The programs that benches compare with: where their environments are, and that they leave nothing behind."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
import pytest
from bench.peers import FOLDER, Peers, add_peers

PROGRAM = """
import json, sys
from pathlib import Path
import numpy as np
for line in sys.stdin:
    asked = json.loads(line)
    Path("MUJOCO_LOG.TXT").write_text("a warning")
    np.savez(asked["made"], twice=2 * np.load(asked["given"])["x"])
    print(json.dumps({"stood": str(Path.cwd())}), flush=True)
"""


def test_what_a_peer_writes_where_it_stands_is_gone_with_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("program.py").write_text(PROGRAM, "utf-8")
    peers = Peers(Path(sys.executable), Path("program.py"))
    told = peers.run("any", x=np.arange(3))
    peers.close()
    assert told["twice"].tolist() == [0, 2, 4]
    assert not Path(told["stood"]).exists()
    assert [path.name for path in tmp_path.iterdir()] == ["program.py"]


def test_the_peers_folder_is_one_for_all_benches(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    parser = argparse.ArgumentParser()
    add_peers(parser, "with something")
    assert parser.parse_args([]).peers is None
    assert parser.parse_args(["--peers"]).peers == FOLDER == Path(__file__).parents[2] / "build" / "peers"
    monkeypatch.chdir(tmp_path)
    assert (
        parser.parse_args(["--peers", "mine"]).peers == tmp_path / "mine"
    )  # also where a peer stands elsewhere
