"""Questionnaires: asked, kept, counted and analysed. Imports nothing of the hall or the simulation.

Names are handed out lazily (PEP 562), so that `import survey` loads neither a web framework nor a database.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from survey.analysis import Analysis, analyse
    from survey.errors import AnswerError, Problem, QuestionnaireError, StoreError, SurveyError
    from survey.questionnaire import (
        Answer,
        Questionnaire,
        QuestionnaireFolder,
        content_folder,
        read_questionnaire,
    )
    from survey.store import Receipt, Store
    from survey.web import Mounted, mount
    from survey.web.api import router
    from survey.web.form import Clip, Ways, form_router

__all__ = [
    "Analysis",
    "Answer",
    "AnswerError",
    "Clip",
    "Mounted",
    "Problem",
    "Questionnaire",
    "QuestionnaireError",
    "QuestionnaireFolder",
    "Receipt",
    "Store",
    "StoreError",
    "SurveyError",
    "Ways",
    "analyse",
    "content_folder",
    "form_router",
    "mount",
    "read_questionnaire",
    "router",
]

_HOME = {
    "Analysis": "survey.analysis",
    "analyse": "survey.analysis",
    "Answer": "survey.questionnaire",
    "router": "survey.web.api",
    "QuestionnaireFolder": "survey.questionnaire",
    "content_folder": "survey.questionnaire",
    "read_questionnaire": "survey.questionnaire",
    "AnswerError": "survey.errors",
    "Problem": "survey.errors",
    "QuestionnaireError": "survey.errors",
    "StoreError": "survey.errors",
    "SurveyError": "survey.errors",
    "Clip": "survey.web.form",
    "Ways": "survey.web.form",
    "form_router": "survey.web.form",
    "Mounted": "survey.web",
    "mount": "survey.web",
    "Questionnaire": "survey.questionnaire",
    "Receipt": "survey.store",
    "Store": "survey.store",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module 'survey' has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value
