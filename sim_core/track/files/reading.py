"""Any motion file becomes a recording of a Kinect's joints."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sim_core.errors import FileProblem, SimCoreError
from sim_core.track.files.arrays import read_arrays
from sim_core.track.files.bvh import read_bvh
from sim_core.track.files.mapping import load_mapping, mapping_for
from sim_core.track.files.stream import read_csv_stream, read_json_stream
from sim_core.track.recording import Recording

__all__ = ["ENDINGS", "read_recording"]

ENDINGS = (".bvh", ".npz", ".csv", ".json")


def read_recording(path: Path, mapping: str | None = None, unit: float | None = None) -> Recording:
    """The recording of a BVH file, an npz of arrays, or a sensor's stream (CSV, JSON).

    mapping: of MAPPINGS or a file (None: found by the names of the joints); unit [m] of the file's lengths (None: the
    mapping's, else told by stature in a BVH file, metres in others). Raises FileProblem, with line and column where
    the file has any.
    """
    chosen = None if mapping is None else load_mapping(mapping)
    kind = path.suffix.lower()
    if kind == ".bvh":
        file = read_bvh(path)
        places, _ = file.moved()
        known = chosen or mapping_for(file.names)
        time = np.arange(len(places)) * file.seconds
        try:
            return known.applied(file.names, places, time, unit)
        except SimCoreError as error:
            raise FileProblem(f"{path}: {error}") from error
    if kind == ".npz":
        return read_arrays(path, chosen, unit)
    if kind in (".csv", ".json"):
        if chosen is not None:
            raise FileProblem(f"{path}: a stream names a Kinect's joints itself – leave the mapping away")
        return (read_csv_stream if kind == ".csv" else read_json_stream)(path, 1.0 if unit is None else unit)
    raise FileProblem(f"{path}: no motion file – give one that ends with {', '.join(ENDINGS)}")
