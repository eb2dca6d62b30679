"""Hostile input: `make test` tries some of it, `make fuzz` much more (FUZZ_EXAMPLES of each)."""

import os

import hypothesis

hypothesis.settings.register_profile(
    "fuzz",
    max_examples=int(os.environ.get("FUZZ_EXAMPLES", "60")),
    deadline=None,
    suppress_health_check=list(hypothesis.HealthCheck),
)
