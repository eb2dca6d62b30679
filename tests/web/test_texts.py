"""Law: what the page says of a flock, as a command and in Python, is the flock."""

import runpy
import shlex
from itertools import pairwise
from pathlib import Path

import pytest

import flockenv
from flockenv.cli.parameters import OneFlock, option_of

pytestmark = pytest.mark.live

SCRIPT = """
import { readFileSync } from "node:fs";
import { commandLine, pythonText } from "./web/texts.mjs";
const { flocks, kinds, changes } = JSON.parse(readFileSync(0, "utf8"));
const pair = (each) => [each, { ...each, bw_s: "0.2" }];
const python = (each) => pythonText(pair(each), 90, kinds, changes);
const texts = flocks.map((each) => [commandLine(each, 90, changes), python(each)]);
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
NAMED = {option_of(name): name for name in OneFlock.named}
TYPES = {"n_boats": int, "n_leaders": int, "bw_s": float}


def test_command_and_python_change_the_same_flock_on_the_way(
    answer_of_node, cli, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    changes = [{"time": 20.5, "fields": {"bw_s": "2.85", "pool": "150,60"}}]
    changes.append({"time": 60, "fields": {"target": "cw,ccw", "leaders_reverse": "false"}})
    flock = {"n_boats": "9", "n_leaders": "2", "seed": "5"}
    question = {"flocks": [flock], "kinds": KINDS, "changes": changes}
    ((command, python),) = answer_of_node(question, "--input-type=module", "-e", SCRIPT)
    arguments = [*shlex.split(command)[1:], "--no-contacts", "--quiet", "--out", "run.npz"]
    cli.succeeds(*arguments)
    Path("same.py").write_text(python)
    recording = runpy.run_path("same.py")["recording"]
    assert flockenv.Recording.load("run.npz") == recording
    schedule = [(20.5, {"bw_s": 2.85, "pool": (150, 60)})]
    schedule.append((60.0, {"target": ["cw", "ccw"], "leaders_reverse": False}))
    parameters = flockenv.FlockParameters(n_boats=9, n_leaders=2)
    assert recording == flockenv.simulate(parameters, 5, 90.0, schedule=schedule)


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
    question = {"flocks": [flock], "kinds": KINDS, "changes": []}
    ((command, python),) = answer_of_node(question, "--input-type=module", "-e", SCRIPT)
    wanted = flockenv.FlockParameters(**expected)
    words = shlex.split(command)
    given = list(pairwise(words))
    changes = [value for option, value in given if option == "--set"]
    own = {name: value for option, value in given if (name := NAMED.get(option))}
    numbers = {name: TYPES.get(name, str)(value) for name, value in own.items()}
    assert OneFlock(changes=changes, **numbers).parameters() == wanted
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
