"""The tasks of BenchMARL: many flocks behind TorchRL, and the policies that its learners find.

Needs the extra ``benchmarl``: ``pip install flockenv[benchmarl]``. ``python -m flockenv.benchmarl
task=flockenv/lean algorithm=mappo`` is BenchMARL's own command with these tasks.
"""

from flockenv._io.extras import require

require("benchmarl", "benchmarl")

# ruff: noqa: E402 - after the check above
from flockenv.benchmarl.tasks import CONF, LeadersTask, LeadersTaskClass, network_policy, register

__all__ = ["CONF", "LeadersTask", "LeadersTaskClass", "network_policy", "register"]

register()
