"""Law: what a command has trained it does not train again, and the file is the mean or one seed."""

import json

import pytest

from flockenv.policies import LeaningLaw, load


@pytest.fixture(scope="module")
def trial(script, tmp_path_factory):
    out = tmp_path_factory.mktemp("pretrained")
    script.main(["--trial", "--out", str(out)])
    return out


@pytest.mark.parametrize("pool", ["wide", "narrow"])
def test_a_trial_writes_a_policy_with_its_provenance(trial, pool):
    law = load(trial / f"{pool}.json")
    assert law.pool == pool
    assert any(law.weights.values())
    seeds = [load(trial / pool / seed / "policy.json") for seed in "01"]
    assert seeds[0].weights != seeds[1].weights
    assert law.provenance["command"].startswith("python baselines/pretrained.py --trial")
    used = law.provenance["seed"].split(", ")
    hours = [float(seeds[int(each)].provenance["flock_hours"]) for each in used]
    assert float(law.provenance["flock_hours"]) == pytest.approx(sum(hours))
    assert law.judged["n_leaders"] == 3


def test_a_training_that_is_there_is_not_made_again(script, trial, monkeypatch):
    before = (trial / "wide.json").read_text()
    monkeypatch.setattr(script, "MAKERS", dict.fromkeys(script.MAKERS))  # None is not called.
    script.main(["--trial", "--pool", "wide", "--out", str(trial)])
    after = (trial / "wide.json").read_text()
    assert json.loads(after)["weights"] == json.loads(before)["weights"]


def test_ppo_keeps_its_policy_on_the_way(trial):
    kept, last = (load(trial / name / "0/policy.json") for name in ("wide-0.5", "wide"))
    assert kept.decision_period_s is None
    assert kept.weights != last.weights


def test_the_mean_is_of_all_numbers(script):
    one, other = (LeaningLaw("narrow", b, {"near": w}) for b, w in ((0.1, 0.2), (0.3, 0.0)))
    mean = script.mean_of([one, other])
    assert (mean.bias, mean.weights["near"], mean.weights["leaders"]) == (0.2, 0.1, 0.0)


@pytest.mark.parametrize(("of_mean", "chosen"), [(0.5, "mean"), (0.4, "seed 1")])
def test_the_mean_ships_unless_a_seed_leads_better(script, trial, monkeypatch, of_mean, chosen):
    best = load(trial / "narrow/1/policy.json")
    mean = script.mean_of([load(trial / "narrow/0/policy.json"), best])
    found = {str(best.weights): 0.45, str(mean.weights): of_mean}

    def orders(policy, pool, leaders, seeds, episode_s):
        order = found.get(str(getattr(policy, "weights", None)), 0.3)
        return order + 0.01 * script.np.sin(seeds)  # Some spread, for the interval.

    monkeypatch.setattr(script, "orders", orders)
    assert script.make(script.TRIAL, "narrow", trial, "a command")
    law = load(trial / "narrow.json")
    assert law.provenance["chosen"].startswith(chosen)
    assert law.weights == {"mean": mean, "seed 1": best}[chosen].weights


@pytest.mark.parametrize(("tuned", "ships"), [(0.44, True), (0.46, False)])
def test_what_leads_worse_than_the_tuned_law_does_not_ship(
    script, trial, monkeypatch, tmp_path, tuned, ships
):
    learned = [load(trial / f"narrow/{seed}/policy.json") for seed in "01"]
    weights = [law.weights for law in (*learned, script.mean_of(learned))]

    def orders(policy, pool, leaders, seeds, episode_s):
        order = 0.45 if getattr(policy, "weights", None) in weights else tuned
        return order + 0.01 * script.np.sin(seeds)

    monkeypatch.setattr(script, "orders", orders)
    monkeypatch.setattr(script, "Settings", lambda: script.TRIAL)
    monkeypatch.setattr(script, "SHIPPED", tmp_path)
    script.main(["--pool", "narrow", "--ship", "--out", str(trial)])
    assert (tmp_path / "narrow.json").exists() == ships


def test_a_trial_does_not_ship(script, capsys):
    with pytest.raises(SystemExit):
        script.main(["--trial", "--ship"])
    assert "does not ship" in capsys.readouterr().err
