"""The core's controller for one craft and for many."""

import numpy as np
import pytest

import quatrack as q
from conftest import ROOT, random_crafts, row_of

CRAFT = "crazyflie-2.1-brushless"
LAWS = ["quatrack", "actuator-aware", "lqr-e", "lyap-e", "lqr-f", "lyap-f"]


def controllers():
    for law in LAWS:
        yield pytest.param(lambda law=law: q.Controller(law, CRAFT), id=law)
    for name in q.GainTable.names():
        yield pytest.param(lambda name=name: q.Controller(q.GainTable.builtin(name)), id=f"table {name}")


@pytest.mark.parametrize("make", list(controllers()))
def test_many_crafts_are_as_many_single_ones_to_the_bit(make):
    state, reference = random_crafts(600)
    many = make()
    steps = [many.step(state, reference) for _ in range(3)]
    for row in (0, 1, 299, 599):
        one, (one_state, one_reference) = make(), row_of(state, reference, row)
        for step in steps:
            alone = one.step(one_state, one_reference)
            for name in ("motor_forces", "thrust", "body_rates", "limited"):
                assert np.array_equal(getattr(alone, name), getattr(step, name)[row], equal_nan=True), name


def test_the_papers_law_gives_its_gains_command():
    controller = q.Controller("lqr-e")
    step = controller.step(q.State([0.0, 0.0, 0.99]), q.Reference([0.0, 0.0, 1.0]))
    # 10 mm too low at 100 1/s^2; single precision of 10.81.
    assert step.thrust == pytest.approx(9.81 + 100.0 * 0.01, abs=2e-6)
    assert np.isnan(step.motor_forces).all()


def test_at_rest_on_its_reference_a_craft_gets_its_weight():
    for law in LAWS:
        state = q.State([0.0, 0.0, 1.0], body_rates=[0.0, 0.0, 0.0])
        forces = q.Controller(law, CRAFT).step(state, q.Reference([0.0, 0.0, 1.0])).motor_forces
        assert forces == pytest.approx(q.Vehicle(CRAFT).hover_force_n, rel=1e-6), law


def test_a_reference_to_the_jerk_has_its_snap_fitted():
    eight = lambda t: q.Trajectory.paper("aggressive").at(t)
    exact, fitted = (q.Controller("quatrack", CRAFT) for _ in range(2))
    apart = []
    for step in range(200):
        at = eight(3.0 + 0.002 * step)
        to_jerk = q.Reference(at.position, at.velocity, at.acceleration, at.jerk)
        forces = [c.step(at.state, r).motor_forces for c, r in ((exact, at), (fitted, to_jerk))]
        apart.append(np.abs(forces[0] - forces[1]).max())
    # While it fits, the snap is missing; then the fit's own error is missing, a hundredth of the weight at most.
    assert max(apart[10:]) < 0.02 * q.Vehicle(CRAFT).hover_force_n < max(apart[:1]) + 1.0


def test_a_fault_names_the_craft_and_the_others_go_on():
    state, reference = random_crafts(600)
    position = state.position
    position[400, 1] = np.nan
    broken = q.State(position, state.attitude, state.velocity, state.body_rates, state.specific_force)
    controller = q.Controller("quatrack", CRAFT)
    with pytest.raises(q.QuatrackError, match=r"^craft 400: state: position holds NaN; distrust the estimator"):
        controller.step(broken, reference)
    forces = q.Controller("quatrack", CRAFT).step(broken, reference, on_fault="nan").motor_forces
    assert np.isnan(forces[400]).all() and np.isfinite(np.delete(forces, 400, axis=0)).all()


def test_reset_forgets_the_flight_of_some():
    state, reference = random_crafts(10)
    controller = q.Controller("quatrack", CRAFT)
    first = controller.step(state, reference).motor_forces
    controller.step(state, reference)
    controller.reset(np.arange(10) < 5)
    again = controller.step(state, reference).motor_forces
    assert np.array_equal(again[:5], first[:5]) and not np.array_equal(again[5:], first[5:])
    controller.reset()
    assert np.array_equal(controller.step(state, reference).motor_forces, first)


