"""The page at `/`, the catalogue, and what they are made of.

modules: the page's scripts as one; static: its files; client: viser's own; still, thumbnails: small pictures; door:
the page; catalogue: the hall without 3-D.
"""

from hall_app.web.pages.catalogue import catalogue_html
from hall_app.web.pages.client import viser_client
from hall_app.web.pages.door import door_page
from hall_app.web.pages.modules import one_module
from hall_app.web.pages.static import PAGE_FOLDER, PageFiles, PageFolder, page_files
from hall_app.web.pages.thumbnails import EDGE, Thumbnails

__all__ = [
    "EDGE",
    "PAGE_FOLDER",
    "PageFiles",
    "PageFolder",
    "Thumbnails",
    "catalogue_html",
    "door_page",
    "one_module",
    "page_files",
    "viser_client",
]
