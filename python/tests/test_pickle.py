"""Objects through pickle and copy: the same to the bit, or refused."""

import copy
import multiprocessing
import pickle

import numpy as np
import pytest

import quatrack as q
from conftest import ROOT, random_crafts

WAYS = [copy.copy, copy.deepcopy] + [
    lambda given, protocol=protocol: pickle.loads(pickle.dumps(given, protocol))
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1)
]
GUSTY = {
    "vehicle": "crazyflie-2.1-brushless",
    "duration_s": 0.5,
    "air": {"of": "vehicle", "gust_rms_m_s": 0.3},
    "noise": {"gyro_rad_s": 0.01},
}


@pytest.fixture(params=WAYS, ids=["copy", "deepcopy", *(f"pickle {n}" for n in range(pickle.HIGHEST_PROTOCOL + 1))])
def again(request):
    return request.param


def bits(value):
    """What two of them are compared by: NaN and -0 count as what they are."""
    if isinstance(value, np.ndarray):
        return value.dtype, value.shape, value.tobytes()
    if isinstance(value, (q.State, q.Vehicle)):
        return everything(value)
    return value


def everything(thing):
    names = [name for name in dir(type(thing)) if not name.startswith("_")]
    values = {name: getattr(thing, name) for name in names}
    return {name: bits(value) for name, value in values.items() if not callable(value)}


def test_states_and_references(again):
    state, reference = random_crafts(5)
    odd = q.State([np.nan, -0.0, np.inf], velocity=np.random.default_rng(1).normal(size=(3, 3)))
    for thing in (state, odd, q.State([0.1, 0.2, 0.3]), reference, q.Reference([0, 0, 1.0], snap=[0.1, 0.2, -0.0])):
        assert everything(again(thing)) == everything(thing)
    # What is left out stays left out: the laws fit snap and crackle.
    to_jerk = again(q.Reference([0.0, 0.0, 1.0], heading=0.3, heading_jerk=0.1))
    assert to_jerk.snap is None and again(q.State([0.0] * 3)).body_rates is None
    steps = [q.Controller("quatrack", "crazyflie-2.1").step(state, given) for given in (reference, again(reference))]
    assert bits(steps[0].motor_forces) == bits(steps[1].motor_forces)


def test_the_place_on_a_trajectory_goes_with_a_players_reference(again):
    controller = q.Controller(q.GainTable.builtin("along-aggressive"))
    reference = q.Trajectory.paper("aggressive").player(controller.rate_hz).reference(650)
    state = q.State(reference.position + 0.1, velocity=reference.velocity)
    assert everything(controller.step(state, again(reference))) == everything(controller.step(state, reference))
    without = q.Reference(reference.position, reference.velocity, reference.acceleration, reference.jerk)
    assert everything(controller.step(state, without)) != everything(controller.step(state, reference))


def test_vehicles_and_tables(again, tmp_path):
    text = (ROOT / "gains" / "vehicles" / "crazyflie-2.1.toml").read_text()
    path = tmp_path / "own.toml"
    path.write_text(text.replace('name = "crazyflie-2.1"', 'name = "own"').replace("0.029", "0.0290000000000000001"))
    own = q.Vehicle(path)
    path.unlink()
    for vehicle in (own, *map(q.Vehicle, q.Vehicle.names())):
        assert everything(again(vehicle)) == everything(vehicle)
        assert again(vehicle).__reduce__()[1] == vehicle.__reduce__()[1]
    # All figures in flight are there: the air too.
    assert again(q.Scenario(GUSTY)).vehicle.__reduce__()[1] == q.Scenario(GUSTY).vehicle.__reduce__()[1]
    for name in ("cascade-63ms", "along-mild"):
        table = q.GainTable.builtin(name)
        assert again(table).to_bytes() == table.to_bytes()


def test_trajectories(again):
    planned = q.plan(ROOT / "plans" / "aggressive.toml")
    for trajectory in (q.Trajectory.paper("mild"), planned):
        same = again(trajectory)
        assert everything(same) == everything(trajectory)
        times = np.linspace(-1.0, trajectory.duration + 1.0, 1001)
        assert everything(same.at(times)) == everything(trajectory.at(times))


def test_scenarios_fly_the_same(again, tmp_path):
    own = tmp_path / "own.toml"
    own.write_text((ROOT / "gains" / "vehicles" / "crazyflie-2.1.toml").read_text())
    (tmp_path / "scenario.toml").write_text('vehicle = "own.toml"\nduration_s = 0.5\ncourse = "hover"\n')
    of_file = q.Scenario(tmp_path / "scenario.toml")
    # The vehicle is taken along: its file is not read again.
    own.unlink()
    for scenario in (q.Scenario(GUSTY).with_seed(2**64 - 1), of_file):
        same = again(scenario)
        assert (str(same), everything(same)) == (str(scenario), everything(scenario))
        assert q.fly(same, "lee").to_csv() == q.fly(scenario, "lee").to_csv()


def test_a_course_beside_its_scenario_is_found(again, tmp_path):
    (tmp_path / "way.csv").write_text(q.Trajectory.paper("mild").to_csv())
    (tmp_path / "scenario.toml").write_text('vehicle = "crazyflie-2.1"\ncourse = "way.csv"\n')
    scenario = q.Scenario(tmp_path / "scenario.toml")
    assert again(scenario).course().duration == scenario.course().duration


def test_a_controller_is_not_copied_without_its_memory(again):
    with pytest.raises(TypeError, match="^Controller: its memory of the flight is not copied; make another from the same"):
        again(q.Controller("quatrack", "crazyflie-2.1"))


def error_of(scenario):
    return q.fly(scenario, "lee").iae


def test_processes_fly_scenarios():
    scenarios = [q.Scenario(GUSTY).with_seed(seed) for seed in (1, 2)]
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.map(error_of, scenarios) == [error_of(scenario) for scenario in scenarios]
