"""Law: the command prints and stores the signals that it measured."""

import csv
import json


def test_signals_are_printed_and_stored(cli, tmp_path):
    command = ["signal", "--pool", "table-1", "--set", "n_boats=6", "--leaders", "1"]
    command += ["--reward", "rudder_effort", "--reward", "jam=1,signed_order=0.5", "--horizon", "1"]
    command += ["--from", "0.5", "--to", "0", "--flocks", "8", "--rounds", "1", "--minutes", "0.1"]
    done = cli(*command, "--json", "--out", str(tmp_path))
    rows = json.loads(done.stdout)
    assert [row["reward"] for row in rows] == ["rudder_effort", "jam=1,signed_order=0.5"]
    assert rows[0]["z"] > 3.0
    with (tmp_path / "signals.csv").open() as file:
        stored = list(csv.DictReader(file))
    assert [float(row["z"]) for row in stored] == [row["z"] for row in rows]
    assert 'seed = "0"' in (tmp_path / "run.toml").read_text()
    refused = cli(*command, "--reward", "jam=much")
    assert refused.returncode == 2
    assert "'much' is no weight" in refused.stderr
