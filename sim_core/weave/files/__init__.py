"""Drafts and cloths from the files of other programs, by name or from a picture: what SOURCE of the command names.

`wif` reads and writes WIF, `dtx` Fiberworks' own files as the same sections, `profiles` blocks a profile draft out;
`sources` finds out which of these a source is, and holds the draft and the cloth that it can be woven into.
"""

from sim_core.weave.files.dtx import parse_dtx, read_dtx
from sim_core.weave.files.profiles import STRUCTURES, blocked_out, unit_of
from sim_core.weave.files.sources import Source, blocked_source, dressed, source_of, source_of_wif, weave_of

__all__ = [
    "STRUCTURES",
    "Source",
    "blocked_out",
    "blocked_source",
    "dressed",
    "parse_dtx",
    "read_dtx",
    "source_of",
    "source_of_wif",
    "unit_of",
    "weave_of",
]
