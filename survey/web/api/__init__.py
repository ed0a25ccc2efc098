"""The questionnaire's HTTP interface.

`routes` gathers what is read, submitted (`submission`) and handed to researchers (`research`). `lookup` finds the
version that is meant, `guard` admits by token, `rate_limit` counts addresses, `body` reads and `replies` answers;
`schema` is what a submission must look like, `results` what everybody sees, and `jobs` run in processes of their own.
"""

from survey.web.api.jobs import JOBS_AT_WORK, JOBS_OPEN, Jobs, Run
from survey.web.api.lookup import find_version
from survey.web.api.rate_limit import Limit
from survey.web.api.research import Wanted
from survey.web.api.routes import router

__all__ = ["JOBS_AT_WORK", "JOBS_OPEN", "Jobs", "Limit", "Run", "Wanted", "find_version", "router"]
