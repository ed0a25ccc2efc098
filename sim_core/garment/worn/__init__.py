"""Worn garments: carried on where they hang, with a wearer who moves, or through an outfit's motion to a loop."""

from sim_core.garment.worn.follow_body import follow
from sim_core.garment.worn.loop_closure import Lengths
from sim_core.garment.worn.pins import Pins
from sim_core.garment.worn.play import Played, move, moving_errors

__all__ = ["Lengths", "Pins", "Played", "follow", "move", "moving_errors"]
