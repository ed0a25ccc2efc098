"""The office: what the house has behind its pages, /office for people and /api/office for programs.

deeds: what can be read and done, each with the act of the table of roles that it takes; access: both doors to it, one
check; entering: signing in, the first page; the parts: collection, people,
programme, questionnaires, opinions, backups; description: the API as OpenAPI; table: rows as HTML.
"""

from hall_app.web.platform.office.routes import add_office

__all__ = ["add_office"]
