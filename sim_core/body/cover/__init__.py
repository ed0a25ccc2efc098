"""What a figure wears beneath garments, which goes with it and is not simulated."""

from sim_core.body.cover.cover import Cover, covered
from sim_core.body.cover.petticoat import Petticoat

__all__ = ["Cover", "Petticoat", "covered"]
