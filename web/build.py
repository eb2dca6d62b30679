"""Build the live page: the crate compiled to WebAssembly and the page's scripts, in one HTML file.

`make live` writes it to ``flockenv/replay/live.html``, where the package finds it. The page loads
no other file. The build needs cargo, and only the sources of the package.
"""

import ast
import base64
import csv
import gzip
import json
import re
import runpy
import subprocess
import sys
import tomllib
from collections import defaultdict
from pathlib import Path

WEB = Path(__file__).parent
ROOT = WEB.parent
REPLAY = ROOT / "flockenv" / "replay"
PAGE = REPLAY / "live.html"
MOST_BYTES = 500_000
"""Largest size of the page in bytes."""

_TARGET = "wasm32-unknown-unknown"
_THREAD = ("core.mjs", "worker.mjs")
# In the order of their dependencies.
_SHARED = (
    "words.mjs",
    "link.mjs",
    "transport.mjs",
    "run.mjs",
    "forces.mjs",
    "scene.mjs",
    "chart.mjs",
    "panel.mjs",
)
_OWN = (
    "core.mjs",
    "npz.mjs",
    "lessons.mjs",
    "request.mjs",
    "texts.mjs",
    "laws.mjs",
    "order_map.mjs",
    "lap_frame.mjs",
    "growing_run.mjs",
    "recording.mjs",
    "share.mjs",
    "controls.mjs",
    "simulator.mjs",
    "flocks.mjs",
    "follow.mjs",
    "helm.mjs",
    "learning_curve.mjs",
    "training.mjs",
    "game.mjs",
    "doing.mjs",
    "quantities.mjs",
    "view.mjs",
    "playback.mjs",
    "live.mjs",
    "listen.mjs",
    "main.mjs",
)


def without_names(module: bytes) -> bytes:
    """Return a WebAssembly module without its custom sections, such as names of functions."""
    parts, start = [module[:8]], 8
    while start < len(module):
        # A section: its kind in one byte, its length as a LEB128 number, and its content.
        length = shift = 0
        end = start + 1
        while True:
            byte = module[end]
            length |= (byte & 0x7F) << shift
            end, shift = end + 1, shift + 7
            if byte < 0x80:
                break
        end += length
        is_custom = module[start] == 0
        if not is_custom:
            parts.append(module[start:end])
        start = end
    return b"".join(parts)


def wasm() -> bytes:
    """Compile the simulator to WebAssembly, and return the module."""
    command = ["cargo", "build", "--locked", "--release", "--target", _TARGET]
    subprocess.run(command, cwd=WEB, check=True)
    command = ["cargo", "metadata", "--no-deps", "--format-version", "1"]
    metadata = subprocess.run(command, cwd=WEB, check=True, capture_output=True, text=True).stdout
    folder = Path(json.loads(metadata)["target_directory"], _TARGET, "release")
    return without_names((folder / "flockenv_web.wasm").read_bytes())


def constant(path: Path, name: str) -> str:
    """Return a constant of a Python module without importing it."""
    for statement in ast.parse(path.read_text("utf-8")).body:
        if isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) == name:
            return str(ast.literal_eval(statement.value))
    raise SystemExit(f"{path} has no {name}")


def expected_orders() -> list[dict[str, object]]:
    """Return curves of mean order by backward duration, from the study of Section 4.

    The one curve is that of 27 boats without leaders.
    """
    orders = defaultdict(list)
    results = ROOT / "studies" / "section4" / "results" / "section4.csv.gz"
    with gzip.open(results, "rt", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["preset"] == "experiment" and row["n_leaders"] == "0":
                orders[float(row["bw_s"])].append(float(row["psi_o"]))
    points = [
        [bw_s, round(sum(values) / len(values), 3)] for bw_s, values in sorted(orders.items())
    ]
    return [{"preset": "experiment", "n_boats": 27, "n_leaders": 0, "points": points}]


def bare(script: str) -> str:
    """Return a script without lines of comments and without indents, a quarter of its bytes."""
    code = re.sub(r"^[ \t]*(?://.*|/\*\*(?:.|\n)*?\*/)\n", "", script, flags=re.MULTILINE)
    return re.sub(r"^[ \t]+", "", code, flags=re.MULTILINE)


def packed(content: bytes) -> str:
    """Return the gzip of bytes as text, the same in every build since its header holds no time.

    Base 85 takes 6 % fewer bytes than base 64, and cannot spell the end of a script element.
    """
    return base64.b85encode(gzip.compress(content, mtime=0)).decode("ascii")


def page(compiled: bytes) -> str:
    """Return the page around a compiled simulator."""
    template = runpy.run_path(str(REPLAY / "template.py"))
    shared = [(REPLAY / "shared" / name).read_text("utf-8") for name in _SHARED]
    own, threads = (
        [(WEB / name).read_text("utf-8") for name in names] for names in (_OWN, _THREAD)
    )
    script = bare(template["joined"]([*shared, *own]))
    thread = bare(template["joined"](threads))
    unpack = bare((WEB / "unpack.mjs").read_text("utf-8"))
    style = (REPLAY / "shared" / "page.css").read_text("utf-8")
    style += (WEB / "live.css").read_text("utf-8")
    cargo = tomllib.loads((ROOT / "Cargo.toml").read_text("utf-8"))
    about = {
        "version": cargo["package"]["version"],
        "format": constant(ROOT / "flockenv" / "recording" / "stored.py", "FORMAT"),
        "results_version": constant(ROOT / "flockenv" / "runs" / "store.py", "RESULTS_VERSION"),
        "orders": expected_orders(),
        "opening": None,
    }
    digest = template["digest"]
    policy = [
        "default-src 'none'",
        f"style-src {digest(style)}",
        f"script-src {digest(unpack)} {digest(script)} 'wasm-unsafe-eval'",
        "worker-src blob:",
        "img-src data:",
        "base-uri 'none'",
        "form-action 'none'",
    ]
    parts = {
        "policy": "; ".join(policy),
        "style": style,
        "about": template["as_script_content"](json.dumps(about)),
        "thread": packed(thread.encode()),
        "wasm": packed(compiled),
        "packed": packed(script.encode()),
        "unpack": unpack,
    }
    return template["filled"]((WEB / "page.html").read_text("utf-8"), parts)


def main() -> None:
    """Write the page."""
    built = page(wasm())
    if len(built.encode()) > MOST_BYTES:
        raise SystemExit(f"the page has {len(built.encode())} bytes, more than {MOST_BYTES}")
    PAGE.write_text(built, "utf-8", newline="\n")
    sys.stdout.write(f"{PAGE.relative_to(ROOT)}: {len(built.encode())} bytes\n")


if __name__ == "__main__":
    main()