def test_steps_are_of_as_many_crafts_always():
    controller = q.Controller("quatrack", CRAFT)
    controller.step(*random_crafts(3))
    with pytest.raises(ValueError, match="4 crafts, but the steps before were of 3 crafts"):
        controller.step(*random_crafts(4))
    with pytest.raises(ValueError, match="reference: 4 rows, but state has 3"):
        controller.step(random_crafts(3)[0], random_crafts(4)[1])


def test_a_table_is_flown_on_its_own_vehicle():
    table = q.GainTable.builtin("cascade-brushless-50ms")
    assert q.Controller(table).rate_hz == 500
    with pytest.raises(q.QuatrackError, match="made for crazyflie-2.1-brushless .* make its table anew"):
        q.Controller(table, "crazyflie-2.1")


def test_an_own_craft_flies_the_certified_table_of_its_kind(tmp_path):
    built_in = (ROOT / "gains" / "vehicles" / "crazyflie-2.1-brushless.toml").read_text()
    own = tmp_path / "own.toml"
    own.write_text(built_in.replace('name = "crazyflie-2.1-brushless"', 'name = "own"'))
    controller = q.Controller("quatrack", str(own))
    state = q.State([0.0, 0.0, 1.0], body_rates=[0.0, 0.0, 0.0])
    forces = controller.step(state, q.Reference([0.0, 0.0, 1.0])).motor_forces
    assert forces == pytest.approx(q.Vehicle(CRAFT).hover_force_n, rel=1e-6)
    # The built-in one is designed for any lag; a table is certified for a range of them.
    q.Controller("quatrack", CRAFT, lag_s=0.005)
    with pytest.raises(q.QuatrackError, match="lag"):
        q.Controller("quatrack", str(own), lag_s=0.005)


@pytest.mark.parametrize(
    "told, text",
    [
        ({"lag_s": 0.2}, "^lag_s: 0.2; must be from 0.004 to 0.126 s, .*; leave it out for the vehicle's own"),
        ({"lag_s": float("nan")}, "^lag_s: NaN; must be"),
        ({"mass_kg": 0.3}, "^mass_kg: 0.3; must be from 0.0[0-9]* to 0.0[0-9]* kg, half to twice the vehicle's"),
        ({"drag_per_s": 1.5}, "^drag_per_s: 1.5; must be from 0 to 1 1/s"),
        ({"moment_n_m_per_m_s": [0.0, 0.1]}, "^moment_n_m_per_m_s: 0.1; must be from 0 to 0.002 N m per m/s"),
    ],
)
def test_a_controller_is_told_what_a_scenario_is_told(told, text):
    for law in (*LAWS, q.GainTable.builtin("cascade-brushless-50ms")):
        with pytest.raises(q.QuatrackError, match=text):
            q.Controller(law, CRAFT, **told)
    with pytest.raises(q.QuatrackError, match=text):
        q.Controller(q.GainTable.builtin("cascade-brushless-50ms"), **told)


def test_gains_along_a_trajectory_follow_its_player():
    controller = q.Controller(q.GainTable.builtin("along-aggressive"))
    player = q.Trajectory.paper("aggressive").player(controller.rate_hz)
    start, later = player.reference(0), player.reference(3000)
    # The same error: other gains at another place.
    off = np.array([0.1, -0.2, 0.05])
    rates = []
    for reference in (start, later):
        on = reference.state
        step = controller.step(q.State(on.position + off, on.attitude, on.velocity), reference)
        rates.append(step.body_rates - on.body_rates)
    assert np.abs(rates[0] - rates[1]).max() > 1e-3


def test_laws_and_crafts_that_are_not_there_are_named():
    with pytest.raises(q.QuatrackError, match="no such law; there are quatrack, actuator-aware"):
        q.Controller("pid", CRAFT)
    with pytest.raises(q.QuatrackError, match="name a vehicle"):
        q.Controller("quatrack")
    with pytest.raises(q.QuatrackError, match="crazyflie-9.*crazyflie-2.1"):
        q.Controller("quatrack", "crazyflie-9")
