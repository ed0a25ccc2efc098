"""Yarns."""
