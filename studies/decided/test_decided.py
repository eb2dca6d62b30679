"""Law: each open statement that 500 runs decide gets its runs, judged as before."""

import functools
from types import ModuleType

import numpy as np
import pandas as pd
import pytest

from flockenv.runs.seeds import POLICY_SEEDS
from studies import study
from studies.decided import decided

FOLDERS = ("section4", "section5", "headlines")
NAMES = [f"{each.figure}: {each.claim} ({each.reading})" for each in decided.STATEMENTS]


@functools.cache
def first_runs(made: study.Study) -> pd.DataFrame:
    return made.results(study.Options(runs=False))


def test_every_open_line_that_500_runs_decide_gets_them() -> None:
    asked = [tuple(each.line()) for each in decided.STATEMENTS]
    files = [study.HERE / name / "claims.csv" for name in FOLDERS]
    tables = [pd.read_csv(path, dtype=str, keep_default_na=False) for path in files]
    lines = pd.concat(tables)
    few = pd.to_numeric(lines["runs_that_would_decide"], errors="coerce") <= decided.MOST_RUNS
    assert sorted(asked) == sorted(lines[few].itertuples(index=False, name=None))


@pytest.mark.parametrize("statement", decided.STATEMENTS, ids=NAMES)
def test_first_runs_judge_a_statement_as_its_line_does(statement: decided.Statement) -> None:
    line, runs = statement.line(), statement.runs
    assert str(statement.needed) == line["runs_that_would_decide"]
    table = first_runs(runs.study)
    cells = pd.DataFrame(runs.cells)
    cells = cells.astype(dict.fromkeys(cells.select_dtypes(bool), str))  # As a file has them.
    found = statement.judged(runs.found(table.merge(cells, on=list(cells))))
    assert found.verdict == line["verdict"]
    assert str(found.found.runs) == line["n_runs"]
    ends = [float(line[name]) for name in ("measured", "low", "high")]
    np.testing.assert_allclose(found.found, ends, rtol=0.02, atol=1e-3)


def test_the_number_of_runs_is_one_and_a_half_times_what_would_decide_and_at_most_500() -> None:
    for each in decided.STATEMENTS:
        runs = each.seeds * each.runs.counted
        assert abs(runs - min(500, 1.5 * each.needed)) <= max(1, each.runs.counted / 2)
        assert len(each.rows()) == each.seeds * len(each.runs.cells)


def test_seeds_of_two_statements_never_meet(script: ModuleType) -> None:
    every = [
        set(range(each.first_seed, each.first_seed + each.seeds)) for each in script.STATEMENTS
    ]
    assert len(set.union(*every)) == sum(map(len, every))
    assert set.union(*every) < set(POLICY_SEEDS["paper"].every[30_000:100_000])


def test_a_statement_with_a_run_missing_is_not_judged() -> None:
    statement = decided.STATEMENTS[1]
    table = pd.DataFrame(statement.rows()).assign(**{f"stretch_{i}": 1.0 for i in range(4)})
    tables = {name: pd.DataFrame({"first_seed": []}) for name in decided.STUDIES}
    name = statement.runs.study.name
    assert list(decided.judge(tables | {name: table})) == [statement]
    assert not decided.judge(tables | {name: table[1:]})
    assert decided.judge(tables | {name: table})[statement].verdict == "holds"


def test_the_page_has_the_table_and_counts_its_lines() -> None:
    page = (study.HERE / "decided" / "README.md").read_text("utf-8")
    claims = pd.read_csv(study.HERE / "decided" / "claims.csv")
    left = (claims["verdict"] == "open").sum()
    assert decided.table() in page
    assert f"{len(claims) - left} of {len(decided.STATEMENTS)}" in page
    assert decided.table().count("\n") == 2 + len(claims)
