"""Law: names that honest users give to attributes and options are accepted.

The names are those of the tutorials of Gymnasium, HighwayEnv, PettingZoo, SuperSuit,
stable-baselines3, TorchRL and RLlib, of wrappers of their users, and of this field's papers.
"""

import copy

import gymnasium
import numpy as np
import pytest

import flockenv

OPTIONS = {"n_boats": 6, "n_leaders": 2, "episode_s": 0.5}


def words(text):
    return text.split()


#: Attributes that a subclass keeps.
ATTRIBUTES = words(
    """
achieved_goal action action_history action_mode action_repeat action_type actions agent
agent_location allow_overlap alpha angle arena autoreset_mode base_env batch_size beta boats
bounds buffer bw bw_s c0 c1 c2 c3 c4 callbacks canvas cfg clock coefficients config control_hz
controlled_vehicles counter critic cumulative_reward curriculum dataset delay_frames desired_goal
device difficulty discount discs done dones dropout_rate dt dt_control dt_s dtype elapsed_steps
engine episode episode_count episode_id episode_length episode_reward episode_s episodes epsilon
expert failed frame frame_stack frames frequency fw_s gamma generator goal goals grid heading
headings high history horizon hyperparams info infos inner is_success isopen label lanes
last_action last_info last_obs last_reward last_state leaders level log logger low map mask
max_episode_steps max_steps memory metrics mirror_to_target model n_agents n_boats n_steps name
noise noise_scale noise_seed noise_std np_rng num_agents num_envs num_flocks obs obs_buffer
observation observation_type observations obstacles parameter_range params path phase physics
pix_square_size policy policy_frequency pool pose position positions preset previous_action
previous_state radius random_state render_fps render_size reset_mask return_ reward reward_fn
reward_range reward_scale reward_weights rewards rng road rudder rudder_lag_s rudder_levels scheme
score scores screen screen_size seed seeds settings sim simulation_frequency simulator snapshot
snapshots solver space speed speed_limit speeds stack stage state state_size states stats
step_count steps success surface t target target_heading target_location target_speed targets task
task_id tau teacher terminated theta threshold time time_limit time_s timestep tolerance
total_reward trajectory truncated vehicle velocities velocity viewer walls weights window
window_size world x y
"""
)

#: Keys of the dictionary that Gymnasium hands through all wrappers.
KEYS = words(
    """
action_mask agent agent_id agents alpha angle batch batch_size belief beta boat boats bonus buffer
camera camera_id cfg checkpoint checkpoint_path color colors config context context_id counter
curriculum curriculum_stage dataset debug demo demonstration desired_goal device difficulty
distribution domain_randomization dt dtype env_id env_ids env_seed episode episode_id
episode_length episodes epsilon eval evaluate evaluation expert fault faults fps frame frame_skip
frame_stack frames friction full_reset gamma goal goal_pos goal_state goals gravity hard_reset
heading high history horizon host hyperparameters id ids idx index info infos init init_state
initial_state is_training kwargs label layout layout_id layout_seed leader leaders length lesson
level level_id levels log log_dir logging low map map_id map_name mask masks mass
max_episode_steps max_speed max_steps maze memory mode model modes n_agents n_leader name names
noise noise_level noise_scale noise_std num_agents num_boats obs obs_noise observation_noise
observations obstacle obstacles offset opponent opponents option options palette param parameter
parameters penalty phase phases player policies policy pos pose_noise poses position positions
prior radius random random_state randomize rank rank_id record record_video render render_fps
rendering replay replay_id reset reset_kwargs reset_state reset_to reset_type resets restore
restore_from return_info reward_fn reward_scale reward_type reward_weights rewards rng rollout
rollout_id run run_id sample sampler samples save save_path scale scenario scenario_id scene
scene_id schedule schedules score scores seeds sensor sensors settings shaping snapshots
soft_reset speed speed_limit speeds split stage stages start start_pos start_state stat state_id
states statistic stats status step step_count steps subtask success t t0 tag tags target_heading
target_id target_location target_pos target_speed target_velocity targets task task_id task_name
tasks teacher team teams temperature test theta threshold time time_limit timestep tolerance train
training trajectories trajectory trial trial_id vel velocity_limit verbose video video_path view
viewpoint wall weight weights wind worker worker_id world world_seed x x_init y y_init
"""
)


