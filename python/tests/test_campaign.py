"""Campaigns: rows, their repetition, and their end by Ctrl-C."""

import numpy as np
import pytest

import quatrack as q

VARIED = {
    "vehicle": "crazyflie-2.1-brushless",
    "course": "hover",
    "duration_s": 0.5,
    "noise": {"position_m": 0.001},
    "vary": {"errors": {"mass_factor": {"uniform": [0.95, 1.05]}}},
}


def test_rows_come_as_columns_and_are_the_same_again(tmp_path):
    rows = q.campaign(VARIED, 5, tmp_path / "one", laws=["quatrack", "lee"], seed=3)
    assert rows["run"].tolist() == [0, 0, 1, 1, 2, 2, 3, 3, 4, 4] and rows["law"][:2] == ["quatrack", "lee"]
    assert (rows["iae_m_s"] > 0).all() and set(rows["outcome"]) == {"flown"}
    drawn = rows["errors.mass_factor"]
    assert ((0.95 <= drawn) & (drawn <= 1.05)).all() and len(np.unique(drawn)) == 5
    again = q.campaign(VARIED, 5, tmp_path / "two", laws=["quatrack", "lee"], seed=3, threads=1)
    assert np.array_equal(again["iae_m_s"], rows["iae_m_s"])
    assert (tmp_path / "one" / "rows.parquet").exists()


def test_folders_that_are_no_campaign_are_refused(tmp_path):
    with pytest.raises(q.QuatrackError, match="no such law"):
        q.campaign(VARIED, 5, tmp_path / "one", laws=["albatross"])
    with pytest.raises(ValueError, match="at least 1"):
        q.campaign(VARIED, 0, tmp_path / "one")
