"""Figures of a craft out of a log of its flight."""

import pytest
import quatrack as q

# A Crazyflie 2.1 of 27 g in air, with noise as on a real one; the drag of a scenario is over the file's 29 g.
KNOWN = {
    "vehicle": "crazyflie-2.1",
    "estimator": "kalman",
    "seed": 3,
    "speed_m_s": 2.0,
    "duration_s": 40.0,
    "air": {"drag_per_s": [0.39, 0.43, 0.3], "moment_n_m_per_m_s": [3.8e-4, 4.3e-4], "gust_rms_m_s": 0.05},
    "errors": {"lag_ms": 67.0, "delay_ms": 5.0, "mass_factor": 0.931},
    "noise": {"gyro_rad_s": 0.01, "accelerometer_m_s2": 0.1, "position_m": 0.002},
    "told": {"lag_ms": 67.0},
}


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    path = tmp_path_factory.mktemp("identify") / "flight.csv"
    path.write_text(q.fly(KNOWN).to_log())
    return path


def test_a_known_craft_is_known_again(log):
    told = q.identify([log], mass_kg=0.027)
    # The accelerometer tells the drag of a smooth eight to a tenth; the rest roughly.
    for name, truth, share in [
        ("drag_x_per_s", 0.39 * 0.029 / 0.027, 0.1),
        ("drag_y_per_s", 0.43 * 0.029 / 0.027, 0.1),
        ("moment_x_n_m_per_m_s", 3.8e-4, 0.25),
    ]:
        figure = told.figures[name]
        assert figure is not None
        assert abs(figure["value"] / truth - 1.0) < share, name
        assert figure["low"] <= figure["value"] <= figure["high"]
    assert told.prediction["ours"]["position_m"] < told.prediction["no_angular_acceleration"]["position_m"]
    # Each figure is told or refused, never both.
    assert {name for name, figure in told.figures.items() if figure is None} == set(told.refused)
    vehicle = told.vehicle_toml
    assert 'name = "crazyflie-2.1-own"' in vehicle and "[identified.drag_x_per_s]" in vehicle
    assert "drag_x_per_s" in str(told)


def test_the_path_of_one_log_will_do(log):
    assert q.identify(str(log), mass_kg=0.027).figures == q.identify([log], mass_kg=0.027).figures
    for one in ("/nonexistent.csv", log.parent / "none.csv"):
        with pytest.raises(q.QuatrackError, match="/non[a-z]*.csv: cannot be read"):
            q.identify(one)
    with pytest.raises(TypeError, match="^logs: int; give a path, or a list of paths"):
        q.identify(3)
    with pytest.raises(TypeError, match="^logs: int among them; give a path, or a list of paths"):
        q.identify([log, 3])


def test_what_is_wrong_is_said_in_a_line(log):
    with pytest.raises(q.QuatrackError, match="27 g are 0.027"):
        q.identify([log], mass_kg=27.0)
    with pytest.raises(q.QuatrackError, match='no column "t" for the time'):
        q.identify([log], columns="nanobench")
