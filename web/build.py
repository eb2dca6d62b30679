"""Build the live page: the crate compiled to WebAssembly, and all that shows it, in one HTML file.

`make live` writes it to ``web/live.html``. It loads nothing and opens from anywhere.
"""

import base64
import gzip
import json
import subprocess
import sys
from pathlib import Path

import flockenv
from flockenv.recording.stored import FORMAT
from flockenv.replay.template import as_script_content, digest, filled, joined

WEB = Path(__file__).parent
REPLAY = WEB.parent / "flockenv" / "replay"
MOST_BYTES = 500_000
"""Size that the page may not exceed."""

_TARGET = "wasm32-unknown-unknown"
_THREAD = ("core.mjs", "worker.mjs")
# In the order in which one needs another.
_SHARED = ("words", "run", "forces", "scene", "chart", "panel")
_OWN = (
    "core.mjs",
    "npz.mjs",
    "request.mjs",
    "order_map.mjs",
    "lap_frame.mjs",
    "growing_run.mjs",
    "share.mjs",
    "lessons.mjs",
    "controls.mjs",
    "simulator.mjs",
    "live.mjs",
    "main.mjs",
)


def wasm() -> bytes:
    """Compile the simulator, and return it."""
    command = ["cargo", "build", "--locked", "--release", "--target", _TARGET]
    subprocess.run(command, cwd=WEB, check=True)
    return (WEB / "target" / _TARGET / "release" / "flockenv_web.wasm").read_bytes()


def page(compiled: bytes) -> str:
    """Return the page around a compiled simulator."""
    shared = [(REPLAY / "shared" / f"{name}.mjs").read_text("utf-8") for name in _SHARED]
    script = joined([*shared, *((WEB / name).read_text("utf-8") for name in _OWN)])
    thread = joined([(WEB / name).read_text("utf-8") for name in _THREAD])
    style = (REPLAY / "replay.css").read_text("utf-8") + (WEB / "live.css").read_text("utf-8")
    about = {"version": flockenv.__version__, "format": FORMAT, "opening": None}
    policy = [
        "default-src 'none'",
        f"style-src {digest(style)}",
        f"script-src {digest(script)} 'wasm-unsafe-eval'",
        "worker-src blob:",
        "img-src data:",
        "base-uri 'none'",
        "form-action 'none'",
    ]
    parts = {
        "policy": "; ".join(policy),
        "style": style,
        "about": as_script_content(json.dumps(about)),
        "thread": thread,
        # The same bytes at every build: no time in the header.
        "wasm": base64.b64encode(gzip.compress(compiled, mtime=0)).decode("ascii"),
        "script": script,
    }
    return filled((WEB / "page.html").read_text("utf-8"), parts)


def main() -> None:
    """Write the page."""
    built = page(wasm())
    if len(built.encode()) > MOST_BYTES:
        raise SystemExit(f"the page has {len(built.encode())} bytes, more than {MOST_BYTES}")
    (WEB / "live.html").write_text(built, "utf-8")
    sys.stdout.write(f"web/live.html: {len(built.encode())} bytes\n")


if __name__ == "__main__":
    main()
