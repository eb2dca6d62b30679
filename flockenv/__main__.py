"""`python -m flockenv`: the command line."""

from flockenv.cli import main

main()
