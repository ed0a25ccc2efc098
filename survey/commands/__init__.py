"""What the subcommands of `survey` do; survey/cli.py puts them together."""
