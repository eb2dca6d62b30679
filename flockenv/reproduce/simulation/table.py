"""The claims of Section 5 by scheme, noise convention and pool: what each of them hangs on."""

from collections.abc import Mapping

import pandas as pd

from flockenv.reproduce.claim import DOES_NOT_HOLD, HOLDS, CheckedClaim
from flockenv.reproduce.files import claims_table
from flockenv.reproduce.reproduction import Outcome, Reproduction, Results, Settings
from flockenv.reproduce.simulation.claims import Evidence, check, runs_needed
from flockenv.reproduce.simulation.design import TABLE, Model
from flockenv.reproduce.simulation.figures import interval_note
from flockenv.runs.spec import RunSpec

__all__ = ["REPRODUCTIONS", "dependence", "statements"]

_POOLS = ("500-boats", "table-1")
# (preset that gives the scheme, noise) by name; the first and last are the presets themselves.
_READINGS = {
    "paper scheme, per-step noise": ("paper", "per-step"),
    "paper scheme, white noise": ("paper", "white"),
    "leapfrog, per-step noise": ("simulation", "per-step"),
    "leapfrog, white noise": ("simulation", "white"),
}
# By whether the claim holds with each reading.
_PLAIN = {
    (True, True, True, True): "holds whatever the scheme and the noise convention",
    (True, True, False, False): "holds only with the paper's scheme",
    (True, False, True, False): "holds only with the paper's noise convention",
    (True, False, False, False): "holds only with the paper's scheme and noise together",
    (False, False, False, True): "holds only with leapfrog and white noise together",
    (False, True, False, True): "holds only with white noise",
    (False, False, True, True): "holds only with leapfrog",
    (False, False, False, False): "holds with no reading",
}
_FIGURES = ("fig14", "fig15", "fig16", "fig17")


def _models(pool: str) -> list[Model]:
    return [Model(name, preset, noise, pool) for name, (preset, noise) in _READINGS.items()]


def _runs(settings: Settings) -> list[RunSpec]:
    models = (model for pool in _POOLS for model in _models(pool))
    return [spec for model in models for spec in runs_needed(settings, model, TABLE)]


def dependence(verdicts: Mapping[str, str]) -> str:
    """Say what a claim hangs on.

    Parameters
    ----------
    verdicts
        The verdict for each of the four readings "<scheme>, <noise>", the two presets' at the ends.
    """
    paper, white, per_step, simulation = (verdicts[name] for name in _READINGS)
    holds = tuple(each == HOLDS for each in (paper, white, per_step, simulation))
    decided = all(each in (HOLDS, DOES_NOT_HOLD) for each in verdicts.values())
    if decided and holds in _PLAIN:
        return _PLAIN[holds]
    both = "holds with both presets" if paper == simulation == HOLDS else ""
    lists = [
        f"{verdict} with {'; '.join(names)}"
        for verdict in dict.fromkeys(verdicts.values())
        if (names := [name for name, each in verdicts.items() if each == verdict])
    ]
    return ". ".join(filter(None, [both, *lists]))


def statements(table: pd.DataFrame) -> list[str]:
    """Say in plain words which claims hang on what, pool by pool.

    Parameters
    ----------
    table
        With the columns ``claim``, ``pool``, ``conclusion`` and one for each reading.
    """
    first, *_, last = _READINGS
    said = []
    for pool, rows in table.groupby("pool", sort=False):
        both = rows[(rows[first] == HOLDS) & (rows[last] == HOLDS)]
        groups = {"hold with both presets, paper and simulation": list(both["claim"])}
        for words in _PLAIN.values():
            alike = rows[(rows["conclusion"] == words) & ~rows.index.isin(both.index)]
            groups[words.replace("holds", "hold", 1)] = list(alike["claim"])
        rest = rows[~rows["conclusion"].isin(_PLAIN.values()) & ~rows.index.isin(both.index)]
        groups["are inconclusive with some reading, or depend on no single choice"] = list(
            rest["claim"]
        )
        said += [
            f"Pool {pool}: {len(names)} of {len(rows)} claims {words}: {'; '.join(names)}."
            for words, names in groups.items()
            if names or words == next(iter(groups))
        ]
    return said


def _summary(claims: dict[tuple[str, str], list[CheckedClaim]]) -> pd.DataFrame:
    rows = []
    for pool in _POOLS:
        by_claim = zip(*(claims[pool, name] for name in _READINGS), strict=True)
        for checked in by_claim:
            verdicts = {name: each.verdict for name, each in zip(_READINGS, checked, strict=True)}
            claim = checked[0].claim
            row = {"claim": claim.text, "section": claim.section, "pool": pool, **verdicts}
            rows.append(row | {"conclusion": dependence(verdicts)})
    return pd.DataFrame(rows)


def _analyse(settings: Settings, results: Results) -> Outcome:
    claims: dict[tuple[str, str], list[CheckedClaim]] = {}
    for pool in _POOLS:
        for model in _models(pool):
            evidence = Evidence(settings, results, model, TABLE)
            claims[pool, model.name] = check(evidence, _FIGURES)
    every = [claim for each in claims.values() for claim in each]
    table = _summary(claims)
    tables = {"scheme_and_noise": table, "measured": claims_table(every)}
    notes = [*statements(table), interval_note(settings, TABLE.runs)]
    return Outcome(tables, notes=notes, shown=["scheme_and_noise"])


REPRODUCTIONS = (
    Reproduction(
        name="scheme-and-noise",
        title="The claims of Section 5 by scheme, noise convention and pool",
        section="5.2",
        runs=_runs,
        analyze=_analyse,
    ),
)
