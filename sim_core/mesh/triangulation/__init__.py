"""Triangulation."""
