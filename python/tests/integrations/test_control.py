"""python-control's systems in and out, and its own solutions."""

import numpy as np
import pytest

from needed import need

need("control")

import control as ct

import quatrack as q
from quatrack.integrations import control as ours


def test_our_gain_is_theirs_in_continuous_and_in_sampled_time():
    system = ct.ss([[0.0, 1.0], [-2.0, -0.5]], [[0.0], [1.0]], np.eye(2), np.zeros((2, 1)))
    weights = np.diag([3.0, 1.0]), np.array([[0.5]])
    gain, p, poles = ct.lqr(system, *weights)
    feedback = ours.lqr(system, *weights)
    # Theirs is good to 1e-9 or so.
    assert feedback.gain == pytest.approx(gain, rel=1e-8) and feedback.p == pytest.approx(p, rel=1e-8)
    sampled = ct.c2d(system, 0.1)
    assert ours.lqr(sampled, *weights).gain == pytest.approx(ct.dlqr(sampled, *weights)[0], rel=1e-8)
    with pytest.raises(ValueError, match="sampled"):
        ours.lqr(system, *weights, np.zeros((2, 1)))


def test_the_papers_gain_closes_the_papers_loop():
    system = ours.hover()
    gain = np.asarray(q.GainTable.builtin("lqr-e").gain, dtype=float)
    loop = ours.closed_loop(system, gain)
    assert loop.poles().real.max() < -0.5
    static = ours.gain_of(q.GainTable.builtin("lqr-e"))
    feedback = ct.feedback(system, static, sign=1)
    assert np.sort(feedback.poles().real) == pytest.approx(np.sort(loop.poles().real), rel=1e-6)
    assert ours.certify(system, gain, 500)["sampled"]["spectral_radius"] < 1.0


def test_a_vehicles_model_reaches_to_its_motors():
    system = ours.hover("crazyflie-2.1-brushless")
    assert system.A.shape == (16, 16) and system.B.shape == (16, 4)
    # Four lags.
    assert sum(np.isclose(system.poles(), -1.0 / 0.05)) == 4


def test_gains_along_a_trajectory_are_no_system():
    with pytest.raises(ValueError, match="along a trajectory"):
        ours.gain_of(q.GainTable.builtin("along-mild"))
