"""Files, optional packages and Ctrl-C: everything that has nothing to do with boats."""
