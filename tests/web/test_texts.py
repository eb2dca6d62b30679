"""Law: what the page says of a flock, as a command and in Python, is the flock."""

import runpy
import shlex
from itertools import pairwise

import pytest

import flockenv
from flockenv.cli.parameters import OneFlock

pytestmark = pytest.mark.live

SCRIPT = """
import { readFileSync } from "node:fs";
import { commandLine, pythonText } from "./web/request.mjs";
const { flocks, kinds } = JSON.parse(readFileSync(0, "utf8"));
const pair = (each) => [each, { ...each, bw_s: "0.2" }];
const texts = flocks.map((each) => [commandLine(each, 90), pythonText(pair(each), 90, kinds)]);
process.stdout.write(JSON.stringify(texts));
"""
KINDS = {
    "n_boats": "count",
    "n_leaders": "count",
    "pool": "pool",
    "bw_s": "real",
    "target": "choices",
    "scheme": "choice",
    "leaders_reverse": "flag",
    "discs": "rows",
}


@pytest.mark.parametrize(
    ("flock", "expected"),
    [
        ({}, {}),
        (
            {"n_boats": "12", "n_leaders": "2", "bw_s": "0.35", "seed": "11", "scheme": "moreau"},
            {"n_boats": 12, "n_leaders": 2, "bw_s": 0.35, "scheme": "moreau"},
        ),
        (
            {"pool": "180,0", "n_leaders": "2", "target": "cw,ccw", "leaders_reverse": "false"},
            {"pool": (180, 0), "n_leaders": 2, "target": ["cw", "ccw"], "leaders_reverse": False},
        ),
        ({"pool": "inf,0"}, {"pool": (float("inf"), 0)}),
        (
            {"discs": "120,0,5;-130,0,8", "leaders": "damped law", "n_leaders": "1"},
            {"discs": ((120, 0, 5), (-130, 0, 8)), "n_leaders": 1},
        ),
    ],
)
def test_command_and_python_name_the_same_flock(flock, expected, answer_of_node, tmp_path):
    question = {"flocks": [flock], "kinds": KINDS}
    ((command, python),) = answer_of_node(question, "--input-type=module", "-e", SCRIPT)
    wanted = flockenv.FlockParameters(**expected)
    words = shlex.split(command)
    changes = [value for option, value in pairwise(words) if option == "--set"]
    assert OneFlock(changes=changes).parameters() == wanted
    assert words[words.index("--minutes") + 1] == "1.5"
    assert words[words.index("--seed") + 1] == flock.get("seed", "0")
    same = tmp_path / "same.py"
    same.write_text(python)
    recorded = runpy.run_path(str(same))
    recording = recorded["recording"]
    assert recording.parameters == wanted
    assert recorded["beside"].parameters == wanted.replace(bw_s=0.2)
    assert recording.seed == int(flock.get("seed", "0"))
    assert recording.duration_s == 90.0
    assert recording.policy.startswith(
        "Damped" if "leaders" in flock else "paper's law at every substep"
    )
