"""What strangers may ask for.

budgets: of each kind, with a clock in the hand; addresses: the same per address, asked by the doorkeeper; open_lines:
which connections are open; portions: large answers, bit by bit; descriptors: how many files may be open. lines puts
them into uvicorn, and is imported where it runs.
"""

from hall_app.web.limits.addresses import MOST_SILENT, MOST_SILENT_IN_ALL, RATES, Addresses, name_of
from hall_app.web.limits.budgets import RELAY, WALK, Allowance, Bucket, Rate
from hall_app.web.limits.descriptors import connections, raise_limit, shortage
from hall_app.web.limits.doorkeeper import Doorkeeper, address_of
from hall_app.web.limits.open_lines import ASKS_WITHIN, MOST_OF_ONE_ADDRESS, TAKES_WITHIN, OpenLines
from hall_app.web.limits.portions import PORTION, Portions
from hall_app.web.limits.shares import Shares
from hall_app.web.limits.threads import few_threads

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
    "OpenLines",
    "Portions",
    "Rate",
    "Shares",
    "address_of",
    "connections",
    "few_threads",
    "name_of",
    "raise_limit",
    "shortage",
]
