"""Train one network for one to four leaders, both pools and both directions, with PPO.

    python baselines/ppo_shared_policy.py                        # into results/ppo_shared_policy
    python baselines/ppo_shared_policy.py --resume               # continues after a kill
    flockenv compare --policy "damped law" --policy results/ppo_shared_policy/best.npz

Training starts from a clone of the damped law instead of from nothing. Episodes have between half
and 1.25 times the critical noise of their pool. docs/train.md lists the
files. The pretrained policies were searched by evolution_strategy.py instead (docs/leaders.md).
"""

import argparse
import shlex
import sys
from pathlib import Path

from script_end import one_line_end

from flockenv import training
from flockenv.training import TrainingSettings

SETTINGS = TrainingSettings(
    pools=("wide", "narrow"),
    n_boats=27,
    n_leaders=(1, 2, 3, 4),
    noise=(0.5, 1.25),
    target="random",
    mirror_to_target=True,
    start="damped law",
    episode_s=240.0,
    reward={"signed_order": 1.0},
    samples=4_000_000,
    num_flocks=16,
    batch_size=512,
    net_arch=(64, 64),
    activation="tanh",
    # From here on as the best of ten runs had it: docs/leaders/ppo_search.csv.
    # At ten decisions per second, exploring rudders cancel out before a boat has turned.
    control_hz=2.5,
    n_steps=128,
    n_epochs=4,
    learning_rate=5.18e-5,
    final_learning_rate=5.18e-6,
    gamma=0.9964,
    gae_lambda=0.99462,
    clip_range=0.135,
    log_std_init=-1.43,
    use_sde=True,
    # Validated as policies are compared, at ten decisions per second; few episodes flatter.
    validation_hz=10.0,
    validation_episodes=64,
)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=SETTINGS.samples)
    parser.add_argument("--seed", type=int, default=SETTINGS.seed)
    parser.add_argument("--out", type=Path, default=Path("results/ppo_shared_policy"))
    parser.add_argument("--resume", action="store_true")
    options = parser.parse_args(arguments)

    def report(progress: training.Progress) -> None:
        best = "none yet" if progress.best_score is None else f"{progress.best_score:.3f}"
        left = progress.wall_s * (options.samples / max(progress.samples, 1) - 1)
        print(
            f"\r{progress.samples} samples, best mean signed order {best}, {left:.0f} s left  ",
            end="",
            flush=True,
        )

    path = options.out / "checkpoint.npz"
    with one_line_end(
        lambda: f"--resume continues from {path}" if path.exists() else "there is no checkpoint yet"
    ):
        if options.resume:
            result = training.resume(options.out, samples=options.samples, report=report)
        else:
            settings = SETTINGS.replace(samples=options.samples, seed=options.seed)
            given = sys.argv[1:] if arguments is None else arguments
            command = shlex.join(["python", "baselines/ppo_shared_policy.py", *given])
            result = training.train(settings, options.out, command=command, report=report)
    rows = training.with_flock_hours(result.progress.validations, result.settings)
    for name, value in rows[-1].items():
        print(f"\n{name}: {value:g}", end="")
    print(f"\nwritten to {options.out / 'best.npz'}")


if __name__ == "__main__":
    main()
