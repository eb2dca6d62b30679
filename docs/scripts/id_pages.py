"""A page for each registered id of the environments: purpose, spaces, reward, arguments, results.

All of it follows from flockenv/envs/ids.py, the core's declarations and committed data, so that a
new id changes only that file. Parts that only the site can show stand in a comment
`<!-- site`, which conf.py opens: in a repository's viewer the page is plain Markdown.
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import asdict, fields
from functools import partial
from pathlib import Path
from string import Template
from typing import Any

import gymnasium
from matplotlib.figure import Figure
from PIL import Image

from docs.scripts.loops import HEIGHT, SHOWN, draw, shown
from docs.scripts.markdown import markdown
from docs.scripts.plots import STUDIES, Interval, Plot, Row, listed, rows
from flockenv.comparison.figure import policy_colors
from flockenv.comparison.levels import LEVEL_IDS
from flockenv.comparison.suite import REFERENCE, TASK_IDS
from flockenv.envs.ids import ENVIRONMENTS
from flockenv.envs.observation import observation_entries
from flockenv.envs.options import OPTIONS, TERMS, EnvOptions
from flockenv.parameters import FlockParameters
from flockenv.policies import policy

LEADERS, EASY = "flockenv/Leaders-v0", "flockenv/Order-easy-v0"
GOOD_POLICIES = {"wide": "learned"}
"""The policy in a film, by the pool; in other pools it is the damped law."""
BEFORE_S, FRAMES, STEP_S, SEED = 10.0, 100, 0.8, 10
"""A film starts 10 s before a quarter of the episode is over, when targets may change. With this
seed the flocks follow."""

SCORES = STUDIES / "suite" / "results" / "v2.csv"
PAGE = Template(Path(__file__).with_name("id_page.template").read_text(encoding="utf-8"))
WORDS = {
    name: Template(words)
    for name, words in re.findall(
        r"^# (\w+)\n\n(.+)$",
        Path(__file__).with_name("reached.template").read_text(encoding="utf-8"),
        re.MULTILINE,
    )
}
"""Text below the plot of the orders that policies reach, by the kind of data."""
MEANS = STUDIES / "leaders" / "results" / "means.csv"


def page_name(env_id: str) -> str:
    """Return the name of an id's page: its own, without the package and the version."""
    return env_id.removeprefix("flockenv/").rpartition("-v")[0]


def id_pages() -> dict[str, str]:
    """Return the text of every page by its name."""
    return {page_name(env_id): page(env_id) for env_id in ENVIRONMENTS}


def registered() -> str:
    """Return a table of all ids, and their order on the site."""
    body = [
        [f"[`{env_id.removeprefix('flockenv/')}`]({page_name(env_id)}.md)", declared.purpose]
        for env_id, declared in ENVIRONMENTS.items()
    ]
    names = "\n".join(map(page_name, ENVIRONMENTS))
    toctree = site(f"```{{toctree}}\n:hidden:\n\n{names}\n```")
    return f"{markdown(['id', 'purpose'], body)}\n\n{toctree}"


def site(text: str) -> str:
    """Return a text as a comment that the site shows and a repository's viewer hides."""
    return f"<!-- site\n{text}\n-->"


def page(env_id: str) -> str:
    """Return the page of an id, whose sentences are in id_page.template."""
    declared, name = ENVIRONMENTS[env_id], page_name(env_id)
    env = gymnasium.make(env_id)
    alt = f"A flock in {env_id}. Its leaders have a ring, and steer by the {film_policy(env_id)}."
    steps, step_s = env.spec.max_episode_steps, 1.0 / env.metadata["render_fps"]
    return PAGE.substitute(
        title=env_id.removeprefix("flockenv/"),
        env_id=env_id,
        purpose=declared.purpose,
        history="\n".join(f"- {change}" for change in declared.history),
        film=shown(name, alt, "../"),
        policy=film_policy(env_id),
        told=_shared_target_words(env_id),
        seed=SEED,
        step_s=f"{step_s:g}",
        steps=steps,
        episode_s=f"{steps * step_s:g}",
        arguments=_arguments(env_id),
        reached=_reached(env_id),
        **_spaces(env_id, env),
        **_reward(env_id),
    )


