"""A vector environment of our plant: many crafts, flown by their motors, by thrust and body rates, or by setpoints for our law.

    env = QuatrackVectorEnv(64, {"vehicle": "crazyflie-2.1-brushless", "air": "vehicle"})
    observations, _ = env.reset(seed=1)

A craft is to come to a goal and stay there. Its reward is 1 there at rest and falls with the distance; an episode ends where the
craft is lost (5 m from its goal or its thrust downwards), and is cut after a number of steps. The plant is that of
`quatrack fly`: drag, airflow moment, wind, motor lag, delay, as in the scenario.
"""

from __future__ import annotations

from typing import Any, Literal

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from quatrack import Plant, Scenario, State

Singles = NDArray[np.float32]

# Where an episode begins, and where it is lost.
_START_M, _START_M_S, _START_TILT_RAD, _LOST_M = 0.5, 0.3, 0.3, 5.0


class QuatrackVectorEnv(VectorEnv[Singles, Singles, NDArray[Any]]):
    """Crafts in flight, stepped together; a craft whose episode is over begins anew at the next step.

    num_envs: how many crafts
    scenario: a Scenario, a path, or the keys of a file; its course and law count for nothing here
    steps: control steps of an episode
    rate_hz: control steps a second, a divisor of 1000

    Observations (18,): position from the goal (m), velocity (m/s), body axes in the world frame by rows (9), body rates (rad/s).
    Actions (4,): forces of M1 to M4 from -1, the least, to 1, the most.
    """

    metadata = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(
        self,
        num_envs: int = 1,
        scenario: Any = None,
        *,
        steps: int = 500,
        rate_hz: int = 100,
        render_mode: None = None,
    ) -> None:
        if rate_hz < 1 or 1000 % rate_hz:
            raise ValueError(f"rate_hz: {rate_hz}; must divide 1000")
        self.num_envs, self.steps, self.rate_hz, self.render_mode = num_envs, steps, rate_hz, render_mode
        self._scenario = Scenario({"vehicle": "crazyflie-2.1-brushless", "air": "vehicle"} if scenario is None else scenario)
        self.spec = None
        self._range = self._scenario.vehicle.motor_force_n
        bound = np.full(18, np.inf, dtype=np.float32)
        bound[6:15] = 1.0
        self.single_observation_space = spaces.Box(-bound, bound, dtype=np.float32)
        self.single_action_space = spaces.Box(-1.0, 1.0, (4,), dtype=np.float32)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._plant: Plant | None = None
        self._age = np.zeros(num_envs, dtype=int)
        self._over = np.zeros(num_envs, dtype=bool)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Singles, dict[str, Any]]:
        """Starts all crafts anew; the same seed gives the same flights to the bit."""
        if isinstance(seed, list):
            seed = next((one for one in seed if one is not None), None)
        super().reset(seed=seed)
        self._plant = Plant(self._scenario, self._starts(), seeds=self._seeds())
        self._age[:], self._over[:] = 0, False
        return self._observations(), {}

    def step(
        self, actions: Singles
    ) -> tuple[Singles, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """One control step of all crafts."""
        if self._plant is None:
            raise gymnasium.error.ResetNeeded("reset() comes before step()")
        again = self._over.copy()
        least, most = self._range
        share = 0.5 * (np.clip(np.asarray(actions, dtype=float), -1.0, 1.0) + 1.0)
        self._plant.advance(least + share * (most - least), 1.0 / self.rate_hz)
        self._age += 1
        if again.any():
            self._plant.restart(again, self._starts(), seeds=self._seeds())
            self._age[again] = 0
        state = self._plant.state
        distance = np.linalg.norm(state.position, axis=1)
        upright = _axes(state.attitude)[:, 2, 2]
        terminated = ~((distance < _LOST_M) & (upright > 0.0)) & ~again
        truncated = (self._age >= self.steps) & ~terminated & ~again
        reward = 1.0 / (1.0 + distance + 0.1 * np.linalg.norm(state.velocity, axis=1))
        reward[terminated | again] = 0.0
        self._over = terminated | truncated
        return self._observations(), reward, terminated, truncated, {}

    def _seeds(self) -> NDArray[np.int64]:
        seeds: NDArray[np.int64] = self.np_random.integers(2**62, size=self.num_envs)
        return seeds

    def _starts(self) -> State:
        """Near the goal, which is at the origin, slow and tilted a little."""
        rows, rng = self.num_envs, self.np_random
        half = 0.5 * _START_TILT_RAD * rng.uniform(-1.0, 1.0, (rows, 3)) / np.sqrt(3.0)
        attitude = np.hstack([np.sqrt(1.0 - (half**2).sum(axis=1, keepdims=True)), half])
        return State(
            rng.uniform(-_START_M, _START_M, (rows, 3)),
            attitude,
            rng.uniform(-_START_M_S, _START_M_S, (rows, 3)),
            np.zeros((rows, 3)),
        )

    def _observations(self) -> Singles:
        assert self._plant is not None
        state = self._plant.state
        assert state.body_rates is not None
        axes = np.clip(_axes(state.attitude).reshape(-1, 9), -1.0, 1.0)
        return np.hstack([state.position, state.velocity, axes, state.body_rates]).astype(np.float32)


def _axes(quaternion: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotation matrices, body to world, of quaternions w x y z; (N, 3, 3)."""
    w, x, y, z = (quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


class QuatrackEnv(gymnasium.Env[Singles, Singles]):
    """One craft of the vector environment, for tools that take a single one; arguments likewise."""

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(self, scenario: Any = None, **arguments: Any) -> None:
        self._vector = QuatrackVectorEnv(1, scenario, **arguments)
        self.observation_space = self._vector.single_observation_space
        self.action_space = self._vector.single_action_space
        self.render_mode = None

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Singles, dict[str, Any]]:
        """Starts the craft anew."""
        super().reset(seed=seed)
        observations, info = self._vector.reset(seed=seed)
        return observations[0], info

    def step(self, action: Singles) -> tuple[Singles, float, bool, bool, dict[str, Any]]:
        """One control step."""
        observations, reward, terminated, truncated, info = self._vector.step(action[np.newaxis])
        return observations[0], float(reward[0]), bool(terminated[0]), bool(truncated[0]), info
