//! Flight by hand: angles, rates, heights and climbs.

use quatrack_crazyflie::abi::{Control, Mode, Setpoint};

use super::flight::{CRAFTS, DESCENDING, FLYING, Flight, assert_near, mode};
use super::sent::{FlightMode, alt_hold, full_state, manual, rpyt, z_distance};

#[test]
fn angles_by_hand_have_cflibs_signs() {
    // Right side down, nose down, and the other way about for the older packet: clockwise seen from above.
    for (yaw_rate, is_older) in [(30.0, false), (-30.0, true)] {
        let mut flight = Flight::hovering();
        let thrust = flight.hover_thrust() / (5.0_f32.to_radians().cos() * 10.0_f32.to_radians().cos());
        let setpoint = if is_older {
            let mut setpoint = Setpoint::OFF;
            rpyt(&mut setpoint, FlightMode::default(), [5.0, 10.0, 30.0], thrust as u16);
            setpoint
        } else {
            manual([5.0, 10.0, yaw_rate], thrust, false)
        };
        flight.hold(&setpoint, 1500);
        let [roll, pitch, _] = flight.euler_deg();
        // The tilt stays in place as the heading turns: it lags by some hundredths of a second of it.
        assert_near(&[roll, pitch], &[5.0, 10.0], 1.0);
        assert!((flight.rates_deg_s().z - f64::from(yaw_rate)).abs() < 1.5, "{}", flight.rates_deg_s());
        // Forwards, and upwards no more than a thrust in whole 65535ths lets it.
        let ahead = flight.state.velocity_m_s;
        assert!(ahead.x > 0.5 && ahead.z.abs() < 0.1, "{ahead}");
    }
}

#[test]
fn rates_by_hand_have_the_signs_of_angles() {
    // A stick that is pushed lowers the nose, whether it means an angle or a rate.
    for (rates, axis) in [([40.0, 0.0, 0.0], 0), ([0.0, 40.0, 0.0], 1), ([0.0, 0.0, 40.0], 2)] {
        let mut flight = Flight::hovering();
        let thrust = flight.hover_thrust();
        flight.hold(&manual(rates, thrust, true), 500);
        let mut wanted = [0.0; 3];
        wanted[axis] = 40.0;
        assert_near(flight.rates_deg_s().as_slice(), &wanted, 3.0);
        drop(flight);
        let flown = FlightMode { roll_rate: true, pitch_rate: true, ..FlightMode::default() };
        let (mut flight, mut setpoint) = (Flight::hovering(), Setpoint::OFF);
        rpyt(&mut setpoint, flown, rates, thrust as u16);
        flight.hold(&setpoint, 500);
        // The older packet's yaw is the other way round.
        wanted[2] = -wanted[2];
        assert_near(flight.rates_deg_s().as_slice(), &wanted, 3.0);
    }
}

#[test]
fn thrust_by_hand_is_a_share_of_the_most_of_four_motors() {
    for name in CRAFTS {
        let mut flight = Flight::of(name, 0, 0.0);
        let share = 1.1 * flight.hover_thrust() / 65_535.0;
        flight.hold(&manual([0.0; 3], share * 65_535.0, false), 400);
        let sum: f32 = flight.firmware.control().payload.iter().sum();
        assert!((sum - 4.0 * share).abs() < 0.01 * share, "{name}: {sum} of 4, not {share} of 1");
        assert_eq!(flight.firmware.control().control_mode, Control::FORCE);
        // Mellinger, Lee and PID turn motors off below 1000 too.
        flight.hold(&manual([5.0, 0.0, 0.0], 999.0, false), 10);
        assert!(flight.is_off(), "{name}");
    }
}

