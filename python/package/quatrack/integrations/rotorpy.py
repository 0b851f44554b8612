"""A controller for RotorPy's `Environment`: the cascade of the core, told the vehicle's parameters.

    from rotorpy.vehicles.crazyfliebrushless_params import quad_params
    from rotorpy.vehicles.multirotor import Multirotor
    from rotorpy.environments import Environment
    from quatrack.integrations.rotorpy import QuatrackControl

    Environment(Multirotor(quad_params), QuatrackControl(quad_params), trajectory, sim_rate=500).run(10)

RotorPy numbers rotors as its parameters do (its Crazyflies begin front left) and writes quaternions x y z w; both are converted.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from quatrack import Controller, Reference, State, Vehicle
from quatrack.integrations._craft import GRAVITY_M_S2, Array, scalar_first, vehicle

# Where M1 to M4 are, and which way their drag turns the craft.
_SIDES = ((1, -1), (-1, -1), (-1, 1), (1, 1))
_TURNS = (-1, 1, -1, 1)


def vehicle_of(quad_params: Mapping[str, Any]) -> tuple[Vehicle, Array]:
    """The vehicle of RotorPy's parameters, and which of their rotors are M1 to M4; whole numbers of shape (4,).

    Raises ValueError for a craft that is no X of four equal arms.
    """
    places = np.array([np.asarray(place, dtype=float) for place in quad_params["rotor_pos"].values()])
    turns = np.asarray(quad_params["rotor_directions"])
    if places.shape != (4, 3) or not np.allclose(np.abs(places[:, :2]), np.abs(places[0, 0]), rtol=1e-3):
        raise ValueError(f"rotor_pos: {places.tolist()}; must be four equal arms at 45 degrees")
    order = []
    for side, turn in zip(_SIDES, _TURNS, strict=True):
        (rotor,) = np.flatnonzero((np.sign(places[:, :2]) == side).all(axis=1))
        if turns[rotor] != turn:
            raise ValueError(f"rotor_directions: {turns.tolist()}; the rotor at {side} must turn the craft by {turn}")
        order.append(rotor)
    p = quad_params
    inertia = [[p["Ixx"], p["Ixy"], p["Ixz"]], [p["Ixy"], p["Iyy"], p["Iyz"]], [p["Ixz"], p["Iyz"], p["Izz"]]]
    force = [p["k_eta"] * p[key] ** 2 for key in ("rotor_speed_min", "rotor_speed_max")]
    arm = float(np.linalg.norm(places[0, :2]))
    # Its motors' speed lags with tau_m; so does, to first order at hover, their thrust.
    made = vehicle("rotorpy", p["mass"], _of_a_body(np.array(inertia, dtype=float)), arm, (force[0], force[1]), p["k_m"] / p["k_eta"], p["tau_m"])
    return made, np.array(order)


def _of_a_body(inertia: Array) -> Array:
    """The same inertia where a body has it. That of RotorPy's Crazyflie 2.1 exceeds about z the sum of those about x and y, by a hundredth,
    and is cut to that sum."""
    x, y, z = np.diag(inertia)
    # Room for the rounding of the sum.
    inertia[2, 2] = min(z, (x + y) * (1.0 - 1e-6))
    return inertia


def drag_per_s(quad_params: Mapping[str, Any]) -> float:
    """Linear drag over mass at hover of RotorPy's rotor drag, 1/s: each rotor brakes with k_d times its speed."""
    hover = np.sqrt(0.25 * quad_params["mass"] * GRAVITY_M_S2 / quad_params["k_eta"])
    return float(4.0 * quad_params["k_d"] * hover / quad_params["mass"])


class QuatrackControl:
    """A controller as RotorPy calls it, at 500 Hz: run `Environment` with sim_rate=500.

    quad_params: parameters of the vehicle
    law: any law of quatrack.Controller that gives motor forces
    told_air: whether the law is told the drag of the parameters; it learns the air by itself otherwise
    told: further figures for the law, as keywords of quatrack.Controller
    """

    def __init__(
        self, quad_params: Mapping[str, Any], law: str = "quatrack", *, told_air: bool = True, **told: Any
    ) -> None:
        self._vehicle, self._order = vehicle_of(quad_params)
        self._k_eta = float(quad_params["k_eta"])
        if told_air:
            told = {"drag_per_s": drag_per_s(quad_params)} | told
        self._told = {"lag_s": self._vehicle.motor_lag_s} | told
        self._controller = Controller(law, self._vehicle, **self._told)
        self._last: tuple[float, Array] | None = None

    def update(self, t: float, state: Mapping[str, Any], flat_output: Mapping[str, Any]) -> dict[str, Any]:
        """Commands for a state and flat outputs, with the keys of RotorPy's own controllers; SI, quaternions x y z w."""
        period = 1.0 / self._controller.rate_hz
        snap = np.asarray(flat_output["x_ddddot"], dtype=float)
        crackle = np.zeros(3)
        if self._last is not None:
            since = t - self._last[0]
            if since <= 0.0:
                # Another flight.
                self._controller.reset()
            elif abs(since - period) > 0.01 * period:
                raise ValueError(f"sim_rate: steps of {since} s; the law is made for {period} s, sim_rate=500")
            else:
                # RotorPy's flat outputs end with the snap.
                crackle = (snap - self._last[1]) / since
        self._last = (t, snap)
        attitude = scalar_first(state["q"])
        given = State(_floats(state["x"]), attitude, _floats(state["v"]), _floats(state["w"]))
        # Some of its trajectories turn.
        position, velocity, acceleration, jerk = (_floats(flat_output[key]) for key in ("x", "x_dot", "x_ddot", "x_dddot"))
        reference = Reference(
            position,
            velocity,
            acceleration,
            jerk,
            snap,
            crackle,
            heading=float(flat_output["yaw"]),
            heading_rate=float(flat_output["yaw_dot"]),
        )
        forces = np.asarray(self._controller.step(given, reference).motor_forces, dtype=float)
        thrust, *torque = self._vehicle.mixing @ forces
        theirs = np.empty(4)
        theirs[self._order] = forces
        flown = reference.state
        return {
            "cmd_motor_speeds": np.sqrt(theirs / self._k_eta),
            "cmd_motor_thrusts": theirs,
            "cmd_thrust": thrust,
            "cmd_moment": np.array(torque),
            "cmd_q": np.roll(flown.attitude, -1),
            "cmd_w": flown.body_rates,
            "cmd_v": reference.velocity,
            "cmd_acc": reference.acceleration + np.array([0.0, 0.0, GRAVITY_M_S2]),
        }


def _floats(value: Any) -> Array:
    """An array of floats: some of RotorPy's are of integers."""
    return np.asarray(value, dtype=float)
