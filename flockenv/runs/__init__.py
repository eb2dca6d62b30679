"""Many runs as data: their specs, their store, and the engines that make them.

A `RunSpec` holds everything on which a run depends, and `execute` makes that run. `run_missing`
makes the runs that a `RunStore` lacks, on an engine of `flockenv.runs.executors`, so interrupted
work resumes. `Shard` shares them among machines. `read_sweep` and `run_sweep` make a table of a
grid. `POLICY_SEEDS` is the one table of seed ranges by use.
"""
