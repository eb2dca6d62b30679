"""Many runs as data: their specs, their store, and the engines that make them.

A `RunSpec` says all that a run depends on; `execute` makes it, and `run_missing` makes those of
many that a `RunStore` lacks, on an engine of `flockenv.runs.executors`: it resumes where work was
ended. `Shard` shares them among machines. `read_sweep` and `run_sweep` make a table of a grid.
`POLICY_SEEDS` is the one table of seed ranges by use.
"""