#[test]
fn the_least_force_keeps_the_motors_turning() {
    for name in CRAFTS {
        let mut flight = Flight::of(name, 0, 0.0);
        let max_n = flight.vehicle.motors().thrust_max_n as f32;
        let least_n = flight.vehicle.motors().thrust_min_n as f32;
        flight.hold(&manual([0.0; 3], 1001.0, false), 200);
        for share in flight.firmware.control().payload {
            // powerDistributionForce, then motorsCompensateBatteryVoltage: a motor below THRUST_MIN is stopped.
            let number = (share * 65_535.0) as i32;
            assert_eq!(number, 7000, "{name}");
            assert!(number as f32 / 65_535.0 * max_n >= least_n, "{name}: {share}");
        }
    }
}

#[test]
fn heights_and_climbs_hold_at_a_tilt() {
    let mut flight = Flight::hovering();
    flight.hold(&z_distance([-5.0, -5.0, 20.0], 1.2), 4000);
    let [roll, pitch, _] = flight.euler_deg();
    // The older sign of pitch, which cflib does not turn here: the nose goes down at -5.
    assert_near(&[roll, pitch, flight.rates_deg_s().z], &[-5.0, 5.0, 20.0], 2.0);
    assert!((flight.state.position_m.z - 1.2).abs() < 0.02, "{}", flight.state.position_m);
    drop(flight);

    let mut flight = Flight::hovering();
    flight.hold(&alt_hold([5.0, 0.0, 0.0], 0.3), 1500);
    assert_near(&[flight.euler_deg()[0], flight.state.velocity_m_s.z], &[5.0, 0.3], 0.1);
    let mut setpoint = Setpoint::OFF;
    let flown = FlightMode { alt_hold: true, ..FlightMode::default() };
    rpyt(&mut setpoint, flown, [0.0, 5.0, 0.0], 32_767 + 3277);
    flight.hold(&setpoint, 1500);
    assert_near(&[flight.euler_deg()[1], 10.0 * flight.state.velocity_m_s.z], &[5.0, 1.0], 0.2);
}

#[test]
fn a_thrust_of_zero_is_heard_in_the_tick_of_another() {
    let mut flight = Flight::hovering();
    let mut setpoint = manual([0.0; 3], flight.hover_thrust(), false);
    flight.hold(&setpoint, 50);
    // Both have the same stamp: USB brings several packets in a millisecond.
    flight.send(&manual([1.0, 0.0, 0.0], flight.hover_thrust(), false));
    flight.pass(2);
    setpoint = Setpoint { thrust: 0.0, ..flight.sent };
    (0..4).for_each(|_| flight.step(|_, _| setpoint));
    assert!(flight.is_off());
}

#[test]
fn a_pilot_takes_over_from_full_states() {
    let mut flight = Flight::hovering();
    let mut setpoint = full_state([[0.0, 0.0, 1.0], [0.0; 3], [0.0; 3]], [0.0, 0.0, 0.0, 1.0], 0.0);
    flight.hold(&setpoint, 500);
    // The older packet leaves the quaternion's mode as it finds it.
    let thrust = flight.hover_thrust() as u16;
    rpyt(&mut setpoint, FlightMode::default(), [0.0, 8.0, 0.0], thrust);
    assert_eq!(setpoint.mode.quat, Mode::ABSOLUTE);
    flight.hold(&setpoint, 1000);
    assert_eq!(mode(), FLYING);
    assert_near(&flight.euler_deg(), &[0.0, 8.0, 0.0], 0.5);
}

#[test]
fn an_angle_beside_a_rate_stops_and_goes_slowly_down() {
    let (mut flight, mut setpoint) = (Flight::hovering(), Setpoint::OFF);
    let flown = FlightMode { roll_rate: true, ..FlightMode::default() };
    rpyt(&mut setpoint, flown, [30.0, 0.0, 0.0], flight.hover_thrust() as u16);
    // It stays for a second and a half, and goes down at its speed half a second later.
    flight.hold(&setpoint, 2100);
    assert_eq!(mode(), DESCENDING);
    assert_near(&[flight.state.velocity_m_s.z, flight.euler_deg()[0]], &[-0.3, 0.0], 0.05);
}
