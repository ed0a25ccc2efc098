"""Can a visitor come to each exhibit on foot and face it? Do the exhibits' bodies keep apart?"""

from __future__ import annotations

import math

import numpy as np

from hall_app.content.behaviours import kind_of
from hall_app.content.floor.placement import overlapping_bodies
from hall_app.content.floor.walkable import facing_spots, reached_spots
from hall_app.content.folder import Content, Exhibit
from hall_app.content.problems import Problem

WITHIN = 2.2  # [m] from the exhibit's body: nearer than a visitor has to be for its caption
FRONT = math.cos(math.radians(75))  # an exhibit is faced from within this angle to its front


def reach_problems(content: Content) -> list[Problem]:
    """Exhibits nobody can walk to or face, and pairs whose rigid bodies overlap."""
    if not content.exhibits:
        return []
    spots = reached_spots(content)
    found = [problem for exhibit in content.exhibits for problem in _unreached(content, exhibit, spots)]
    files = [(exhibit.id, exhibit.file) for exhibit in content.exhibits]
    for first, second in overlapping_bodies(files):
        what, fix = f"its body overlaps that of exhibit {second!r}", "move one of them or make a body smaller"
        found.append(Problem(f"exhibits/{first}/exhibit.toml", "body", what, fix))
    return found


def _unreached(content: Content, exhibit: Exhibit, spots: np.ndarray) -> list[Problem]:
    seen = facing_spots(content, exhibit, spots, within=WITHIN)
    if not len(seen):
        what = f"cannot be reached on foot: nobody comes within {WITHIN:g} m and sees it (behind a wall?)"
        fix = "move place.x, place.z to the open side, or open a way of 0.75 m in plan.toml"
        return [Problem(exhibit.toml, "place", what, fix)]
    if kind_of(exhibit.file.behaviours) != "still":
        return []  # it shows every side, or its front to everybody, by itself
    place = exhibit.file.place
    front = np.array([math.sin(math.radians(place.facing)), math.cos(math.radians(place.facing))])
    to_visitor = seen - [place.x, place.z]
    cosines = to_visitor @ front / np.maximum(np.linalg.norm(to_visitor, axis=1), 1e-9)
    if cosines.max() < FRONT:
        what = "can be reached only from behind"
        return [Problem(exhibit.toml, "place.facing", what, "turn its front to the free floor")]
    return []
