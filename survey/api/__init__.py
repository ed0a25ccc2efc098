"""The questionnaire's HTTP interface."""

from survey.api.router import router

__all__ = ["router"]
