"""What is asked and what is answered.

`keys` says what may stand as an id, `definition` holds a questionnaire in one version, `files` finds and re-reads the
TOML files that state them, and `answer` is one submission, validated against the version that it answers.
"""

from survey.questionnaire.answer import TEXT_LIMIT, Answer, ever_asked, submission_id
from survey.questionnaire.definition import (
    LANGUAGES,
    META_COLUMNS,
    NEEDS,
    NOT_ASKED,
    SUGGESTION,
    UNASKED,
    UNSEEN,
    Item,
    Language,
    Module,
    Need,
    Offers,
    Questionnaire,
    Text,
    suggestion_column,
)
from survey.questionnaire.files import (
    QUESTIONNAIRES,
    QuestionnaireFolder,
    content_folder,
    find_questionnaire_file,
    problem_of,
    read_questionnaire,
)
from survey.questionnaire.keys import COLUMN_KEY, SLUG, is_slug

__all__ = [
    "COLUMN_KEY",
    "LANGUAGES",
    "META_COLUMNS",
    "NEEDS",
    "NOT_ASKED",
    "QUESTIONNAIRES",
    "SLUG",
    "SUGGESTION",
    "TEXT_LIMIT",
    "UNASKED",
    "UNSEEN",
    "Answer",
    "Item",
    "Language",
    "Module",
    "Need",
    "Offers",
    "Questionnaire",
    "QuestionnaireFolder",
    "Text",
    "content_folder",
    "ever_asked",
    "find_questionnaire_file",
    "is_slug",
    "problem_of",
    "read_questionnaire",
    "submission_id",
    "suggestion_column",
]
