"""Law: values are accepted as arithmetic has them, in the containers that people write."""

import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv import FlockParameters
from flockenv.runs.spec import RunSpec

OPTIONS = {"n_boats": 6, "n_leaders": 2, "episode_s": 0.5}


def parameters(**fields):
    return lambda: FlockParameters(**fields)


def single(**options):
    return lambda: flockenv.LeadersEnv(**{**OPTIONS, **options}).reset(seed=1)


def vector(num_envs=2, seed=1, reset=None, **options):
    return lambda: flockenv.LeadersVectorEnv(num_envs, **{**OPTIONS, **options}).reset(
        seed=seed, options=reset
    )


def parallel(seed=1, reset=None, **options):
    return lambda: flockenv.parallel_env(**{**OPTIONS, **options}).reset(seed=seed, options=reset)


def run(seed=1, duration_s=1.0, **options):
    few = FlockParameters(n_boats=4, pool="narrow", n_leaders=1)
    return lambda: flockenv.simulate(few, seed, duration_s, **options)


def torchrl_seed(seed):
    def seeded():
        pytest.importorskip("torchrl")
        flockenv.torchrl.LeadersEnv(2, **OPTIONS).set_seed(seed)

    return seeded


def run_spec(seed):
    def made():
        spec = RunSpec(parameters=FlockParameters(), seed=seed, duration_s=1)
        # The same run has the same name however its seed was written.
        assert spec.key == RunSpec(parameters=FlockParameters(), seed=int(seed), duration_s=1).key

    return made


def ramp(times):
    return [(time_s, {"bw_s": 0.1 + 0.1 * place}) for place, time_s in enumerate(times)]


POOL = (100.0, 40.0)
NUMBERS = [np.float64, np.float32, np.int64, lambda value: np.array(value), float]
SERIES = [list, tuple, np.array, pd.Series, iter, lambda each: np.array(each, np.float32)]
DIRECTIONS = [list, tuple, np.array, pd.Series, iter, lambda each: (word for word in each)]
VALUES = {
    **{
        f"FlockParameters({name}={value!r})": parameters(**{name: value})
        for name, number in [("n_boats", 8), ("n_leaders", 2), ("tolerance_cm", 2)]
        for value in (kind(number) for kind in NUMBERS)
    },
    **{
        f"FlockParameters({name}={value!r})": parameters(**{name: value})
        for name, number in [("bw_s", 1), ("dt_s", 0.02), ("speed_cm_s", 22), ("fw_s", 2)]
        for value in (number, np.float32(number), np.float64(number), np.array(number))
    },
    **{
        f"FlockParameters(pool={kind.__name__} {place})": parameters(pool=kind(POOL))
        for place, kind in enumerate(SERIES)
    },
    **{
        f"FlockParameters(discs={place})": parameters(n_boats=4, discs=discs)
        for place, discs in enumerate(
            [
                [(130, 0, 5)],
                np.array([[130.0, 0.0, 5.0]]),
                pd.DataFrame([[130.0, 0, 5]]).to_numpy(),
                ((130, 0, 5) for _ in range(1)),
                np.array([[130, 0, 5]]),
                (),
            ]
        )
    },
    **{
        f"LeadersEnv({name}={value!r})": single(**{name: value})
        for name, number in [
            ("n_boats", 8),
            ("n_leaders", 2),
            ("rudder_levels", 5),
            ("delay_frames", 1),
        ]
        for value in (kind(number) for kind in NUMBERS)
    },
    **{
        f"LeadersEnv({name}={value!r})": single(**{name: value})
        for name, number in [
            ("control_hz", 5),
            ("episode_s", 1),
            ("dropout_rate", 0),
            ("rudder_lag_s", 0),
            ("decision_period_s", 1),
            ("reward_horizon_s", 10),
            ("bw_s", 1),
        ]
        for value in (number, float(number), np.float32(number), np.int64(number), np.array(number))
    },
    **{
        f"LeadersEnv(bw_s={kind.__name__} {place})": single(bw_s=kind([0.1, 0.5]))
        for place, kind in enumerate(SERIES)
    },
    **{
        f"LeadersEnv(target={kind.__name__} {place})": single(target=kind(["cw", "ccw"]))
        for place, kind in enumerate(DIRECTIONS)
    },
    **{
        f"LeadersEnv(render_size={size!r})": single(render_size=size)
        for size in [(80, 80), [80, 90], np.array([80, 90])]
    },
    **{
        f"LeadersEnv(observation={blocks!r})": single(observation=blocks)
        for blocks in [
            {"neighbors": 3.0},
            {"neighbors": np.int64(3)},
            {"order": np.False_},
            {},
            {"neighbors": np.float32(2)},
            {"target": False, "order": False},
        ]
    },
    **{
        f"LeadersEnv(reward={weights!r})": single(reward=weights)
        for weights in [
            {"signed_order": 1},
            {"jam": np.float32(0.5)},
            {"jam": np.array(0.5)},
            [{"jam": 1.0}, {"signed_order": 1.0}],
            ({"jam": 1}, {"jam": 2}),
        ]
    },
    **{
        f"seed {place} = {type(seed).__name__} in a vector": vector(seed=seed)
        for place, seed in enumerate(
            [
                3.0,
                np.float64(3),
                np.array([1, 2]),
                [1.0, 2.0],
                (1, None),
                range(2),
                np.array([1.0, 2.0]),
                np.uint64(2**63),
                iter([5, 6]),
                np.array(4),
            ]
        )
    },
    **{
        f"seed={seed!r} of one flock": parallel(seed=seed)
        for seed in [3.0, np.float32(3), np.int32(7), np.array(7), 2**64 - 1]
    },
    **{f"num_envs={count!r}": vector(num_envs=count) for count in [2.0, np.int64(2), np.array(2)]},
    **{
        f"reset bw_s {place}": parallel(reset={"bw_s": bw_s})
        for place, bw_s in enumerate(
            [
                1,
                0.5,
                np.float32(0.5),
                np.array(0.5),
                [0.1, 0.5],
                np.array([0.1, 0.5]),
                (0.1, 0.5),
                iter([0.1, 0.5]),
            ]
        )
    },
    **{f"simulate(seed={seed!r})": run(seed=seed) for seed in [3.0, np.int64(3), np.float64(3)]},
    **{
        f"torchrl.LeadersEnv.set_seed({seed!r})": torchrl_seed(seed)
        for seed in [3.0, np.float32(3), np.array(3.0), np.uint64(2**64 - 2), None]
    },
    **{
        f"RunSpec(seed={seed!r})": run_spec(seed)
        for seed in [3.0, np.int64(3), np.float64(3), np.array(3), np.uint64(2**64 - 1)]
    },
    **{
        f"simulate(duration_s={duration!r})": run(duration_s=duration)
        for duration in [1, np.float32(1), np.int64(1), np.array(1.0)]
    },
    **{
        f"simulate(schedule {place})": run(schedule=schedule)
        for place, schedule in enumerate(
            [
                ramp(np.linspace(0, 1.0, 6)),
                ramp(np.linspace(0, 1.0, 2)),
                ramp(np.arange(0, 1, 0.25)),
                ramp([0, 0.5, 1]),
                iter(ramp([0.0, 0.7])),
                tuple(ramp([0.5])),
                zip([0.25, 0.5], [{"bw_s": 0.2}, {"target": "ccw"}], strict=True),
                {0.25: {"bw_s": 0.2}}.items(),
            ]
        )
    },
}


@pytest.mark.parametrize("accepted", VALUES.values(), ids=VALUES.keys())
def test_values_are_accepted_as_people_write_them(accepted):
    accepted()
