"""Runs in which something changes on the way: targets, noise, density, or how they start."""
