"""Law: whenever Ctrl-C comes, a command leaves whole files and no other."""

import os
import random
import signal
import subprocess
import sys

import pytest

from flockenv.runs.sweep import load_sweep

TIMES = int(os.environ.get("FUZZ_EXAMPLES", 0)) // 40

# Before a script's first line Python itself takes Ctrl-C.
STARTED = """
import flockenv_command, signal
signal.signal(signal.SIGINT, flockenv_command._end)
print("started", flush=True)
flockenv_command.main()
"""
SWEEP = "minutes = 2\nseeds = 40\n[[grid]]\nn_boats = [8, 12]\n"


@pytest.mark.skipif(not TIMES, reason="chance decides here: `make fuzz` runs it")
@pytest.mark.parametrize("presses", [1, 2])
def test_wherever_ctrl_c_comes_no_file_is_left(presses, tmp_path):
    (tmp_path / "sweep.toml").write_text(SWEEP)
    command = [sys.executable, "-c", STARTED, "sweep", str(tmp_path / "sweep.toml"), "--quiet"]
    command += ["--out", str(tmp_path / "out")]
    draws = random.Random(presses)
    for _ in range(TIMES):
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        process = subprocess.Popen(command, **pipes)
        assert process.stdout.readline() == "started\n"
        for _ in range(presses):
            try:
                process.wait(draws.uniform(0.0, 4.0))
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=60)
        assert process.returncode in (0, 130), said
        assert "Traceback" not in said
        assert not list(tmp_path.rglob("*.tmp"))
    subprocess.run(command, check=True, timeout=120)
    assert len(load_sweep(tmp_path / "out")) == 80
    assert not list(tmp_path.rglob("*.damaged"))
