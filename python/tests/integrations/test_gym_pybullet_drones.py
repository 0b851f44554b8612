"""gym-pybullet-drones' own environment, and its own controller."""

import warnings

import numpy as np
import pytest

from needed import need

need("gym-pybullet-drones", "pybullet")

import pybullet
from gym_pybullet_drones.envs.CtrlAviary import CtrlAviary
from gym_pybullet_drones.envs.HoverAviary import HoverAviary
from gym_pybullet_drones.utils.enums import DroneModel, Physics

import quatrack as q
from quatrack.integrations import _table
from quatrack.integrations.gym_pybullet_drones import RotorControl, drag_per_s, vehicle_of

# Far above the ground, and far enough apart.
PLACES = np.array([[0.0, 0.0, 5.0], [3.0, 1.0, 6.0], [-2.0, 2.0, 4.0]])

def made(kind, **given):
    with warnings.catch_warnings():
        # Bounds of its spaces are rounded.
        warnings.simplefilter("ignore")
        return kind(**given)


def environment(drones=1, **changed):
    given = {
        "num_drones": drones,
        "initial_xyzs": PLACES[:drones],
        "physics": Physics.PYB_DRAG,
        "pyb_freq": 1000,
        "ctrl_freq": 500,
    }
    return made(CtrlAviary, **given | changed)


def at_hover(physics=Physics.PYB, **changed):
    """An environment after one step at hover, which its drag needs."""
    env = environment(physics=physics, **changed)
    env.reset()
    obs, *_ = env.step(np.full((1, 4), env.HOVER_RPM))
    return env, obs


@pytest.mark.parametrize("physics", list(Physics), ids=lambda physics: physics.name)
def test_at_hover_it_stays(physics):
    env = environment(physics=physics)
    control = RotorControl(env)
    obs, _ = env.reset()
    first = control(obs, q.Reference(PLACES[0]))
    # Of its weight with its gravity, in single precision.
    assert first == pytest.approx(env.HOVER_RPM, rel=1e-6)
    for _ in range(250):
        obs, *_ = env.step(control(obs, q.Reference(PLACES[0])))
    # Half a second on, within micrometres: five metres up the ground lifts by a hundred thousandth of the weight.
    assert np.abs(obs[0, :3] - PLACES[0]).max() < 1e-5


@pytest.mark.parametrize("physics", [Physics.PYB, Physics.DYN], ids=["PYB", "DYN"])
def test_forces_give_the_torques_that_they_are_meant_to(physics):
    env = environment(physics=physics, pyb_freq=500)
    env.reset()
    speeds = env.HOVER_RPM * np.array([[1.01, 1.02, 0.97, 1.03]])
    obs, *_ = env.step(speeds)
    thrust, *torque = vehicle_of(env).mixing @ (env.KF * speeds[0] ** 2)
    # From rest, over one step; its rotors are 0.028 m from either axis, and its arm of 0.0397 m is rounded.
    assert obs[0, 12] / 0.002 == pytest.approx(thrust / env.M - env.G, rel=1e-6)
    assert env.J @ obs[0, 13:16] / 0.002 == pytest.approx(torque, rel=3e-3)


@pytest.mark.parametrize("physics", [Physics.PYB, Physics.DYN], ids=["PYB", "DYN"])
@pytest.mark.parametrize("heading", [0.0, 2.0])
def test_every_turn_is_turned_back(physics, heading):
    angles = np.array([[0.02, -0.04, heading + 0.03]])
    env = environment(physics=physics, initial_rpys=angles)
    control = RotorControl(env)
    obs, _ = env.reset()
    obs, *_ = env.step(control(obs, q.Reference(PLACES[0], heading=heading)))
    axes = np.reshape(pybullet.getMatrixFromQuaternion(obs[0, 3:7]), (3, 3))
    assert (np.sign(axes.T @ obs[0, 13:16]) == [-1, 1, -1]).all()


