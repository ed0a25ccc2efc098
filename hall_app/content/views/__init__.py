"""What pages show of the content.

markdown: curators' texts as HTML; measurements: what a bake measured, in words; scene: the dictionaries of the API;
sources: what no visitor is handed; writing: articles, and where what they name is read.
"""

from hall_app.content.views.markdown import (
    html_of,
    link_allowed,
    pictures_in,
    plain_text,
    raw_html_in,
    references_in,
    undescribed_in,
    words_in,
)
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
from hall_app.content.views.sources import is_source
from hall_app.content.views.writing import (
    article_html,
    article_picture,
    articles_on,
    image_html,
    is_written,
    page_of,
    plot_picture,
    spoken_of,
    weave_picture,
    words_of,
    writing_file,
)

__all__ = [
    "TYPES",
    "article_html",
    "article_picture",
    "articles_on",
    "image_html",
    "is_source",
    "is_written",
    "page_of",
    "words_in",
    "plot_picture",
    "references_in",
    "spoken_of",
    "undescribed_in",
    "weave_picture",
    "words_of",
    "writing_file",
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
