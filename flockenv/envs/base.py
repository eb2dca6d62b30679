"""Base classes of all environments, of those with many flocks, and of those with one."""

import copy
from typing import Any, ClassVar, Self

import numpy as np
from gymnasium.envs.registration import EnvSpec
from numpy.typing import NDArray

from flockenv._io.arguments import as_bytes
from flockenv.envs.batch import LeaderBatch
from flockenv.envs.fixed_options import FixedOptions
from flockenv.envs.options import EnvOptions
from flockenv.envs.render_mode import RenderMode
from flockenv.envs.reset_options import reset_requests
from flockenv.envs.seeds import drawn_seed, seed_of
from flockenv.flock import Flock


class OwnFlocks(FixedOptions):
    """An environment whose copies, including shallow ones, have their own flocks."""

    def __copy__(self) -> Self:
        return copy.deepcopy(self)


class Resumable(OwnFlocks):
    """An environment that can be pickled and copied, and continues from the same state."""

    _batch: LeaderBatch

    def get_state(self) -> bytes:
        """Return the whole state of the environment, as bytes.

        Parameters, options, terms and blocks are stored by name. The rest, such as motion and
        noise, can be read only by the build that wrote it.
        """
        return self._batch.core.to_bytes()

    def set_state(self, state: bytes) -> Any:
        """Continue from `get_state` of an environment with the same options, bit for bit."""
        self._batch.core.restore(as_bytes(state, "state"))

    def set_next_episodes(self, **options: object) -> None:
        """Set ``bw_s`` or ``target`` of all future episodes.

        Values are as for `reset`: from a range (low, high) each episode draws its bw_s. A vector
        environment sets all flocks. Raises ParameterError for other names, and for values that are
        not accepted.
        """
        self._batch.set_upcoming(range(self._batch.num_flocks), options)

    def clone(self) -> Self:
        """Return an independent copy that continues bit for bit as this environment does.

        A copy of an environment that was never reset draws another seed.
        """
        return copy.deepcopy(self)


class ManyFlocks(Resumable):
    """An environment of many flocks, with arrays of all boats and flocks."""

    def poses(self) -> NDArray[np.float64]:
        """Return all poses, shape (flocks, n, 3): [x cm, y cm, heading rad], leaders first."""
        return self._batch.core.poses().reshape(self._batch.num_flocks, -1, 3)

    def velocities(self) -> NDArray[np.float64]:
        """Return all velocities, shape (flocks, n, 3): [cm/s, cm/s, rad/s], leaders first."""
        return self._batch.core.velocities().reshape(self._batch.num_flocks, -1, 3)

    def snapshots(self) -> list[bytes]:
        """Return each flock's snapshot, as `Flock.snapshot`, for the `snapshot` option of `reset`.

        Snapshots hold the flocks, but not the progress of their episodes.
        """
        return [self._batch.flock(flock).snapshot() for flock in range(self._batch.num_flocks)]

    def order_parameters(self) -> NDArray[np.float64]:
        """Return the present order parameters of the normal boats.

        Shape (flocks, quantities), with the fields of `OrderParameters` as columns; NaN if a flock
        has no normal boat.
        """
        return self._batch.core.order_parameters()


class SpecOfEpisodes:
    """An environment with Gymnasium's spec, to which the length of its episodes is added."""

    _batch: LeaderBatch
    _spec: EnvSpec | None = None

    @property
    def spec(self) -> EnvSpec | None:
        """Gymnasium's spec of the environment, with the decisions of an episode as its steps."""
        return self._spec

    @spec.setter
    def spec(self, spec: EnvSpec | None) -> None:
        if spec is not None and spec.max_episode_steps is None:
            # The registered spec is for all options, so it has no number of steps.
            spec = copy.deepcopy(spec)
            spec.max_episode_steps = self._batch.decisions
        self._spec = spec


class SingleEnvironmentBase(Resumable):
    """The base of environments of one flock: episodes, infos and frames."""

    metadata: dict[str, Any]
    np_random: np.random.Generator
    _read_only_attributes: ClassVar[tuple[str, ...]] = ("parameters", "num_leaders", "render_mode")

    def _set_up(
        self, options: dict[str, Any], render_mode: str | None, render_size: object
    ) -> None:
        """Store the checked options, the batch of one flock, and the render mode."""
        parsed = EnvOptions.parse(options)
        self.parameters = parsed.parameters
        self.num_leaders = parsed.parameters.n_leaders
        self._batch = LeaderBatch(parsed, [self.num_leaders], autoreset_mode="disabled")
        self.state_space = self._batch.state_space
        fps = self._batch.decisions_hz
        self.render_mode = render_mode
        self._render_mode = RenderMode(render_mode, render_size, fps)
        self.metadata = {**self.metadata, "render_fps": fps}

    def _reset(self, seed: object, options: object) -> int | None:
        """Start an episode; return the seed of this reset as an int, or None without one."""
        requests = reset_requests(options, 1, lists_flocks=False)
        checked_seed = None if seed is None else seed_of(seed)
        self._batch.reset([checked_seed], requests, lambda: drawn_seed(self.np_random))
        return checked_seed

    def state(self) -> NDArray[np.float32]:
        """Return the global state for centralized critics, shape (state size,), float32."""
        state: NDArray[np.float32] = self._batch.core.states()[0]
        return state

    def flock_features(self) -> NDArray[np.float32]:
        """Return features of the flock, shape (features,), float32.

        They depend neither on the order of boats nor on absolute angles. They are in the frame of
        the target; with several targets, in the frame of leader 0's target.
        `envs.observation.flock_feature_entries` lists them.
        """
        features: NDArray[np.float32] = self._batch.core.flock_features(each_leader=False)[0]
        return features

    def episode(self) -> dict[str, Any]:
        """Return target, backward duration, seed and step of the episode."""
        return self._batch.core.episode(0)

    @property
    def flock(self) -> Flock:
        """A copy of the flock in its present state."""
        return self._batch.flock(0)

    def _show(self) -> None:
        if self._render_mode.is_live:
            self._render_mode.show(self.flock)

    def render(self) -> NDArray[np.uint8] | None:
        """Return a frame, (height, width, 3) uint8, if `render_mode` is "rgb_array".

        With "human" every reset and step shows the flock in a window, and None is returned.
        """
        return None if self.render_mode is None else self._render_mode.render(self.flock)

    def close(self) -> None:
        """Close the window, if there is one; it stays closed."""
        self._render_mode.close()
