"""An environment of the benches' own for the programs they compare with, and a process in it that takes turns."""

import json
import subprocess
import sys
import tempfile
from hashlib import sha256
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
LIST = HERE / "peers.txt"


def peer_python(folder: Path) -> Path:
    """The Python of the environment in `folder`, made from peers.txt where it is missing or of another list."""
    python, mark = folder / "bin" / "python", folder / "peers.sha256"
    wanted = sha256(LIST.read_bytes()).hexdigest()
    if python.is_file() and mark.is_file() and mark.read_text("utf-8") == wanted:
        return python
    subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
    subprocess.run([str(python), "-m", "pip", "install", "--quiet", "-r", str(LIST)], check=True)
    mark.write_text(wanted, "utf-8")
    return python


class Peers:
    """A running `mesh_peers.py`: it is asked for one mesh at a time, so that engines take turns on one machine."""

    def __init__(self, python: Path) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.process = subprocess.Popen(
            [str(python), str(HERE / "mesh_peers.py")],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def run(self, engine: str, **arrays) -> dict:
        """Seconds of the engine alone, and its `vertices` and `faces`; arrays are what it is given."""
        given, made = Path(self.folder.name) / "given.npz", Path(self.folder.name) / "made.npz"
        np.savez(given, **arrays)
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.write(
            json.dumps({"engine": engine, "given": str(given), "made": str(made)}) + "\n"
        )
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise SystemExit(f"{engine}: the peers' process ended – see its message above")
        answer = json.loads(line)
        with np.load(made) as found:
            return {**answer, "vertices": found["vertices"], "faces": found["faces"]}

    def close(self) -> None:
        assert self.process.stdin is not None
        self.process.stdin.close()
        self.process.wait()
        self.folder.cleanup()
