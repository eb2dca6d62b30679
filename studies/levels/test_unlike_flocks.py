"""Law: no steering has the score 0 in unlike flocks, and the damped law 1."""

from flockenv.comparison.levels import LEVELS


def test_conditions_are_the_cells_that_differ_from_the_level(script) -> None:
    for name, level in LEVELS.items():
        cells = [each.cell for each in script.conditions(level)]
        left_out = [each.what for each in script.CELLS if each not in cells]
        assert left_out == ["as trained"] + ["n_leaders"] * (name in ("order-easy", "order-noisy"))


def test_a_condition_changes_what_its_cell_names_alone(script) -> None:
    level = LEVELS["order-narrow"]
    for each in script.conditions(level):
        own, other = level.parameters.to_dict(), each.flock.to_dict()
        changed = {name for name in own if own[name] != other[name]}
        if each.cell.preset == "paper":
            assert changed >= {"scheme", "noise_scheme", "bw_s", "dt_s"}
            assert other["bw_s"] == script.FlockParameters.critical_bw_s("paper", "narrow")
            assert not changed & {"pool", "n_boats", "n_leaders"}
        else:
            assert changed == {*each.cell.parameters}
        assert {**each.options} == {**level.environment, **each.cell.options}
