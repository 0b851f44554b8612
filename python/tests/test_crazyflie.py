"""The object as the firmware calls it."""

import numpy as np
import pytest

import quatrack as q
from quatrack.crazyflie import Attitude, Modes, SensorData, Setpoint, State, Vector

CRAFT = "crazyflie-2.1-brushless"


def test_a_hover_takes_the_weight():
    controller = q.CrazyflieController(CRAFT)
    at = q.State([0.0, 0.0, 1.0])
    for _ in range(20):
        control = controller.step(Setpoint.at([0.0, 0.0, 1.0]), SensorData.of(at), State.of(at))
    vehicle = q.Vehicle(CRAFT)
    assert control.controlMode == 2 and control.forceTorque is None
    # Single precision, over the largest force.
    assert control.normalizedForces == pytest.approx([vehicle.hover_force_n / vehicle.motor_force_n[1]] * 4, rel=1e-4)
    assert controller.mode != 4


def test_a_setpoint_that_counts_for_nothing_stops_the_motors():
    controller = q.CrazyflieController(CRAFT)
    at = q.State([0.0, 0.0, 0.0])
    for _ in range(20):
        control = controller.step(Setpoint(), SensorData.of(at), State.of(at))
    assert control.normalizedForces == [0.0] * 4


def test_it_flies_to_a_goal():
    """A plant of ours between its control and its estimate."""
    controller, vehicle = q.CrazyflieController(CRAFT), q.Vehicle(CRAFT)
    plant = q.Plant({"vehicle": CRAFT}, q.State([0.0, 0.0, 1.0]))
    for _ in range(3000):
        state = plant.state
        setpoint = Setpoint.at([0.3, -0.2, 1.1])
        control = controller.step(setpoint, SensorData.of(state), State.of(state))
        plant.advance(np.array(control.normalizedForces) * vehicle.motor_force_n[1], 0.001)
    # Three seconds on, within centimetres.
    assert np.abs(plant.state.position - [0.3, -0.2, 1.1]).max() < 0.05


def turned_deg(stamp):
    """The turn after six seconds of setpoints at 500 Hz that turn at 45 degrees a second, without a rate."""
    controller, vehicle = q.CrazyflieController(CRAFT), q.Vehicle(CRAFT)
    plant = q.Plant({"vehicle": CRAFT}, q.State([0.0, 0.0, 1.0]))
    for step in range(6000):
        state = plant.state
        setpoint = Setpoint.at([0.0, 0.0, 1.0], heading=np.radians(0.045 * (step - step % 2)))
        setpoint.timestamp = stamp(step)
        control = controller.step(setpoint, SensorData.of(state), State.of(state))
        plant.advance(np.array(control.normalizedForces) * vehicle.motor_force_n[1], 0.001)
    return np.degrees(np.arctan2(*(plant.state.attitude[[3, 0]]))) * 2.0 % 360.0


def test_a_setpoint_without_a_stamp_is_dated_by_the_tick_at_which_it_changes():
    dated, undated = turned_deg(lambda step: 2 + step - step % 2), turned_deg(lambda step: 0)
    # A turn of 270 degrees, followed within the 2 ms of a setpoint and the law's own error in a turn.
    assert dated == pytest.approx(270.0, abs=2.0) and undated == pytest.approx(dated, abs=0.5)


def test_a_whole_parameter_takes_whole_numbers_alone():
    controller = q.CrazyflieController(CRAFT)
    for value in [300.0, -1.0, 1.9, float("nan")]:
        with pytest.raises(q.QuatrackError, match=f"table is {value:g}.*whole number from 0 to 255".replace("nan", "NaN")):
            controller.set("table", value)
    assert controller.get("table") == 0.0


def test_parameters_are_set_by_their_names_in_the_firmware():
    controller = q.CrazyflieController(CRAFT)
    controller.set("motorLag", 0.05)
    assert controller.get("motorLag") == pytest.approx(0.05)
    assert {"table", "posScale", "motorLag", "feedForward"} <= set(controller.parameters)
    with pytest.raises(KeyError, match="controller: no parameter of the group quatrack; there are table"):
        controller.set("controller", 6)
    controller.set("motorLag", 0.0)


def test_the_firmwares_signs_are_the_firmwares():
    pitched = q.State([0.0, 0.0, 1.0], [np.cos(0.1), 0.0, np.sin(0.1), 0.0])
    # Nose down is a negative angle there.
    assert State.of(pitched).attitude.pitch == pytest.approx(-np.degrees(0.2))
    assert SensorData.of(q.State([0.0] * 3, body_rates=[0.0, 1.0, 0.0])).gyro.y == pytest.approx(np.degrees(1.0))


def test_there_is_one_in_a_process():
    first = q.CrazyflieController(CRAFT)
    q.CrazyflieController(CRAFT)
    with pytest.raises(q.QuatrackError, match="another Crazyflie controller has been switched on"):
        first.step(Setpoint(), SensorData(), State())


def test_a_craft_without_a_table_is_refused():
    with pytest.raises(q.QuatrackError, match="no table for crazyflie-2.1-brushless told 0.1"):
        q.CrazyflieController(CRAFT, mass_kg=0.1)


def test_a_struct_without_its_fields_is_refused():
    controller = q.CrazyflieController(CRAFT)
    with pytest.raises(AttributeError):
        controller.step(Modes(), SensorData(), State())
    with pytest.raises(ValueError, match=r"^velocity: shape \(1, 3\); give \(3,\)"):
        Setpoint.at([0.0, 0.0, 1.0], np.zeros((1, 3)))
    assert Vector() == Vector(0.0, 0.0, 0.0) and Attitude().yaw == 0.0
