"""Environments: one batch of flocks in the core, under four interfaces."""
