"""What stands in the hall, and what it does.

compression, pieces: large bytes by address; scene: what viser draws; exhibits: what is drawn of the content; stage:
who is near what, what is clicked, and what follows from it.
"""

from hall_app.show.compression import best_frame
from hall_app.show.exhibits import Drawn, drawn_exhibits
from hall_app.show.pieces import LEAN, PICTURE, Pieces, split
from hall_app.show.scene import STUDIO, Figure, HallScene, Model
from hall_app.show.stage import Actor, Figures, Stage

__all__ = [
    "LEAN",
    "PICTURE",
    "STUDIO",
    "Actor",
    "Drawn",
    "Figure",
    "Figures",
    "HallScene",
    "Model",
    "Pieces",
    "Stage",
    "best_frame",
    "drawn_exhibits",
    "split",
]
