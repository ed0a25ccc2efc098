"""The page at `/`, the catalogue, and what they are made of.

modules: the page's scripts as one; static: its files; client: viser's own; still, thumbnails: small pictures; door:
the page; catalogue: the hall without 3-D.
"""

from hall_app.web.pages.catalogue import Small, catalogue_html, shown_language
from hall_app.web.pages.client import ViserClient, viser_client
from hall_app.web.pages.door import content_security_policy, door_page
from hall_app.web.pages.modules import one_module
from hall_app.web.pages.static import PAGE_FOLDER, PageFiles, PageFolder, page_files
from hall_app.web.pages.still import still_jpeg
from hall_app.web.pages.thumbnails import EDGE, Thumbnails

__all__ = [
    "EDGE",
    "PAGE_FOLDER",
    "PageFiles",
    "PageFolder",
    "Small",
    "Thumbnails",
    "ViserClient",
    "catalogue_html",
    "content_security_policy",
    "door_page",
    "one_module",
    "page_files",
    "shown_language",
    "still_jpeg",
    "viser_client",
]
