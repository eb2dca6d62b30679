"""Law: pictures are a function of the flock alone, in every interface, and need no display."""

from concurrent.futures import ThreadPoolExecutor

import gymnasium
import numpy as np
import PIL.Image
import pytest

import flockenv
from flockenv import rendering

SHORT = {"n_boats": 8, "n_leaders": 2, "episode_s": 3.0}
SMALL = {**SHORT, "render_size": (160, 120)}


def flock(**fields):
    given = {"n_boats": 8, "n_leaders": 2, **fields}
    return flockenv.Flock(flockenv.FlockParameters().replace(**given), seed=3)


def test_a_frame_of_a_recording_is_that_of_its_flock():
    frame = rendering.frame
    parameters = flockenv.FlockParameters(n_boats=8, n_leaders=2)
    recording = flockenv.simulate(parameters, 5, 10.0)
    flock = flockenv.Flock(parameters, 5)
    flock.advance(7.0)
    assert np.array_equal(frame(recording, 7.0, 160, 120), frame(flock, 160, 120))
    assert np.array_equal(frame(recording, 7.09, width=160), frame(flock, width=160))
    assert frame(recording, 0.0).shape == frame(flock).shape
    with pytest.raises(flockenv.ParameterError, match="time_s = 11"):
        frame(recording, 11)
    with pytest.raises(TypeError):
        frame(recording)
    with pytest.raises(TypeError):
        frame("run.npz")


def test_color_shows_what_it_is_told_to_show():
    scene = flock()
    direction = rendering.frame(scene, 160, 120)
    assert np.array_equal(rendering.frame(scene, 160, 120, colors="direction"), direction)
    role = rendering.frame(scene, 160, 120, colors="role")
    assert not np.array_equal(role, direction)
    with pytest.raises(flockenv.ParameterError, match=r'colors = "red" .* "direction", "role"'):
        rendering.frame(scene, colors="red")
    # In open water boats circle around nothing.
    scene = flock(pool=(np.inf, 0))
    assert np.array_equal(
        rendering.frame(scene, 160, 120), rendering.frame(scene, 160, 120, colors="role")
    )


def test_frames_may_be_drawn_in_several_threads():
    scenes = [flock(n_boats=n, pool=pool) for n in (3, 8) for pool in ("wide", "narrow")]
    alone = [rendering.frame(scene, 160, 120) for scene in scenes]
    with ThreadPoolExecutor(len(scenes)) as threads:
        # All of them share one renderer.
        for _ in range(25):
            together = threads.map(lambda scene: rendering.frame(scene, 160, 120), scenes)
            for ours, theirs in zip(alone, together, strict=True):
                np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("size", [(63, 100), (100, 4097), (2**40, 100), (100.5, 100), (None, 100)])
def test_wrong_sizes(size):
    with pytest.raises((flockenv.ParameterError, TypeError), match=r"width|height"):
        rendering.frame(flock(), *size)
    for mode in (None, "rgb_array"):
        with pytest.raises((flockenv.ParameterError, TypeError), match=r"width|height"):
            flockenv.LeadersEnv(render_mode=mode, render_size=size, **SHORT)
    for pair in (600, size[:1], (*size, 3), None):
        with pytest.raises(flockenv.ParameterError, match="render_size"):
            flockenv.LeadersEnv(render_mode="rgb_array", render_size=pair, **SHORT)


def test_faces_show_the_same_flock():
    single = gymnasium.make("flockenv/Leaders-v0", render_mode="rgb_array", **SMALL)
    parallel = flockenv.parallel_env(render_mode="rgb_array", **SMALL)
    vector = gymnasium.make_vec("flockenv/Leaders-v0", num_envs=2, render_mode="rgb_array", **SMALL)
    for env in (single, parallel, vector):
        env.reset(seed=5)
    picture, frames = single.render(), vector.render()
    assert picture.shape == (120, 160, 3)
    np.testing.assert_array_equal(picture, rendering.frame(single.unwrapped.flock, 160, 120))
    np.testing.assert_array_equal(picture, parallel.render())
    assert isinstance(frames, tuple)
    assert len(frames) == 2
    np.testing.assert_array_equal(picture, frames[0])
    assert (frames[0] != frames[1]).any()


def test_rendering_changes_nothing():
    seen, unseen = (flockenv.LeadersEnv(render_mode=mode, **SMALL) for mode in ("rgb_array", None))
    for env in (seen, unseen):
        env.reset(seed=1)
    for _ in range(10):
        seen.render()
        for env in (seen, unseen):
            env.step([0.5, -0.5])
    assert seen.get_state() == unseen.get_state()


@pytest.mark.parametrize(
    ("interface", "modes"),
    [
        (flockenv.LeadersEnv, ["human", "rgb_array"]),
        (flockenv.parallel_env, ["human", "rgb_array"]),
        (flockenv.LeadersVectorEnv, ["rgb_array"]),
    ],
)
def test_metadata(interface, modes):
    env = interface(control_hz=20.0, **SHORT)
    assert env.metadata["render_modes"] == modes
    assert env.metadata["render_fps"] == 20.0
    assert type(env).metadata["render_fps"] == 10.0
    for wrong in {"ansi", "human"} - set(modes):
        with pytest.raises(flockenv.ParameterError, match=f"render_mode = '{wrong}'"):
            interface(render_mode=wrong, **SHORT)


def plain(level):
    return np.full((30, 40, 3), level, np.uint8)


def test_animations_keep_time_and_few_colors(tmp_path):
    # 33.3 ms a frame in whole hundredths of a second; two equal frames are one.
    path, levels = tmp_path / "run.gif", [7, 200, 90, 13, 13]
    rendering.save_animation(path, map(plain, levels), fps=np.float32(30))
    with PIL.Image.open(path) as file:
        assert (file.n_frames, file.info["loop"]) == (4, 0)
        for index, duration in enumerate([30, 40, 30, 70]):
            file.seek(index)
            assert file.info["duration"] == duration
            assert file.convert("RGB").getpixel((20, 10)) == (levels[index],) * 3


@pytest.mark.parametrize(
    ("name", "frames", "fps", "words"),
    [
        ("run.avi", [plain(1)], 10, "a name in .gif, .mp4"),
        ("run.gif", [], 10, "at least one"),
        ("run.gif", [plain(1)], float("nan"), "fps"),
        ("run.gif", [plain(1)], "fast", "fps"),
        ("run.gif", [plain(1), plain(1).astype(float)], 10, "of uint8"),
        ("run.gif", [None], 10, "of uint8"),
        ("run.gif", [plain(1)[..., [0, 1, 2, 2]]], 10, "expected"),
        ("run.gif", [np.zeros((65_536, 1, 3), np.uint8)], 10, "65535"),
        ("run.mp4", [plain(1), plain(1)[1:]], 10, "expected"),
    ],
)
def test_animations_that_cannot_be(tmp_path, name, frames, fps, words):
    path = tmp_path / name
    path.write_bytes(b"what was there before")
    with pytest.raises((flockenv.ParameterError, TypeError), match=words):
        rendering.save_animation(path, frames, fps)
    assert path.read_bytes() == b"what was there before"
    assert len(list(tmp_path.iterdir())) == 1
