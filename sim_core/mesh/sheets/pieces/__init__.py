"""Lines of a drawing sorted into pieces.

`contours` puts closed lines into each other (`boxes` finds which may be around which, `scribbles` what
is no outline), `sizes` takes those apart that
are sizes of one piece, `sorting` says what all and the open ones are to their piece.
"""

from sim_core.mesh.sheets.pieces.sorting import SCRIBBLES, sorted_sheet

__all__ = ["SCRIBBLES", "sorted_sheet"]
