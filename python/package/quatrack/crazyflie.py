"""The firmware's structs for `quatrack.CrazyflieController`, by the names and in the units of `stabilizer_types.h`.

    controller = quatrack.CrazyflieController("crazyflie-2.1-brushless")
    setpoint = Setpoint.at([0.0, 0.0, 1.0])
    control = controller.step(setpoint, SensorData(), State.of(quatrack.State([0.0, 0.0, 0.9])))

Angles are degrees, the pitch angle of the opposite sign; accelerations g; quaternions by name. Other objects with these fields, as
those of the firmware's own Python bindings, do as well.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

import quatrack

DISABLED, ABSOLUTE, VELOCITY = 0, 1, 2


@dataclass
class Vector:
    """x, y, z."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


def _vector(name: str, array: ArrayLike) -> Vector:
    part = np.asarray(array, dtype=float)
    if part.shape != (3,):
        raise ValueError(f"{name}: shape {part.shape}; give (3,)")
    return Vector(*part.tolist())


@dataclass
class Attitude:
    """roll, pitch, yaw, degrees or degrees a second."""

    roll: float = 0.0
    pitch: float = 0.0
    yaw: float = 0.0


@dataclass
class Quaternion:
    """Body to world."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    w: float = 0.0


@dataclass
class Modes:
    """The parts of a setpoint that count: DISABLED, ABSOLUTE or VELOCITY each."""

    x: int = DISABLED
    y: int = DISABLED
    z: int = DISABLED
    roll: int = DISABLED
    pitch: int = DISABLED
    yaw: int = DISABLED
    quat: int = DISABLED


@dataclass
class Setpoint:
    """`setpoint_t`; as made here the motors are off."""

    timestamp: int = 0
    attitude: Attitude = field(default_factory=Attitude)
    attitudeRate: Attitude = field(default_factory=Attitude)
    attitudeQuaternion: Quaternion = field(default_factory=Quaternion)
    thrust: float = 0.0
    position: Vector = field(default_factory=Vector)
    velocity: Vector = field(default_factory=Vector)
    acceleration: Vector = field(default_factory=Vector)
    jerk: Vector = field(default_factory=Vector)
    velocity_body: bool = False
    mode: Modes = field(default_factory=Modes)

    @classmethod
    def at(
        cls,
        position: ArrayLike,
        velocity: ArrayLike = (0.0, 0.0, 0.0),
        acceleration: ArrayLike = (0.0, 0.0, 0.0),
        jerk: ArrayLike = (0.0, 0.0, 0.0),
        heading: float = 0.0,
    ) -> Setpoint:
        """As the high-level commander puts a point of a trajectory: SI, heading in rad."""
        return cls(
            attitude=Attitude(yaw=float(np.degrees(heading))),
            position=_vector("position", position),
            velocity=_vector("velocity", velocity),
            acceleration=_vector("acceleration", acceleration),
            jerk=_vector("jerk", jerk),
            mode=Modes(x=ABSOLUTE, y=ABSOLUTE, z=ABSOLUTE, yaw=ABSOLUTE),
        )


@dataclass
class SensorData:
    """`sensorData_t`, as far as the controller looks at it: accelerometer in g, gyroscope in degrees a second."""

    acc: Vector = field(default_factory=lambda: Vector(z=1.0))
    gyro: Vector = field(default_factory=Vector)

    @classmethod
    def of(cls, state: quatrack.State) -> SensorData:
        """The readings of a craft's sensors."""
        sensors = cls()
        if state.body_rates is not None:
            sensors.gyro = Vector(*np.degrees(state.body_rates).tolist())
        if state.specific_force is not None:
            sensors.acc = Vector(*(state.specific_force / 9.81).tolist())
        return sensors


@dataclass
class State:
    """`state_t`, the estimate."""

    attitude: Attitude = field(default_factory=Attitude)
    attitudeQuaternion: Quaternion = field(default_factory=lambda: Quaternion(w=1.0))
    position: Vector = field(default_factory=Vector)
    velocity: Vector = field(default_factory=Vector)
    acc: Vector = field(default_factory=Vector)

    @classmethod
    def of(cls, state: quatrack.State) -> State:
        """Of a craft."""
        w, x, y, z = state.attitude.tolist()
        roll = np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
        pitch = np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0))
        yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
        return cls(
            attitude=Attitude(*(float(np.degrees(angle)) for angle in (roll, -pitch, yaw))),
            attitudeQuaternion=Quaternion(x, y, z, w),
            position=Vector(*state.position.tolist()),
            velocity=Vector(*state.velocity.tolist()),
        )
