"""What pages show of the content.

markdown: curators' texts as HTML; measurements: what a bake measured, in words; scene: the dictionaries of the API.
"""

from hall_app.content.views.markdown import html_of, link_allowed, pictures_in, plain_text, raw_html_in
from hall_app.content.views.scene import (
    TYPES,
    exhibit_json,
    media_file,
    media_type,
    own_file,
    own_picture,
    scene_json,
    thumbnail,
    yaw_of,
)

__all__ = [
    "TYPES",
    "exhibit_json",
    "html_of",
    "link_allowed",
    "media_file",
    "media_type",
    "own_file",
    "own_picture",
    "pictures_in",
    "plain_text",
    "raw_html_in",
    "scene_json",
    "thumbnail",
    "yaw_of",
]
