"""Measure and draw how leaders move: their rudders, positions and tracks, for several policies.

    python baselines/understand_leaders.py --pool narrow \\
        --policy "steering law" --policy "damped law" --out results/understand/narrow

The script draws rudders.png (mean rudder by time in the control cycle, against the angular velocity
of a leader that heads nearly right, and against misalignment), places.png (headings, distances from
the center and from each other) and tracks.png (two minutes of one episode). It writes means to
means.csv (at_wall, beside_wall and beside_leader are shares of the time). Episodes have the
critical noise, clockwise targets and paired seeds, and the first tenth of each is left out.
"""

import argparse
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from rich.progress import Progress
from script_end import one_line_end

import flockenv
from flockenv._core import pool_radii_cm
from flockenv._io.atomic_write import atomic_write, write_csv
from flockenv.comparison.figure import COLORS, policy_colors
from flockenv.envs.observation import observation_entries, state_entries
from flockenv.policies.registry import named_policy
from flockenv.runs.seeds import check_evaluation_seeds

CONTROL_HZ = 10.0
SAMPLED_EVERY = 5
PHASES = ("fw", "nop1", "bw", "nop2")
#: Within this of the target's tangent a leader heads nearly right.
NEARLY_RIGHT_RAD = 0.3
SPIN_RAD_S = 2.0
TRACKED_S = 120.0
#: What counts as in the row on the outer wall, in the lane beside that row, and next to a leader.
NEAR_WALL_CM, FAR_FROM_WALL_CM, BESIDE_CM = 8.0, 22.0, 20.0


def watch(
    name: str, parameters: flockenv.FlockParameters, options: argparse.Namespace, progress: Progress
) -> tuple[pd.DataFrame, float]:
    """Run episodes, and return samples, one row per leader and time, and the mean signed order."""
    policy = named_policy(name, parameters.pool)()
    if isinstance(policy, str):
        raise flockenv.ParameterError(f"{name!r} sees no observations: name another policy")
    env = flockenv.LeadersVectorEnv(
        options.episodes,
        autoreset_mode="disabled",
        params=parameters,
        target="cw",
        mirror_to_target=getattr(policy, "mirror_to_target", False),
        control_hz=CONTROL_HZ,
        episode_s=options.minutes * 60.0,
    )
    observations, infos = env.reset(seed=list(range(options.seed, options.seed + options.episodes)))
    steps = round(options.minutes * 60.0 * CONTROL_HZ)
    task, parts = progress.add_task(name, total=steps), []
    for step in range(steps):
        actions, _ = policy.predict(observations)
        if step >= steps // 10 and step % SAMPLED_EVERY == 0:
            parts.append(samples(observations, actions, env.state(), parameters))
        observations, _, _, _, infos = env.step(actions)
        progress.advance(task)
    return pd.concat(parts, ignore_index=True), float(
        infos["episode_summary"]["signed_order"].mean()
    )


def samples(
    observations: np.ndarray,
    actions: np.ndarray,
    state: np.ndarray,
    parameters: flockenv.FlockParameters,
) -> pd.DataFrame:
    """Take observations (episodes, leaders * size) and global states (episodes, size) apart."""
    own = {}
    rows = observations.reshape(actions.size, -1).astype(np.float64)
    for entry, column in zip(observation_entries(), rows.T, strict=True):
        own.setdefault(entry.name, column)
    ends = np.cumsum([getattr(parameters, f"{phase}_s") for phase in PHASES])
    phase = np.argmax([own[each] for each in PHASES], axis=0)
    orientation = np.arctan2(own["sin_orientation"], own["cos_orientation"])
    misalignment = np.angle(np.exp(1j * (orientation - np.pi / 2)))
    speed_cm_s = max(parameters.speed_cm_s, parameters.reverse_speed_cm_s)
    radius, apart = radius_cm(own["radial_position"], parameters), apart_cm(state, parameters)
    outer, _ = pool_radii_cm(parameters.pool)
    return pd.DataFrame(
        {
            "cycle_s": ends[phase] - 2.0 * own["time_left"],
            "misalignment_rad": misalignment,
            "spin_rad_s": -SPIN_RAD_S * own["clockwise_spin"],
            "rudder": np.clip(actions.ravel(), -1.0, 1.0),
            "alignment": np.cos(misalignment),
            "velocity_cm_s": speed_cm_s * own["clockwise_velocity"],
            "radius_cm": radius,
            "apart_cm": apart,
            "at_wall": radius > outer - NEAR_WALL_CM,
            "beside_wall": (radius > outer - FAR_FROM_WALL_CM) & (radius <= outer - NEAR_WALL_CM),
            "beside_leader": apart < BESIDE_CM,
        }
    )


