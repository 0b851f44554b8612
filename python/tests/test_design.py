"""Equations, certificates and tables."""

import numpy as np
import pytest

import quatrack as q

DOUBLE = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]]), np.eye(2), np.eye(1)


def test_the_double_integrators_gain_is_known():
    feedback = q.lqr(*DOUBLE)
    root = np.sqrt(3.0)
    # An ulp or two.
    assert np.abs(feedback.gain - [[1.0, root]]).max() < 1e-15
    assert np.abs(feedback.p - [[root, 1.0], [1.0, root]]).max() < 1e-15
    assert feedback.poles.dtype == complex and (feedback.poles.real < 0).all()
    assert feedback.relative_residual < 1e-15 and feedback.condition > 0


@pytest.mark.parametrize("dtype", [int, np.int8, np.uint16])
def test_matrices_of_whole_numbers_are_matrices(dtype):
    whole = [part.astype(dtype) for part in DOUBLE]
    assert np.array_equal(q.care(*whole).p, q.care(*DOUBLE).p)
    with pytest.raises(TypeError, match="^a: dtype bool"):
        q.care(whole[0].astype(bool), *whole[1:])


def test_equations_hold_to_the_last_digits():
    rng = np.random.default_rng(3)
    a, b = rng.normal(size=(6, 6)), rng.normal(size=(6, 2))
    q_, r = np.diag(rng.uniform(0.1, 2.0, 6)), np.diag(rng.uniform(0.1, 2.0, 2))
    p = q.care(a, b, q_, r).p
    residual = a.T @ p + p @ a - p @ b @ np.linalg.solve(r, b.T @ p) + q_
    # Rounding of P in a product: its size times 2^-53 times a few.
    assert np.abs(residual).max() < 1e-12 * np.abs(p).max()
    sampled = q.dlqr(a / 4, b, q_, r)
    p, k = sampled.p, sampled.gain
    residual = (a / 4).T @ p @ (a / 4 - b @ k) - p + q_
    assert np.abs(residual).max() < 1e-12 * np.abs(p).max()
    assert np.allclose(q.dare(a / 4, b, q_, r).p, p, rtol=1e-13)
    x = q.lyapunov(a, np.eye(6))
    assert np.abs(a.T @ x + x @ a + np.eye(6)).max() < 1e-12 * np.abs(x).max()
    x = q.stein(a / 4, np.eye(6))
    assert np.abs((a / 4).T @ x @ (a / 4) - x + np.eye(6)).max() < 1e-12 * np.abs(x).max()


def test_a_cross_weight_counts():
    a, b = np.array([[1.0, 0.1], [0.0, 1.0]]), np.array([[0.0], [0.1]])
    with_cross = q.dlqr(a, b, np.eye(2), np.eye(1), [[0.1], [0.2]])
    assert np.abs(with_cross.gain - q.dlqr(a, b, np.eye(2), np.eye(1)).gain).max() > 1e-2


def test_fortran_order_is_the_same_matrix():
    a = np.array([[0.0, 1.0], [-2.0, -3.0]])
    assert np.array_equal(q.lyapunov(np.asfortranarray(a), np.eye(2)), q.lyapunov(a, np.eye(2)))
    assert np.array_equal(q.lyapunov(a.T, np.eye(2)), q.lyapunov(np.ascontiguousarray(a.T), np.eye(2)))


@pytest.mark.parametrize(
    "call, text",
    [
        (lambda: q.lqr(np.zeros((2, 2)), np.zeros((2, 1)), np.eye(2), np.eye(1)), "stabilis"),
        (lambda: q.lqr(*DOUBLE[:2], -np.eye(2), np.eye(1)), "Q"),
        (lambda: q.lqr(*DOUBLE[:3], np.zeros((1, 1))), "R"),
        (lambda: q.lyapunov(np.diag([1.0, -1.0]), np.eye(2)), "eigenvalue"),
        (lambda: q.lyapunov(np.eye(2), np.eye(3)), "3"),
        (lambda: q.certify(*DOUBLE[:2], [[-1.0, -1.0]], 500), "stable"),
    ],
)
def test_equations_without_an_answer_are_refused(call, text):
    with pytest.raises(q.QuatrackError, match=text):
        call()


