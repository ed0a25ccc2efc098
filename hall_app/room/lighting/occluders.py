"""The exhibits as the light meets them: their hall models as bare triangles where they stand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hall_app.content.bakes.models import models_of
from hall_app.content.floor.footprints import foot_height
from hall_app.content.folder import Content
from hall_app.room.patch import Frame

__all__ = ["exhibit_solids"]


def exhibit_solids(content: Content, data: Path) -> list[tuple[NDArray[np.float64], NDArray[np.int32]]]:
    """(vertices (V, 3) [m], faces (F, 3)) of every exhibit that stands still and has a model."""
    import trimesh

    found = []
    for exhibit in content.exhibits:
        models = models_of(content, exhibit, data)
        if models is None or not models.hall.is_file():
            continue
        mesh = trimesh.load_scene(models.hall, file_type="glb").to_mesh()
        mesh.update_faces(mesh.area_faces > 0.0)  # what is seen from afar alone has no size here
        place = exhibit.file.place
        height = foot_height(content.plan, exhibit.file)
        frame = Frame.on_floor((place.x, place.z), place.facing, height)
        found.append((frame(np.asarray(mesh.vertices)), np.asarray(mesh.faces, np.int32)))
    return found
