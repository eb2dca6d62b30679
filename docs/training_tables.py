"""The tables of docs/train.md: what trainings, their searches and signals of rewards gave."""

from collections.abc import Mapping
from functools import partial

from committed_data import (
    DIFFERENCES,
    MEANS,
    POOLS,
    difference,
    interval,
    markdown,
    one,
    order,
    rows,
)

LEANS = "training/trials_of_leans.csv"


def ppo_comparison() -> str:
    """Return the order with PPO's best policy and three leaders."""
    body = []
    for pool, scene in zip(POOLS, ("wide-bw-0.31", "narrow-bw-0.45"), strict=True):
        mean = one(MEANS, comparison="ppo", scene=scene, policy="best")
        gains = [
            one(DIFFERENCES, comparison="ppo", scene=scene, policy="best", reference=law)
            for law in ("damped law", "tuned damped law")
        ]
        body.append([f"`{pool}`", order(mean), *(difference(row) for row in gains)])
    header = ["pool", "PPO", "minus the damped law", "minus the tuned damped law"]
    return markdown(header, body)


def first_training() -> str:
    """Return what the first training run of docs/train.md adds to the law that it started from."""
    body = []
    for k in ("1", "2", "3"):
        means = (
            one(MEANS, comparison="first-training", policy=name, leaders=k)
            for name in ("damped law", "best")
        )
        gain = one(DIFFERENCES, comparison="first-training", policy="best", leaders=k)
        body.append([k, *(order(row) for row in means), difference(gain)])
    return markdown(["leaders", "damped law", "trained", "trained minus damped law"], body)


def signals() -> str:
    """Return z per million samples of each reward and horizon, for rudders."""
    return _signals({"": "results/signals.csv"})


def lean_signals() -> str:
    """Return z per million samples of each reward and horizon, for leans."""
    noises = ("own", "shared")
    return _signals({f"{noise} noise, ": f"results/signals_lean_{noise}.csv" for noise in noises})


def ppo_signals() -> str:
    """Return z per million samples along the direction to a trained policy, by kind of noise."""
    noises = {
        "of each leader's action": "own",
        "of the actions of a flock's leaders": "shared",
        "of the weights of a flock's leaders": "weights",
    }
    body = []
    for title, name in noises.items():
        found = rows(f"results/signals_ppo_{name}.csv")
        for reward in dict.fromkeys(row["reward"] for row in found):
            cells = [_z(row) for row in found if row["reward"] == reward]
            body.append([title, f"`{reward}`", *cells])
    horizons = list(dict.fromkeys(row["horizon_s"] for row in found))
    return markdown(["noise", "reward", *(f"horizon {float(h):g} s" for h in horizons)], body)


def _z(row: Mapping[str, str]) -> str:
    return f"{float(row['z_per_million']):+.1f} ± {float(row['error']):.1f}"


def _signals(files: Mapping[str, str]) -> str:
    """Return what `flockenv signal` measured; files stand by how their titles start."""
    every = {title: rows(file) for title, file in files.items()}
    (first, *_) = every.values()
    horizons = list(dict.fromkeys(row["horizon_s"] for row in first))
    body = []
    for pool, reward_name in dict.fromkeys((row["pool"], row["reward"]) for row in first):
        each = (
            one(file, pool=pool, reward=reward_name, horizon_s=horizon)
            for file in files.values()
            for horizon in horizons
        )
        body.append([f"`{pool}`", f"`{reward_name}`", *map(_z, each)])
    titles = [f"{title}horizon {float(each):g} s" for title in files for each in horizons]
    return markdown(["pool", "reward", *titles], body)


def rudders() -> str:
    """Return what PPO of rudders from random weights reached in narrow."""
    observed = {"default": "default_observation", "default and `law_rudder`": "law_rudder"}
    body = []
    for title, name in observed.items():
        known = {"comparison": "ppo-rudders", "policy": name}
        gains = [
            one(DIFFERENCES, reference=law, **known) for law in ("damped law", "tuned damped law")
        ]
        body.append([title, order(one(MEANS, **known)), *(difference(row) for row in gains)])
    header = ["observation", "PPO", "minus the damped law", "minus the tuned damped law"]
    return markdown(header, body)


def level_searches() -> str:
    """Return what searches reached that gained nothing over the pretrained leaders."""
    hours = {row["comparison"]: row["flock_hours"] for row in rows("training/searches.csv")}
    titles = {
        "search-alternating": "`wide`, target alternates",
        "search-nonlinear": "`narrow`, nonlinear lean with the gaps to fellow leaders",
    }
    body = []
    for comparison, title in titles.items():
        known = {"comparison": comparison, "policy": "searched"}
        references = ("tuned damped law", "learned")
        gains = [one(DIFFERENCES, reference=each, **known) for each in references]
        cells = [order(one(MEANS, **known)), *(difference(row) for row in gains)]
        body.append([title, hours[comparison], *cells])
    header = ["search", "flock-hours", "searched", "minus the tuned damped law", "minus learned"]
    return markdown(header, body)


