"""Pages of one file: scripts joined to one, a template filled, and what may run on them."""

import base64
import hashlib
import re
from collections.abc import Iterable, Mapping


def joined(modules: Iterable[str]) -> str:
    """Return the sources of modules as one script: without lines that import, words that export."""
    return re.sub(r"^(?:import .*;\n|export )", "", "\n".join(modules), flags=re.MULTILINE)


def digest(source: str) -> str:
    """Return the name of a script or a style of this source in a content security policy."""
    value = base64.b64encode(hashlib.sha256(source.encode()).digest()).decode("ascii")
    return f"'sha256-{value}'"


def as_script_content(json_text: str) -> str:
    """Return JSON that cannot end the script element it stands in."""
    return json_text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def filled(template: str, parts: Mapping[str, str]) -> str:
    """Return a template with its parts in place of their ``{{names}}``.

    One pass over the template: a part's own text is never filled in again.
    """
    return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match[1]], template)
