"""Scenarios flown: by name, by table, by a law of one's own."""

import numpy as np
import pytest

import quatrack as q

SHORT = {"vehicle": "crazyflie-2.1-brushless", "course": "hover", "duration_s": 1.0}
EIGHT = {"vehicle": "crazyflie-2.1-brushless", "air": "vehicle", "duration_s": 2.0, "setpoints": "exact"}


def ours(vehicle, **told):
    """The core's controller as a law of one's own."""

    class Ours:
        rate_hz = 500

        def reset(self):
            self.controller = q.Controller("quatrack", vehicle, **told)

        def __call__(self, given):
            return self.controller.step(given.state, given.reference).motor_forces

    return Ours()


def test_the_controller_flown_from_python_is_the_law_by_its_name_to_the_bit():
    built_in = q.fly(EIGHT, "quatrack")
    own = q.fly(EIGHT, ours("crazyflie-2.1-brushless"))
    assert np.array_equal(own.state.position, built_in.state.position)
    assert own.iae == built_in.iae and own.law == "Ours"


def test_a_file_and_its_keys_fly_the_same(brushless, tmp_path):
    import tomllib

    keys = tomllib.loads(brushless.read_text()) | {"duration_s": 1.0}
    short = tmp_path / "short.toml"
    short.write_text('duration_s = 1.0\n' + brushless.read_text())
    assert q.fly(short).iae == q.fly(keys).iae == q.fly(q.Scenario(keys)).iae


def test_rows_come_every_10_ms_with_all_that_was_known():
    flight = q.fly(EIGHT)
    rows = len(flight)
    assert rows == 201 and np.allclose(np.diff(flight.time), 0.01)
    for name, width in (("target", 3), ("commands", 4), ("motor_forces", 4), ("wind", 3)):
        assert getattr(flight, name).shape == (rows, width), name
    error = np.linalg.norm(flight.state.position - flight.target, axis=1)
    assert flight.iae == pytest.approx(0.01 * error.sum(), rel=1e-12)
    assert flight.max_error == error.max()
    assert np.array_equal(flight.estimate.position, flight.state.position)
    header, *lines = flight.to_csv().splitlines()
    assert header.startswith("t_s,ref_x_m") and len(lines) == rows


def test_compare_prints_the_commands_table_and_flies_ones_own():
    table = q.compare(SHORT, ["quatrack", "lee", ("mine", ours("crazyflie-2.1-brushless"))])
    assert [law for law, *_ in table.rows] == ["quatrack", "lee", "mine"]
    assert str(table).splitlines()[2].split() == ["law", "IAE,", "m", "s", "most,", "m"]
    assert table.flights["mine"].iae == pytest.approx(table.flights["quatrack"].iae, abs=1e-9)


def test_all_laws_fly_where_none_is_asked_for():
    table = q.compare(SHORT)
    assert {"quatrack", "mellinger", "lee", "pid"} <= set(table.flights)


def test_a_table_of_the_cascade_flies():
    flight = q.fly(SHORT, q.GainTable.builtin("cascade-brushless-50ms"))
    assert flight.lost is None and flight.iae < 1e-3 and flight.law == "cascade-brushless-50ms"
    with pytest.raises(q.QuatrackError, match="a scenario takes a table of the cascade"):
        q.fly(SHORT, q.GainTable.builtin("lqr-e"))


def test_an_exception_of_a_law_ends_the_flight_and_is_raised():
    class Broken(Exception):
        pass

    def law(given):
        if given.time > 0.5:
            raise Broken("at half a second")
        return [0.1, 0.1, 0.1, 0.1]

    with pytest.raises(Broken, match="at half a second"):
        q.fly(SHORT, law)


@pytest.mark.parametrize(
    "given, error, text",
    [
        ([0.1] * 3, ValueError, r"motor forces of the law: shape \(3,\)"),
        ([np.nan] * 4, q.QuatrackError, "must be finite"),
        ("up", TypeError, "motor forces of the law"),
        (None, Exception, "motor forces of the law"),
    ],
)
def test_returns_that_are_no_forces_are_refused(given, error, text):
    with pytest.raises(error, match=text):
        q.fly(SHORT, lambda _: given)


def test_a_lost_flight_is_no_exception():
    flight = q.fly(SHORT, lambda _: [0.0] * 4)
    when, why = flight.lost
    assert flight.iae is None and 0.0 < when < 3.0 and "from the course" in why


def test_a_rate_divides_the_stabilizers():
    law = ours("crazyflie-2.1-brushless")
    law.rate_hz = 300
    with pytest.raises(ValueError, match="rate_hz: 300; must divide 1000"):
        q.fly(SHORT, law)


