"""What the numbers were measured on and with, in words: no names of hosts, no paths."""

from __future__ import annotations

import json
import os
import platform
import subprocess
import tomllib
from pathlib import Path


def machine() -> str:
    """Processor, cores and operating system."""
    model = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        names = [line for line in cpuinfo.read_text().splitlines() if line.startswith("model name")]
        model = names[0].split(":", 1)[1].strip() if names else model
    return f"{model}, {os.cpu_count()} cores, {platform.system()} on {platform.machine()}"


def versions(benches: Path, files: Path) -> str:
    """Of compiler and engines, as locked or installed."""
    command = ["rustc", "--version"]
    rustc = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    lock = tomllib.loads((benches / "Cargo.lock").read_text())
    locked = {package["name"]: package["version"] for package in lock["package"]}
    crates = ["flockenv", "rapier2d-f64", "rapier2d", "boxdd-sys", "clarabel"]
    found = [" ".join(rustc.split()[:2])] + [f"{name} {locked[name]}" for name in crates]
    peers = json.loads((files / "versions.json").read_text())
    found += [f"{name} {number}" for name, number in peers.items()]
    return ", ".join(found).replace("boxdd-sys", "Box2D 3.2 (crate boxdd-sys)")
