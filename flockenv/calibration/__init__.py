"""Constants of the preset "experiment", fitted to what the paper says of its boats."""
