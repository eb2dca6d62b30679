"""Many runs as data: their specs, their store, and the engines that make them.

A `RunSpec` holds everything on which a run depends, and `execute` makes that run. `run_missing`
makes the runs that a `RunStore` lacks, on an engine of `flockenv.runs.executors`, so interrupted
work resumes. `Shard` divides runs among machines. `read_sweep` reads a grid of parameters, and
`run_sweep` makes a table of its runs. `POLICY_SEEDS` is the one table of seed ranges by use.
"""
