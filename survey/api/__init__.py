"""The questionnaire's HTTP interface."""

from survey.api.limit import Limit
from survey.api.router import router

__all__ = ["Limit", "router"]
