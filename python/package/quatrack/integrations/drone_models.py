"""Rotor commands for the models of drone-models, for any number of drones at once.

    dynamics = drone_models.parametrize(drone_models.first_principles.dynamics, "cf21B_500")
    control = RotorControl("cf21B_500")
    rotor_vel = control(pos, quat, vel, ang_vel, reference)      # RPM, to be given to dynamics at 500 Hz

drone-models numbers rotors as the firmware does, writes quaternions x y z w, and takes rotor speeds in revolutions a minute.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from quatrack import Controller, Reference, State, Vehicle
from quatrack.integrations._craft import GRAVITY_M_S2, Array, scalar_first, vehicle


def parameters(drone: str) -> dict[str, Any]:
    """All figures that drone-models has of a drone, SI and RPM."""
    from drone_models.core import load_params

    return dict(load_params("first_principles", drone))


def hover_rpm(p: Mapping[str, Any]) -> float:
    """Speed of each rotor at hover, RPM."""
    return float(rpm_of(np.array([0.25 * p["mass"] * GRAVITY_M_S2]), p)[0])


def rpm_of(forces: ArrayLike, p: Mapping[str, Any]) -> Array:
    """Rotor speeds that give forces (N): of f = c + b rpm + a rpm^2 the larger."""
    c, b, a = np.asarray(p["rpm2thrust"], dtype=float)
    speeds: Array = (-b + np.sqrt(b**2 - 4.0 * a * (c - np.asarray(forces, dtype=float)))) / (2.0 * a)
    return speeds


def lag_s(p: Mapping[str, Any]) -> float:
    """Time constant of the thrust, s: as it was fitted, or the mean of rise and fall of the speed about hover."""
    if "thrust_dyn_coef" in p:
        return 1.0 / float(p["thrust_dyn_coef"])
    rise, rise_square, fall, fall_square = np.asarray(p["rotor_dyn_coef"], dtype=float)
    twice = 2.0 * hover_rpm(p)
    return float(0.5 / (rise + twice * rise_square) + 0.5 / (fall + twice * fall_square))


def vehicle_of(drone: str, p: Mapping[str, Any]) -> Vehicle:
    """The vehicle of such figures."""
    rpm = hover_rpm(p)
    c, b, a = np.asarray(p["rpm2torque"], dtype=float)
    torque_per_thrust = (c + b * rpm + a * rpm**2) / (0.25 * p["mass"] * GRAVITY_M_S2)
    # L is the lever, not the arm.
    arm = np.sqrt(2.0) * float(p["L"])
    force = (float(p["thrust_min"]), float(p["thrust_max"]))
    return vehicle(drone, float(p["mass"]), p["J"], arm, force, float(torque_per_thrust), lag_s(p))


class RotorControl:
    """A control function with memory, at 500 Hz: states and references in, rotor speeds out.

    drone: its name
    law: any law of quatrack.Controller that gives motor forces
    told_air: whether the law is told the drag of the model; it learns the air by itself otherwise
    told: further figures for the law, as keywords of quatrack.Controller
    """

    def __init__(self, drone: str, law: str = "quatrack", *, told_air: bool = True, **told: Any) -> None:
        self._parameters = self._figures(drone)
        self.vehicle = vehicle_of(drone, self._parameters)
        if told_air:
            drag = -float(np.asarray(self._parameters["drag_matrix"])[0, 0]) / self.vehicle.mass_kg
            told = {"drag_per_s": drag} | told
        self.controller = Controller(law, self.vehicle, lag_s=self.vehicle.motor_lag_s, **told)

    def _figures(self, drone: str) -> dict[str, Any]:
        return parameters(drone)

    @property
    def hover_rpm(self) -> float:
        """Speed of each rotor at hover, RPM."""
        return hover_rpm(self._parameters)

    def __call__(self, pos: ArrayLike, quat: ArrayLike, vel: ArrayLike, ang_vel: ArrayLike, reference: Reference) -> Array:
        """Rotor speeds, RPM, of shape (..., 4).

        pos, vel, ang_vel: (..., 3), m, m/s, rad/s; quat: (..., 4), x y z w; reference: of as many rows, or of one for all
        """
        pos = np.asarray(pos, dtype=float)
        rows = pos.shape[:-1]

        def flat(quantity: ArrayLike) -> Array:
            array = np.asarray(quantity, dtype=float)
            return np.reshape(array, (-1, array.shape[-1])) if rows else array

        state = State(flat(pos), flat(scalar_first(quat)), flat(vel), flat(ang_vel))
        forces = self.controller.step(state, reference).motor_forces
        return np.reshape(rpm_of(forces, self._parameters), (*rows, 4))
