"""The values of --seed in training scripts."""

import argparse

#: CMA-ES and NumPy take no others.
MOST = (1 << 32) - 1


def run_number(text: str) -> int:
    """Return the number of a training run, as argparse's `type` of an option."""
    if not text.isdecimal() or int(text) > MOST:
        raise argparse.ArgumentTypeError(f"{text} is not accepted: from 0 to {MOST}")
    return int(text)
