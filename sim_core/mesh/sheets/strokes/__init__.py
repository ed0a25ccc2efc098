"""Strokes."""
