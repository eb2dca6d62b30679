"""`python -m flockenv`: the command line."""

from flockenv_command import main

main()
