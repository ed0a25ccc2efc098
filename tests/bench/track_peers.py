"""RoMa's registration of corresponding points. Runs in the peers' environment and imports nothing of the project.

Reads one JSON object a line: {"engine", "given": npz with source and target (N, 3), "made": npz}; answers
{"seconds": …} of one registration, the median of some in a row, and the rotation it found.
"""

import json
import statistics
import sys
from time import perf_counter

import numpy as np
import roma
import torch

torch.set_num_threads(1)


def registered(given):
    source, target = (torch.from_numpy(given[name]) for name in ("source", "target"))
    times = []
    for _ in range(50):
        begin = perf_counter()
        rotation, translation = roma.rigid_points_registration(source, target)
        times.append(perf_counter() - begin)
    return statistics.median(times), rotation.numpy(), translation.numpy()


def main() -> int:
    for line in sys.stdin:
        asked = json.loads(line)
        with np.load(asked["given"]) as given:
            seconds, rotation, translation = registered(given)
        np.savez(asked["made"], rotation=rotation, translation=translation)
        print(json.dumps({"seconds": seconds}), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
