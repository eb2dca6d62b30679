"""Law: the names that a user's notebook relies on keep their import paths and their meaning."""

import inspect
from operator import attrgetter
from pathlib import Path

import gymnasium
import numpy as np
import pytest
import typer

import flockenv
import flockenv.comparison.suite
import flockenv.runs.workload
from flockenv.cli import app

PARAMETERS = flockenv.FlockParameters(n_boats=4, n_leaders=1, pool="narrow")
#: Names by the object that has them.
NAMES = {
    "": "Flock FlockError FlockParameters LeadersEnv LeadersParallelEnv LeadersVectorEnv "
    "ParameterError Recording SolverError order_series parallel_env policies simulate",
    "FlockParameters": "preset presets replace to_dict from_dict to_toml from_toml",
    "Flock": "set_state pose velocity time_s phase advance order_parameters contacts statistics "
    "snapshot restore",
    "Recording": "time_s phase pose velocity order save load to_dataframe to_xarray analyzed",
    "OrderParameters": "psi_o phi_o c_o psi_v phi_v c_v",
    "OrderSeries": "psi_o phi_o c_o psi_v phi_v c_v plot",
    "Contacts": "gap_cm normal force",
    "policies": "SteeringLaw load",
}
FIELDS = (
    "n_boats n_leaders pool boat_radius_cm boat_shape gyration_radius_cm speed_cm_s "
    "reverse_speed_cm_s c0 c1 c2 c3 c4 fw_s nop1_s bw_s nop2_s leaders_reverse target scheme "
    "noise_scheme solver dt_s overlap_tolerance_cm relinearizations"
)
SIGNATURES = {
    "Flock": ["parameters", "seed"],
    "simulate": ["parameters", "seed", "duration_s", "sample_hz", "policy"],
    "order_series": ["pose", "velocity"],
}
#: Arguments that are given by name, in any place.
NAMED = {
    "simulate": "start",
    "tracks.recording_of": "time_s pose pool hull velocity phase ids",
    "Recording.analyzed": "after",
    "policies.load": "pool",
}

#: An environment takes each of these; fields of the parameters stand for all of theirs.
ENVIRONMENT_OPTIONS = {
    "preset": {"preset": "paper"},
    "params": {"params": PARAMETERS},
    "fields": {"n_boats": 5, "bw_s": 0.4, "pool": "narrow"},
    "target": {"target": "random"},
    "episode_s": {"episode_s": 960.0},
    "control_hz": {"control_hz": 5.0},
    "reward": {"reward": {"signed_order": 1.0, "leader_velocity": 0.5}},
    "observation": {"observation": {"neighbors": 4, "order": False}},
    "action_mode": {"action_mode": "lean"},
    "decision_period_s": {"decision_period_s": 0.5},
    "decision_period_cycles": {"decision_period_cycles": 2.0},
    "physics": {"physics": "training"},
    "render_mode": {"render_mode": "rgb_array"},
}
#: Options of the commands, and what long work has: progress that can be silenced, and a folder.
LONG_WORK = "--out --quiet"
COMMANDS = {
    "run": f"--preset --params --set --policy --seed --minutes {LONG_WORK}",
    "compare": f"--pool --policy --name --suite --task --episodes {LONG_WORK}",
    "sweep": f"--shard --dry-run --engine {LONG_WORK}",
    "train": f"--set --resume {LONG_WORK}",
    "replay": "--html --open",
    "presets": "--json",
    "demo": f"--seed {LONG_WORK}",
    "analyze": f"--layout --plot {LONG_WORK}",
}


@pytest.mark.parametrize("owner", NAMES)
def test_names_are_where_they_were(owner):
    flock = flockenv.Flock(PARAMETERS, seed=1)
    run = flockenv.simulate(PARAMETERS, 1, 0.1)
    instances = {
        "Flock": flock,
        "Recording": run,
        "OrderParameters": flock.order_parameters(),
        "OrderSeries": run.order,
        "Contacts": flock.contacts(),
    }
    thing = getattr(flockenv, owner) if owner else flockenv
    if owner in instances:
        assert isinstance(instances[owner], thing)
        thing = instances[owner]
    assert [name for name in NAMES[owner].split() if not hasattr(thing, name)] == []


