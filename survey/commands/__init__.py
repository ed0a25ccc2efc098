"""Subcommands of `survey`, one module each: `add(commands)` declares it and sets what it runs.

`storage` holds those that keep the answers, `research` those that ask them, with the help that all share in `options`.
"""

from survey.commands.options import add_proxy

__all__ = ["add_proxy"]
