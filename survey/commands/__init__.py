"""Subcommands of `survey`, one module each: `add(commands)` declares it and sets what it runs."""
