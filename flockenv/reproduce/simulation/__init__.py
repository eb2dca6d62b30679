"""Section 5: the simulation's figures and claims."""
