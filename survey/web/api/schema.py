"""What the API takes, as JSON Schema: the general form, and exactly what one questionnaire's version admits."""

from __future__ import annotations

from typing import Any

from survey.questionnaire import LANGUAGES, SLUG, TEXT_LIMIT, Questionnaire

__all__ = ["NO_CODE", "UUID_PATTERN", "submission_schema"]

UUID_PATTERN = "^[0-9a-fA-F]{8}-[0-9a-fA-F]{4}-[0-9a-fA-F]{4}-[0-9a-fA-F]{4}-[0-9a-fA-F]{12}$"

# The two that RFC 9562 sets apart: they are somebody's by accident, and everybody could withdraw under them.
NO_CODE: dict[str, Any] = {"pattern": "^([0-]{36}|[fF-]{36})$"}


def submission_schema(questionnaire: Questionnaire) -> dict[str, Any]:
    """JSON Schema (2020-12) of a submission to this version: what fits it is stored, what does not is refused."""
    points = {"type": "integer", "minimum": 1, "maximum": questionnaire.points}
    scores = {
        item.id: {"anyOf": [points, {"type": "null"}]}
        if questionnaire.scale.not_seen or not item.required
        else points
        for item in questionnaire.items
    }
    # NUL is no text to the database.
    text = {"type": "string", "maxLength": TEXT_LIMIT, "pattern": "^[^\\u0000]*$"}
    return {
        "type": "object",
        "additionalProperties": False,
        "required": ["id", "version", "language", "consent", "scores"],
        "properties": {
            "id": {"type": "string", "format": "uuid", "pattern": UUID_PATTERN, "not": NO_CODE},
            "version": {"const": questionnaire.version, "type": "integer"},
            "language": {"enum": list(LANGUAGES)},
            "consent": {"const": True},
            "scores": {
                "type": "object",
                "additionalProperties": False,
                "required": [item.id for item in questionnaire.items if item.required],
                "properties": scores,
            },
            "suggestions": {
                "type": "object",
                "additionalProperties": False,
                "properties": {module.id: text for module in questionnaire.modules if module.suggestion},
            },
            "exhibit": {"anyOf": [{"type": "string", "pattern": f"^{SLUG}$"}, {"type": "null"}]},
        },
    }