def test_rates_of_the_world_frame_are_turned_to_the_body():
    # Upright, and with its nose to the left: its roll is about the world's y.
    env = environment(initial_rpys=np.array([[0.0, 0.0, np.pi / 2]]))
    control = RotorControl(env)
    obs, _ = env.reset()
    pybullet.resetBaseVelocity(env.DRONE_IDS[0], [0, 0, 0], [0, 2, 0], physicsClientId=env.CLIENT)
    obs[0, 13:16] = [0, 2, 0]
    speeds = control(obs, q.Reference(PLACES[0], heading=np.pi / 2))[0]
    # Its left side comes up: M1 and M2, on the right, give more, both the same.
    assert speeds[0] == pytest.approx(speeds[1], rel=1e-6) and speeds[2] == pytest.approx(speeds[3], rel=1e-6)
    assert speeds[0] > speeds[2] + 100.0


@pytest.mark.parametrize("physics", list(Physics), ids=lambda physics: physics.name)
def test_drag_at_hover_is_that_of_the_plant(physics):
    env, _ = at_hover(physics)
    slow = 0.001
    pybullet.resetBaseVelocity(env.DRONE_IDS[0], [slow, 0, 0], [0, 0, 0], physicsClientId=env.CLIENT)
    obs, *_ = env.step(np.full((1, 4), env.HOVER_RPM))
    braked = (slow - obs[0, 10]) / (slow * 0.002)
    # It slows down in these two milliseconds, and the damping grows with the speed: by a thousandth, each.
    assert braked == pytest.approx(drag_per_s(env), rel=2e-3, abs=1e-9)


def test_pybullets_damping_grows_with_the_speed():
    env, _ = at_hover()
    pybullet.resetBaseVelocity(env.DRONE_IDS[0], [2, 0, 0], [0, 0, 0], physicsClientId=env.CLIENT)
    obs, *_ = env.step(np.full((1, 4), env.HOVER_RPM))
    assert (2.0 - obs[0, 10]) / (2.0 * 0.002) == pytest.approx(0.04 * 3.0, rel=5e-3)


def test_several_drones_fly_as_one_alone():
    goals = PLACES + [0.3, -0.2, 0.1]

    def flown(env, which):
        control = RotorControl(env)
        obs, _ = env.reset()
        for _ in range(300):
            obs, *_ = env.step(control(obs, q.Reference(goals[which])))
        return obs

    together = flown(environment(3), slice(None))
    alone = flown(environment(1, initial_xyzs=PLACES[1:2]), slice(1, 2))
    assert together.shape == (3, 20) and np.array_equal(together[1], alone[0])
    # They began 0.37 m away, 0.6 s ago.
    assert np.linalg.norm(together[:, :3] - goals, axis=1).max() < 0.12


def test_a_reset_begins_another_flight():
    env = environment()
    control = RotorControl(env)
    flights = []
    for _ in range(2):
        obs, _ = env.reset()
        for _ in range(50):
            obs, *_ = env.step(control(obs, q.Reference(PLACES[0] + [0.1, 0.0, 0.0])))
        flights.append(obs)
    assert np.array_equal(*flights)


def test_what_the_law_is_not_made_for_is_refused():
    with pytest.raises(ValueError, match="ctrl_freq: 240; .*ctrl_freq=500"):
        RotorControl(environment(pyb_freq=240, ctrl_freq=240))
    with pytest.raises(ValueError, match="drone_model: CF2P"):
        RotorControl(environment(drone_model=DroneModel.CF2P))
    with pytest.raises(ValueError, match="drone_model: RACE"):
        RotorControl(environment(drone_model=DroneModel.RACE))
    with pytest.raises(ValueError, match="action_space: .*CtrlAviary"):
        RotorControl(made(HoverAviary, pyb_freq=1000, ctrl_freq=500))
    env = environment(2)
    obs, _ = env.reset()
    with pytest.raises(ValueError, match=r"obs: of shape \(1, 20\); must be \(2, 20\)"):
        RotorControl(env)(obs[:1], q.Reference(PLACES[0]))


def test_the_eight_flies_nearer_than_under_its_own_controller():
    (row,) = _table.gym_pybullet_drones(_table.Flown.eight(1.0, up_to_speed=True))
    assert row.is_won(), row


@pytest.mark.heavy
def test_the_eight_flies_nearer_over_the_whole_course():
    (row,) = _table.gym_pybullet_drones(_table.Flown.eight(12.0))
    assert row.is_won(), row
