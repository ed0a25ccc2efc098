"""The hall's content: files read into frozen values, watched, and shown to the page.

problems, behaviours: what the rest speaks of. schema: the tables of its TOML files. files,
folder: what a folder names and holds, and the values it becomes. models: GLBs and pictures looked into. floor: what
stands where, and where one can walk. views: what pages show. bakes: where baked garments lie. loading: from a
folder to `Content`, and again after an edit. search: what is looked for in it. lookup: where the folders are.
"""

from hall_app.content.behaviours import BEHAVIOURS, Behaviour, Stage, behaviour
from hall_app.content.floor import Footprint, foot_height, solids_of, walking_floor
from hall_app.content.folder import Article, Cloth, Content, Exhibit, Writing
from hall_app.content.loading import Watcher, load
from hall_app.content.lookup import content_folder, make_data_folder
from hall_app.content.problems import ContentError, Problem
from hall_app.content.views import exhibit_json, media_file, scene_json, yaw_of

__all__ = [
    "BEHAVIOURS",
    "Article",
    "Behaviour",
    "Cloth",
    "Content",
    "ContentError",
    "Exhibit",
    "Footprint",
    "Problem",
    "Stage",
    "Watcher",
    "Writing",
    "behaviour",
    "content_folder",
    "exhibit_json",
    "foot_height",
    "load",
    "make_data_folder",
    "media_file",
    "scene_json",
    "solids_of",
    "walking_floor",
    "yaw_of",
]
