"""`LeadersEnv`: one policy steering all leaders of a flock, behind Gymnasium's interface."""

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv.envs.base import SingleEnvironmentBase
from flockenv.envs.batch import drawn_seed
from flockenv.envs.observation import ObservationSpace
from flockenv.envs.render_mode import RENDER_MODES
from flockenv.envs.spaces import joint_action_space
from flockenv.rendering.frames import DEFAULT_SIZE


class LeadersEnv(SingleEnvironmentBase, gymnasium.Env[NDArray[np.float32], NDArray[Any]]):
    """Lead a flock of boats around a ring-shaped pool: one policy steers all leaders.

    ``gymnasium.make("flockenv/Leaders-v0", **options)``

    This text specifies the task for all interfaces: `LeadersParallelEnv`, `LeadersVectorEnv` and
    `flockenv.sb3.LeaderVecEnv` say where they differ. `flockenv/Order-easy-v0` is the environment
    to start with: ten boats, four of which lead and are rewarded for the order of the others. Plain
    PPO passes the paper's law within two minutes of processor time, which
    docs/train_in_four_minutes.md shows. The other interfaces take the same options:
    `gymnasium.spec("flockenv/Order-easy-v0").kwargs`. The ids are registered by `import flockenv`;
    `gymnasium.make("flockenv:flockenv/Order-easy-v0")` imports it by itself.

    ## Description
    Boats drive through a ring-shaped pool in cycles: forward for 2 s, drift, backward for `bw_s`,
    drift. Only frictionless, perfectly inelastic collisions align them. Backing makes boats spin
    and destroys order, the more the longer it lasts (Tarcai et al. 2011). A few boats, the leaders,
    have a rudder. The task is to make the *normal* boats circulate in the target direction.

    ## Action space
    `Box(-1, 1, (k,), float32)`: the rudders of leaders 0 to k - 1; `MultiDiscrete([n] * k)` with
    `rudder_levels=n`. A rudder is held for a control step. A positive rudder turns a boat that
    moves forward counter-clockwise, and works in reverse on a boat that moves backward. Numbers
    beyond ±1 are clipped. NaN is an error, and nothing moves then. With `rudder_levels=n`, levels 0
    to n - 1 are rudders evenly spaced from -1 to 1. With `action_mode="heading"` an action stands
    for a heading, its angle outward of the target's tangent over π, and `DampedLaw()` steers to it
    in every control step. With `"lean"` it stands for that angle over 1.2 rad, and the damped law
    with the gains tuned in the pool steers to it: 0 is that law itself, bit for bit. Both laws read
    what the leader sees of itself. A step holds its action for `decision_period_s`; its reward is
    the sum over those control steps, or over fewer where the episode ends, and its `reward_terms`
    are means over them.

    ## Observation space
    `Box` of shape (k * observation size,), float32: what leader 0 observes, then leader 1, and so
    on. All entries are in the local-angle polar (LAP) frame of the leader's own position, outward
    and clockwise. They are scaled (the unit of an entry stands behind ×), and clipped at their
    bounds; the share of clipped numbers is reported at the end of the episode. The entries of
    `neighbors` repeat for each of the nearest boats, nearest first, and those of `obstacles` for
    each of the nearest discs and walls. The blocks `obstacles` and `lean_features` are off unless
    `observation` switches them on.

    - own
      - `radial_position` in [-1.1, 1.1], -1 at the inner, +1 at the outer wall: distance from the
        pool's center
      - `cos_orientation` in [-1, 1]: cosine of the LAP orientation: 1 heads at the outer wall
      - `sin_orientation` in [-1, 1]: sine of the LAP orientation: 1 heads clockwise
      - `outward_velocity` in [-2, 2] × preferred speed: velocity away from the pool's center
      - `clockwise_velocity` in [-2, 2] × preferred speed: tangential velocity, positive clockwise
      - `forward_velocity` in [-2, 2] × preferred speed: velocity along the heading; a rudder works
        in reverse where it is negative
      - `clockwise_spin` in [-2, 2] × 2 rad/s: angular velocity, positive clockwise
      - `rudder` in [-1, 1]: the rudder as it stands, positive turns counter-clockwise when moving
        forward
    - phase
      - `fw` in [0, 1]: 1 in the forward phase
      - `nop1` in [0, 1]: 1 in the drift after it
      - `bw` in [0, 1]: 1 in the backward phase
      - `nop2` in [0, 1]: 1 in the drift after that
      - `time_left` in [0, 2] × 2 s: time until the phase ends
      - `bw_duration` in [0, 4] × 1 s: length of the backward phase, which sets the noise
    - target
      - `target` in [-1, 1]: +1 clockwise, -1 counter-clockwise
    - neighbors
      - `present` in [0, 1]: 1 where there is such a neighbor
      - `outward_distance` in [-4, 4] × 6 boat radii: its center, seen from the leader along the
        leader's outward axis
      - `clockwise_distance` in [-4, 4] × 6 boat radii: the same along the leader's clockwise axis
      - `cos_relative_heading` in [-1, 1]: cosine of the angle between the headings
      - `sin_relative_heading` in [-1, 1]: its sine: positive where the neighbor heads clockwise of
        the leader
      - `outward_velocity` in [-2, 2] × preferred speed: its velocity along the leader's outward
        axis
      - `clockwise_velocity` in [-2, 2] × preferred speed: its velocity along the leader's clockwise
        axis
      - `is_leader` in [0, 1]: 1 for a leader
    - order
      - `mean_cos_orientation` in [-1, 1]: mean orientation, outward part: psi_o*cos(phi_o)
      - `mean_sin_orientation` in [-1, 1]: mean orientation, clockwise part: psi_o*sin(phi_o)
      - `mean_outward_velocity` in [-2, 2] × preferred speed: mean velocity, outward part:
        psi_v*cos(phi_v)
      - `mean_clockwise_velocity` in [-2, 2] × preferred speed: mean velocity, clockwise part:
        psi_v*sin(phi_v)
    - obstacles
      - `there` in [0, 1]: 1 where there is such an obstacle
      - `outward_distance` in [-4, 4] × 6 boat radii: its nearest point, seen from the leader's
        center along the leader's outward axis
      - `clockwise_distance` in [-4, 4] × 6 boat radii: the same along the leader's clockwise axis
      - `gap` in [-1, 4] × 6 boat radii: distance between the leader's hull and the obstacle,
        negative for overlap
    - lean_features, all in [-20, 20] and standardized as in the pool
      - `radial_position`: distance from the pool's center, -1 at the inner and 1 at the outer wall
      - `outward_velocity`: velocity away from the center over the preferred speed
      - `clockwise_velocity`: velocity towards the target over the preferred speed
      - `forward_velocity`: velocity along the heading over the preferred speed
      - `near_outer_wall`: how much the radial position exceeds 0.6
      - `mean_cos_orientation`: mean orientation of the normal boats, outward part
      - `mean_sin_orientation`: the same, towards the target: the signed order
      - `mean_outward_velocity`: mean velocity of the normal boats over the preferred speed, outward
        part
      - `mean_clockwise_velocity`: the same, towards the target
      - `near`: sum over the normal boats among the six nearest of w = exp(-d^2/2), d their distance
        over 6 boat radii
      - `near_outward`: the same of w times the outward part of d
      - `near_ahead`: the same of w times the part of d towards the target
      - `near_opposed`: the same of w times o = (1 - cos)/2 of the angle between the headings
      - `near_turned`: the same of w times t = the sine of that angle, positive towards the target
      - `near_outward_velocity`: the same of w times the outward velocity over the preferred speed
      - `near_clockwise_velocity`: the same of w times the velocity towards the target over the
        preferred speed
      - `opposed_outward`: the same of w times o times the outward part of d
      - `opposed_ahead`: the same of w times o times the part of d towards the target
      - `turned_outward`: the same of w times t times the outward part of d
      - `turned_ahead`: the same of w times t times the part of d towards the target
      - `leaders`: sum over the leaders among the six nearest of exp(-d^2/8)
      - `leaders_outward`: the same times the outward part of d
      - `leaders_ahead`: the same times the part of d towards the target
      - `cos_orientation`: cosine of the leader's LAP orientation
      - `sin_orientation`: its sine, positive towards the target
      - `clockwise_spin`: angular velocity over 2 rad/s, positive in the sense of the target's
        circulation
      - `fw`: 1 in the forward phase
      - `bw`: 1 in the backward phase
      - `bw_duration`: length of the backward phase in s

    `state()` gives the global state, for critics: the entries of `boat` for each boat in order,
    then the rest.

    - boat
      - `radial_position` in [-1.1, 1.1], -1 at the inner, +1 at the outer wall: distance from the
        pool's center
      - `cos_polar_angle` in [-1, 1]: cosine of its polar angle, counter-clockwise from x
      - `sin_polar_angle` in [-1, 1]: its sine
      - `cos_orientation` in [-1, 1]: cosine of the LAP orientation
      - `sin_orientation` in [-1, 1]: its sine: 1 heads clockwise
      - `outward_velocity` in [-2, 2] × preferred speed: velocity away from the pool's center
      - `clockwise_velocity` in [-2, 2] × preferred speed: tangential velocity, positive clockwise
      - `clockwise_spin` in [-2, 2] × 2 rad/s: angular velocity, positive clockwise
      - `rudder` in [-1, 1]: a leader's rudder as it stands; 0 for a normal boat
      - `is_leader` in [0, 1]: 1 for a leader
    - clock
      - `fw` in [0, 1]: 1 in the forward phase
      - `nop1` in [0, 1]: 1 in the drift after it
      - `bw` in [0, 1]: 1 in the backward phase
      - `nop2` in [0, 1]: 1 in the drift after that
      - `time_left` in [0, 2] × 2 s: time until the phase ends
      - `bw_duration` in [0, 4] × 1 s: length of the backward phase, which sets the noise
      - `target` in [-1, 1]: +1 clockwise, -1 counter-clockwise
      - `episode_elapsed` in [0, 1]: part of the episode that is over

    `flock_features()` gives features of the flock that depend neither on the order of boats nor on
    absolute angles, for critics too.

    - `radial_position` in [-1.1, 1.1] of normal boats, leaders: mean radial position r, scaled as
      that of a leader
    - `radial_position_squared` in [0, 1.21] of normal boats, leaders: mean r^2
    - `outward` in [-1, 1] of normal boats, leaders: mean cosine of the LAP orientation
    - `outward_squared` in [0, 1] of normal boats, leaders: its mean square
    - `ahead` in [-1, 1] of normal boats, leaders: mean cosine of the angle to the target's tangent:
      the signed order
    - `ahead_outward` in [-1, 1] of normal boats, leaders: mean product of the two
    - `outward_velocity` in [-2, 2] of normal boats, leaders: mean velocity away from the center
      over the preferred speed
    - `outward_velocity_squared` in [0, 4] of normal boats, leaders: its mean square
    - `velocity_ahead` in [-2, 2] of normal boats, leaders: mean tangential velocity v towards the
      target over the preferred speed
    - `velocity_ahead_squared` in [0, 4] of normal boats, leaders: mean v^2
    - `spin_ahead` in [-2, 2] of normal boats, leaders: mean angular velocity over 2 rad/s, positive
      in the sense of the target's circulation
    - `spin_ahead_squared` in [0, 4] of normal boats, leaders: its mean square
    - `radial_outward` in [-1.1, 1.1] of normal boats, leaders: mean of r times the cosine of the
      LAP orientation
    - `radial_ahead` in [-1.1, 1.1] of normal boats, leaders: mean of r times the cosine of the
      angle to the tangent
    - `radial_velocity_ahead` in [-2.2, 2.2] of normal boats, leaders: mean of r*v
    - `against_inside` in [0, 1] of normal boats, leaders: share of boats in the inner half (r <= 0)
      that head against the target, within 60 degrees
    - `against_outside` in [0, 1] of normal boats, leaders: the same in the outer half
    - `across_inside` in [0, 1] of normal boats, leaders: share in the inner half that head neither
      against nor along the target
    - `across_outside` in [0, 1] of normal boats, leaders: the same in the outer half
    - `along_inside` in [0, 1] of normal boats, leaders: share in the inner half that head along the
      target, within 60 degrees
    - `along_outside` in [0, 1] of normal boats, leaders: the same in the outer half
    - `clumping_1` in [0, 1] of normal boats, leaders: |mean exp(i*theta)| of the polar angles theta
    - `clumping_2` in [0, 1] of normal boats, leaders: |mean exp(2i*theta)|
    - `clumping_3` in [0, 1] of normal boats, leaders: |mean exp(3i*theta)|
    - `near` in [-40, 40] of near leaders: mean over leaders of the sum over normal boats of the
      weight exp(-d^2/2), d their distance over 6 boat radii
    - `near_outward` in [-40, 40] of near leaders: the same of the weight times the cosine of the
      LAP orientation
    - `near_ahead` in [-40, 40] of near leaders: the same of the weight times the cosine of the
      angle to the target's tangent
    - `near_velocity_ahead` in [-40, 40] of near leaders: the same of the weight times the velocity
      towards the target over the preferred speed
    - `fw` in [0, 1] of clock: 1 in the forward phase
    - `nop1` in [0, 1] of clock: 1 in the drift after it
    - `bw` in [0, 1] of clock: 1 in the backward phase
    - `nop2` in [0, 1] of clock: 1 in the drift after that
    - `time_left` in [0, 2] of clock: time until the phase ends
    - `bw_duration` in [0, 4] of clock: length of the backward phase, which sets the noise
    - `episode_elapsed` in [0, 1] of clock: part of the episode that is over

    ## Rewards
    The weighted sum of the terms below, mean over leaders, as `reward` has it for all leaders or,
    as a list of dictionaries, for each; `signed_order` alone by default, whose return per control
    step is the mean signed order. Infos have `"reward_terms"`, the last one `"episode_summary"`.

    - `signed_order`: psi_o*cos(phi_o - phi_target) of the normal boats, in [-1, 1]; the same for
      all leaders with one target
    - `tangential_velocity`: mean tangential velocity of the normal boats towards the target over
      the preferred speed; the same for all leaders with one target
    - `leader_velocity`: the leader's own tangential velocity towards the target over the preferred
      speed
    - `rudder_effort`: minus the square of the leader's own rudder, in [-1, 0]
    - `jam`: minus psi_o*max(cos(phi_o), 0)*max(1 - psi_v/preferred speed, 0), in [-1, 0]; the same
      for all leaders
    - `contact_push`: tangential momentum that the leader's contacts gave to normal boats towards
      the target, sum of impulse*(normal*tangent) over the step's length, in cm/s^2; 0 where no
      contact_... or touched_order has a weight
    - `contact_alignment`: angular velocity that the leader's contacts gave to normal boats, each
      times the sine of the angle that the boat has to turn to head along the target, over the
      step's length, in rad/s^2; 0 as contact_push
    - `touched_order`: sum over normal boats of cos(d) - cos(d + a), where d is the boat's angle to
      the target's tangent and a the angle that the leader's contacts turned it by: its spin by them
      decays as eq. (9) damps it, and the angle is forgotten within 4 s; 0 as contact_push

    With `target` a list of "cw" and "ccw", one per leader, each leader has a target of its own: its
    observation, the reflection of `mirror_to_target`, what its actions stand for and all its reward
    terms are towards that one, as if it were everybody's. Leaders with opposite targets play a
    general-sum game: their `signed_order` sums to zero, the terms of a leader alone do not. What
    belongs to the whole flock refers to leader 0's target: the `signed_order` and
    `share_towards_target` of the `"episode_summary"`, the reflection of `state()`, and the flock
    features of an environment (those of a `LeaderVecEnv` are in the frame of each slot's target).
    The `target` of `state()` is the mean over the leaders. The joint reward stays the mean over
    leaders, so that k1 leaders against k2 are rewarded with (k1 - k2)/k of the signed order towards
    the k1 leaders' target.

    ## Starting state
    Boats start at rest at random positions with random headings, without overlap, in phase fw. The
    seed fixes the initial state, the noise (whatever the policy does), the target and the backward
    duration; the first episode's flock is `Flock(parameters, seed)`. `reset(options=...)` can set
    for one episode: `target`, `bw_s`, `state` (a dictionary with pose (n, 3) and optionally
    velocity (n, 3), time_s and allow_overlap as in `Flock.set_state`) or `snapshot` (bytes of
    `Flock.snapshot`), the latter with a `noise_seed` for other noise than the snapshot's.

    ## Episode end
    After `episode_s` the episode is truncated; it never terminates. The `"episode_summary"` has the
    episode's `flock_seed`, `bw_s`, `steps` (control steps), `total_reward` and means of the
    `reward_terms` over steps and leaders; means of quantities of the normal boats over the analysis
    window after the first tenth of the episode (`psi_o`, `c_o`, `psi_v`, `c_v`, `nematic`,
    `milling`, `signed_order`, `rotation`) and `share_towards_target` (part of that time with a
    signed order above 0.5); `ordering_time_s` and `ordering_time_wide_s` (eq. 7, with the angle
    π/20 as printed and with π/4); and `clip_rate`. An ordering time that never came is infinite. An
    episode that ends before its first analysis window has no means over it: those entries are left
    out. Where each leader has a target of its own, `signed_order` and `share_towards_target` are
    towards that of leader 0.

    ## Arguments
    Any field of `FlockParameters`, where `n_boats` is 27 and `n_leaders` 3 unless given, and:

    - `preset` = `'simulation'`: named parameters of the flock, see `FlockParameters.presets`
    - `params` = `None`: parameters of the flock, `FlockParameters` or a dictionary, instead of a
      preset
    - `physics` = `'default'`: "training" steps the flock by dt_s = 0.1 s with one relinearization,
      coarser and cheaper; "default" as the parameters have it
    - `bw_s` = `0.3`: Duration of the backward phase: the source of disorder. In s; a pair (low,
      high) draws it uniformly for each episode.
    - `target` = `'cw'`: "cw", "ccw", "random" (drawn for each episode) or "alternate" (ccw, cw,
      ccw, cw, a quarter of the episode each); or a list of "cw" and "ccw", one per leader
    - `episode_s` = `None`: length of an episode in s, rounded to whole control steps; None: 480,
      and 960 where targets alternate
    - `control_hz` = `10.0`: control steps per second
    - `action_mode` = `'rudder'`: what an action in [-1, 1] stands for: "rudder"; "heading", the
      angle outward of the target's tangent over pi, to which the damped law steers; or "lean", that
      angle over 1.2 rad, to which the pool's tuned law steers, so that 0 is that law
    - `decision_period_s` = `None`: time in s from one decision to the next, a whole number of
      control steps, through which a step holds its action; None: one control step
    - `observation` = `{'own': True, 'phase': True, 'target': True, 'neighbors': 6, 'order': True,
      'obstacles': 0, 'lean_features': False}`: blocks that differ from the default layout, such as
      `{'order': False, 'neighbors': 4}`
    - `mirror_to_target` = `False`: reflect observation, state and action where the target is ccw,
      so that both directions are one task
    - `dropout_rate` = `0.0`: chance that the camera loses a boat in a frame and shows where it was
      before
    - `delay_frames` = `0`: frames that the leaders' picture is late, 0 or 1
    - `reward` = `{'signed_order': 1.0}`: weights of the reward's terms; terms that are not named
      weigh nothing
    - `reward_horizon_s` = `None`: time T in s: a control step's reward counts for its length over
      T, so that sums over T are means, of order one; None: each counts in full
    - `rudder_levels` = `None`: number of levels of the discrete action, 2 to 1001; None: continuous
    - `rudder_lag_s` = `0.0`: time constant of the rudder servo in s
    - `rudder_rate_per_s` = `None`: fastest change of the rudder in 1/s (-1 to 1 is a change of 2);
      None: any
    - `render_mode` = `None`: None, "rgb_array" (`render` returns a frame) or, for environments with
      one flock, "human" (a window, extra `render`)
    - `render_size` = `(600, 600)`: width and height of a frame in pixels, 64 to 4096

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
        **options: Any,
    ) -> None:
        self._set_up(options, render_mode, render_size)
        settings = self._batch.settings
        self.observation_space = ObservationSpace(settings, self.num_leaders)
        self.action_space = joint_action_space(settings["rudder_levels"], self.num_leaders)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start an episode.

        Parameters
        ----------
        seed
            Fixes this episode, and those that follow without a seed. None continues with the
            next one.
        options
            For this episode: ``target``, ``bw_s`` in s, and ``state`` or ``snapshot``, as the class
            says of the starting state. A snapshot is of a flock with the same parameters, target
            and bw_s aside; with ``noise_seed`` it continues with other noise, as in
            `Flock.restore`.

        Returns
        -------
        observation : numpy.ndarray
            Shape (k * observation size,), float32.
        info : dict
            Target, backward duration and seed of the episode.
        """
        self._reset(seed, options, lambda: drawn_seed(self.np_random))
        super().reset(seed=None if seed is None else int(seed))
        self._show()
        return self.observe(), self._batch.reset_info(0)

    def step(
        self, action: ArrayLike
    ) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Take one control step.

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
        flat = _core.flat_actions(
            action, (self.num_leaders,), self._batch.settings["rudder_levels"]
        )
        rows, rewards, truncated = self._batch.step(self, flat)
        terms = {name: float(each.mean()) for name, each in self._batch.reward_terms().items()}
        info: dict[str, Any] = {"reward_terms": terms}
        over = bool(truncated[0])
        if over:
            info.update(self._batch.end_info(0))
        self._show()
        return rows.reshape(-1), float(rewards.mean()), False, over, info

    def observe(self) -> NDArray[np.float32]:
        """Return the present observation."""
        return self._batch.core.observe().reshape(-1)
