"""The page on which a visitor answers: HTML from the server, one script, one style sheet, nothing from elsewhere."""

from survey.web.form.clip import Clip
from survey.web.form.routes import form_router

__all__ = ["Clip", "form_router"]
