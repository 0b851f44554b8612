"""The controller back end of crazyswarm2's simulator: its calls, with structs of the firmware's names; ROS is not needed."""

from types import SimpleNamespace

import pytest

import quatrack as q
from quatrack.crazyflie import SensorData, Setpoint, State
from quatrack.integrations.crazyswarm2 import QuatrackBackend

FIRMWARE = SimpleNamespace(controlModeForce=2, controlModeForceTorque=1)


@pytest.mark.parametrize("own", [False, True])
def test_it_writes_the_control_that_the_simulator_distributes(own):
    backend = QuatrackBackend(FIRMWARE, own=own)
    control = SimpleNamespace(controlMode=0, normalizedForces=[0.0] * 4)
    at = q.State([0.0, 0.0, 1.0], body_rates=[0.0, 0.0, 0.0])
    for call in range(40):
        # Twice a millisecond.
        backend(control, Setpoint.at([0.0, 0.0, 1.2]), SensorData.of(at), State.of(at), 100 + call // 2)
    assert control.controlMode == 2
    vehicle = q.Vehicle("crazyflie-2.1")
    forces = [force * vehicle.motor_force_n[1] for force in control.normalizedForces]
    # Told to rise it gives more than the weight, the same on all motors.
    assert min(forces) > 0.25 * 0.031 * 9.81 and max(forces) == pytest.approx(min(forces), rel=1e-4)
