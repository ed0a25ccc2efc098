"""Fine vertices from coarse ones, without a network: fine = W @ coarse, and what frames of training add to that.

`location` finds points in the sheet at rest; `linear` and `biharmonic` are sparse matrices, the second by the energy
of `edge_laplacian`; `local_frames` regresses what that leaves on each coarse vertex's neighbourhood, in its own frame.
"""

from sim_core.learn.upsampling.biharmonic import Biharmonic, biharmonic
from sim_core.learn.upsampling.edge_laplacian import squared_laplacian
from sim_core.learn.upsampling.linear import linear
from sim_core.learn.upsampling.local_frames import LocalFrames, LocalFramesFit, TangentFrames, tangent_frames
from sim_core.learn.upsampling.location import located
from sim_core.learn.upsampling.weighted_sums import weighted_sums

__all__ = [
    "Biharmonic",
    "LocalFrames",
    "LocalFramesFit",
    "TangentFrames",
    "biharmonic",
    "linear",
    "located",
    "squared_laplacian",
    "tangent_frames",
    "weighted_sums",
]
