"""Data to learn from: published scenes simulated coarse and free, and fine, softly led by the coarse."""

from sim_core.learn.data.film import Film, coarse_film, film, fine_film
from sim_core.learn.data.gate import GATE, Floor, floor, looked_at
from sim_core.learn.data.generation import generate
from sim_core.learn.data.lead import STIFFNESS, Lead
from sim_core.learn.data.pair import Pair
from sim_core.learn.data.pools import POOLINGS, pooled_by_kind, pooled_takes
from sim_core.learn.data.recipe import DESIGNS, Design, Recipe, recipes
from sim_core.learn.data.split import Split, split
from sim_core.learn.data.store import MANIFEST, Manifest, read_films, read_sequence
from sim_core.learn.data.take import Take

__all__ = [
    "DESIGNS",
    "GATE",
    "MANIFEST",
    "POOLINGS",
    "STIFFNESS",
    "Design",
    "Film",
    "Floor",
    "Lead",
    "Manifest",
    "Pair",
    "Recipe",
    "Split",
    "Take",
    "coarse_film",
    "film",
    "fine_film",
    "floor",
    "generate",
    "looked_at",
    "pooled_by_kind",
    "pooled_takes",
    "read_films",
    "read_sequence",
    "recipes",
    "split",
]
