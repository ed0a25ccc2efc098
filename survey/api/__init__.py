"""The questionnaire's HTTP interface."""

from survey.api.jobs import Jobs
from survey.api.limit import Limit
from survey.api.router import router

__all__ = ["Jobs", "Limit", "router"]
