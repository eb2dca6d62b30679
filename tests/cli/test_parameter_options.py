"""Law: parameters are a preset, then a file, then single fields; what is wrong has a name."""

import pytest

import flockenv
from flockenv.cli.parameters import OneFlock

SIMULATION = flockenv.FlockParameters()


def test_nothing_asked_for_is_the_preset_simulation():
    assert OneFlock().parameters() == SIMULATION
    assert OneFlock(preset="paper").parameters() == flockenv.FlockParameters.preset("paper")


@pytest.mark.parametrize(
    ("change", "field", "value"),
    [
        (" bw_s = 0 ", "bw_s", 0.0),
        ("pool=narrow", "pool", "narrow"),
        ('pool="narrow"', "pool", "narrow"),
        ("pool=(300,100)", "pool", (300.0, 100.0)),
        ("pool=[inf, 0]", "pool", (float("inf"), 0.0)),
        ("target=ccw", "target", "ccw"),
        ("walls=[(100, 0, 150, 0)]", "walls", ((100.0, 0.0, 150.0, 0.0),)),
        ("discs=((100, 0, 5), (-130, 0, 8),)", "discs", ((100.0, 0.0, 5.0), (-130.0, 0.0, 8.0))),
        ("leaders_reverse=false", "leaders_reverse", False),
    ],
)
def test_values_are_those_of_toml_and_words(change, field, value):
    assert OneFlock(changes=[change]).parameters() == SIMULATION.replace(**{field: value})


def test_a_file_then_fields(tmp_path):
    file = tmp_path / "flock.toml"
    file.write_text('preset = "paper"\nn_boats = 12\nbw_s = 0.1\n')
    paper = flockenv.FlockParameters.preset("paper")
    assert OneFlock(params=file).parameters() == paper.replace(n_boats=12, bw_s=0.1)
    assert OneFlock(
        preset="paper", params=file, changes=["bw_s=0.2"]
    ).parameters() == paper.replace(n_boats=12, bw_s=0.2)
    with pytest.raises(flockenv.ParameterError, match="contradicts preset = 'paper'"):
        OneFlock(preset="simulation", params=file).parameters()


@pytest.mark.parametrize("change", ["cw, ccw", "[cw, ccw]", "(cw,ccw)", '["cw", "ccw"]'])
def test_lists_of_words_need_no_quotes(change):
    assert OneFlock(changes=["n_leaders=2", f"target={change}"]).parameters().target == (
        "cw",
        "ccw",
    )


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (["n_bots=3"], "did you mean 'n_boats'"),
        (["n_boats"], "NAME=VALUE"),
        (["=3"], "NAME=VALUE"),
        (["n_boats=3", "n_boats=4"], "n_boats twice"),
        (["n_boats=three"], "n_boats"),
        (["bw_s=1\nn_boats=2"], "bw_s"),
        (["walls=[(1, 2, 3]"], "rows of"),
        (["walls=(1, 2, 3, 4)"], "rows of"),
    ],
)
def test_bad_changes_are_named(changes, words):
    with pytest.raises(flockenv.ParameterError, match=words):
        OneFlock(changes=changes).parameters()


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"n_boats = ", "is not TOML"),
        (b"n_bots = 3", "did you mean 'n_boats'"),
        (b"preset = 'papr'", "paper"),
        (None, "cannot be read"),
    ],
)
def test_bad_files_are_named(content, words, tmp_path):
    file = tmp_path / "flock.toml"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(flockenv.ParameterError, match=words):
        OneFlock(params=file).parameters()
