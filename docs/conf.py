"""How Sphinx builds the pages: `make docs`."""

import re
import shutil
import sys
from pathlib import Path
from typing import Any

from docutils import nodes
from PIL import Image
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment

import flockenv

sys.path[:0] = [str(Path(__file__).parents[1]), str(Path(__file__).parent / "extensions")]

from docs.scripts import environment_pages  # noqa: E402
from docs.scripts.plots import LETTERS, is_scrolled  # noqa: E402
from flockenv.replay import write_replay  # noqa: E402
from flockenv.replay.demo import demo_runs, live_page  # noqa: E402

environment_pages.write()
environment_pages.draw()

# Sphinx reads only pages below this folder.
_studies = Path(__file__).parent / "studies"
shutil.rmtree(_studies, ignore_errors=True)
shutil.copytree(
    _studies.parents[1] / "studies",
    _studies,
    ignore=shutil.ignore_patterns("*.py", "__pycache__", ".*"),
)
_notebooks = Path(__file__).parent / "examples"
shutil.rmtree(_notebooks, ignore_errors=True)
_notebooks.mkdir()
for _notebook in (_notebooks.parents[1] / "examples").glob("*.ipynb"):
    shutil.copy2(_notebook, _notebooks)

# index.md shows the live page if `make live` has built it, and otherwise the replay of two flocks.
html_extra_path = ["_build/shown", "replay.webp", "replay-still.webp"]
_shown = Path(__file__).parent / html_extra_path[0] / "flock.html"
_shown.parent.mkdir(parents=True, exist_ok=True)
if (_live := live_page()) is None:
    write_replay(_shown, demo_runs())
else:
    _shown.write_bytes(_live.read_bytes())

project = "flockenv"
author = "flockenv contributors"
project_copyright = author
release = version = flockenv.__version__

extensions = [
    "myst_nb",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinxcontrib.typer",
    "loop",
    "mathml",
]
exclude_patterns = ["_build", "results", "software", "speed_vs_error"]

html_theme = "furo"
html_title = f"flockenv {release}"
html_math_renderer = "mathml"
html_static_path = ["static"]
html_css_files = ["doors.css", "loops.css", "phones.css", "dark.css"]
html_show_copyright = False
html_copy_source = False

nitpicky = True
# Names of other packages are not linked, so that a build needs no network.
nitpick_ignore_regex = [
    (
        r"py:.*",
        r"(ArrayLike|DTypeLike|NDArray|np|numpy|pd|pandas|gymnasium|pettingzoo|collections|typing|"
        r"os|pathlib|threading|concurrent|torch|xarray|stable_baselines3|matplotlib|Axes|Path|"
        r"PathLike|Executor|Future|Any|rich|importlib|"
        r"Self|Mapping|Sequence|Callable|Iterator|Iterable|Generator)(\..*)?",
    ),
    # The types that DTypeLike stands for.
    (r"py:.*", r"type\[.*"),
    # Internal modules and type variables of public signatures.
    (r"py:.*", r"(flockenv\.)?_core(\..*)?"),
    (r"py:.*", r"flockenv\.runs\.executors\.(Item|Value)"),
]

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

# All code cells of pages run at every build; a cell that fails makes the build fail.
nb_execution_mode = "force"
# These need other versions of packages: `make test-rllib` and `make test-benchmarl` run them.
nb_execution_excludepatterns = ["examples/with_rllib.ipynb", "examples/with_benchmarl.ipynb"]
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_execution_show_tb = True

default_role = "autolink"
autodoc_default_options = {"members": True}
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 88
numpydoc_show_class_members = False
numpydoc_xref_param_type = False


ENVIRONMENTS = (
    "flockenv.LeadersEnv",
    "flockenv.LeadersVectorEnv",
    "flockenv.LeadersParallelEnv",
    "flockenv.sb3.LeaderVecEnv",
)

SHORT = {
    r"\(\$cls, ": "(",  # class methods of the compiled module show their first argument
    r"<class '(?:\w+\.)*(\w+)'>": r"\1",
    r"<factory>": "...",
    r"~[\w.]+\._Buffer \| .*?_NestedSequence\[complex \| bytes \| str\]": "ArrayLike",
    r"type\[~typing\.Any\] \| ~numpy\.dtype\[.*?_DTypeDict \| str": "DTypeLike",
    r"(~numpy\.ndarray)\[tuple\[[^\]]*\], ~numpy\.dtype\[[^\[\]]*(?:\[[^\]]*\])?\]\]": r"\1",
}
"""Replacements in signatures with evaluated types, made in this order."""


def setup(app: Sphinx) -> None:
    """Register the handlers that autodoc and the pages need."""
    app.connect("autodoc-process-docstring", _link_environment_pages)
    app.connect("autodoc-process-signature", _shorten)
    app.connect("doctree-resolved", _mark_wide_pictures)
    app.connect("missing-reference", _plain_name)
    app.connect("source-read", _open_comments)
    app.connect("source-read", _link_copies)


def _link_environment_pages(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]
) -> None:
    # These docstrings are Markdown, on a separate page.
    if what == "class" and name in ENVIRONMENTS:
        lines[:] = ["See :doc:`/environments/classes`."]


def _link_copies(app: Sphinx, docname: str, source: list[str]) -> None:
    # Studies and notebooks are copied into the site's sources, so links to and from them change.
    link, here = (
        ("../../studies/", "../studies/") if "/" in docname else ("../studies/", "studies/")
    )
    if docname.startswith("studies/"):
        link, here = "../../docs/", "../../"
    # Scripts are not copied.
    source[0] = re.sub(rf"\]\({re.escape(link)}(?!\S*\.py\))", f"]({here}", source[0])
    source[0] = re.sub(r"\]\((?:\.\./)+(examples/\w+\.ipynb)\)", r"](/\1)", source[0])


def _open_comments(app: Sphinx, docname: str, source: list[str]) -> None:
    # A repository's viewer shows the same pages as plain Markdown, without what only the site has.
    source[0] = re.sub(r"<!-- site\n(.*?)\n-->", r"\1", source[0], flags=re.DOTALL)


def _shorten(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, signature: str, returns: str
) -> tuple[str, str] | None:
    if not signature:
        return None
    for long, short in SHORT.items():
        signature, returns = re.sub(long, short, signature), re.sub(long, short, returns or "")
    return signature, returns


def _mark_wide_pictures(app: Sphinx, doctree: nodes.document, docname: str) -> None:
    for node in doctree.findall(nodes.image):
        file = Path(app.srcdir, node["uri"])
        if file.suffix == ".png" and file.is_file():
            with Image.open(file) as picture:
                is_ours = LETTERS in picture.info  # and not the output of a cell
            if is_ours and is_scrolled(file):
                node["classes"].append("wide")


def _plain_name(
    app: Sphinx, env: BuildEnvironment, node: pending_xref, shown: nodes.Element
) -> nodes.Element | None:
    # A name in single backticks links to the reference, or is plain text if the reference lacks it.
    return shown if node["reftype"] == "obj" else None