def test_the_poles_are_those_of_the_gain_that_is_returned():
    # Three fast modes and one input: the best poles are at 1e-4, and the rounding of the gain moves them out to tenths.
    fast, drive = np.diag([1e4, 2e4, 3e4]), np.ones((3, 1))
    feedback = q.dlqr(fast, drive, np.eye(3), np.eye(1))
    assert 0.01 < np.abs(feedback.poles).max() < 1.0
    assert np.abs(np.linalg.eigvals(fast - drive @ feedback.gain)).max() < 1.0
    with pytest.raises(q.QuatrackError, match="its gain rounded to 16 digits leaves the closed loop the pole"):
        q.dlqr(10 * fast, drive, np.eye(3), np.eye(1))


@pytest.mark.parametrize("factor", [1e-200, 1e200])
def test_sizes_that_hide_the_answer_are_named(factor):
    a, b = (factor * part for part in DOUBLE[:2])
    for solve in (q.lqr, q.care):
        with pytest.raises(q.QuatrackError, match="^A has the largest entry 1.000e-?200, .*from 1e-20 to 1e20: choose other units"):
            solve(a, b, *DOUBLE[2:])


def test_a_vector_is_no_matrix():
    with pytest.raises(ValueError, match=r"b: shape \(2,\); give a matrix"):
        q.lqr(DOUBLE[0], [0.0, 1.0], np.eye(2), np.eye(1))


def test_a_certificate_has_the_figures_of_a_gain():
    gain = q.lqr(*DOUBLE).gain
    certificate = q.certify(*DOUBLE[:2], gain, 500)
    assert certificate["rate_hz"] == 500.0
    assert certificate["sampled"]["spectral_radius"] < 1.0
    # (sqrt 3 s + 1) / s^2 crosses 1 at w^2 = (3 + sqrt 13) / 2 with a phase of atan(sqrt 3 w) - pi; holding takes half a period off
    # that, to first order.
    crossover = np.sqrt(0.5 * (3.0 + np.sqrt(13.0)))
    delay = np.arctan(np.sqrt(3.0) * crossover) / crossover - 0.001
    assert [limit["stable_to_s"] for limit in certificate["delay"]] == pytest.approx([delay, delay], abs=2e-5)


def test_a_table_goes_out_and_comes_back(tmp_path):
    table = q.GainTable.builtin("sampled-lqr-e")
    assert (table.kind, table.rate_hz, table.gain.shape) == ("equilibrium", 500, (4, 9))
    path = tmp_path / "table.bin"
    path.write_bytes(table.to_bytes())
    assert np.array_equal(q.GainTable.load(path).gain, table.gain)
    assert table.certificate["delay_max_s"] > 0.002
    assert q.GainTable.builtin("along-mild").gain.shape[1:] == (4, 9)


def test_a_damaged_table_is_refused(tmp_path):
    whole = bytearray(q.GainTable.builtin("lqr-e").to_bytes())
    whole[100] ^= 1
    with pytest.raises(q.QuatrackError):
        q.GainTable(bytes(whole))
    with pytest.raises(q.QuatrackError, match="cannot be read"):
        q.GainTable.load(tmp_path / "none.bin")
    with pytest.raises(q.QuatrackError, match="not built in; there are"):
        q.GainTable.builtin("none")


def test_a_design_becomes_the_table_that_is_built_in():
    from conftest import ROOT

    made = q.GainTable.design(ROOT / "gains" / "lqr-e.toml")
    assert made.to_bytes() == q.GainTable.builtin("lqr-e").to_bytes()
    with pytest.raises(q.QuatrackError, match="missing field"):
        q.GainTable.design({"vehicle": "crazyflie-2.1"})
