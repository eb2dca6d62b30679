"""`LeadersEnv`: one policy steering all leaders of a flock, behind Gymnasium's interface."""

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv.envs.base import SingleEnvironmentBase, SpecOfEpisodes
from flockenv.envs.batch import is_plain, mean_rows
from flockenv.envs.options import TERMS
from flockenv.envs.render_mode import RENDER_MODES
from flockenv.envs.spaces import ObservationSpace, joint_action_space
from flockenv.rendering.frames import DEFAULT_SIZE


class LeadersEnv(
    SpecOfEpisodes, SingleEnvironmentBase, gymnasium.Env[NDArray[np.float32], NDArray[Any]]
):
    """Lead a flock of boats around a ring-shaped pool: one policy steers all leaders.

    ``gymnasium.make("flockenv/Leaders-v0", **options)``

    This text specifies the task for all interfaces. `LeadersParallelEnv`, `LeadersVectorEnv` and
    `flockenv.sb3.LeaderVecEnv` take the same options and say what differs.
    docs/environments/tables.md lists every option, reward term, entry of
    the observation and feature of the flock. In Python, `flockenv.envs.options` has `OPTIONS` and
    `TERMS`, and `flockenv.envs.observation` has `observation_entries()`, `state_entries()` and
    `flock_feature_entries()`.

    Start with `flockenv/Order-easy-v0`: ten boats, and four of them lead and are rewarded for the
    order of the others. Plain PPO passes the paper's law there within two minutes
    of processor time (docs/train.md). `gymnasium.spec("flockenv/Order-easy-v0")`
    has its options in `kwargs`. `import flockenv` registers the ids;
    `gymnasium.make("flockenv:flockenv/Order-easy-v0")` imports the package by itself.

    ## Description
    Boats drive through a ring-shaped pool in cycles: forward for 2 s, drift, backward for `bw_s`,
    drift. Only frictionless, perfectly inelastic collisions align them. Backing makes boats spin
    and destroys order, the more the longer it lasts (Tarcai et al. 2011). A few boats, the leaders,
    have a rudder. The task is to make the *normal* boats circulate in the target direction.

    ## Action space
    `Box(-1, 1, (k,), float32)`: the rudders of leaders 0 to k - 1. A rudder is held for a control
    step. A positive rudder turns a boat that moves forward counter-clockwise, and works in reverse
    on a boat that moves backward. Numbers beyond ±1 are clipped. NaN is an error, and nothing moves
    then.

    - `rudder_levels=n` makes it `MultiDiscrete([n] * k)`: levels 0 to n - 1 are rudders evenly
      spaced from -1 to 1.
    - With `action_mode="heading"` an action is a heading: its angle outward of the target's tangent
      over π. `DampedLaw()` steers to it in every control step.
    - With `action_mode="lean"` an action is that angle over 1.2 rad, and the damped law with the
      gains tuned in the pool steers to it. An action of 0 is the tuned law, bit for bit.
    - Both laws read what the leader observes of itself.
    - `decision_period_s` makes a step hold its action for that long. The reward of the step is the
      sum over its control steps; the last step of an episode may have fewer of them. The
      `reward_terms` of the step are means.

    ## Observation space
    `Box` of shape (k * observation size,), float32: what leader 0 observes, then leader 1, and so
    on. All entries are in the local-angle polar (LAP) frame of the leader's own position, outward
    and clockwise. They are scaled and clipped at their bounds; the end of the episode reports the
    fraction of clipped numbers. `observation` switches blocks on and off, such as:

    - `own`: position, heading, velocity, spin and rudder of the leader
    - `phase`: phase of the motors, time left in it, length of the backward phase
    - `target`: +1 clockwise, -1 counter-clockwise
    - `neighbors`: distance, heading and velocity of each of the six nearest boats, nearest first
    - `order`: mean orientation and velocity of the normal boats
    - `lean_features`, off by default: the features that the learned leaders read

    `state()` is the global state, for critics: the entries of `boat` for each boat in order, then
    `clock`. `flock_features()`, for critics too, depend neither on the order of boats nor on
    absolute angles.

    ## Rewards
    The weighted sum of reward terms, mean over leaders. `reward` has the weights for all leaders
    or, as a list of dictionaries, for each. By default `signed_order` alone counts: the mean of the
    signed order of the normal boats, in [-1, 1], over the control step. Other terms are
    of the flock, such as `jam`, or of a leader alone, such as `rudder_effort` and `contact_push`.
    Each info has `"reward_terms"`, and the last one of an episode also has `"episode_summary"`.

    If `target` is a list of "cw" and "ccw", one per leader, each leader has its own target. Its
    observation, the reflection by `mirror_to_target`, its actions and its reward terms refer to
    that target. Leaders with opposite targets play a general-sum game: their `signed_order` sums to
    zero, the terms of a leader alone do not. The joint reward stays the mean over leaders: if k1
    leaders have one target and k2 the other, it is (k1 - k2)/k times the signed order towards the
    first. Quantities of the whole flock refer to leader 0's target: the `signed_order` and
    `share_towards_target` of the `"episode_summary"`, the reflection of `state()`, and the flock
    features (a `LeaderVecEnv` has them in the frame of each slot's target). The `target` of
    `state()` is the mean over leaders.

    ## Starting state
    Boats start at rest at random positions with random headings, without overlap, in phase fw. The
    seed fixes the initial state, the noise (whatever the policy does), the target and the backward
    duration; the first episode's flock is `Flock(parameters, seed)`. `reset(options=...)` can set
    for one episode: `target`, `bw_s`, `state` (a dictionary with pose (n, 3) and optionally
    velocity (n, 3), time_s and allow_overlap as in `Flock.set_state`) or `snapshot` (bytes of
    `Flock.snapshot`), the latter with a `noise_seed` for other noise than the snapshot's.

    ## Episode end
    After `episode_s` the episode is truncated; it never terminates. The `"episode_summary"` has:

    - `flock_seed`, `bw_s` and `steps` (control steps) of the episode
    - `total_reward`, and the mean of each reward term over steps and leaders
    - means of order parameters of the normal boats, such as `psi_o`, `signed_order` and `rotation`,
      over the analysis window without the first tenth; missing if the episode ends before that
    - `share_towards_target`: fraction of that window with a signed order above 0.5
    - `ordering_time_s` and `ordering_time_wide_s`: eq. (7) with the angle π/20 as printed and with
      π/4; infinite if the flock never ordered
    - `clip_rate`: fraction of clipped numbers in the observations
    - `worst_overlap_cm`, `unsolved` and `halved_substeps` of the flock, as in `flockenv.Statistics`

    ## Arguments
    Any field of `FlockParameters` (`n_boats` is 27 and `n_leaders` 3 unless given) and the options
    of docs/environments/tables.md. Those that most trainings set:

    - `preset` or `params`: parameters of the flock by name, or as a `FlockParameters`
    - `physics`: "training" for steps that are coarser and cheaper, "publication" for finer ones
    - `bw_s`: duration of the backward phase in s; a pair (low, high) draws it for each episode
    - `target`: "cw", "ccw", "random" or "alternate", or one per leader
    - `mirror_to_target`: reflects what leaders see and do, so that both directions are one task
    - `episode_s`, `control_hz`, `decision_period_s`: lengths of an episode and of a step
    - `reward`, `reward_horizon_s`: weights of the terms, and the time that scales their sum
    - `render_mode`: None, "rgb_array" or "human"

    ## Version history
    - v0, observation version 1: initial version.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 - Gymnasium's own declaration
        "render_modes": list(RENDER_MODES),
        "render_fps": 10.0,
    }

    def __init__(
        self,
        *,
        render_mode: str | None = None,
        render_size: tuple[int, int] = DEFAULT_SIZE,
        **options: object,
    ) -> None:
        self._set_up(options, render_mode, render_size)
        settings = self._batch.settings
        self.observation_space = ObservationSpace(settings, self.num_leaders)
        self._levels: int | None = settings["rudder_levels"]
        self._actions_shape = (self.num_leaders,)
        self.action_space = joint_action_space(self._levels, self.num_leaders)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start an episode.

        Parameters
        ----------
        seed
            Fixes everything random in this episode and in the episodes that follow without a seed.
            None continues with the next episode.
        options
            For this episode: ``target``, ``bw_s`` in s, and ``state`` or ``snapshot``, as under
            "Starting state" of the class. A snapshot must come from a flock with the same
            parameters, except for target and bw_s. With ``noise_seed`` it continues with other
            noise, as in `Flock.restore`.

        Returns
        -------
        observation : numpy.ndarray
            Shape (k * observation size,), float32.
        info : dict
            Target, backward duration and seed of the episode.
        """
        super().reset(seed=self._reset(seed, options))
        self._show()
        return self.observe(), self._batch.reset_info(0)

    def step(
        self, action: ArrayLike
    ) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Take one decision, for one control step or `decision_period_s`.

        Parameters
        ----------
        action
            Shape (k,).

        Returns
        -------
        observation, reward, terminated, truncated, info
            The info has the step's ``"reward_terms"``, means over leaders, and at the end the
            ``"episode_summary"``.

        Raises
        ------
        ParameterError
            For NaN and wrong shapes; nothing has moved then.
        EpisodeError
            Before the first reset and after the end.
        """
        actions: ArrayLike = action
        if self._levels is not None or not is_plain(action, self._actions_shape):
            actions = _core.flat_actions(action, self._actions_shape, self._levels)
        rows, rewards, truncated = self._batch.step(self, actions)
        means = mean_rows(self._batch.core.reward_terms().tolist())
        info: dict[str, Any] = {"reward_terms": dict(zip(TERMS, means, strict=True))}
        is_over = bool(truncated[0])
        if is_over:
            info.update(self._batch.end_info(0))
        self._show()
        (reward,) = mean_rows(rewards[:, None].tolist())
        return rows.reshape(-1), reward, False, is_over, info

    def set_wrapper_attr(self, name: str, value: object, *, force: bool = True) -> bool:
        """Set an existing attribute, for Gymnasium's wrappers; options are refused."""
        self._refuse_from_outside(name)
        return super().set_wrapper_attr(name, value, force=force)

    def observe(self) -> NDArray[np.float32]:
        """Return the present observation."""
        return self._batch.core.observe().reshape(-1)
