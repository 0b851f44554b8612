"""Rotor speeds for gym-pybullet-drones' `CtrlAviary`, for all of its drones at once.

    env = CtrlAviary(num_drones=2, physics=Physics.PYB_DRAG, pyb_freq=1000, ctrl_freq=500)
    control = RotorControl(env)
    obs, _ = env.reset()
    obs, *_ = env.step(control(obs, reference))      # RPM

Its Crazyflie in the X (CF2X) numbers rotors as the firmware does. Its observations have quaternions x y z w, and angular velocities in
the world frame; both are converted. Its gravity is 9.8 m/s^2, and the law is told the mass that weighs as much with ours.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from quatrack import Controller, Reference, State, Vehicle
from quatrack.integrations._craft import GRAVITY_M_S2, Array, scalar_first, vehicle

# Its rotors have no lag, and below 12.5 ms there is no certified law for the CF2X.
LAG_S = 0.015

# The damping of PyBullet's bodies, which the environments leave on: 0.04 (1 + v) per second, v in m/s.
_DAMPING_PER_S = 0.04


def vehicle_of(env: Any, lag_s: float = LAG_S) -> Vehicle:
    """The vehicle of an environment, with such motors.

    Raises ValueError for a craft that is no X of four equal arms.
    """
    plant = env.unwrapped
    if plant.DRONE_MODEL.name != "CF2X":
        raise ValueError(f"drone_model: {plant.DRONE_MODEL.name}; must be four equal arms at 45 degrees, as CF2X has")
    force = (0.0, float(plant.KF * plant.MAX_RPM**2))
    return vehicle("gym-pybullet-drones", float(plant.M), plant.J, float(plant.L), force, float(plant.KM / plant.KF), lag_s)


def drag_per_s(env: Any) -> float:
    """Linear drag over mass at hover, 1/s: of the rotors where its physics have it, and the damping that PyBullet adds but in DYN.

    Of PyBullet's damping this is the part at rest; at 2 m/s it is three times as much. One that was changed with `changeDynamics` cannot
    be read: give drag_per_s to the control.
    """
    plant = env.unwrapped
    physics = plant.PHYSICS.name
    if physics == "DYN":
        return 0.0
    rotors_rad_s = 4.0 * plant.HOVER_RPM * 2.0 * np.pi / 60.0
    rotors = plant.DRAG_COEFF[0] * rotors_rad_s / plant.M if "DRAG" in physics else 0.0
    return float(rotors + _DAMPING_PER_S)


class RotorControl:
    """A control function with memory, at 500 Hz: observations and references in, rotor speeds out.

    Rotors of this package turn at once as they are told, and the law is certified for motors that lag: the speeds that come out are
    those of motors that lag by lag_s behind the law.

    env: a CtrlAviary with ctrl_freq=500; a flight begins where its step_counter is 0, as after reset
    law: any law of quatrack.Controller that gives motor forces
    lag_s: of these motors, s
    told_air: whether the law is told the drag at hover; it learns the air by itself otherwise
    told: further figures for the law, as keywords of quatrack.Controller
    """

    def __init__(
        self, env: Any, law: str = "quatrack", *, lag_s: float = LAG_S, told_air: bool = True, **told: Any
    ) -> None:
        self.vehicle = vehicle_of(env, lag_s)
        plant = env.unwrapped
        most = np.asarray(env.action_space.high)
        if most.shape != (plant.NUM_DRONES, 4) or not np.allclose(most, plant.MAX_RPM):
            raise ValueError(f"action_space: {env.action_space}; must be rotor speeds, as CtrlAviary takes them")
        if told_air:
            told = {"drag_per_s": drag_per_s(env)} | told
        told = {"mass_kg": float(plant.GRAVITY) / GRAVITY_M_S2} | told
        self.controller = Controller(law, self.vehicle, **told)
        if plant.CTRL_FREQ != self.controller.rate_hz:
            rate = self.controller.rate_hz
            raise ValueError(f"ctrl_freq: {plant.CTRL_FREQ}; the law is made for {rate} Hz: pyb_freq={2 * rate}, ctrl_freq={rate}")
        self._plant = plant
        periods = 1.0 / (self.controller.rate_hz * lag_s)
        # The share of a difference that is left after a period, and its mean over the period.
        self._left, self._mean = np.exp(-periods), -np.expm1(-periods) / periods
        self._forces = self._hover()

    def _hover(self) -> Array:
        """Forces at hover, N, (num_drones, 4)."""
        return np.full((self._plant.NUM_DRONES, 4), 0.25 * float(self._plant.GRAVITY))

    def __call__(self, obs: ArrayLike, reference: Reference) -> Array:
        """Rotor speeds for `step`, RPM, of shape (num_drones, 4).

        obs: (num_drones, 20), as `reset` and `step` give them; reference: of as many rows, or of one for all
        """
        obs = np.asarray(obs, dtype=float)
        if obs.shape != (self._plant.NUM_DRONES, 20):
            raise ValueError(f"obs: of shape {obs.shape}; must be ({self._plant.NUM_DRONES}, 20)")
        if self._plant.step_counter == 0:
            # Another flight.
            self.controller.reset()
            self._forces = self._hover()
        pos, quat, vel, ang_vel = obs[:, 0:3], obs[:, 3:7], obs[:, 10:13], obs[:, 13:16]
        state = State(pos, scalar_first(quat), vel, _in_body(quat, ang_vel))
        asked = np.asarray(self.controller.step(state, reference).motor_forces, dtype=float)
        behind = self._forces - asked
        self._forces = asked + self._left * behind
        speeds: Array = np.sqrt((asked + self._mean * behind) / self._plant.KF)
        return speeds


def _in_body(quat: Array, vectors: Array) -> Array:
    """Vectors of the world (N, 3) in the body's axes, of attitudes x y z w (N, 4)."""
    axis, w = -quat[:, :3], quat[:, 3:]
    twice = 2.0 * np.cross(axis, vectors)
    turned: Array = vectors + w * twice + np.cross(axis, twice)
    return turned
