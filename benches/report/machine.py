"""The machine and the versions of a measurement, in words: no names of hosts, no paths."""

from __future__ import annotations

import json
import os
import platform
import re
import subprocess
import tomllib
from datetime import UTC, datetime
from pathlib import Path

FILE = "made.toml"


def provenance(benches: Path, files: Path) -> dict[str, str]:
    """Return the date, the machine and the versions of a measurement that has just ended."""
    return {
        "date": str(datetime.now(UTC).date()),
        "machine": _machine(),
        "versions": _versions(benches, files),
    }


def write_provenance(folder: Path, made: dict[str, str]) -> None:
    """Store the provenance of tables beside them."""
    lines = [f"{name} = {json.dumps(text, ensure_ascii=False)}\n" for name, text in made.items()]
    (folder / FILE).write_text("".join(lines), encoding="utf-8")


def processor() -> str:
    """Return the processor's model as the name of a file."""
    return re.sub(r"[^a-z0-9]+", "-", _model().lower()).strip("-")


def _model() -> str:
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        names = [line for line in cpuinfo.read_text().splitlines() if line.startswith("model name")]
        if names:
            return names[0].split(":", 1)[1].strip()
    return platform.processor() or platform.machine()


def _machine() -> str:
    return f"{_model()}, {os.cpu_count()} cores, {platform.system()} on {platform.machine()}"


def _versions(benches: Path, files: Path) -> str:
    # Versions of the compiler and of the engines, as locked or installed.
    command = ["rustc", "--version"]
    rustc = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    lock = tomllib.loads((benches / "Cargo.lock").read_text())
    locked = {package["name"]: package["version"] for package in lock["package"]}
    crates = ["flockenv", "rapier2d-f64", "rapier2d", "boxdd-sys", "clarabel"]
    versions = [" ".join(rustc.split()[:2])] + [f"{name} {locked[name]}" for name in crates]
    peers = json.loads((files / "versions.json").read_text())
    versions += [f"{name} {number}" for name, number in peers.items()]
    return ", ".join(versions).replace("boxdd-sys", "Box2D 3.2 (crate boxdd-sys)")
