"""The survey over HTTP."""
