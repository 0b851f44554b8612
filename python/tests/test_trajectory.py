"""Pieces, files and plans."""

import numpy as np
import pytest

import quatrack as q
from conftest import ROOT


def test_pieces_go_out_and_come_back():
    mild = q.Trajectory.paper("mild")
    again = q.Trajectory(mild.durations, mild.coefficients)
    assert np.array_equal(again.at(3.3).position, mild.at(3.3).position)
    assert len(mild) == len(mild.durations) and mild.coefficients.shape == (len(mild), 4, 8)
    assert q.Trajectory.from_csv(mild.to_csv()).duration == pytest.approx(mild.duration, rel=1e-12)


def test_derivatives_are_those_of_the_polynomials():
    line = q.Trajectory([2.0], np.arange(32.0).reshape(1, 4, 8) * 1e-2)
    t = np.array([0.0, 0.5, 1.5])
    at = line.at(t)
    x = np.polynomial.Polynomial(np.arange(8) * 1e-2)
    for order, name in enumerate(("position", "velocity", "acceleration", "jerk", "snap", "crackle")):
        assert getattr(at, name)[:, 0] == pytest.approx(x.deriv(order)(t) if order else x(t), rel=1e-12), name
    assert at.heading == pytest.approx(np.polynomial.Polynomial(np.arange(24, 32) * 1e-2)(t))


def test_a_plan_passes_its_waypoints():
    trajectory = q.plan(ROOT / "plans" / "aggressive.toml")
    stored = q.Trajectory.paper("aggressive")
    times = np.linspace(0.0, 12.0, 50)
    # The stored one is the same curve in single precision.
    assert np.abs(trajectory.at(times).position - stored.at(times).position).max() < 1e-5


def test_an_infeasible_plan_names_its_tight_bounds():
    import tomllib

    plan = tomllib.loads((ROOT / "plans" / "aggressive.toml").read_text())
    plan["bounds"] = plan.get("bounds", {}) | {"velocity_m_s": 0.05}
    with pytest.raises(q.QuatrackError, match="^plan: "):
        q.plan(plan)
    plan["bounds"] = plan
    with pytest.raises(TypeError, match="deeper than any file is"):
        q.plan(plan)


def test_a_refit_goes_into_a_crazyflies_memory():
    mild = q.Trajectory.paper("mild")
    fitted = mild.refit(31)
    times = np.linspace(0.0, 30.0, 300)
    assert len(fitted) <= 31
    assert np.abs(fitted.at(times).position - mild.at(times).position).max() < 5e-3


def test_trajectories_that_cannot_be_flown_are_refused():
    jump = np.zeros((2, 4, 8))
    jump[1, 0, 0] = 1.0
    with pytest.raises(q.QuatrackError, match="x jumps by 1.0"):
        q.Trajectory([1.0, 1.0], jump)
    with pytest.raises(ValueError, match="coefficients: 2 pieces, but durations has 3"):
        q.Trajectory([1.0] * 3, jump)
    with pytest.raises(q.QuatrackError, match="none.csv: cannot be read"):
        q.Trajectory.load("none.csv")


def test_times_are_numbers():
    mild = q.Trajectory.paper("mild")
    course = q.Scenario({"vehicle": "crazyflie-2.1", "course": "eight"}).course()
    for follows in (mild, course):
        with pytest.raises(ValueError, match="^time: nan; must be a number, s"):
            follows.at(np.nan)
        with pytest.raises(ValueError, match="^time: nan in row 2; must be a number, s"):
            follows.at([0.0, 1.0, np.nan])
    # A trajectory is at rest beyond its ends, however far; an eight has no place at infinity.
    ends = mild.at([-np.inf, np.inf])
    assert np.array_equal(ends.position, mild.at([-1.0, mild.duration + 1.0]).position) and (ends.velocity == 0.0).all()
    with pytest.raises(ValueError, match="^time: inf; must be finite"):
        course.at([1.0, np.inf])


def test_a_player_gives_the_trajectorys_samples():
    mild = q.Trajectory.paper("mild")
    player = mild.player(500)
    assert player.end_tick == 15000
    # Single precision of a few metres.
    assert player.reference(1234).position == pytest.approx(mild.at(1234 / 500).position, abs=2e-6)


def test_the_flat_map_gives_the_state_of_a_reference():
    state = q.Reference([0.0, 0.0, 1.0], acceleration=[0.0, 0.0, 1.0], heading=0.5).state
    assert state.attitude == pytest.approx([np.cos(0.25), 0.0, 0.0, np.sin(0.25)], abs=1e-6)
    assert q.Reference([0.0, 0.0, 1.0], acceleration=[0.0, 0.0, 1.0]).thrust == pytest.approx(10.81, abs=1e-5)
    with pytest.raises(q.QuatrackError, match="free fall"):
        _ = q.Reference([0.0, 0.0, 1.0], acceleration=[0.0, 0.0, -9.81]).state
