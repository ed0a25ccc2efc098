"""The counter: what all pages with forms have in common.

asking: what a page is asked and what it answers; cookies: of sessions; guard: whether a form is one of ours; pace: how
often one may try; fields: forms as HTML; clock: days and hours told; leaves: long lists on pages; counter: pages and
acts put at their addresses, refusals told; signing_in: what both counters let in by.
"""

from hall_app.web.platform.counter.asking import Asking, Brought, Download, Guest, Moved, Page, Shown
from hall_app.web.platform.counter.clock import clock_line, told_day, told_hours, told_time
from hall_app.web.platform.counter.cookies import OFFICE, VISITOR
from hall_app.web.platform.counter.counter import LEAD, STATUS, Act, Answer, Counter, View
from hall_app.web.platform.counter.fields import Field, button, form
from hall_app.web.platform.counter.guard import PLAIN, Form, Takes, form_of, is_whole
from hall_app.web.platform.counter.leaves import leaf_asked, leaf_ways
from hall_app.web.platform.counter.pace import RATES, Pace
from hall_app.web.platform.counter.signing_in import address_field, sign_in_fields, signed_in

__all__ = [
    "LEAD",
    "OFFICE",
    "PLAIN",
    "RATES",
    "STATUS",
    "VISITOR",
    "Act",
    "Answer",
    "Asking",
    "Brought",
    "Counter",
    "Download",
    "Field",
    "Form",
    "Guest",
    "Moved",
    "Pace",
    "Page",
    "Shown",
    "Takes",
    "View",
    "address_field",
    "button",
    "clock_line",
    "form",
    "form_of",
    "is_whole",
    "leaf_asked",
    "leaf_ways",
    "sign_in_fields",
    "signed_in",
    "told_day",
    "told_hours",
    "told_time",
]
