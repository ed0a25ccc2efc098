"""Moving garments as a value: frames of meshes at a rate, the figure's motion beside them, a file, a GLB for others.

frame_code: positions of one frame as bytes, and back; skinned: a figure that goes by its bones; drawn: which vertices
of a model go with which of a clip; clip: the value; clip_file: its bytes; model_clip: the clip of a model from what
moved; morphs: GLB with morph targets.
"""

from sim_core.garment.clip.clip import Clip, Moved
from sim_core.garment.clip.drawn import Drawn, drawn_in
from sim_core.garment.clip.frame_code import STEP, FrameCode
from sim_core.garment.clip.model_clip import model_clip
from sim_core.garment.clip.skinned import Skinned

__all__ = ["STEP", "Clip", "Drawn", "FrameCode", "Moved", "Skinned", "drawn_in", "model_clip"]
