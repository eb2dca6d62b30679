"""Many runs as data: what to run, where results are stored, and how many run at once.

A `RunSpec` says all that a run depends on; `execute` makes it, and `run_missing` makes those of
many that a `RunStore` lacks, on an engine of `flockenv.runs.executors`: it resumes where work was
ended. `Shard` shares them among machines. `read_sweep` and `run_sweep` make a table of a grid.
Runs in which something changes on the way: `simulate_alternating`, `simulate_loop`, and
`simulate_prepared` from `initial_flock`. `POLICY_SEEDS` is the one table of seed ranges by use.
"""

from flockenv.runs.executors import ENGINES, Engine, in_order, named
from flockenv.runs.protocols.hysteresis import simulate_loop, simulate_prepared
from flockenv.runs.protocols.initial_state import initial_flock
from flockenv.runs.protocols.target_switching import simulate_alternating
from flockenv.runs.seeds import POLICY_SEEDS, SeedRange
from flockenv.runs.spec import KEEP, PROTOCOLS, RunSpec, execute
from flockenv.runs.store import RunStore, StorageError, StoreWarning, run_missing
from flockenv.runs.sweep import load_sweep, run_sweep, to_xarray
from flockenv.runs.sweep_spec import SweepSpec, read_sweep
from flockenv.runs.workload import Shard, Workload, measure_workload

__all__ = [
    "ENGINES",
    "KEEP",
    "POLICY_SEEDS",
    "PROTOCOLS",
    "Engine",
    "RunSpec",
    "RunStore",
    "SeedRange",
    "Shard",
    "StorageError",
    "StoreWarning",
    "SweepSpec",
    "Workload",
    "execute",
    "in_order",
    "initial_flock",
    "load_sweep",
    "measure_workload",
    "named",
    "read_sweep",
    "run_missing",
    "run_sweep",
    "simulate_alternating",
    "simulate_loop",
    "simulate_prepared",
    "to_xarray",
]
