"""Motifs: figures that repeat, drawn in millimetres by small programs, and cut to the sett of a loom.

`strokes` is what one draws with, `programs` the figures, `motif` the value and its cut, `drawing` reads
them from SVG, `layout` puts several into one repeat, `motif_file` is their TOML.
"""

from sim_core.weave.draft.motifs.layout import Part
from sim_core.weave.draft.motifs.motif import Motif, cut
from sim_core.weave.draft.motifs.motif_file import Recipe, motif_of_program, read_motif, recipe_of
from sim_core.weave.draft.motifs.programs import PROGRAMS

__all__ = ["PROGRAMS", "Motif", "Part", "Recipe", "cut", "motif_of_program", "read_motif", "recipe_of"]
