"""Law: a policy that is the tuned law gains nothing anywhere, and no cell is measured twice."""

import pandas as pd
import pytest

from flockenv.policies import DampedLaw, LeaningLaw


@pytest.mark.parametrize("of", ["scheme", "target", "camera", "n_leaders"])
def test_the_tuned_law_gains_nothing_on_itself(script, of):
    cell = next(each for each in script.CELLS if each.what == of)
    row = script.measured(cell, DampedLaw.tuned("wide"), 3, 20.0)
    assert row["gain"] == 0.0
    assert row["signed_order"] == row["tuned_law"]


def test_no_lean_is_the_tuned_law_and_cells_that_stand_in_the_file_stay(
    script, tmp_path, monkeypatch
):
    monkeypatch.setattr(script, "CELLS", script.CELLS[:3])
    path, policy = tmp_path / "beyond.csv", tmp_path / "none.json"
    LeaningLaw("wide", 0.0, {}).save(policy)
    arguments = ["--flocks", "3", "--minutes", "0.5", "--policy", str(policy), "--out", str(path)]
    script.main(arguments)
    found = pd.read_csv(path)
    assert found["what"].tolist() == ["as trained", "bw_s", "bw_s"]
    assert found["gain"].abs().max() < 1e-4
    lines = path.read_text().splitlines()
    path.write_text("\n".join([lines[0], lines[1].replace("as trained,0", "as trained,9")]) + "\n")
    kept = path.read_text()
    monkeypatch.setattr(script, "CELLS", script.CELLS[:2])
    script.main(arguments)
    assert path.read_text().startswith(kept)
    assert len(pd.read_csv(path)) == 2