def _reached(env_id: str) -> str:
    """Return the section on the orders that policies reach; empty without data."""
    plot_and_words = plot_of_orders(env_id)
    if plot_and_words is None:
        return ""
    source = f"../loops/{page_name(env_id)}.png"
    picture = f'<img class="plot" src="{source}" alt="Signed order by policy" width="540">'
    picture = site(f"```{{raw}} html\n{picture}\n```")
    return f"## What policies reach\n\n{picture}\n\n{plot_and_words[1]}\n\n"


def _spaces(env_id: str, env: gymnasium.Env[Any, Any]) -> dict[str, str]:
    """Return the spaces of actions and observations, with a table of each."""
    leaders = env.unwrapped.num_leaders
    body = [[str(k), f"rudder of leader {k}", "-1", "1"] for k in range(leaders)]
    entries = observation_entries(_settings(env_id, by_block=True)["observation"])
    indices: dict[tuple[str, str], list[int]] = {}
    for index, entry in enumerate(entries):
        indices.setdefault((entry.block, entry.name), []).append(index)
    table = []
    for (_, name), same_indices in indices.items():
        entry = entries[same_indices[0]]
        bounds = f"[{entry.low:g}, {entry.high:g}]"
        meaning = plain_cell(entry.meaning)
        table.append([_index_list(same_indices), f"`{name}`", entry.unit or "1", bounds, meaning])
    return {
        "action_space": str(env.action_space),
        "actions": markdown(["index", "meaning", "low", "high"], body),
        "observation_shape": str(env.observation_space.shape),
        "times": "The table has leader 0's entries; each further leader adds the same. "
        * (leaders > 1),
        "entries": markdown(["index", "name", "unit", "range", "meaning"], table),
    }


def _index_list(indices: list[int]) -> str:
    """Return indices as text: up to three of them, or the first two and the last."""
    return (
        ", ".join(map(str, indices))
        if len(indices) < 4
        else f"{indices[0]}, {indices[1]}, … {indices[-1]}"
    )


def _reward(env_id: str) -> dict[str, str]:
    """Return the reward's formula and its terms."""
    weights = _settings(env_id, by_block=True)["reward"]
    formula = " + ".join(
        name if weight == 1.0 else f"{weight:g}·{name}" for name, weight in weights.items()
    )
    terms = "\n".join(f"- `{name}`: {plain_cell(TERMS[name])}" for name in weights)
    return {"formula": formula, "terms": terms}


USUAL = ("n_boats", "n_leaders", "pool", "bw_s", "target", "episode_s", "control_hz", "reward")
"""Arguments that most trainings set."""


def _arguments(env_id: str) -> str:
    """Return the arguments that most trainings set, and those that an id sets."""
    in_leaders, settings = _settings(LEADERS), _settings(env_id)
    differing = [name for name, value in settings.items() if value != in_leaders[name]]
    names = list(dict.fromkeys([*USUAL, *differing]))
    meanings = {field.name: field.metadata["doc"] for field in fields(FlockParameters)}
    meanings = {name: option.doc for name, option in OPTIONS.items()} | meanings
    meanings["episode_s"] = OPTIONS["episode_s"].doc
    body = []
    for name in names:
        block = re.fullmatch(r'observation\["(\w+)"\]', name)
        meaning = (
            f"block `{block[1]}` of the observation" if block else _first_sentence(meanings[name])
        )
        body.append([f"`{name}`", f"`{settings[name]}`", f"`{in_leaders[name]}`", meaning])
    header = ["argument", "here", f"in `{page_name(LEADERS)}`", "meaning"]
    if env_id == LEADERS:
        body, header = (
            [[name, here, meaning] for name, here, _, meaning in body],
            ["argument", "here", "meaning"],
        )
    return markdown(header, body)


