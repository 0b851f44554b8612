"""The core's filter."""

import numpy as np
import pytest

import quatrack as q


def test_a_hovering_craft_stays_where_it_is():
    filter = q.Estimator(q.State([0.0, 0.0, 1.0]))
    for _ in range(100):
        filter.predict([0.0, 0.0, 0.0], [0.0, 0.0, 9.81], 0.01)
    # Rounding of 9.81 in single precision over a second.
    assert filter.state.position == pytest.approx([0.0, 0.0, 1.0], abs=1e-5)


def test_positions_pull_the_estimate_and_its_covariance_shrinks():
    filter = q.Estimator(q.State([0.0, 0.0, 1.0]))
    before = filter.covariance
    for _ in range(50):
        filter.predict([0.0, 0.0, 0.0], [0.0, 0.0, 9.81], 0.01)
        innovation = filter.update_position([0.1, 0.0, 1.0], 0.001)
    assert innovation["is_taken"] and innovation["difference"].shape == (3,)
    assert filter.state.position[0] == pytest.approx(0.1, abs=1e-3)
    assert filter.covariance[0, 0] < 1e-4 * before[0, 0]
    assert np.allclose(filter.covariance, filter.covariance.T)


def test_an_outlier_is_not_taken():
    filter = q.Estimator(q.State([0.0, 0.0, 1.0]), gate="99.9%", deviation_at_start=[0.01, 0.01, 0.01, 0.01])
    assert not filter.update_position([5.0, 0.0, 1.0], 0.001)["is_taken"]
    assert filter.update_height(1.0, 0.01)["is_taken"] and filter.update_velocity([0.0] * 3, 0.1)["is_taken"]
    assert filter.update_attitude([1.0, 0.0, 0.0, 0.0], 0.01)["is_taken"]
    assert filter.update_distance([0.0, 3.0, 1.0], 3.0, 0.1)["is_taken"]


def test_impossible_measurements_are_refused():
    filter = q.Estimator(q.State([0.0, 0.0, 1.0]))
    with pytest.raises(q.QuatrackError):
        filter.predict([np.nan, 0.0, 0.0], [0.0, 0.0, 9.81], 0.01)
    with pytest.raises(ValueError, match="force: sideways; there are thrust-axis, all-axes"):
        q.Estimator(q.State([0.0, 0.0, 1.0]), force="sideways")
