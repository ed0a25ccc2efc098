"""Motifs: figures that repeat, drawn in millimetres by small programs, and cut to the sett of a loom.

`strokes` is what one draws with, `programs` the figures, `motif` the value and its cut, `motif_file` their TOML.
"""

from sim_core.weave.draft.motifs.motif import Motif, cut
from sim_core.weave.draft.motifs.motif_file import motif_of_program, program_of, read_motif
from sim_core.weave.draft.motifs.programs import PROGRAMS

__all__ = ["PROGRAMS", "Motif", "cut", "motif_of_program", "program_of", "read_motif"]