def _first_sentence(text: str) -> str:
    """Return the first sentence of a meaning as a table's cell."""
    return plain_cell(re.split(r"\.\s(?=[A-Z])", text, maxsplit=1)[0].rstrip("."))


def plain_cell(text: str) -> str:
    """Return a text with the characters escaped that tables in Markdown interpret."""
    return text.replace("|", r"\|").replace("*", r"\*")


def _settings(env_id: str, *, by_block: bool = False) -> dict[str, Any]:
    """Return the values of all parameters and options of an id, by name.

    With `by_block`, "observation" has the values of its blocks by name. Otherwise each block is an
    entry such as 'observation["own"]'.
    """
    parsed = EnvOptions.parse(ENVIRONMENTS[env_id].options)
    parameters = asdict(parsed.parameters)
    defaults = {name: option.default for name, option in OPTIONS.items()}
    # Parameters are first in the table, and replace the defaults of options with the same name.
    settings = {**parameters, **defaults, **parameters, **parsed.settings}
    settings["observation"] = {**defaults["observation"], **settings["observation"]}
    if not by_block:
        for block, value in settings.pop("observation").items():
            settings[f'observation["{block}"]'] = value
    # The option may be None for a length that depends on the target.
    env = gymnasium.make(env_id)
    settings["episode_s"] = round(env.spec.max_episode_steps / env.metadata["render_fps"])
    return settings


# --- films ----------------------------------------------------------------------------------------


def draw_films() -> None:
    """Draw the plot of each id, and its film unless it is up to date."""
    code = Path(__file__).read_text(encoding="utf-8")
    for env_id, declared in ENVIRONMENTS.items():
        draw(page_name(env_id), partial(film, env_id), repr(declared.options), code)
        if plot_and_words := plot_of_orders(env_id):
            SHOWN.mkdir(parents=True, exist_ok=True)
            plot_and_words[0].save(SHOWN / f"{page_name(env_id)}.png")


def film_policy(env_id: str) -> str:
    """Return the name of the policy in the film."""
    if _shared_target_words(env_id):
        # Learned leaders read mirrored observations and no target: to tell them one has no effect.
        return REFERENCE
    pool = EnvOptions.parse(ENVIRONMENTS[env_id].options).parameters.pool
    return GOOD_POLICIES.get(pool, "damped law")


def _shared_target_words(env_id: str) -> str:
    """Return words on a target that leaders with different ones share; empty for other ids."""
    is_per_leader = isinstance(ENVIRONMENTS[env_id].options.get("target"), tuple)
    return ", which are both told the direction of leader 0" if is_per_leader else ""


def film(env_id: str) -> Iterator[Image.Image]:
    """Yield pictures of a flock that a good policy leads."""
    pool = EnvOptions.parse(ENVIRONMENTS[env_id].options).parameters.pool
    leaders = policy(film_policy(env_id), pool)
    layout = {name: getattr(leaders, name) for name in ("observation", "mirror_to_target")}
    size = (HEIGHT, HEIGHT)
    env = gymnasium.make(env_id, render_mode="rgb_array", render_size=size, **layout)
    observation, _ = env.reset(seed=SEED)
    hz = env.metadata["render_fps"]
    skipped = round(env.spec.max_episode_steps / 4 - BEFORE_S * hz)
    for step in range(skipped + FRAMES * round(STEP_S * hz)):
        if step >= skipped and (step - skipped) % round(STEP_S * hz) == 0:
            yield Image.fromarray(env.render())
        rows = observation.reshape(env.unwrapped.num_leaders, -1)
        if _shared_target_words(env_id):
            # As in studies/roles/misinformed_pair.py, both are told the target of leader 0.
            rows[:, _TARGET_ENTRIES] = rows[0, _TARGET_ENTRIES]
        observation = env.step(leaders.predict(rows.reshape(-1))[0])[0]
    env.close()


_TARGET_ENTRIES = [
    index for index, entry in enumerate(observation_entries()) if entry.block == "target"
]


# --- what policies reach --------------------------------------------------------------------------


