"""The compiled simulator of the live page, as the page holds it."""

import base64
import gzip
import json
import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest


@pytest.fixture(scope="session")
def wasm(pytestconfig, tmp_path_factory) -> Path:
    page = pytestconfig.rootpath / "flockenv" / "replay" / "live.html"
    (packed,) = re.findall(r'id="wasm">(.*?)</script>', page.read_text("utf-8"))
    path: Path = tmp_path_factory.mktemp("wasm") / "flockenv_web.wasm"
    path.write_bytes(gzip.decompress(base64.b85decode(packed)))
    return path


@pytest.fixture(scope="session")
def answer_of_node(pytestconfig) -> Callable[..., Any]:
    """Give a script a question in JSON, and read its answer."""

    def answer(question: object, *script: str) -> Any:
        done = subprocess.run(
            ["node", *script],
            input=json.dumps(question),
            cwd=pytestconfig.rootpath,
            capture_output=True,
            text=True,
            check=True,
        )
        return json.loads(done.stdout)

    return answer
