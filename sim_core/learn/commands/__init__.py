"""What `simcore learn` does, one module an action."""
