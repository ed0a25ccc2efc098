"""The pages to read: articles, glossary, weaves, numbers, search; every one in both languages and without an account.

culture: articles; glossary: words and weaves; research: what was measured; bibliography: its papers; search: what was
found; routes: their addresses.
"""

from hall_app.web.reading.bibliography import bibliography
from hall_app.web.reading.culture import Pictures
from hall_app.web.reading.routes import add_reading

__all__ = ["Pictures", "add_reading", "bibliography"]