@pytest.mark.parametrize(
    "keys, text",
    [
        ({"vehicle": "crazyflie-2.1", "speed": 2.0}, "unknown field `speed`"),
        ({"vehicle": "crazyflie-2.1", "speed_m_s": 100.0}, r"scenario: speed_m_s = 100: must be from 0.01 to 10"),
        ({"vehicle": "crazyflie-2.1", "errors": {"lag_ms": 0.067}}, "errors.lag_ms"),
        ({"vehicle": "albatross"}, "scenario: vehicle: vehicle albatross: unknown; the built-in ones are"),
        ({"course": "eight"}, "missing field `vehicle`"),
    ],
)
def test_errors_are_those_of_the_command(keys, text):
    with pytest.raises(q.QuatrackError, match=text):
        q.Scenario(keys)


def test_laws_of_one_name_are_refused_before_any_flies():
    def never(given):
        raise AssertionError("flown")

    for laws, name in [
        ([never, never], "never"),
        (["lee", "quatrack", "lee"], "lee"),
        ([("quatrack", never), "quatrack"], "quatrack"),
        ([never, q.GainTable.builtin("cascade-100ms"), q.GainTable.builtin("cascade-100ms")], "cascade-100ms"),
    ]:
        with pytest.raises(q.QuatrackError, match=f"^laws: {name} is there twice; .* a name of its own"):
            q.compare(SHORT, laws)


@pytest.mark.parametrize("seed", [2**63, -(2**63) - 1, 2**64])
def test_a_whole_number_that_no_file_holds_is_named(seed):
    range_of_toml = "must be from -9223372036854775808 to 9223372036854775807"
    with pytest.raises(q.QuatrackError, match=f"^scenario.seed: {seed}; {range_of_toml}, .*Scenario.with_seed"):
        q.Scenario(SHORT | {"seed": seed})
    with pytest.raises(q.QuatrackError, match=f"^scenario.noise.position_m: {seed}; {range_of_toml}, as in a file$"):
        q.Scenario(SHORT | {"noise": {"position_m": seed}})


def test_seeds_go_to_64_bits():
    scenario = q.Scenario(SHORT)
    assert scenario.with_seed(2**64 - 1).seed == 2**64 - 1
    for seed in (-1, 2**64):
        with pytest.raises(q.QuatrackError, match=f"^seed: {seed}; must be from 0 to 18446744073709551615"):
            scenario.with_seed(seed)
    with pytest.raises(TypeError, match="^seed: float; give a whole number"):
        scenario.with_seed(1.0)


def test_numpy_scalars_and_paths_are_values_of_a_scenario():
    keys = SHORT | {"seed": np.int64(3), "noise": {"position_m": np.float64(1e-3)}, "air": {"wind_m_s": np.zeros(3)}}
    assert q.Scenario(keys).seed == 3
    with pytest.raises(TypeError, match=r"scenario\.noise\.position_m"):
        q.Scenario(SHORT | {"noise": {"position_m": object()}})


def test_many_plants_are_as_many_single_ones():
    gusty = {"vehicle": "crazyflie-2.1", "air": {"drag_per_s": [0.4] * 3, "gust_rms_m_s": 0.5}}
    rng = np.random.default_rng(2)
    start, commands = rng.normal(size=(70, 3)), rng.uniform(0.05, 0.1, (70, 4))
    plants = q.Plant(gusty, q.State(start))
    for _ in range(5):
        plants.advance(commands, 0.01)
    one = q.Plant(gusty, q.State(start[33]), seeds=[34])
    for _ in range(5):
        one.advance(commands[33], 0.01)
    assert np.array_equal(plants.state.position[33], one.state.position)
    assert np.array_equal(plants.wind[33], one.wind) and plants.wind[32, 0] != plants.wind[33, 0]
    assert plants.state.specific_force.shape == (70, 3)


def test_a_free_fall_takes_half_g_t_squared():
    fall = q.Plant({"vehicle": "crazyflie-2.1"}, q.State([0.0, 0.0, 1.0]), motor_forces=[0.0] * 4)
    least, _ = q.Vehicle("crazyflie-2.1").motor_force_n
    hovering = q.Plant({"vehicle": "crazyflie-2.1"}, q.State([0.0, 0.0, 1.0]))
    fall.advance([0.0] * 4, 0.1)
    hovering.advance([q.Vehicle("crazyflie-2.1").hover_force_n] * 4, 0.1)
    # The motors go to their least force behind a lag: at most that much less than free fall.
    free = 1.0 - 0.5 * 9.81 * 0.1**2
    assert free <= fall.state.position[2] < free + 0.5 * 4 * least / 0.029 * 0.1**2
    assert hovering.state.position[2] == pytest.approx(1.0, abs=1e-12)


def test_restarted_crafts_begin_anew():
    plants = q.Plant({"vehicle": "crazyflie-2.1"}, q.State(np.zeros((3, 3))))
    plants.advance([0.0] * 4, 0.1)
    plants.restart([True, False, False], q.State(np.ones((3, 3))))
    assert np.array_equal(plants.state.position[0], np.ones(3))
    assert plants.time.tolist() == [0.0, 0.1, 0.1]
