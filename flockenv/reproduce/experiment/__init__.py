"""Section 4: the experiment's figures."""
