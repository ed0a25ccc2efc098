"""Environments of the benches' own for the programs they compare with, and a process in one that takes turns."""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from hashlib import sha256
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
LIST = HERE / "peers.txt"
FOLDER = HERE.parents[1] / "build" / "peers"


def add_peers(parser: argparse.ArgumentParser, what: str, default: Path | None = None) -> None:
    """`--peers [FOLDER]`, None without it; what: for its help."""
    parser.add_argument(
        "--peers",
        nargs="?",
        const=FOLDER,
        default=default,
        type=lambda text: Path(text).absolute(),
        metavar="FOLDER",
        help=f"{what}, in an environment of their own (default: build/peers)",
    )


def requirements(text: str, section: str) -> list[str]:
    """The lines of one section of peers.txt: those between `# section: …` and the next such line."""
    lines, inside = [], False
    for line in text.splitlines():
        if line.startswith("#"):
            inside = line.startswith(f"# {section}:")
        elif inside and line.strip():
            lines.append(line.strip())
    if not lines:
        raise SystemExit(f"{LIST}: no section {section!r} – add `# {section}: …` and its packages")
    return lines


def peer_python(folder: Path, section: str = "mesh") -> Path:
    """The Python of the environment `folder`/`section`, made from its lines where it is missing or of other lines.

    What cannot be installed is named in one line and left out.
    """
    folder = folder / section
    python, mark = folder / "bin" / "python", folder / "peers.sha256"
    lines = requirements(LIST.read_text("utf-8"), section)
    wanted = sha256("\n".join(lines).encode()).hexdigest()
    if python.is_file() and mark.is_file() and mark.read_text("utf-8") == wanted:
        return python
    subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
    install = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    if subprocess.run([*install, *lines], check=False, capture_output=True).returncode:
        for line in lines:
            done = subprocess.run([*install, line], check=False, capture_output=True, text=True)
            if done.returncode:
                reason = (done.stderr.strip().splitlines() or ["no reason given"])[-1]
                print(f"{line}: cannot be installed – {reason}", file=sys.stderr)
    mark.write_text(wanted, "utf-8")
    return python


class Peers:
    """A running program of the peers' environment: it is asked for one run at a time, so that engines take turns.

    What it leaves where it stands, as MuJoCo its log, is gone when it closes.
    """

    def __init__(self, python: Path, program: Path = HERE / "mesh_peers.py", **environment: str) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.process = subprocess.Popen(
            [str(python.absolute()), str(program.absolute())],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=self.folder.name,
            env={**os.environ, **environment},
        )

    def run(self, engine: str, setting: dict | None = None, **arrays) -> dict:
        """What the program answers (seconds of the engine alone, or `error`) and the arrays it made.

        setting: anything JSON holds; arrays: what the engine is given.
        """
        given, made = Path(self.folder.name) / "given.npz", Path(self.folder.name) / "made.npz"
        np.savez(given, **arrays)
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        asked = {"engine": engine, "setting": setting, "given": str(given), "made": str(made)}
        self.process.stdin.write(json.dumps(asked) + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise SystemExit(f"{engine}: the peers' process ended – see its message above")
        answer = json.loads(line)
        if "error" in answer:
            return answer
        with np.load(made) as found:
            return {**answer, **{name: found[name] for name in found.files}}

    def close(self) -> None:
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()
        self.folder.cleanup()
