"""Each policy of the grid is made once, and a score is the difference from the tuned law."""

import json

import numpy as np
import pandas as pd
import pytest

from flockenv.policies import load

pytestmark = [pytest.mark.benchmarl, pytest.mark.filterwarnings("ignore")]

pytest.importorskip("benchmarl")
pytest.importorskip("sb3_contrib")

ALGORITHMS = ["ppo", "trpo", "evolution", "recurrent-ppo", "sac", "ippo", "mappo"]


@pytest.mark.timeout(600)
@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_a_trial_trains_judges_and_is_not_made_again(script, algorithm, tmp_path):
    given = ["--trial", "--algorithms", algorithm, "--inputs", "default-network"]
    given += ["--out", str(tmp_path)]
    script.main(given)
    folder = tmp_path / algorithm / "default-network"
    (made,) = folder.glob("0.1/0")
    if algorithm == "recurrent-ppo":
        assert (made / "model.zip").exists()
    else:
        assert load(made / "policy.npz").observation == {}
    first = (tmp_path / "grid-0.1.csv").read_bytes()
    times = {path: path.stat().st_mtime_ns for path in folder.rglob("*.*")}
    script.main(given)
    assert (tmp_path / "grid-0.1.csv").read_bytes() == first
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*.*")} == times


def test_a_cell_has_its_seeds_and_all_of_them_together(script, tmp_path):
    def write(path, orders):
        path.parent.mkdir(parents=True, exist_ok=True)
        cases = np.repeat(script.JUDGED, 2)
        pd.DataFrame({"case": cases, "signed_order": orders}).to_csv(path, index=False)
        made = {"setting": 1.0, "cpu_s": 2.0, "commit": "0"}
        (path.parent / "made.json").write_text(json.dumps(made))

    write(tmp_path / "tuned.csv", np.zeros(6))
    cells = [("ppo", "lean-linear"), ("sac", "lean-linear"), ("ippo", "lean-linear")]
    for seed, cell in ((0, cells[0]), (1, cells[0]), (0, cells[1])):
        write(tmp_path.joinpath(*cell, f"100/{seed}/orders.csv"), np.full(6, 0.1 + seed))
    found = script.table(cells, 100.0, tmp_path)
    assert found["seed"].tolist() == [0, 1, "all", 0, "all"]
    for name in (*script.JUDGED, "iqm"):
        np.testing.assert_allclose(found[name], [0.1, 1.1, 0.6, 0.1, 0.1])
    # Some draws have one seed twice, and no draw of flocks differs from another.
    np.testing.assert_allclose(found["iqm_low"], [0.1, 1.1, 0.1, 0.1, 0.1])
    np.testing.assert_allclose(found["iqm_high"], [0.1, 1.1, 1.1, 0.1, 0.1])
    assert found["searched_hours"].tolist() == [1500.0, 1500.0, 1500.0, 0.0, 0.0]
    assert (found["improvement"] == 1.0).all()