def trained(pool: str) -> str:
    """Return the held-out orders of `flockenv train --seeds`."""
    file = f"training/{pool}/evaluation.csv"
    laws = ("damped law", "tuned damped law", "learned")
    body = []
    for policy in dict.fromkeys(row["policy"] for row in rows(file)):
        found = [one(file, policy=policy, minus="")]
        found += [] if policy in laws else [one(file, policy=policy, minus=law) for law in laws]
        forms = (".3f", *["+.3f"] * len(laws))
        cells = [
            interval(row, "signed_order", "low", "high", form)
            for row, form in zip(found, forms, strict=False)
        ]
        body.append([policy, *cells, *[""] * (len(forms) - len(cells))])
    return markdown(["policy", "signed order", *(f"minus {law}" for law in laws)], body)


def settings_of_leans() -> str:
    """Return the held-out orders of trainings in wide with different settings."""
    kinds = {
        "wide-action-noise": ("a deep set, then 32 units", "action", "1"),
        "wide-linear-action-noise": ("linear", "action", "1"),
        "wide": ("linear", "weights", "1"),
        "wide-hidden": ("64 units", "weights of the last layer", "1"),
        "wide-5-hz": ("linear", "weights", "5"),
    }
    body = []
    for folder, cells in kinds.items():
        file = f"training/{folder}/evaluation.csv"
        for row in rows(file, minus=""):
            if row["policy"].startswith("seed "):
                gain = one(file, policy=row["policy"], minus="tuned damped law")
                found = zip((row, gain), (".3f", "+.3f"), strict=True)
                orders = (
                    interval(each, "signed_order", "low", "high", form) for each, form in found
                )
                body.append([*cells, row["policy"], *orders])
    header = ["lean", "noise of the", "decisions per second", "training", "signed order"]
    return markdown([*header, "minus tuned damped law"], body)


def ppo_search() -> str:
    """Return the runs of the search of PPO's settings, best first."""
    found = rows("leaders/ppo_search.csv")
    found.sort(key=lambda row: -float(row["mean"]))
    body = []
    for row in found:
        known = row["learning_rate"] != ""
        body.append(
            [
                f"run {row['run']}" if known else row["run"],
                f"{float(row['learning_rate']):.1e}" if known else "",
                row["log_std_init"],
                {"True": "yes", "False": "no"}.get(row["use_sde"], ""),
                row["control_hz"],
                f"{float(row['mean']):.3f}",
            ]
        )
    header = ["", "learning rate", "`log_std_init`", "gSDE", "decisions per second", "signed order"]
    return markdown(header, body)


def lean_search() -> str:
    """Return the best finished trials of the search of PPO's settings for leans."""
    found = rows("training/search_ppo.csv", state="complete")
    found.sort(key=lambda row: -float(row["difference"]))
    body = []
    for row in found[:6]:
        numbers = (
            f"{float(row['learning_rate']):.1e}",
            *(f"{float(row[name]):.2f}" for name in ("deviation", "lambda_4s")),
            *(f"{float(row[name]):.0f}" for name in ("hold_s", "horizon_s", "decision_s")),
        )
        network = f"{row['encoder']}, {row['net_arch'] or 'linear'}"
        cells = (network, interval(row, "difference", "low", "high", "+.3f"))
        body.append([row["trial"], *numbers, *cells])
    header = [
        "trial",
        "learning rate",
        "deviation",
        "λ for 4 s",
        "noise held, s",
        "horizon, s",
        "decision, s",
        "encoder and layers",
        "minus the tuned damped law",
    ]
    return markdown(header, body)


def terms_of_leans() -> str:
    """Return the effects of further terms of the lean, in both designs."""
    designs = ("factorial of 14", "factorial of 7")
    every = [row for design in designs for row in rows(LEANS, how=design)]
    body = []
    for trial in dict.fromkeys(row["trial"] for row in every):
        cells = [trial]
        for design in designs:
            own = [row for row in every if row["trial"] == trial and row["how"] == design]
            cells += [own[0]["change"], _with_error(own[0])] if own else ["", ""]
        body.append(cells)
    return markdown(["term", "change", "effect", "change, second design", "effect"], body)


def trials_of_leans() -> str:
    """Return the paired differences of changed leans from the pretrained leaders."""
    return _trials("paired")


def trained_leans() -> str:
    """Return the paired differences of trained leans."""
    return _trials("trained leans")


def _trials(how: str) -> str:
    body = [
        [row["trial"], row["episodes"], row["flock_hours"], _with_error(row)]
        for row in rows(LEANS, how=how)
    ]
    return markdown(["change", "pairs of episodes", "flock-hours", "difference"], body)


def _with_error(row: Mapping[str, str]) -> str:
    return f"{float(row['difference']):+.3f} ± {float(row['error']):.3f}"


TRAINING_TABLES = {
    "first-training": first_training,
    "ppo-comparison": ppo_comparison,
    "ppo-search": ppo_search,
    "lean-search": lean_search,
    "signals": signals,
    "lean-signals": lean_signals,
    "settings-of-leans": settings_of_leans,
    "ppo-signals": ppo_signals,
    "rudders": rudders,
    "level-searches": level_searches,
    "terms-of-leans": terms_of_leans,
    "trials-of-leans": trials_of_leans,
    "trained-leans": trained_leans,
    "trained-wide": partial(trained, "wide"),
    "trained-narrow": partial(trained, "narrow"),
    "trained-contact-push": partial(trained, "narrow-contact-push"),
}
"""How each table is made."""
