"""Baking: from a pattern, a weave and a recipe to models, film and pictures."""
