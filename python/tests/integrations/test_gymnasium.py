"""Gymnasium's checkers, and the environment's own promises."""

import warnings

import numpy as np
import pytest

from needed import need

need("gymnasium")

from gymnasium.utils.env_checker import check_env

import quatrack as q
from quatrack.integrations.gymnasium import QuatrackEnv, QuatrackVectorEnv

GUSTY = {"vehicle": "crazyflie-2.1-brushless", "air": {"drag_per_s": [0.4, 0.4, 0.4], "gust_rms_m_s": 0.5}}


def test_the_checker_passes_without_a_word():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Unbounded observations are meant.
        warnings.filterwarnings("ignore", message=".*(infinity|not at the range|recommend).*")
        check_env(QuatrackEnv(steps=50), skip_render_check=True)


def rolled(env, seed, steps=30):
    rng = np.random.default_rng(0)
    observations = [env.reset(seed=seed)[0]]
    for _ in range(steps):
        observations.append(env.step(rng.uniform(-1, 1, (env.num_envs, 4)).astype(np.float32))[0])
    return np.array(observations)


def test_a_seed_gives_the_same_flights_and_another_others():
    first, same, other = (rolled(QuatrackVectorEnv(8, GUSTY), seed) for seed in (1, 1, 2))
    assert np.array_equal(first, same) and not np.array_equal(first, other)
    assert first.shape == (31, 8, 18) and first.dtype == np.float32


def test_spaces_hold_every_observation():
    env = QuatrackVectorEnv(8, GUSTY, steps=20)
    observations, _ = env.reset(seed=3)
    for _ in range(60):
        assert observations in env.observation_space
        observations, reward, terminated, truncated, _ = env.step(env.action_space.sample())
        assert reward.shape == terminated.shape == truncated.shape == (8,) and (reward <= 1.0).all()


def test_an_episode_that_is_over_begins_anew_at_the_next_step():
    env = QuatrackVectorEnv(4, steps=5)
    env.reset(seed=1)
    hover = np.zeros((4, 4), dtype=np.float32)
    for step in range(1, 12):
        _, reward, _, truncated, _ = env.step(hover)
        assert truncated.all() == (step in (5, 11)), step
        assert (reward == 0.0).all() == (step == 6), step


def test_our_law_brings_crafts_to_their_goal():
    env = QuatrackVectorEnv(16, steps=1000, rate_hz=500)
    observations, _ = env.reset(seed=5)
    vehicle = q.Vehicle("crazyflie-2.1-brushless")
    least, most = vehicle.motor_force_n
    controller = q.Controller("quatrack", vehicle)
    for _ in range(999):
        axes = observations[:, 6:15].reshape(-1, 3, 3).astype(float)
        state = q.State(observations[:, :3], quaternions(axes), observations[:, 3:6], observations[:, 15:])
        forces = controller.step(state, q.Reference([0.0, 0.0, 0.0])).motor_forces
        action = 2.0 * (forces - least) / (most - least) - 1.0
        observations, reward, terminated, _, _ = env.step(action.astype(np.float32))
        assert not terminated.any()
    # Two seconds on, at rest within centimetres.
    assert reward.min() > 0.9


def quaternions(axes):
    """w x y z of rotations below a half turn."""
    w = 0.5 * np.sqrt(1.0 + np.trace(axes, axis1=1, axis2=2))
    vector = np.stack([axes[:, 2, 1] - axes[:, 1, 2], axes[:, 0, 2] - axes[:, 2, 0], axes[:, 1, 0] - axes[:, 0, 1]], axis=1)
    return np.hstack([w[:, None], vector / (4.0 * w[:, None])])


def test_steps_come_after_a_reset():
    with pytest.raises(Exception, match="reset"):
        QuatrackVectorEnv(2).step(np.zeros((2, 4), dtype=np.float32))
    with pytest.raises(ValueError, match="must divide 1000"):
        QuatrackVectorEnv(2, rate_hz=300)
