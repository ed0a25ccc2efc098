"""A cloth and itself: patches, near pairs, repulsion, and the way out of tangles."""
