"""The hall's content: files read into frozen values, checked, watched, and shown to the page as JSON."""

from .floor import Footprint, foot_height, solids_of
from .folder import Content, Exhibit
from .loading import load
from .lookup import content_folder
from .problems import ContentError, Problem
from .reload import Watcher
from .views import exhibit_json, media_file, scene_json, yaw_of
from .walkable import walking_floor

__all__ = [
    "Content",
    "ContentError",
    "Exhibit",
    "Footprint",
    "Problem",
    "Watcher",
    "content_folder",
    "exhibit_json",
    "foot_height",
    "load",
    "media_file",
    "scene_json",
    "solids_of",
    "walking_floor",
    "yaw_of",
]
