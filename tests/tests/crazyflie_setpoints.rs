//! Every setpoint that the Crazyflie's firmware can send a controller, flown through the C interface on the rigid plant.

mod commanders;

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::atomic::Ordering::Relaxed;

use commanders::{FlightMode, NOTHING, Piece, Planned};
use commanders::{alt_hold, full_state, hover, level_out, manual, position, rpyt, velocity_world, z_distance};
use nalgebra::{UnitQuaternion, Vector3};
use quatrack_crazyflie::abi::{Control, Mode, Modes, Setpoint};
use quatrack_crazyflie::ffi;
use quatrack_sim::crazyflie::{Firmware, Sensors, Tune};
use quatrack_sim::plant::{Craft, Ground, RigidState};
use quatrack_sim::vehicle::Vehicle;

const QUIET: Sensors = Sensors { gyro_noise_rad_s: 0.0, estimate_steps: 1 };
const CRAFTS: [&str; 3] = ["crazyflie-2.1", "crazyflie-2.1-upgrade-kit", "crazyflie-2.1-brushless"];

/// A craft in the air, its firmware and whoever sends it setpoints.
struct Flight {
    vehicle: Vehicle,
    craft: Craft,
    firmware: Firmware,
    state: RigidState,
    sent: Setpoint,
}

impl Flight {
    fn of(name: &str, table: u8, motor_lag_s: f64) -> Self {
        let vehicle = Vehicle::by_name(name).unwrap();
        let firmware = Firmware::start(&vehicle, &Tune { table, motor_lag_s }, QUIET);
        let state = RigidState::at_rest(Vector3::z(), vehicle.hover_thrust_n());
        let mut craft = Craft::new(&vehicle);
        if motor_lag_s > 0.0 {
            craft.motors = craft.motors.with_lag(motor_lag_s, motor_lag_s);
        }
        Self { craft, vehicle, firmware, state, sent: Setpoint::OFF }
    }

    /// Hovering at 1 m.
    fn hovering() -> Self {
        let mut flight = Self::of("crazyflie-2.1", 0, 0.0);
        flight.hold(&position([0.0, 0.0, 1.0], 0.0), 500);
        flight
    }

    /// The commander takes a setpoint and stamps it.
    fn send(&mut self, setpoint: &Setpoint) {
        self.sent = Setpoint { timestamp: self.firmware.next_step(), ..*setpoint };
    }

    /// One step with what supervisor or collision avoidance make of the setpoint.
    fn step(&mut self, change: impl Fn(&Setpoint, &RigidState) -> Setpoint) {
        let setpoint = change(&self.sent, &self.state);
        let commands_n = self.firmware.step(&self.state, Some(&setpoint));
        self.state = self.craft.hold(&self.state, &commands_n, 0.0, 1e-3);
        assert!(self.state.is_finite());
    }

    fn pass(&mut self, steps: u32) {
        (0..steps).for_each(|_| self.step(|sent, _| *sent));
    }

    /// Sends the same a hundred times a second.
    fn hold(&mut self, setpoint: &Setpoint, steps: u32) {
        for _ in 0..steps / 10 {
            self.send(setpoint);
            self.pass(10);
        }
    }

    /// Flies the high-level commander's setpoints; the largest distance from them.
    fn follow(&mut self, duration_s: f32, at: impl Fn(f32) -> Planned) -> f64 {
        let (steps, mut largest_m) = ((duration_s * 1e3) as u32, 0.0_f64);
        for step in 0..steps {
            let planned = at(step as f32 * 1e-3);
            if step % 10 == 0 {
                self.send(&planned.setpoint());
            }
            largest_m = largest_m.max((self.state.position_m - planned.position.map_into()).norm());
            self.pass(1);
        }
        largest_m
    }

    /// Thrust of all motors in 65535ths that carries the craft.
    fn hover_thrust(&self) -> f32 {
        (65_535.0 * self.vehicle.hover_thrust_n() / self.vehicle.motors().thrust_max_n) as f32
    }

    fn euler_deg(&self) -> [f64; 3] {
        let (roll, pitch, yaw) = self.state.attitude.euler_angles();
        [roll.to_degrees(), pitch.to_degrees(), yaw.to_degrees()]
    }

    fn rates_deg_s(&self) -> Vector3<f64> {
        self.state.body_rates_rad_s.map(f64::to_degrees)
    }

