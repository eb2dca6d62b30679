"""Draw the plots of the pages that no study and no benchmark draws itself: `make pictures`."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from docs.scripts.plots import DOCS, Plot, listed, one, rows
from flockenv.rendering.palette import OKABE_ITO

ENGINES = DOCS / "speed_vs_error/short_engines.csv"
IMPACT = DOCS / "speed_vs_error/impact.csv"
STEP_CONTROL = DOCS / "speed_vs_error/step_control.csv"
WORK = DOCS / "speed_vs_error/work.csv"
SPEED_PEERS, HORIZON_PEERS = (DOCS / f"speed_vs_error/{n}_peers.csv" for n in ("speed", "horizon"))
LEARNERS = DOCS / "throughput/learners.csv"
MANY_AGENTS = DOCS / "throughput/many_agents.csv"
SHOWN = {
    "leapfrog, gaps solved once": "leapfrog / exact / linear",
    "leapfrog, gaps to 1e-4 cm": "leapfrog / exact / 1e-4 cm",
    "leapfrog, gaps to 1e-6 cm": "leapfrog / exact / 1e-6 cm",
    "leapfrog, gaps to 1e-9 cm": "leapfrog / exact / 1e-9 cm",
    "moreau, gaps solved once": "moreau / exact / linear",
    "paper's scheme, gaps solved once": "paper / exact / linear",
    "rapier, its unit 10 cm": "rapier2d-f64 4 iterations / unit 10 cm",
    "rapier, its unit 1 cm": "rapier2d-f64 4 iterations / unit 1 cm",
    "Box2D": "Box2D (f32) 4 substeps / unit 10 cm",
    "pymunk": "pymunk 10 iterations",
    "MuJoCo": "MuJoCo Newton",
    "Drake": "Drake SAP",
}
OURS, OURS_CONTROLLED, THEIRS = OKABE_ITO["blue"], OKABE_ITO["vermilion"], "0.45"
N_OURS = 6
WORK_LINES = {
    "fixed step": ("flockenv", "leapfrog", OURS, "o"),
    "controlled step": ("flockenv", "controlled", OURS_CONTROLLED, "s"),
    "rapier": ("rapier2d-f64", "4 iterations", THEIRS, "D"),
    "Box2D": ("Box2D (f32)", "4 substeps", "black", "v"),
    "Drake": ("Drake", "SAP", OKABE_ITO["orange"], "p"),
    "MuJoCo": ("MuJoCo", "Newton", OKABE_ITO["green"], "X"),
    "pymunk": ("pymunk", "10 iterations", OKABE_ITO["purple"], "P"),
}
"""The lines of `work`: engine, beginning of its setting, color and marker."""


def engines(figure: Figure) -> None:
    """Draw the cost of a step and two errors, a line for each engine."""
    panels = figure.subplots(1, 3, sharey=True)
    by_setting = {row["engine, setting"]: row for row in rows(ENGINES)}
    lines = [by_setting[name] for name in SHOWN.values()]
    for axes, columns, label in zip(
        panels,
        ({"jam": "jam, µs", "moving": "cycle, µs"}, {"": "jam overlap, cm"}, {"": "slide, cm"}),
        ("step [µs]", "overlap [cm]", "slide error [cm]"),
        strict=True,
    ):
        for name, column in columns.items():
            _points(axes, [float(line[column]) for line in lines], name)
        axes.set(xscale="log", xlabel=label)
    panels[0].set_yticks(range(len(SHOWN)), [*SHOWN])
    panels[0].invert_yaxis()
    handles, words = panels[0].get_legend_handles_labels()
    figure.legend(handles, words, title="27 boats", loc="outside lower center", ncols=2)


def _points(axes: Axes, values: list[float], name: str) -> None:
    """Draw a point for each engine, ours in color, and hollow for flocks that move."""
    colors = [OURS] * N_OURS + [THEIRS] * (len(values) - N_OURS)
    faces = colors if name != "moving" else ["white"] * len(values)
    axes.scatter(
        values, range(len(values)), 45, color=faces, edgecolors=colors, label=name, zorder=3
    )


def impact(figure: Figure) -> None:
    """Draw the error of a boat that hits the wall against the step."""
    axes = figure.subplots()
    for row, color, marker in zip(
        (row for row in rows(IMPACT) if row["scheme"] != "leapfrog / 1e-9 cm"),
        (OURS, OURS_CONTROLLED),
        "os",
        strict=True,
    ):
        steps = [column for column in row if column != "scheme"]
        errors = [float(row[step]) for step in steps]
        lengths = [float(step.removeprefix("dt = ").removesuffix(" s")) for step in steps]
        name = row["scheme"].removesuffix(" / linear")
        axes.plot(lengths, errors, marker + "-", color=color, label=name)
    axes.set(xscale="log", yscale="log", xlabel="dt [s]", ylabel="error after an impact [cm]")
    axes.set_xticks(lengths, [f"{length:g}" for length in lengths], minor=False)
    axes.set_yticks([0.002, 0.005, 0.01, 0.02], ["0.002", "0.005", "0.01", "0.02"])
    axes.minorticks_off()
    axes.legend()


def step_control(figure: Figure) -> None:
    """Draw the error against the substeps taken, with a fixed and with a controlled step."""
    panels = figure.subplots(2, 2)
    for axes, scene in zip(panels.flat, ("slide", "impact", "jam", "cycle"), strict=True):
        for step, color, marker in (("fixed", OURS, "o"), ("controlled", OURS_CONTROLLED, "s")):
            measured = rows(STEP_CONTROL, scene=scene, step=step)
            substeps, errors = (
                [float(row[column]) for row in measured] for column in ("substeps", "error_cm")
            )
            axes.plot(substeps, errors, marker + "-", color=color, label=f"{step} step")
        axes.set(xscale="log", yscale="log", title=scene)
    for axes in panels[:, 0]:
        axes.set_ylabel("error [cm]")
    for axes in panels[1]:
        axes.set_xlabel("substeps")
    panels[0, 0].legend()


def work(figure: Figure) -> None:
    """Draw the error against the time for a second of a scene, a line for each engine."""
    panels = figure.subplots(1, 3)
    for axes, scene in zip(panels, ("slide", "jam", "cycle"), strict=True):
        for name, (engine, setting, color, marker) in WORK_LINES.items():
            # Only the first four lines are timed in the runs whose errors are measured.
            read = _runs if name in [*WORK_LINES][:4] else _peers
            if points := read(scene, engine, setting):
                times, errors = zip(*points, strict=True)
                axes.plot(times, errors, marker + "-", color=color, label=name, markersize=5)
        axes.set(xscale="log", yscale="log", title=scene, xlabel="computing for 1 s [ms]")
    panels[0].set_ylabel("error [cm]")
    handles, words = panels[1].get_legend_handles_labels()
    figure.legend(handles, words, loc="outside lower center", ncols=4)


def _runs(scene: str, engine: str, setting: str) -> list[tuple[float, float]]:
    """Return the time in ms per second and the error in cm of each step size of an engine.

    The time is that of the engine's step calls if it is known.
    """
    return [
        (
            float(row["call_us_per_s"] or row["us_per_s"]) / 1000,
            float(row["error_median_cm"]),
        )
        for row in rows(WORK, scene=scene, engine=engine)
        if row["setting"].startswith(setting)
    ]


def _peers(scene: str, engine: str, setting: str) -> list[tuple[float, float]]:
    """Return the time and the error, as `_runs` does, of an engine of another program.

    The time is from runs with noise, and the error from runs without. There are none for slides.
    """
    if scene == "slide":
        return []
    key = {"scene": scene, "engine": engine, "setting": setting}
    points = []
    for timed in rows(SPEED_PEERS, n="27", **key):
        error = one(HORIZON_PEERS, horizon_s="0.5", dt_s=timed["dt_s"], **key)
        cost = float(timed["us_per_step"]) / float(timed["dt_s"]) / 1000
        points.append((cost, float(error["horizon_median_cm"])))
    return points


def learners(figure: Figure) -> None:
    """Draw the samples per second of each interface, relative to the batch that it steps."""
    columns = ("median of the batch", "least of the batch", "most of the batch")
    # The first row is the batch itself.
    shares = {
        row["interface"]: (float(row[columns[0]]), float(row[columns[1]]), float(row[columns[2]]))
        for row in rows(LEARNERS)[1:]
    }
    axes = figure.subplots()
    listed(axes, shares, dict.fromkeys(shares, OURS), reference=1.0)
    axes.set(xlim=(0, 1.05), xlabel="share of the batch's speed")


def many_agents(figure: Figure) -> None:
    """Draw the steps per second of each environment, a point for each size of a batch."""
    axes = figure.subplots()
    measured = rows(MANY_AGENTS)
    lines = [*dict.fromkeys(row["environment"] for row in measured)]
    for environments, marker in (("64", "o"), ("1024", "s"), ("8192", "^")):
        batches = [row for row in measured if row["environments"] == environments]
        heights = [lines.index(row["environment"]) for row in batches]
        axes.scatter(
            [float(row["steps per second of one core"]) for row in batches],
            heights,
            45,
            color=[OURS if line == 0 else THEIRS for line in heights],
            marker=marker,
            zorder=3,
        )
        # An empty series gives the legend its marker in gray.
        axes.scatter([], [], 45, color=THEIRS, marker=marker, label=environments)
    axes.set(xscale="log", xlabel="environment steps per second of one core")
    axes.set_yticks(range(len(lines)), lines)
    axes.invert_yaxis()
    axes.legend(title="batch", loc="lower center", bbox_to_anchor=(0.3, 1.0), ncols=3)


PLOTS = {
    "speed_vs_error/engines.png": Plot([ENGINES], engines, (7.2, 4.4)),
    "speed_vs_error/impact.png": Plot([IMPACT], impact, (5.6, 3.6)),
    "speed_vs_error/step_control.png": Plot([STEP_CONTROL], step_control, (7.2, 5.6)),
    "speed_vs_error/work.png": Plot([WORK, SPEED_PEERS, HORIZON_PEERS], work, (7.2, 4.2)),
    "throughput/learners.png": Plot([LEARNERS], learners, (7.2, 3.8)),
    "throughput/many_agents.png": Plot([MANY_AGENTS], many_agents, (7.2, 3.6)),
}
"""The plots by their files below docs."""


if __name__ == "__main__":
    for name, plot in PLOTS.items():
        if not plot.is_drawn(DOCS / name):
            plot.save(DOCS / name)
