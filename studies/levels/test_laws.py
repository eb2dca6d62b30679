"""Law: laws lead the flocks of the suite, and a level that is there is not made again."""

import pandas as pd


def test_laws_are_measured_once(script, tmp_path) -> None:
    given = ["--flocks", "2", "--out", str(tmp_path / "laws.csv")]
    script.main(given)
    table = pd.read_csv(tmp_path / "laws.csv")
    laws = table.groupby("level", sort=False).size()
    assert laws.to_list() == [3, 3, 3, 4]
    law, paper = (
        table[(table["level"] == "order-easy") & (table["policy"] == name)].iloc[0]
        for name in ("damped law", "paper's law")
    )
    assert abs(paper["gain"] - (paper["signed_order"] - law["signed_order"])) < 2e-4
    marked = table.assign(flocks=table["flocks"].where(table["level"] != "order-wide", 99))
    marked.to_csv(tmp_path / "laws.csv", index=False)
    script.main(given)
    assert (pd.read_csv(tmp_path / "laws.csv")["flocks"] == 99).sum() == 4
