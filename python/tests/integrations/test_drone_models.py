"""The models of drone-models, and the controller of drone-controllers."""

import numpy as np
import pytest

from needed import need

need("drone-models", "drone-controllers")

import drone_models as models
from drone_models.first_principles import dynamics

import quatrack as q
from quatrack.integrations import _table
from quatrack.integrations.drone_models import RotorControl

DRONES = ["cf2x_L250", "cf2x_P250", "cf2x_T350", "cf21B_500"]


@pytest.mark.parametrize("drone", DRONES)
def test_at_hover_its_model_stays(drone):
    control, model = RotorControl(drone), models.parametrize(dynamics, drone)
    pos, quat, zero = np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(3)
    speeds = control(pos, quat, zero, zero, q.Reference(pos))
    *_, acceleration, turning, _ = model(pos, quat, zero, zero, speeds, rotor_vel=speeds)
    # Forces in single precision.
    assert np.abs(acceleration).max() < 1e-5 and np.abs(turning).max() < 1e-2


@pytest.mark.parametrize("drone", DRONES)
def test_every_turn_is_turned_back(drone):
    control, model = RotorControl(drone), models.parametrize(dynamics, drone)
    pos, zero = np.array([0.0, 0.0, 1.0]), np.zeros(3)
    quat = np.array([0.01, -0.02, 0.015, 1.0]) / np.linalg.norm([0.01, -0.02, 0.015, 1.0])
    speeds = control(pos, quat, zero, zero, q.Reference(pos))
    *_, turning, _ = model(pos, quat, zero, zero, speeds, rotor_vel=speeds)
    assert (np.sign(turning) == [-1, 1, -1]).all()


def test_worlds_of_drones_are_flown_at_once():
    control = RotorControl("cf21B_500")
    rng = np.random.default_rng(4)
    pos, quat = rng.normal(size=(5, 2, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (5, 2, 1))
    speeds = control(pos, quat, np.zeros((5, 2, 3)), np.zeros((5, 2, 3)), q.Reference([0.0, 0.0, 1.0]))
    assert speeds.shape == (5, 2, 4)
    alone = RotorControl("cf21B_500")(pos[3, 1], quat[3, 1], np.zeros(3), np.zeros(3), q.Reference([0.0, 0.0, 1.0]))
    assert np.array_equal(speeds[3, 1], alone)


def test_the_eight_flies_nearer_than_under_drone_controllers():
    (row,) = _table.drone_models(_table.Flown.eight(1.0, up_to_speed=True), ("cf21B_500",))
    assert row.is_won(), row


@pytest.mark.heavy
def test_the_eight_flies_nearer_on_any_drone():
    rows = list(_table.drone_models(_table.Flown.eight(12.0)))
    assert len(rows) == 4 and all(row.is_won() for row in rows), rows
