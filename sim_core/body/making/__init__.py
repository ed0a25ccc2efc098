"""A shop figure from free body data: the body's mesh, the form without anatomy, its surface with weights."""

from sim_core.body.making.figures import FIGURES, Made
from sim_core.body.making.form import FormSettings, section
from sim_core.body.making.mesh import mannequin_of
from sim_core.body.making.source import Body, body_from_anny, t_posed, turn_between

__all__ = [
    "FIGURES",
    "Body",
    "FormSettings",
    "Made",
    "body_from_anny",
    "mannequin_of",
    "section",
    "t_posed",
    "turn_between",
]