def radius_cm(radial_position: np.ndarray, parameters: flockenv.FlockParameters) -> np.ndarray:
    """-1 and 1 stand for discs that touch the inner and the outer wall."""
    outer, inner = pool_radii_cm(parameters.pool)
    most, least = outer - parameters.boat_radius_cm, inner + parameters.boat_radius_cm
    return (most + least) / 2 + radial_position * (most - least) / 2


def apart_cm(state: np.ndarray, parameters: flockenv.FlockParameters) -> np.ndarray:
    """Distance of each leader to the next other one, from global states (episodes, size)."""
    width = len(state_entries(1)) - len(state_entries(0))
    boats = state[:, : width * parameters.n_leaders].reshape(
        len(state), parameters.n_leaders, width
    )
    names = [entry.name for entry in state_entries(1)]
    radial, cos, sin = (
        boats[..., names.index(name)].astype(np.float64)
        for name in ("radial_position", "cos_polar_angle", "sin_polar_angle")
    )
    place = radius_cm(radial, parameters) * (cos + 1j * sin)
    apart = np.abs(place[:, :, None] - place[:, None, :])
    apart[:, range(parameters.n_leaders), range(parameters.n_leaders)] = np.inf
    return apart.min(axis=2).ravel()


def draw_rudders(found: dict[str, pd.DataFrame], parameters: flockenv.FlockParameters) -> Figure:
    figure = Figure((17 / 2.54, 4.2 / 2.54 * len(found)), layout="constrained")
    panels = figure.subplots(len(found), 2, squeeze=False, sharex=True)
    for (left, right), (name, rows) in zip(panels, found.items(), strict=True):
        nearly = rows[rows["misalignment_rad"].abs() < NEARLY_RIGHT_RAD]
        mean_rudder(left, nearly, "spin_rad_s", 0.8, parameters)
        image = mean_rudder(right, rows, "misalignment_rad", np.pi, parameters)
        left.set_title(f"{name}, heading within {NEARLY_RIGHT_RAD:g} rad of right", pad=12)
        right.set_title(f"{name}, all", pad=12)
        left.set_ylabel("angular velocity [rad/s]")
        right.set_ylabel("misalignment [rad]")
    for axes in panels[-1]:
        axes.set_xlabel("time in the control cycle [s]")
    figure.colorbar(image, ax=panels, label="mean rudder", shrink=0.6)
    return figure


def mean_rudder(
    axes: Axes, rows: pd.DataFrame, against: str, most: float, parameters: flockenv.FlockParameters
) -> object:
    ends = np.cumsum([getattr(parameters, f"{phase}_s") for phase in PHASES])
    edges = [np.linspace(0.0, ends[-1], 31), np.linspace(-most, most, 26)]
    weighted, _, _ = np.histogram2d(rows["cycle_s"], rows[against], edges, weights=rows["rudder"])
    count, _, _ = np.histogram2d(rows["cycle_s"], rows[against], edges)
    mean = np.where(count >= 20, weighted / np.maximum(count, 1), np.nan)
    for end in ends[:-1]:
        axes.axvline(end, color="0.3", linewidth=0.5)
    for phase, end in zip(PHASES, ends, strict=True):
        middle = end - getattr(parameters, f"{phase}_s") / 2
        # Above the panel, where no color lies under the letters.
        above = axes.get_xaxis_transform()
        axes.text(middle, 1.02, phase, ha="center", va="bottom", fontsize=6, transform=above)
    return axes.pcolormesh(*edges, mean.T, cmap="PuOr", vmin=-1.0, vmax=1.0, rasterized=True)


