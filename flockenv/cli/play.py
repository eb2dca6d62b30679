"""`flockenv play`."""

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from numpy.typing import NDArray

from flockenv.cli.console import interruptible, print_json, say
from flockenv.cli.output import check_file, writable
from flockenv.cli.parameters import (
    ChangesOption,
    FileOption,
    PresetOption,
    given_fields,
    parameters_of,
)
from flockenv.cli.run import in_words, summary_of
from flockenv.envs.observation import observe
from flockenv.errors import ParameterError
from flockenv.flock import Flock
from flockenv.parameters import FlockParameters
from flockenv.policies import SteeringLaw
from flockenv.simulation import simulate

__all__ = ["Repeated", "play", "steered"]

_PARAMETERS = {"n_boats": 27, "n_leaders": 4}
_CONTROL_HZ = 10.0
_SIZE = (800, 800)


def play(
    preset: PresetOption = None,
    params: FileOption = None,
    changes: ChangesOption = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of placement and noise.")] = 7,
    minutes: Annotated[float, typer.Option(min=0.1, help="Length of the run.")] = 8.0,
    speed: Annotated[
        float, typer.Option(min=0.0625, max=64.0, help="How many times real time, at first.")
    ] = 4.0,
    out: Annotated[Path, typer.Option(help="Page that plays your run and the law's.")] = Path(
        "results/play.html"
    ),
    as_json: Annotated[bool, typer.Option("--json", help="Print the summaries as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print the scores alone.")] = False,
) -> None:
    """Steer one leader with the arrow keys, the others by the paper's law (extra `render`).

    Left and right hold the rudder of the boat with the ring; up and down change the speed, space
    pauses. A backing boat turns the other way. The score is the order of the normal boats towards
    the target, as `flockenv run` prints it; at the end the score of the paper's law on the same
    seed is printed beside it. Closing the window ends the run early.

    Example: `flockenv play --minutes 4`
    """
    from flockenv.rendering import SteeringWindow
    from flockenv.replay import write_replay

    parameters = parameters_of({**_PARAMETERS, **given_fields(preset, params, changes)})
    if parameters.n_leaders == 0:
        raise ParameterError("n_leaders = 0 is not accepted: you steer leader 0")
    check_file(out)
    with interruptible("Nothing was written."):
        window = SteeringWindow(*_SIZE, fps=_CONTROL_HZ, boat=0)
        window.speed = speed
        if not (as_json or quiet):
            say("Left and right steer the boat with the ring. Up, down: speed; space: pause.")
        try:
            rudders = steered(parameters, seed, minutes * 60, window)
        finally:
            window.close()
        if len(rudders) == 0:
            say("The window was closed before the run started: nothing was written.")
            return
        runs = {
            name: simulate(
                parameters, seed, len(rudders) / _CONTROL_HZ, _CONTROL_HZ, policy, contacts=True
            )
            for name, policy in (("you", Repeated(rudders)), ("paper's law", SteeringLaw()))
        }
        with writable(out):
            write_replay(out, runs)
    summaries = {name: summary_of(run) for name, run in runs.items()}
    if as_json:
        print_json({"html": str(out), "seed": seed, "runs": summaries})
        return
    for name, summary in summaries.items():
        say(f"{name}: {in_words(summary, runs[name])}")
    if not quiet:
        say(f"Written to {out}")


def steered(
    parameters: FlockParameters, seed: int, duration_s: float, window: Any
) -> NDArray[np.float64]:
    """Move a flock with leader 0 steered by a window's keys and the others by the law, eq. (10).

    Parameters
    ----------
    parameters, seed, duration_s
        As for `simulate`.
    window
        A `SteeringWindow`; once it is closed, the run is over.

    Returns
    -------
    numpy.ndarray
        Shape (control steps, leaders): the rudders, which together with the parameters and the seed
        determine the run.
    """
    flock, law = Flock(parameters, seed), SteeringLaw()
    rudder = np.zeros(parameters.n_leaders)
    taken: list[NDArray[np.float64]] = []
    window.show(flock)
    while window.is_open and len(taken) < round(duration_s * _CONTROL_HZ):
        commands, _ = law.predict(observe(flock, rudder=rudder))
        rudder = np.asarray(commands, np.float64).reshape(-1)
        rudder[0] = window.rudder
        flock.advance(1.0 / _CONTROL_HZ, rudder)
        taken.append(rudder)
        window.show(flock)
    return np.array(taken).reshape(-1, parameters.n_leaders)


class Repeated:
    """A policy that repeats rudders, shape (control steps, leaders), whatever it observes."""

    def __init__(self, rudders: NDArray[np.float64]) -> None:
        self._rudders = rudders

    def predict(self, observation: Any, state: Any = None, episode_start: Any = None) -> Any:
        """Return the step's rudders, and the number of the next step as the state."""
        step = state or 0
        # The last sample is steered too, although the run ends there.
        return self._rudders[min(step, len(self._rudders) - 1)], step + 1
