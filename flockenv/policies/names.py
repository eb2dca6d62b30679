"""The names of laws, as the core declares them: commands, recordings and pictures have the same."""

from collections.abc import Mapping
from typing import Any

from flockenv import _core

LAWS: Mapping[str, Mapping[str, Any]] = {each["name"]: each for each in _core.LAWS}
"""What is declared of each law, by name: ``doc``, ``color`` (or None) and ``is_of_pool``."""

EVERY_SUBSTEP, PAPERS_LAW, DAMPED_LAW, TUNED_LAW, LEARNED, *OTHER_LAWS = LAWS
"""The paper's law evaluated at every substep, from the pose: what `simulate` does without a policy.
`PAPERS_LAW` is evaluated at every decision, from the observation, as other policies are."""
