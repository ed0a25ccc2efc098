"""A shop figure from free body data: the body's mesh, the form without anatomy, its surface with weights."""

from sim_core.body.making.form import FormSettings, section
from sim_core.body.making.mesh import mannequin_of
from sim_core.body.making.source import Body, body_from_anny

__all__ = [
    "Body",
    "FormSettings",
    "body_from_anny",
    "mannequin_of",
    "section",
]
