"""The provenance of a policy's file: version, commit, command."""

import platform
import subprocess
from pathlib import Path

from flockenv._core import __version__


def commit() -> str:
    """Return the commit that flockenv runs from, with a + if files differ from it.

    An installed package has no commit: "unknown".
    """
    root = Path(__file__).parents[2]
    if not (root / ".git").exists():
        return "unknown"

    def git(*arguments: str) -> str:
        process = subprocess.run(["git", "-C", root, *arguments], capture_output=True, text=True)
        process.check_returncode()
        return process.stdout.strip()

    try:
        suffix = "+" if git("status", "--porcelain", "--untracked-files=no") else ""
        return git("rev-parse", "--short=12", "HEAD") + suffix
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def provenance_of(
    command: str, *, seed: int, samples: int, cpu_s: float, flock_hours: float | None = None
) -> dict[str, str]:
    """Return the provenance of a policy's file as short texts.

    Parameters
    ----------
    command
        The command that makes the policy again.
    seed
        Seed of the training.
    samples
        Number of leaders' decisions in the training.
    cpu_s
        Processor time of the training in s, on all cores together.
    flock_hours
        Simulated flock-hours of the training.

    Returns
    -------
    dict
        The arguments, the versions of flockenv and Python, and the commit.
    """
    hours = {} if flock_hours is None else {"flock_hours": f"{flock_hours:.6g}"}
    return {
        "command": command,
        "flockenv": __version__,
        "commit": commit(),
        "python": platform.python_version(),
        "seed": str(seed),
        "samples": str(samples),
        **hours,
        "cpu_s": f"{cpu_s:.0f}",
    }
