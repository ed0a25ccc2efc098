"""What strangers may ask for.

budgets: of each kind, with a clock in the hand; addresses: the same per address, asked by the doorkeeper; open_lines:
which connections are open; portions: large answers, bit by bit; descriptors: how many files may be open. lines and
listener put them into uvicorn, and are imported where it runs.
"""

from hall_app.web.limits.addresses import MOST_SILENT, MOST_SILENT_IN_ALL, RATES, Addresses, Silent, name_of
from hall_app.web.limits.budgets import RELAY, WALK, Allowance, Bucket, Rate, Verdict
from hall_app.web.limits.descriptors import connections, raise_limit, shortage
from hall_app.web.limits.doorkeeper import Doorkeeper, address_of
from hall_app.web.limits.open_lines import ASKS_WITHIN, MOST_OF_ONE_ADDRESS, TAKES_WITHIN, OpenLine, OpenLines
from hall_app.web.limits.portions import PORTION, Portions

__all__ = [
    "ASKS_WITHIN",
    "MOST_OF_ONE_ADDRESS",
    "MOST_SILENT",
    "MOST_SILENT_IN_ALL",
    "PORTION",
    "RATES",
    "RELAY",
    "TAKES_WITHIN",
    "WALK",
    "Addresses",
    "Allowance",
    "Bucket",
    "Doorkeeper",
    "OpenLine",
    "OpenLines",
    "Portions",
    "Rate",
    "Silent",
    "Verdict",
    "address_of",
    "connections",
    "name_of",
    "raise_limit",
    "shortage",
]
