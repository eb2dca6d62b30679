"""Self-contained pages: joins scripts, fills a template, and says which scripts may run."""

import base64
import hashlib
import re
from collections.abc import Iterable, Mapping


def joined(modules: Iterable[str]) -> str:
    """Return the sources of modules as one script, without their imports and exports."""
    return re.sub(r"^(?:import .*;\n|export )", "", "\n".join(modules), flags=re.MULTILINE)


def digest(source: str) -> str:
    """Return the digest by which a content security policy allows a script or style."""
    value = base64.b64encode(hashlib.sha256(source.encode()).digest()).decode("ascii")
    return f"'sha256-{value}'"


def as_script_content(json_text: str) -> str:
    """Return JSON that cannot end the script element around it."""
    return json_text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def filled(template: str, parts: Mapping[str, str]) -> str:
    """Return a template with its parts in place of their ``{{names}}``.

    Parts are not scanned, so ``{{names}}`` in their text stay.
    """
    return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match[1]], template)
