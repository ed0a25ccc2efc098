"""What layers cost on cloth that hardly touches itself: the flag and a hanging sheet, with and without them.

    python tests/bench/cloth_idle.py [--frames N]

Processor milliseconds a frame of 1/25 s, and a frame's looks at where the cloth is, renewals of lists, of those among
other pairs of patches, pairs looked at anew and looked through. Scenes with and without layers go in turns.
"""

import argparse
import hashlib
import time

import numpy as np

from sim_core.cloth import Contact
from sim_core.cloth.run import Run, Setup
from sim_core.cloth.scenes import scene

SCENES = {"flag": 1, "hanging": 2}  # and their cases
THICKNESS = 0.003  # [m]


def told(name: str, case: int, thickness: float, frames: int) -> str:
    """A line for people about a run of so many frames."""
    made = scene(name, case, frames=frames).layered(thickness)
    contact = made.contact or Contact()
    run = Run(Setup(made.sheet, made.phases, contact=contact, pins=made.pins, air=made.air))
    state, spent = run.begun(np.array(made.positions, float), np.zeros_like(made.positions)), []
    for _ in range(frames):
        begin = time.process_time()
        run.frame(state)
        spent.append(1e3 * (time.process_time() - begin))
    tally = ", ".join(f"{count / frames:.0f}" for count in run.engine.near.tally)
    bits = hashlib.sha1(state.positions.tobytes()).hexdigest()[:10]
    middle, mean = np.median(spent[1:]), np.mean(spent[1:])
    return f"{name}, {1e3 * thickness:g} mm: mean {mean:.1f} ms, median {middle:.1f}; {tally}; {bits}"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--frames", type=int, default=50, help="of every run (50)")
    args = parser.parse_args()
    for name, case in SCENES.items():
        for thickness in (0.0, THICKNESS):  # compiles
            told(name, case, thickness, 2)
        for _ in range(2):
            for thickness in (0.0, THICKNESS):
                print(told(name, case, thickness, args.frames), flush=True)


if __name__ == "__main__":
    main()
