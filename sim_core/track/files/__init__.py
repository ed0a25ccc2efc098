"""Motion files: BVH, arrays, sensors' streams, and which joints of theirs are which."""

from sim_core.track.files.arrays import read_arrays, write_tracked
from sim_core.track.files.bvh import Bvh, read_bvh
from sim_core.track.files.mapping import MAPPINGS, JointMapping, load_mapping, mapping_for
from sim_core.track.files.reading import ENDINGS, read_recording
from sim_core.track.files.stream import read_csv_stream, read_json_stream

__all__ = [
    "Bvh",
    "ENDINGS",
    "JointMapping",
    "MAPPINGS",
    "load_mapping",
    "mapping_for",
    "read_arrays",
    "read_bvh",
    "read_csv_stream",
    "read_json_stream",
    "read_recording",
    "write_tracked",
]
