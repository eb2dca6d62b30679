"""The compiled simulator of the live page, as the page holds it."""

import base64
import gzip
import re
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def wasm(pytestconfig, tmp_path_factory) -> Path:
    page = pytestconfig.rootpath / "flockenv" / "replay" / "live.html"
    (packed,) = re.findall(r'id="wasm">([^<]*)<', page.read_text("utf-8"))
    path: Path = tmp_path_factory.mktemp("wasm") / "flockenv_web.wasm"
    path.write_bytes(gzip.decompress(base64.b64decode(packed)))
    return path
