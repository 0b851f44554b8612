"""The Crazyflie object as a controller of crazyswarm2's simulator, beside its own `pid`, `mellinger` and `brescianini`.

In `crazyflie_sim/crazyflie_sim/crazyflie_sil.py`, where the controllers are chosen by their names:

    elif controller_name == 'quatrack':
        from quatrack.integrations.crazyswarm2 import QuatrackBackend
        self.controller = QuatrackBackend(firm)

and `controller: quatrack` under `sim` in `server.yaml`. There is one controller in a process, as in a craft: a swarm is
simulated with the core's controller instead, `QuatrackBackend(firm, own=True)`, one for each craft.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from quatrack import Controller, CrazyflieController, Reference, State, Vehicle
from quatrack.integrations._craft import Array

# crazyswarm2's simulator flies this craft, and takes its motors for the firmware's without lag.
_MASS_KG = 0.034


class QuatrackBackend:
    """Called as the firmware's controllers are: (control, setpoint, sensors, state, tick). Writes `control`.

    firm: the module of the firmware's Python bindings, for the number of its control modes
    vehicle: the craft that the object is built for; the mass is the simulator's
    own: fly the core's cascade, one for each craft, instead of the object; setpoints must be positions then
    """

    def __init__(self, firm: Any, vehicle: str = "crazyflie-2.1", *, own: bool = False, mass_kg: float = _MASS_KG) -> None:
        self._firm = firm
        self._vehicle = Vehicle(vehicle)
        self._core = Controller("quatrack", vehicle, mass_kg=mass_kg, standing=True) if own else None
        self._object = None if own else CrazyflieController(vehicle, mass_kg=self._told(mass_kg))
        self._tick: int | None = None

    def _told(self, mass_kg: float) -> float:
        """The mass that the object has a table for, nearest to the simulator's."""
        own = self._vehicle.mass_kg
        return float(np.clip(mass_kg, 0.9001 * own, 1.0999 * own))

    def __call__(self, control: Any, setpoint: Any, sensors: Any, state: Any, tick: int) -> None:
        # The simulator calls twice a millisecond.
        if tick == self._tick:
            return
        self._tick = tick
        if self._object is not None:
            given = self._object.step(setpoint, sensors, state, tick)
            if given.normalizedForces is not None:
                control.controlMode = self._firm.controlModeForce
                for motor, force in enumerate(given.normalizedForces):
                    control.normalizedForces[motor] = force
            elif given.forceTorque is not None:
                control.controlMode = self._firm.controlModeForceTorque
                control.thrustSi, *torque = given.forceTorque
                control.torqueX, control.torqueY, control.torqueZ = torque
        elif tick % 2 == 0:
            self._step_core(control, setpoint, sensors, state)

    def _step_core(self, control: Any, setpoint: Any, sensors: Any, state: Any) -> None:
        assert self._core is not None
        q = state.attitudeQuaternion
        given = State(
            _vector(state.position),
            np.array([q.w, q.x, q.y, q.z]),
            _vector(state.velocity),
            np.radians(_vector(sensors.gyro)),
        )
        wanted = Reference(
            _vector(setpoint.position),
            _vector(setpoint.velocity),
            _vector(setpoint.acceleration),
            _vector(setpoint.jerk) if hasattr(setpoint, "jerk") else None,
            heading=float(np.radians(setpoint.attitude.yaw)),
        )
        forces = self._core.step(given, wanted).motor_forces
        control.controlMode = self._firm.controlModeForce
        for motor, force in enumerate(forces / self._vehicle.motor_force_n[1]):
            control.normalizedForces[motor] = float(force)


def _vector(v: Any) -> Array:
    return np.array([v.x, v.y, v.z], dtype=float)
