"""The questionnaire's HTTP interface."""

from survey.web.api.jobs import Jobs
from survey.web.api.rate_limit import Limit
from survey.web.api.routes import router

__all__ = ["Jobs", "Limit", "router"]
