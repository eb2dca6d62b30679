"""The names of laws, as the core declares them: commands, recordings and pictures have the same."""

from collections.abc import Mapping
from typing import Any

from flockenv import _core

LAWS: Mapping[str, Mapping[str, Any]] = {law["name"]: law for law in _core.LAWS}
"""The declaration of each law, by name: ``doc``, ``color`` (or None) and ``is_of_pool``."""

# "paper's law" under the key "PAPERS_LAW", and so on.
_CONSTANTS = {name.upper().replace("'", "").replace(" ", "_"): name for name in LAWS}

EVERY_SUBSTEP = _CONSTANTS.pop("PAPERS_LAW_AT_EVERY_SUBSTEP")
"""The paper's law evaluated at every substep, from the pose, as `simulate` does without a policy.
`PAPERS_LAW` is evaluated at every decision, from the observation, as other policies are."""
PAPERS_LAW = _CONSTANTS.pop("PAPERS_LAW")
DAMPED_LAW = _CONSTANTS.pop("DAMPED_LAW")
TUNED_LAW = _CONSTANTS.pop("TUNED_LAW")
LEARNED = _CONSTANTS.pop("LEARNED")
OTHER_LAWS = (*_CONSTANTS.values(),)
"""The names of the laws that have no Python class of their own."""
