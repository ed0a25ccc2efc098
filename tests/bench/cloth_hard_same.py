"""Hard cases of sameness: a run that is broken off and resumed, and one with two threads, end in the same bits."""

import hashlib
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from cloth_course import Outcome

from sim_core.cloth import Drape, drape
from sim_core.cloth.scenes import bar

FRAMES_BEFORE = 9


def dropped(**more) -> Drape:
    """Contact, friction and self-contact: a cloth falls over a bar for 0.8 s."""
    made = bar(0.03, seconds=0.6)
    kinds = {"collider": made.collider, "contact": made.contact}
    return drape(made.sheet, made.positions, made.phases, **kinds, **more)


def bits(x: np.ndarray) -> str:
    return hashlib.sha256(np.ascontiguousarray(x).tobytes()).hexdigest()


def restarted() -> Outcome:
    """Broken off after some frames and resumed from its checkpoint."""
    whole = dropped(on_frame=lambda *_: None)

    def stop(index: int, _: np.ndarray) -> None:
        if index == FRAMES_BEFORE:
            raise KeyboardInterrupt

    with tempfile.TemporaryDirectory() as folder:
        kept = Path(folder) / "state"
        try:
            dropped(on_frame=stop, checkpoint=kept)
        except KeyboardInterrupt:
            pass
        again = dropped(on_frame=lambda *_: None, checkpoint=kept)
    same = bits(again.positions) == bits(whole.positions)
    off = float(np.abs(again.positions - whole.positions).max())
    figures = f"{whole.frames} frames, broken off after {FRAMES_BEFORE + 1}: {off:.0e} m apart"
    return Outcome(same, "the same bits", figures, whole.fallbacks)


def threaded() -> Outcome:
    """In two processes, one allowed one thread and the other two."""
    code = "import cloth_hard_same as s; print(s.bits(s.dropped().positions))"
    found = []
    for count in ("1", "2"):
        names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
        env = os.environ | dict.fromkeys(names, count)
        env["PYTHONPATH"] = os.pathsep.join([str(Path(__file__).parent), env.get("PYTHONPATH", "")])
        root = Path(__file__).parents[2]
        done = subprocess.run(
            [sys.executable, "-c", code], env=env, cwd=root, capture_output=True, text=True, check=True
        )
        found.append(done.stdout.strip())
    same = len(set(found)) == 1 and len(found[0]) == 64
    return Outcome(same, "the same bits", f"sha256 {' and '.join(f[:12] for f in found)}")


SAME: dict[str, Callable[[], Outcome]] = {
    "broken off and resumed": restarted,
    "one thread and two": threaded,
}
