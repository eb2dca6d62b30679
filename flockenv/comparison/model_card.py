"""A policy's model card in Markdown: the policy, its provenance and its comparison."""

from typing import Any

from flockenv._core import __version__
from flockenv.comparison.report import ComparisonReport
from flockenv.envs.observation import observation_version
from flockenv.policies.registry import EVERY_SUBSTEP
from flockenv.statistics import CONFIDENCE

__all__ = ["model_card"]


def model_card(name: str, policy: Any, result: ComparisonReport, command: str) -> str:
    """Return the card of a policy as Markdown.

    Parameters
    ----------
    name
        Its name in the results.
    policy
        The policy, or a dictionary with one per leader; a learned policy says where it is from.
    result
        Its comparison.
    command
        The command that made the results.
    """
    lines = [f"# {name}", "", *_policy(policy), "", "## Comparison", ""]
    lines += [
        f"`{command}` made the tables with flockenv {__version__}. Every policy and number of "
        f"leaders has the same seeds in a case. Brackets hold {CONFIDENCE:.0%} intervals. "
        "Differences are paired by seed, and d is their mean over their standard deviation."
    ]
    for case in result.cases:
        lines += ["", f"### {case.name}", ""]
        lines += [f"{case.title()}; {len(case.seeds)} episodes of {case.episode_s:g} s.", ""]
        lines += [*_means(result, case.name), "", *_differences(result, case.name, name)]
    return "\n".join(lines).rstrip() + "\n"


def _policy(policy: Any) -> list[str]:
    if isinstance(policy, dict):
        return [f"- {leader}: `{each!r}`" for leader, each in policy.items()]
    if policy == EVERY_SUBSTEP:
        return ["The policy is the paper's law, eq. (10), from the pose at every substep."]
    lines = [f"The policy is `{policy!r}`."]
    provenance = getattr(policy, "provenance", None)
    if provenance is not None:
        version = observation_version(policy.observation)
        lines += ["", f"It takes version {version} of the observation.", ""]
        lines += ["| provenance | |", "| --- | --- |"]
        lines += [f"| {each} | `{text}` |" for each, text in provenance.items()]
    return lines


def _means(result: ComparisonReport, case: str) -> list[str]:
    lines = [
        "| policy | leaders | signed order | Ψ_o | time towards target | ordered (π/4) |",
        "| --- " * 6 + "|",
    ]
    for row in result.means[result.means["case"] == case].to_dict("records"):
        cells = [
            f"{row[each]:.3f} [{row[f'{each}_low']:.3f}, {row[f'{each}_high']:.3f}]"
            for each in ("signed_order", "psi_o", "share_towards_target")
        ]
        ordered = f"{row['ordered']:.0%}"
        if row["ordered"] > 0:
            ordered += f", median {row['ordering_time_wide_s']:.0f} s"
        lines.append(f"| {row['policy']} | {row['leaders']} | {' | '.join(cells)} | {ordered} |")
    return lines


def _differences(result: ComparisonReport, case: str, name: str) -> list[str]:
    table = result.differences
    own = table[(table["case"] == case) & (table["policy"] == name)]
    lines = ["| minus | leaders | signed order | d |", "| --- " * 4 + "|"]
    for row in own.to_dict("records"):
        interval = f"{row['mean']:+.3f} [{row['low']:+.3f}, {row['high']:+.3f}]"
        lines.append(
            f"| {row['reference']} | {row['leaders']} | {interval} | {row['effect']:.2f} |"
        )
    return lines if len(own) > 0 else []