def test_parameters_have_their_fields():
    assert set(FIELDS.split()) <= {*PARAMETERS.to_dict()}
    assert flockenv.FlockParameters.preset("experiment").leaders_reverse is False
    for name, bw_s in (("simulation", 0.3), ("paper", 0.6)):
        preset = flockenv.FlockParameters.preset(name)
        assert (preset.pool, preset.n_boats, preset.n_leaders) == ("wide", 20, 0)
        assert (preset.bw_s, preset.leaders_reverse) == (bw_s, True)


@pytest.mark.parametrize("name", SIGNATURES)
def test_arguments_keep_their_names_and_order(name):
    arguments = list(inspect.signature(getattr(flockenv, name)).parameters)
    assert arguments[: len(SIGNATURES[name])] == SIGNATURES[name]


@pytest.mark.parametrize("name", NAMED)
def test_named_arguments_are_known(name):
    arguments = inspect.signature(attrgetter(name)(flockenv)).parameters
    assert set(NAMED[name].split()) <= {*arguments}


def test_pretrained_leaders_have_a_name():
    law = flockenv.policies.load("learned", pool="wide")
    run = flockenv.simulate(PARAMETERS.replace(pool="wide"), 1, 0.3, policy="learned")
    assert run == flockenv.simulate(PARAMETERS.replace(pool="wide"), 1, 0.3, policy=law)


def test_environments_are_made_as_they_were():
    options = {"n_boats": 4, "n_leaders": 2, "target": "random", "episode_s": 1.0, "control_hz": 2}
    agents = flockenv.parallel_env(**options)
    agents.reset(seed=0)
    assert agents.agents == ["leader_0", "leader_1"]
    single = gymnasium.make("flockenv/Leaders-v0", **options)
    assert single.action_space.shape == (2,)
    several = gymnasium.make_vec("flockenv/Leaders-v0", num_envs=3, **options)
    assert isinstance(several.unwrapped, flockenv.LeadersVectorEnv)
    observations, _ = single.reset(seed=0)
    assert np.isfinite(flockenv.policies.SteeringLaw().predict(observations)[0]).all()


def test_leaders_are_slots_of_stable_baselines3():
    pytest.importorskip("stable_baselines3")
    assert flockenv.sb3.LeaderVecEnv(num_flocks=3, n_leaders=2).num_envs == 6


@pytest.mark.parametrize("name", ENVIRONMENT_OPTIONS)
def test_environments_take_their_options_in_every_form(name):
    option = ENVIRONMENT_OPTIONS[name]
    flockenv.parallel_env(**option)
    gymnasium.make("flockenv/Leaders-v0", **option)
    gymnasium.make_vec("flockenv/Leaders-v0", num_envs=1, **option)
    if name != "render_mode":
        flockenv.sb3.LeaderVecEnv(1, **option)


@pytest.mark.parametrize(
    ("target", "steps"), [("cw", 48), ("ccw", 48), ("random", 48), ("alternate", 96)]
)
def test_an_episode_lasts_eight_minutes_and_sixteen_where_targets_alternate(target, steps):
    env = flockenv.parallel_env(n_boats=2, n_leaders=1, target=target, control_hz=0.1)
    env.reset(seed=0)
    taken = 0
    while env.agents:
        env.step({"leader_0": np.zeros(1)})
        taken += 1
    assert taken == steps


def test_other_environments_keep_their_ids():
    for name in ("flockenv/Leaders-v0", "flockenv/Circulate-easy-v0"):
        assert name in gymnasium.registry


@pytest.mark.parametrize("name", COMMANDS)
def test_commands_keep_their_names_and_options(name):
    command = typer.main.get_command(app).commands[name]
    options = {option for each in command.params for option in each.opts}
    assert set(COMMANDS[name].split()) <= options


def test_commands_keep_what_they_accept():
    assert flockenv.runs.workload.Shard.parse("2/3")
    assert len(flockenv.comparison.suite.tasks_named("v2")) == 6


def test_errors_are_of_their_classes():
    assert {flockenv.FlockError, ValueError} <= {*flockenv.ParameterError.__mro__}
    assert {flockenv.FlockError, RuntimeError} <= {*flockenv.SolverError.__mro__}


def test_at_most_eight_modules_lie_beside_the_packages():
    modules = sorted(path.name for path in Path(flockenv.__file__).parent.glob("*.py"))
    assert len(modules) <= 8, modules
