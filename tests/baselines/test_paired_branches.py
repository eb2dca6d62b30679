"""Law: a search is its seed's alone, and its file steers."""

import dataclasses


def test_a_search_is_repeated_by_its_seed_and_its_file_steers(
    script, assert_repeats, tmp_path, monkeypatch
):
    small = dataclasses.replace(script.Settings(), branch_s=16, judged_s=8, episode_s=32)
    monkeypatch.setattr(script, "Settings", lambda **given: dataclasses.replace(small, **given))
    arguments = ["--pairs", "2", "--flock-hours", str(3 * 4 * 16 / 3600)]
    assert_repeats(arguments)
    assert (tmp_path / "a/3/curve.csv").read_text().count("\n") == 4
