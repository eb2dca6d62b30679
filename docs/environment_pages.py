"""The pages of the environments, written from the docstrings whenever the pages are built."""

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
    """Return the text of every page."""
    return {
        FOLDER / f"{each.__name__}.md": f"# {each.__name__}\n\n{inspect.getdoc(each)}\n"
        for each in CLASSES
    }


def write() -> None:
    """Write the pages that differ."""
    for path, text in pages().items():
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
