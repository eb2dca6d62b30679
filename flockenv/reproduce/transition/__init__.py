"""The order of the transition between rotation and disorder."""