    fn is_off(&self) -> bool {
        self.firmware.control().payload == [0.0; 4]
    }
}

trait MapInto {
    fn map_into(self) -> Vector3<f64>;
}

impl MapInto for [f32; 3] {
    fn map_into(self) -> Vector3<f64> {
        self.map(f64::from).into()
    }
}

fn mode() -> u8 {
    ffi::quatrack.log.mode.load(Relaxed)
}

const FLYING: u8 = 1;
const DESCENDING: u8 = 2;

fn assert_near(found: &[f64], wanted: &[f64], tolerance: f64) {
    let is_near = found.iter().zip(wanted).all(|(a, b)| (a - b).abs() <= tolerance);
    assert!(is_near && found.len() == wanted.len(), "{found:?}, not {wanted:?} within {tolerance}");
}

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
    // A stick that is pushed lowers the nose, whether it stands for an angle or for a rate.
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
fn thrust_by_hand_is_a_share_of_what_four_motors_can_do() {
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
fn velocities_turn_with_the_craft_or_not() {
    for (is_ahead, wanted) in [(true, [0.0, 0.4]), (false, [0.4, 0.0])] {
        let mut flight = Flight::hovering();
        flight.hold(&position([0.0, 0.0, 1.0], 90.0), 3000);
        let setpoint = if is_ahead { hover([0.4, 0.0], 0.0, 1.1) } else { velocity_world([0.4, 0.0, 0.0], 0.0) };
        flight.hold(&setpoint, 2500);
        let v = flight.state.velocity_m_s;
        assert_near(&[v.x, v.y, v.z], &[wanted[0], wanted[1], 0.0], 0.02);
        let height = if is_ahead { 1.1 } else { 1.0 };
        assert!((flight.state.position_m.z - height).abs() < 0.03, "{}", flight.state.position_m);
    }
    let (mut flight, mut setpoint) = (Flight::hovering(), Setpoint::OFF);
    let flown = FlightMode { pos_hold: true, alt_hold: true, ..FlightMode::default() };
    rpyt(&mut setpoint, flown, [9.0, 12.0, 0.0], 32_767);
    flight.hold(&setpoint, 2000);
    // As the firmware's PID has it: the pitch that arrives is cflib's with the other sign.
    let v = flight.state.velocity_m_s;
    assert_near(&[v.x, v.y, v.z], &[-0.4, 0.3, 0.0], 0.02);
}

#[test]
fn level_out_is_flown_whatever_was_flown_before() {
    let hover_thrust = Flight::hovering().hover_thrust();
    let tilted = UnitQuaternion::from_euler_angles(0.1_f32, 0.0, 0.0);
    let q = tilted.quaternion();
    let cases = [
        ("angles", manual([15.0, 0.0, 60.0], hover_thrust, false), false),
        ("rates", manual([10.0, 0.0, 60.0], hover_thrust, true), false),
        ("height", z_distance([15.0, 0.0, 60.0], 1.0), true),
        ("hover", hover([0.5, 0.0], 60.0, 1.0), true),
        ("velocity", velocity_world([0.5, 0.0, 0.0], 60.0), true),
        ("position", position([0.3, 0.0, 1.0], 20.0), true),
        ("full state", full_state([[0.3, 0.0, 1.0], [0.0; 3], [0.0; 3]], [q.i, q.j, q.k, q.w], 0.0), true),
    ];
    for (name, setpoint, has_height) in cases {
        let mut flight = Flight::hovering();
        flight.hold(&setpoint, 500);
        // A stick that has just been moved, taken with its stamp.
        flight.hold(&Setpoint { thrust: setpoint.thrust + 1.0, ..setpoint }, 10);
        // No more setpoints: after half a second the supervisor levels the last one out, after two it stops the motors.
        flight.pass(500);
        let height = flight.state.position_m.z;
        (0..1500).for_each(|_| flight.step(|sent, _| level_out(sent)));
        assert_eq!(mode(), FLYING, "{name}");
        let [roll, pitch, _] = flight.euler_deg();
        assert_near(&[roll, pitch], &[0.0, 0.0], 0.5);
        assert!(flight.rates_deg_s().norm() < 5.0, "{name}: {}", flight.rates_deg_s());
        if has_height {
            assert!((flight.state.position_m.z - height).abs() < 0.05, "{name}: {height} m");
        }
        flight.step(|_, _| Setpoint::OFF);
        flight.step(|_, _| Setpoint::OFF);
        assert!(flight.is_off(), "{name}");
    }
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
fn an_angle_beside_a_rate_goes_level_and_slowly_down() {
    let (mut flight, mut setpoint) = (Flight::hovering(), Setpoint::OFF);
    let flown = FlightMode { roll_rate: true, ..FlightMode::default() };
    rpyt(&mut setpoint, flown, [30.0, 0.0, 0.0], flight.hover_thrust() as u16);
    flight.hold(&setpoint, 1500);
    assert_eq!(mode(), DESCENDING);
    assert_near(&[flight.state.velocity_m_s.z, flight.euler_deg()[0]], &[-0.3, 0.0], 0.05);
}

#[test]
fn positions_that_lie_apart_are_gone_to() {
    for (name, is_older) in [("position", false), ("older packet", true)] {
        let mut flight = Flight::hovering();
        let mut setpoint = position([2.0, -1.0, 1.5], 60.0);
        if is_older {
            setpoint = Setpoint::OFF;
            rpyt(&mut setpoint, FlightMode { pos_set: true, ..FlightMode::default() }, [-1.0, 2.0, 60.0], 1500);
        }
        flight.hold(&setpoint, 6000);
        let p = flight.state.position_m;
        assert_near(&[p.x, p.y, p.z], &[2.0, -1.0, 1.5], 0.02);
        assert!((flight.euler_deg()[2] - 60.0).abs() < 1.0, "{name}: {:?}", flight.euler_deg());
    }
}

#[test]
fn a_yaw_that_jumps_costs_no_position() {
    for yaw in [90.0, 170.0, -170.0] {
        for name in CRAFTS {
            let mut flight = Flight::of(name, 0, 0.0);
            flight.hold(&position([0.0, 0.0, 1.0], 0.0), 500);
            let mut largest_m = 0.0_f64;
            for _ in 0..400 {
                flight.hold(&position([0.0, 0.0, 1.0], yaw), 10);
                largest_m = largest_m.max((flight.state.position_m - Vector3::z()).norm());
            }
            assert!(largest_m < 0.1, "{name}, {yaw} degrees: {largest_m} m");
            let heading = UnitQuaternion::from_euler_angles(0.0, 0.0, f64::from(yaw).to_radians());
            assert!(flight.state.attitude.angle_to(&heading) < 0.02, "{name}: {:?}", flight.euler_deg());
        }
    }
}

#[test]
fn orders_to_the_high_level_commander_are_flown_from_the_ground_to_the_ground() {
    for name in CRAFTS {
        let mut flight = Flight::of(name, 0, 0.0);
        flight.craft = Craft::new(&flight.vehicle).with_load(Ground::under(&flight.vehicle));
        let standing = Ground::standing_height_m();
        flight.state = RigidState::at_rest(Vector3::new(0.0, 0.0, standing), 0.0);
        flight.hold(&Setpoint::OFF, 100);
        let from = Planned::at([0.0, 0.0, standing as f32], 0.0);
        let orders = [
            ("take-off", Piece::go_to(&from, [0.0, 0.0, 1.0], 0.0, 2.0, false), 0.06),
            (
                "go to, turning",
                Piece::go_to(&Planned::at([0.0, 0.0, 1.0], 0.0), [1.0, 0.0, 1.0], 3.0, 2.0, false),
                0.06,
            ),
            (
                "back past 180",
                Piece::go_to(&Planned::at([1.0, 0.0, 1.0], 3.0), [0.0, 0.0, 1.0], -3.0, 2.0, false),
                0.06,
            ),
            // Begins and ends at 0.5 m/s, from rest to rest.
            ("linear", Piece::go_to(&Planned::at([0.0, 0.0, 1.0], -3.0), [1.0, 0.0, 1.0], -3.0, 2.0, true), 0.15),
            ("spiral", Piece::spiral(&Planned::at([1.0, 0.0, 1.0], -3.0), 2.0 * 3.0, [0.5, 0.8], 0.2, 6.0), 0.15),
        ];
        let mut end = from;
        for (order, piece, most_m) in &orders {
            let largest_m = flight.follow(piece.duration_s, |t| piece.eval(t));
            assert!(largest_m < *most_m, "{name}, {order}: {largest_m} m");
            end = piece.eval(piece.duration_s + 0.01);
            flight.follow(1.5, |_| end);
        }
        let [x, y, _] = end.position;
        let landing = Piece::go_to(&end, [x, y, standing as f32], end.yaw, 2.0, false);
        let largest_m = flight.follow(2.0, |t| landing.eval(t));
        assert!(largest_m < 0.1, "{name}: {largest_m} m");
        // The planner is done and sends nothing but null setpoints.
        flight.hold(&Setpoint::OFF, 500);
        assert!(flight.is_off() && flight.state.velocity_m_s.norm() < 0.01, "{}", flight.state.velocity_m_s);
    }
}

#[test]
fn a_velocity_that_jumps_does_not_turn_the_craft_over() {
    // A stop at full speed, or a script that starts in the middle of a figure: both differ by where the observer moves.
    for speed in [1.0_f32, 2.1, 3.0] {
        for name in CRAFTS {
            let mut flight = Flight::of(name, 0, 0.0);
            flight.hold(&position([0.0, 0.0, 1.0], 0.0), 500);
            let (mut x, mut largest_deg) = (0.0_f32, 0.0_f64);
            for _ in 0..500 {
                let motion = [[x, 0.0, 1.0], [speed, 0.0, 0.0], [0.0; 3]];
                flight.hold(&full_state(motion, [0.0, 0.0, 0.0, 1.0], 0.0), 10);
                largest_deg = largest_deg.max(flight.state.thrust_axis().z.acos().to_degrees());
                x += 0.01 * speed;
            }
            let left_m = (flight.state.position_m - [x, 0.0, 1.0].map_into()).norm();
            assert!(largest_deg < 70.0 && left_m < 0.05, "{name}, {speed} m/s: {largest_deg} degrees, {left_m} m");
        }
    }
}

/// Products of values with their first three derivatives.
fn times([a0, a1, a2, a3]: [f32; 4], [b0, b1, b2, b3]: [f32; 4]) -> [f32; 4] {
    let third = a3 * b0 + 3.0 * (a2 * b1 + a1 * b2) + a0 * b3;
    [a0 * b0, a1 * b0 + a0 * b1, a2 * b0 + 2.0 * a1 * b1 + a0 * b2, third]
}

/// A figure 8 of 2.1 m/s at 1 m that grows out of its middle in 4 s, as the high-level commander evaluates it.
fn figure_eight(t_s: f32) -> Planned {
    const W: f32 = 1.485;
    let growth = Piece::go_to(&Planned::at([0.0; 3], 0.0), [1.0, 0.0, 0.0], 0.0, 4.0, false).eval(t_s);
    let size = [growth.position, growth.velocity, growth.acceleration, growth.jerk].map(|v| v[0]);
    let wave = |w: f32, half: f32| {
        let (sin, cos) = (w * t_s).sin_cos();
        times(size, [sin, w * cos, -w * w * sin, -w * w * w * cos].map(|v| half * v))
    };
    let (x, y) = (wave(W, 1.0), wave(2.0 * W, 0.5));
    let [position, velocity, acceleration, jerk] = [0, 1, 2, 3].map(|i| [x[i], y[i], if i == 0 { 1.0 } else { 0.0 }]);
    Planned { position, velocity, acceleration, jerk, ..Planned::at([0.0; 3], 0.0) }
}

/// Largest distance from the figure once it has been caught up with; jumps that were counted on the way.
fn figure_strayed_m(turned_by: f32, change: impl Fn(&Setpoint, &RigidState) -> Setpoint) -> (f64, u16) {
    let mut flight = Flight::hovering();
    let before = ffi::quatrack.log.jumps.load(Relaxed);
    let mut largest_m = 0.0_f64;
    for step in 0..8000_u32 {
        let planned = figure_eight(step as f32 * 1e-3).turned(turned_by);
        if step % 10 == 0 {
            flight.send(&planned.setpoint());
        }
        flight.step(&change);
        if step > 0 {
            largest_m = largest_m.max((flight.state.position_m - planned.position.map_into()).norm());
        }
    }
    (largest_m, ffi::quatrack.log.jumps.load(Relaxed).wrapping_sub(before))
}

#[test]
fn a_trajectory_turned_on_its_start_is_flown_though_its_jerk_is_not_turned() {
    let (straight_m, _) = figure_strayed_m(0.0, |sent, _| *sent);
    for turned_by in [FRAC_PI_2, PI] {
        let (largest_m, jumps) = figure_strayed_m(turned_by as f32, |sent, _| *sent);
        // Until it is seen that the jerk is not the slope of the accelerations it leads astray.
        assert!(largest_m < 0.1, "turned by {turned_by}: {largest_m} m, not {straight_m} m, {jumps} jumps");
    }
}

#[test]
fn collision_avoidance_may_change_a_setpoint_at_every_step() {
    // What collisionAvoidanceUpdateSetpoint does to a trajectory whose horizon leaves the cell: the velocity is scaled,
    // by a factor that depends on where the craft is.
    let (strayed_m, jumps) = figure_strayed_m(0.0, |sent, state| {
        let mut changed = *sent;
        let away = (sent.position.x - state.position_m.x as f32).abs();
        let scale = 0.95 - away.min(0.5);
        (changed.velocity.x, changed.velocity.y) = (scale * sent.velocity.x, scale * sent.velocity.y);
        changed
    });
    // A velocity that is a twentieth short and more counts like a position error that grows by as much.
    assert!(strayed_m < 0.5 && jumps == 0, "{strayed_m} m, {jumps} jumps");
}

#[test]
fn forces_and_torques_lift_the_side_that_hangs() {
    // M1 front right, M2 back right, M3 back left, M4 front left; M1 and M3 turn anticlockwise.
    for (table, motor_lag_s) in [(0, 0.0), (2, 0.02)] {
        for (tilt, stronger) in [
            ([0.1, 0.0, 0.0], [0, 1]),
            ([-0.1, 0.0, 0.0], [2, 3]),
            ([0.0, 0.1, 0.0], [0, 3]),
            ([0.0, -0.1, 0.0], [1, 2]),
            ([0.0, 0.0, -0.3], [1, 3]),
        ] {
            let mut flight = Flight::of("crazyflie-2.1", table, motor_lag_s);
            flight.hold(&position([0.0, 0.0, 1.0], 0.0), 300);
            let [roll, pitch, yaw] = tilt;
            flight.state.attitude = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
            flight.state.body_rates_rad_s = Vector3::zeros();
            let sent = flight.sent;
            flight.firmware.step(&flight.state, Some(&sent));
            let forces = flight.firmware.step(&flight.state, Some(&sent));
            let [least, most] = [false, true].map(|is_strong| {
                let side = (0..4).filter(|motor| stronger.contains(motor) == is_strong).map(|motor| forces[motor]);
                if is_strong { side.fold(f64::MAX, f64::min) } else { side.fold(0.0, f64::max) }
            });
            assert!(most > least + 1e-3, "table {table}, {tilt:?}: {forces}");
        }
    }
}

#[test]
fn a_yaw_rate_of_a_full_state_is_in_radians() {
    let mut flight = Flight::hovering();
    let (rate, mut heading) = (0.8_f32, 0.0_f32);
    for _ in 0..500 {
        let q = UnitQuaternion::from_euler_angles(0.0, 0.0, heading);
        let q = q.quaternion();
        flight.send(&full_state([[0.0, 0.0, 1.0], [0.0; 3], [0.0; 3]], [q.i, q.j, q.k, q.w], rate));
        flight.pass(10);
        heading += rate * 0.01;
    }
    assert!((flight.rates_deg_s().z - f64::from(rate).to_degrees()).abs() < 3.0, "{}", flight.rates_deg_s());
    let behind = (f64::from(heading) - flight.euler_deg()[2].to_radians() + PI).rem_euclid(2.0 * PI) - PI;
    // A component of nine bits is a heading of 0.16 degrees.
    assert!(behind.abs() < 0.006, "{behind}");
}

#[test]
fn modes_that_nobody_sends_are_not_guessed_at() {
    let mut flight = Flight::hovering();
    let on = Mode::ABSOLUTE;
    for modes in [
        Modes { x: on, ..NOTHING },
        Modes { x: on, y: on, z: Mode(7), ..NOTHING },
        Modes { z: on, roll: on, ..NOTHING },
        Modes { z: on, quat: Mode::VELOCITY, ..NOTHING },
    ] {
        flight.hold(&Setpoint { mode: modes, ..position([0.0, 0.0, 1.0], 0.0) }, 20);
        assert_eq!(mode(), DESCENDING, "{modes:?}");
    }
}
