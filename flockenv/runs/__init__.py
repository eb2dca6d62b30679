"""Many runs as data: what to run, where results are stored, and how many run at once.

A `RunSpec` says all that a run depends on; `execute` makes it, and `run_missing` makes those of
many that a `RunStore` lacks, on an engine of `flockenv.runs.executors`: it resumes where work was
ended. `Shard` shares them among machines. `read_sweep` and `run_sweep` make a table of a grid.
`POLICY_SEEDS` is the one table of seed ranges by use.
"""

from flockenv.runs.executors import ENGINES, Engine, finished, in_order, named
from flockenv.runs.seeds import POLICY_SEEDS, SeedRange
from flockenv.runs.spec import KEEP, RunSpec, execute
from flockenv.runs.store import RunStore, StorageError, StoreWarning, run_missing
from flockenv.runs.sweep import SweepSpec, load_sweep, read_sweep, run_sweep, to_xarray
from flockenv.runs.workload import Shard, Workload, measure_workload

__all__ = [
    "ENGINES",
    "KEEP",
    "POLICY_SEEDS",
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
    "finished",
    "in_order",
    "load_sweep",
    "measure_workload",
    "named",
    "read_sweep",
    "run_missing",
    "run_sweep",
    "to_xarray",
]
