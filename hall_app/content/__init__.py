"""The hall's content: files read into frozen values, checked, watched, and shown to the page as JSON."""

from hall_app.content.floor import Footprint, foot_height, solids_of
from hall_app.content.folder import Content, Exhibit
from hall_app.content.loading import load
from hall_app.content.lookup import content_folder
from hall_app.content.problems import ContentError, Problem
from hall_app.content.reload import Watcher
from hall_app.content.views import exhibit_json, media_file, scene_json, yaw_of
from hall_app.content.walkable import walking_floor

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