@pytest.fixture(params=["single", "vector", "sb3"])
def base(request):
    if request.param == "sb3":
        pytest.importorskip("stable_baselines3")
        return flockenv.sb3.LeaderVecEnv
    return {"single": flockenv.LeadersEnv, "vector": flockenv.LeadersVectorEnv}[request.param]


def keeping(base, name):
    """Make an environment whose subclass keeps an attribute of this name."""

    class Mine(base):
        def __init__(self, **options):
            setattr(self, name, 0)
            super().__init__(**options)
            setattr(self, name, [1])

        def reset(self, **options):
            started = super().reset(**options)
            setattr(self, name, [2])
            return started

    return Mine(**OPTIONS)


def test_a_subclass_keeps_attributes_of_any_name(base):
    plain = base(**OPTIONS)
    nothing = np.zeros((plain.num_envs, 1) if hasattr(plain, "slots") else plain.action_space.shape)
    for name in (each for each in ATTRIBUTES if each not in plain._read_only_attributes):
        env = keeping(base, name)
        env.reset()
        other = copy.deepcopy(env)
        for _ in range(2):
            env.step(nothing)
            other.step(nothing)
        assert other.get_state() == env.get_state()
        assert getattr(env, name) == getattr(other, name) == [2]
        # It is the subclass's own from now on.
        setattr(env, name, 3)
        assert getattr(env, name) == 3


def test_a_tutorials_first_lines():
    """As HighwayEnv and Gymnasium's tutorials write them, with a property and a class attribute."""

    class Mine(flockenv.LeadersEnv):
        reward = 0.0
        noise = None

        def __init__(self, render_mode=None, **options):
            self.render_mode = render_mode
            self.state = None
            self.target, self.speed = "goal", 0.0
            super().__init__(render_mode=render_mode, **options)
            self.observation = self.params = None
            self.render_mode = render_mode

        @property
        def bw_s(self):
            return self.noise

        @bw_s.setter
        def bw_s(self, value):
            self.noise = value

        def step(self, action):
            self.observation, self.reward, *ends = super().step(action)
            return self.observation, self.reward, *ends

    env = Mine(**OPTIONS, render_mode="rgb_array")
    env.reward = 1.0
    env.reset(seed=0)
    _, reward, *_ = env.step(np.zeros(2))
    assert env.reward == reward
    env.bw_s = 0.7
    assert (env.noise, env.flock.parameters.bw_s) == (0.7, 0.3)
    wrapped = gymnasium.wrappers.FlattenObservation(env)
    wrapped.set_wrapper_attr("target", "other")
    assert env.target == "other"


def test_a_classmethod_sets_attributes_of_what_it_makes(base):
    class Mine(base):
        parameters = None if "parameters" in base._read_only_attributes else {"mine": 1}

        @classmethod
        def from_config(cls, config):
            env = cls(**config)
            env.reward, env.target = 0.0, "goal"
            return env

    env = Mine.from_config(OPTIONS)
    assert (env.reward, env.target) == (0.0, "goal")
    for name in base._read_only_attributes:
        with pytest.raises(AttributeError, match="cannot be set as an attribute"):
            setattr(env, name, 7)


INTERFACES = {
    "single": lambda: flockenv.LeadersEnv(**OPTIONS),
    "parallel": lambda: flockenv.parallel_env(**OPTIONS),
    "aec": lambda: flockenv.env(**OPTIONS),
    "vector": lambda: flockenv.LeadersVectorEnv(2, **OPTIONS),
    "wrapped": lambda: gymnasium.wrappers.RecordEpisodeStatistics(
        gymnasium.make("flockenv/Leaders-v0", **OPTIONS)
    ),
    "torchrl": lambda: pytest.importorskip("torchrl") and flockenv.torchrl.LeadersEnv(2, **OPTIONS),
    "sb3": lambda: (
        pytest.importorskip("stable_baselines3") and flockenv.sb3.LeaderVecEnv(2, **OPTIONS)
    ),
}


@pytest.mark.parametrize("make", INTERFACES.values(), ids=INTERFACES.keys())
def test_keys_of_a_wrapper_pass_a_reset(make):
    env = make()
    for number, key in enumerate(KEYS):
        options = {key: number, "bw_s": 0.25}
        if hasattr(env, "set_options"):
            env.set_options(options)
            env.reset()
        else:
            env.reset(options=options)
        core = (env if hasattr(env, "_batch") else env.unwrapped)._batch.core
        assert core.episode(0)["bw_s"] == 0.25
