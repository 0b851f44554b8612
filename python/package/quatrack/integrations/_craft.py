"""A simulator's figures of its craft, as a vehicle of ours."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatrack import Vehicle

Array = NDArray[np.float64]

GRAVITY_M_S2 = 9.81


def vehicle(
    name: str,
    mass_kg: float,
    inertia_kg_m2: ArrayLike,
    arm_m: float,
    motor_force_n: tuple[float, float],
    torque_per_thrust_m: float,
    lag_s: float,
) -> Vehicle:
    """A vehicle of these figures, SI; inertia (3, 3), arm from the centre to a rotor's axis."""
    keys: dict[str, Any] = {
        "name": name,
        "body": {"mass_kg": mass_kg, "inertia_kg_m2": np.asarray(inertia_kg_m2, dtype=float).tolist()},
        "motors": {
            "arm_m": arm_m,
            "thrust_min_n": motor_force_n[0],
            "thrust_max_n": motor_force_n[1],
            "torque_per_thrust_m": torque_per_thrust_m,
            "lag_s": lag_s,
            "published_lag_s": [lag_s, lag_s],
        },
        # No law of motor forces looks at it.
        "limits": {"body_rates_rad_s": [20.0, 20.0, 10.0]},
    }
    return Vehicle(keys)


def scalar_first(quaternion: ArrayLike) -> Array:
    """w x y z of x y z w, along the last axis."""
    return np.roll(np.asarray(quaternion, dtype=float), 1, axis=-1)
