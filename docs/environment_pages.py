"""Writes docs/environments/*.md from the docstrings of the environment classes.

python docs/environment_pages.py
"""

import inspect
from pathlib import Path

import flockenv
from flockenv.sb3 import LeaderVecEnv

FOLDER = Path(__file__).parent / "environments"
CLASSES = (
    flockenv.LeadersEnv,
    flockenv.LeadersParallelEnv,
    flockenv.LeadersVectorEnv,
    LeaderVecEnv,
)


def pages() -> dict[Path, str]:
    """Every page's text."""
    return {
        FOLDER / f"{each.__name__}.md": f"# {each.__name__}\n\n{inspect.getdoc(each)}\n"
        for each in CLASSES
    }


if __name__ == "__main__":
    for path, text in pages().items():
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
