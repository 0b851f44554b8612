"""RotorPy's own environment, and its own controller."""

import numpy as np
import pytest

from needed import need

need("rotorpy")

from rotorpy.vehicles.crazyflie_params import quad_params as brushed
from rotorpy.vehicles.crazyfliebrushless_params import quad_params as brushless
from rotorpy.vehicles.multirotor import Multirotor

from quatrack.integrations import _table
from quatrack.integrations.rotorpy import QuatrackControl, drag_per_s, vehicle_of

AT_REST = {"x": np.array([0, 0, 1]), "v": np.zeros(3), "q": np.array([0, 0, 0, 1]), "w": np.zeros(3)}


def flat(**changed):
    keys = ("x", "x_dot", "x_ddot", "x_dddot", "x_ddddot")
    return {key: np.zeros(3) for key in keys} | {"x": np.array([0, 0, 1]), "yaw": 0, "yaw_dot": 0} | changed


@pytest.mark.parametrize("parameters", [brushed, brushless], ids=["2.1", "brushless"])
def test_forces_give_the_torques_that_they_are_meant_to(parameters):
    control = QuatrackControl(parameters)
    # Turned a little about every axis: every torque is asked for.
    state = AT_REST | {"q": np.array([0.01, -0.02, 0.015, 1.0]) / np.linalg.norm([0.01, -0.02, 0.015, 1.0])}
    command = control.update(0.0, state, flat())
    # Its own allocation of the same forces: from rotors in its order to thrust and moments.
    vehicle = Multirotor(parameters)
    theirs = vehicle.f_to_TM @ command["cmd_motor_thrusts"]
    assert theirs[0] == pytest.approx(command["cmd_thrust"], rel=1e-6)
    assert theirs[1:] == pytest.approx(command["cmd_moment"], rel=1e-3, abs=1e-9)
    # Against the error, each.
    assert (np.sign(theirs[1:]) == [-1, 1, -1]).all()
    assert command["cmd_motor_speeds"] == pytest.approx(np.sqrt(command["cmd_motor_thrusts"] / parameters["k_eta"]))


def test_whole_numbers_of_its_defaults_are_numbers():
    thrusts = QuatrackControl(brushless).update(0.0, AT_REST, flat())["cmd_motor_thrusts"]
    assert thrusts == pytest.approx(0.25 * 0.044 * 9.81, rel=1e-5)


def test_another_rate_is_refused():
    control = QuatrackControl(brushless)
    control.update(0.0, AT_REST, flat())
    with pytest.raises(ValueError, match="sim_rate=500"):
        control.update(0.01, AT_REST, flat())


def test_a_craft_that_is_no_x_is_refused():
    lame = brushless | {"rotor_directions": np.array([1, 1, 1, 1])}
    with pytest.raises(ValueError, match="rotor_directions"):
        vehicle_of(lame)
    # 4 k_d omega / m at hover.
    assert drag_per_s(brushless) == pytest.approx(4 * 5.09e-6 * np.sqrt(0.044 * 9.81 / 4 / 4.052e-8) / 0.044)


def test_the_eight_flies_nearer_than_under_its_own_controller():
    (row,) = _table.rotorpy(_table.Flown.eight(1.0, up_to_speed=True), ("Brushless",))
    assert row.is_won(), row


@pytest.mark.heavy
def test_the_eight_flies_nearer_on_any_craft():
    rows = list(_table.rotorpy(_table.Flown.eight(12.0)))
    assert len(rows) == 2 and all(row.is_won() for row in rows), rows
