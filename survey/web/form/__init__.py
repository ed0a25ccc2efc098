"""The page on which a visitor answers: HTML from the server, one script, one style sheet, nothing from elsewhere."""

from survey.web.form.clip import Clip, ClipOf
from survey.web.form.page import Home, Ways, document, form_page, heading, words
from survey.web.form.routes import HEADERS, PageRoute, Preferred, Wanted, chosen_language, form_router

__all__ = [
    "HEADERS",
    "Clip",
    "ClipOf",
    "Home",
    "PageRoute",
    "Preferred",
    "Wanted",
    "Ways",
    "chosen_language",
    "document",
    "form_page",
    "form_router",
    "heading",
    "words",
]