def draw_places(found: dict[str, pd.DataFrame], parameters: flockenv.FlockParameters) -> Figure:
    outer, inner = pool_radii_cm(parameters.pool)
    shown = {
        "alignment": ("cos of misalignment", np.linspace(-1.0, 1.0, 41)),
        "radius_cm": ("distance from the center [cm]", np.linspace(inner, outer, 31)),
        "apart_cm": ("distance to the next leader [cm]", np.linspace(0.0, 2.0 * outer, 41)),
    }
    figure = Figure((17 / 2.54, 5 / 2.54), layout="constrained")
    for axes, (column, (label, edges)) in zip(figure.subplots(1, 3), shown.items(), strict=True):
        colors = policy_colors(found)
        for name, rows in found.items():
            if np.isfinite(rows[column]).all():
                axes.hist(
                    rows[column],
                    edges,
                    density=True,
                    histtype="step",
                    color=colors[name],
                    label=name,
                )
        axes.set_xlabel(label)
        axes.set_ylabel("probability density")
        axes.set_yscale("log" if column == "alignment" else "linear")
    figure.axes[0].legend(loc="upper left")
    return figure


def draw_tracks(
    names: list[str], parameters: flockenv.FlockParameters, options: argparse.Namespace
) -> Figure:
    """Draw two minutes in the middle of one episode; every track starts at its dot."""
    figure = Figure((6 / 2.54 * len(names), 6.5 / 2.54), layout="constrained")
    outer, inner = pool_radii_cm(parameters.pool)
    middle = options.minutes * 30.0
    for axes, name in zip(figure.subplots(1, len(names), squeeze=False)[0], names, strict=True):
        run = flockenv.simulate(
            parameters,
            options.seed,
            middle + TRACKED_S,
            CONTROL_HZ,
            policy=named_policy(name, parameters.pool)(),
        )
        pose = run.pose[run.time_s >= middle]
        for radius in (outer, inner):
            axes.add_patch(Circle((0, 0), radius, fill=False, color="0.3", linewidth=0.6))
        for boat in range(parameters.n_boats - 1, -1, -1):
            leads = boat < parameters.n_leaders
            style = {
                "color": COLORS[boat % 6] if leads else "0.85",
                "linewidth": 0.8 if leads else 0.4,
            }
            axes.plot(pose[:, boat, 0], pose[:, boat, 1], **style)
            if leads:
                axes.plot(*pose[0, boat, :2], "o", color=COLORS[boat % 6])
        signed = run.order.signed_order("cw")[run.time_s >= middle].mean()
        axes.set_title(f"{name}: signed order {signed:.2f}")
        axes.set_aspect("equal")
        axes.set_axis_off()
    return figure


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pool", choices=("wide", "narrow"), default="narrow")
    parser.add_argument("--policy", action="append", help="name or .npz [both laws]")
    parser.add_argument("--leaders", type=int, default=3)
    parser.add_argument("--episodes", type=int, default=64)
    parser.add_argument("--minutes", type=float, default=8.0, help="length of an episode")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("results/understand"))
    parser.add_argument("--quiet", action="store_true")
    options = parser.parse_args(arguments)
    parameters = flockenv.FlockParameters.preset("simulation").replace(
        pool=options.pool,
        n_boats=27,
        n_leaders=options.leaders,
        bw_s=flockenv.FlockParameters.critical_bw_s("simulation", options.pool),
    )
    found, means = {}, []
    with one_line_end(lambda: "means.csv was not written"):
        check_evaluation_seeds(range(options.seed, options.seed + options.episodes))
        options.out.mkdir(parents=True, exist_ok=True)
        with Progress(disable=options.quiet) as progress:
            names = list(dict.fromkeys(options.policy or ["steering law", "damped law"]))
            stems = [Path(name).stem for name in names]
            labels = stems if len(set(stems)) == len(names) else names
            for label, name in zip(labels, names, strict=True):
                found[label], order = watch(name, parameters, options, progress)
                means.append({"policy": label, "signed_order": order, **found[label].mean()})
        with mpl.rc_context({"font.size": 7, "legend.frameon": False, "svg.hashsalt": "flockenv"}):
            figures = {
                "rudders": draw_rudders(found, parameters),
                "places": draw_places(found, parameters),
                "tracks": draw_tracks(names, parameters, options),
            }
            for name, figure in figures.items():
                with atomic_write(options.out / f"{name}.png") as file:
                    figure.savefig(file, dpi=200, format="png")
    table = pd.DataFrame(means).drop(columns=["cycle_s", "misalignment_rad", "spin_rad_s"])
    write_csv(options.out / "means.csv", table)
    print(table.round(3).to_string(index=False))
    print(f"written to {options.out}")


if __name__ == "__main__":
    main()
