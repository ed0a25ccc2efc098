"""Questionnaires: asked, kept, counted and analysed. Imports nothing of the hall or the simulation.

Names are handed out lazily (PEP 562), so that `import survey` loads neither a web framework nor a database.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from survey.analysis import Analysis, analyse
    from survey.answer import Answer
    from survey.api import router
    from survey.content import QuestionnaireFolder, content_folder, read_questionnaire
    from survey.errors import AnswerError, Problem, QuestionnaireError, StoreError, SurveyError
    from survey.form import Clip, form_router
    from survey.mounting import Mounted, mount
    from survey.questionnaire import Questionnaire
    from survey.store import Receipt, Store

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
    "Answer": "survey.answer",
    "router": "survey.api",
    "QuestionnaireFolder": "survey.content",
    "content_folder": "survey.content",
    "read_questionnaire": "survey.content",
    "AnswerError": "survey.errors",
    "Problem": "survey.errors",
    "QuestionnaireError": "survey.errors",
    "StoreError": "survey.errors",
    "SurveyError": "survey.errors",
    "Clip": "survey.form",
    "form_router": "survey.form",
    "Mounted": "survey.mounting",
    "mount": "survey.mounting",
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
