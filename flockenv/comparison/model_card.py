"""A policy's model card in Markdown: the policy, its provenance and its comparison."""

from collections.abc import Mapping, Sequence
from typing import Any

from flockenv._core import __version__
from flockenv.comparison.report import ComparisonReport
from flockenv.envs.observation import observation_version
from flockenv.policies import LeaningLaw, ModelPolicy, NetworkPolicy
from flockenv.policies.model import as_policy
from flockenv.policies.registry import EVERY_SUBSTEP
from flockenv.statistics.intervals import CONFIDENCE

__all__ = ["model_card"]


def model_card(
    name: str,
    policy: Any,
    results: Mapping[str, ComparisonReport],
    *,
    command: str,
    seeds: Sequence[int],
    duration_s: float,
) -> str:
    """Return the card of a policy as Markdown.

    Parameters
    ----------
    name
        Its name in the results.
    policy
        The policy; the card of a learned policy lists its provenance.
    results
        Its comparisons, by flock.
    command
        The command that made the results.
    seeds, duration_s
        Of their episodes.
    """
    policy = as_policy(policy)
    lines = [f"# {name}", ""]
    if isinstance(policy, NetworkPolicy | LeaningLaw | ModelPolicy):
        version = observation_version(policy.observation)
        takes = f"It takes version {version} of the observation."
        lines += [f"The policy is `{policy!r}`. {takes}", ""]
        lines += ["| provenance | |", "| --- | --- |"]
        lines += [f"| {name} | `{text}` |" for name, text in policy.provenance.items()]
    elif policy == EVERY_SUBSTEP:
        law = "The policy is the paper's law, eq. (10), from the pose at every substep."
        lines += [f"{law} It has no learned parameters."]
    else:
        lines += [f"The policy is `{policy!r}`. It has no learned parameters."]
    lines += [
        "",
        "## Comparison",
        "",
        f"`{command}` made the tables with flockenv {__version__}. Each row is over {len(seeds)} "
        f"episodes of {duration_s:g} s, with the same seeds {seeds[0]} to {seeds[-1]} for every "
        f"policy and number of leaders. Brackets hold {CONFIDENCE:.0%} intervals. "
        "Differences are paired by seed, and d is a difference's mean over its standard "
        "deviation.",
    ]
    for flock, result in results.items():
        lines += ["", f"### {flock}", "", f"{result.title()}.", "", *_means(result)]
        lines += ["", *_differences(name, result), "", *_lines(result)]
    return "\n".join(lines).rstrip() + "\n"


def _interval(row: Mapping[Any, Any], quantity: str) -> str:
    return f"{row[quantity]:.3f} [{row[f'{quantity}_low']:.3f}, {row[f'{quantity}_high']:.3f}]"


def _means(result: ComparisonReport) -> list[str]:
    lines = [
        "| policy | leaders | signed order | Ψ_o | time towards target | ordered (π/4) |",
        "| --- " * 6 + "|",
    ]
    for row in result.means.to_dict("records"):
        cells = [_interval(row, q) for q in ("signed_order", "psi_o", "share_towards_target")]
        ordered = f"{row['ordered']:.0%}"
        if row["ordered"] > 0:
            ordered += f", median {row['ordering_time_wide_s']:.0f} s"
        lines.append(f"| {row['policy']} | {row['leaders']} | {' | '.join(cells)} | {ordered} |")
    return lines


def _differences(name: str, result: ComparisonReport) -> list[str]:
    own = result.differences[result.differences["policy"] == name]
    lines = [
        "| reference | leaders | difference of the signed order | d |",
        "| --- " * 4 + "|",
    ]
    for row in own.to_dict("records"):
        interval = f"{row['mean']:+.3f} [{row['low']:+.3f}, {row['high']:+.3f}]"
        lines.append(
            f"| {row['reference']} | {row['leaders']} | {interval} | {row['effect']:.2f} |"
        )
    return lines if len(own) > 0 else []


def _lines(result: ComparisonReport) -> list[str]:
    fits = [
        f"- {policy}: signed order = {line}"
        for (policy, quantity), line in result.lines.items()
        if quantity == "signed_order"
    ]
    return ["Linear regressions in the number of leaders k:", "", *fits] if fits else []
