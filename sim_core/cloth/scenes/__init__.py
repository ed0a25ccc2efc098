"""The published scenes, the choice of mesh and setting for a wanted error, and what comes of a run."""

from sim_core.cloth.scenes.catalogue import (
    GF_CM,
    NAMES,
    PINS,
    Scene,
    bar,
    cases,
    drape_coefficient,
    hang_edge,
    material,
    scene,
)
from sim_core.cloth.scenes.fidelity import FILE, Alternative, Asked, Choice, bounds, choose, law_terms, table
from sim_core.cloth.scenes.limb import limb_mesh
from sim_core.cloth.scenes.regular_sheets import disc, equilateral_sheet, sheet_of
from sim_core.cloth.scenes.teapot import teapot_mesh, teapot_solid
from sim_core.cloth.scenes.trial_runs import GRID, TRIAL_EDGES, apart, gap, grid_film, trial_film

__all__ = [
    "Alternative",
    "Asked",
    "Choice",
    "FILE",
    "GF_CM",
    "GRID",
    "NAMES",
    "PINS",
    "Scene",
    "TRIAL_EDGES",
    "apart",
    "bar",
    "bounds",
    "cases",
    "choose",
    "disc",
    "drape_coefficient",
    "equilateral_sheet",
    "gap",
    "grid_film",
    "hang_edge",
    "law_terms",
    "limb_mesh",
    "material",
    "scene",
    "sheet_of",
    "table",
    "teapot_mesh",
    "teapot_solid",
    "trial_film",
]