def plot_of_orders(env_id: str) -> tuple[Plot, str] | None:
    """Return the plot of an id's committed data, and the words below it; None without data."""
    task = next((name for name, task_id in TASK_IDS.items() if task_id == env_id), None)
    if task is not None:
        return _suite(task)
    if env_id in DATA:
        return DATA[env_id]()
    level = next((name for name, level_id in LEVEL_IDS.items() if level_id == env_id), None)
    return None if level is None else _level(level)


def _suite(task: str) -> tuple[Plot, str]:
    """Return the plot and the words of a task of suite v2."""
    scores = rows(SCORES, task=task)
    intervals = {
        f"{row['policy']}: {float(row['signed_order']):z.2f}": _interval(row, "score", "score_")
        for row in scores
    }
    tuned_law = float(scores[0]["signed_order"]) - float(scores[0]["score"])
    words = WORDS["suite"].substitute(task=task)
    label = f"signed order minus the tuned law's {tuned_law:.2f}"
    return _plot([SCORES], intervals, label, 0.0), words


def _level(level: str) -> tuple[Plot, str]:
    """Return the plot and the words of a level of suite v3."""
    file = STUDIES / "levels" / "results" / "laws.csv"
    orders = rows(file, level=level)
    words = WORDS["level"].substitute(level=level, flocks=orders[0]["flocks"])
    return _plot([file], {row["policy"]: _interval(row, "signed_order") for row in orders}), words


AT_THREE = {"case": "wide-bw-0.31", "leaders": "3"}


def _leaders() -> tuple[Plot, str]:
    """Return the plot and the words of `LEADERS`, with three leaders."""
    by_policy = {
        row["policy"]: _interval(row, "signed_order", "signed_order_")
        for row in rows(MEANS, **AT_THREE)
    }
    intervals = dict(sorted(by_policy.items(), key=lambda item: item[1], reverse=True))
    return _plot([MEANS], intervals), WORDS["leaders"].substitute()


def _easy() -> tuple[Plot, str]:
    """Return the plot and the words of `EASY`: trainings at their end, and then laws."""
    file = STUDIES / "easy" / "results" / "curve.csv"
    orders = [row for row in rows(file) if "minus" not in row["policy"]]
    most_samples = max(int(row["samples"] or 0) for row in orders)
    most_s = max(float(row["cpu_s"] or 0.0) for row in orders)
    trainings = [row for row in orders if row["samples"] == str(most_samples)]
    laws = [row for row in orders if row["samples"] == ""]
    names = [f"{row['policy']}, seed {row['seed']}" for row in trainings]
    names += [row["policy"] for row in laws]
    intervals = {
        name: _interval(row, "signed_order")
        for name, row in zip(names, [*trainings, *laws], strict=True)
    }
    words = WORDS["easy"].substitute(millions=f"{most_samples / 1e6:.1f}", most_s=f"{most_s:.0f}")
    return _plot([file], intervals), words


DATA: dict[str, Callable[[], tuple[Plot, str]]] = {LEADERS: _leaders, EASY: _easy}
"""Plots of ids that are not tasks of the suite."""


def _interval(row: Row, mean: str, ends: str = "") -> Interval:
    """Return a mean and its interval from columns `mean`, `ends` + "low" and `ends` + "high"."""
    return float(row[mean]), float(row[f"{ends}low"]), float(row[f"{ends}high"])


def _plot(
    data: list[Path],
    intervals: dict[str, Interval],
    label: str = "signed order",
    reference: float | None = None,
) -> Plot:
    colors = policy_colors(dict.fromkeys(map(_policy, intervals)))

    def draw_intervals(figure: Figure) -> None:
        axes = figure.subplots()
        listed(axes, intervals, {name: colors[_policy(name)] for name in intervals}, reference)
        axes.set_xlabel(label)
        axes.locator_params(axis="x", nbins=5)

    return Plot(data, draw_intervals, (6.0, 0.8 + 0.35 * len(intervals)))


def _policy(shown_name: str) -> str:
    """Return the policy in a name such as `learned: 0.52` or `PPO, seed 0`."""
    return shown_name.partition(":")[0].partition(", seed")[0]
