"""Files, optional packages and Ctrl-C: what has nothing to do with boats."""
