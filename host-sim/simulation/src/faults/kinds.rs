//! Every kind of fault: the signals that it spoils and from when on, whether a craft has to survive it, and the answers
//! of PX4 and Bitcraze.

use nalgebra::{UnitQuaternion, Vector3};
use quatrack::{Quaternion, State};

use super::signals::{Craft, Fault, SOUND, Signals};

const NAN: f32 = f32::NAN;
const LOST_PLACE: &str = "PX4: descends by attitude; Bitcraze: none, estimator resets";
const LOST_ALL: &str = "PX4: terminates; Bitcraze: none, motors follow NaN or stop";
const LINK: &str = "PX4: return or land; Bitcraze: levels after 0.5 s, motors off after 2 s";
const LIMITS: &str = "PX4: control allocation, no promise; Bitcraze: none";
const NONE: &str = "neither promises anything";

fn on(state: &mut Option<State>, change: impl FnOnce(&mut State)) {
    if let Some(state) = state {
        change(state);
    }
}

fn is_within(s: &Signals<'_>, seconds: f64) -> bool {
    s.since_s() < seconds
}

fn place_is(state: &mut Option<State>, value: f32) {
    on(state, |state| {
        (state.position_m, state.velocity_m_s) = (Vector3::repeat(value), Vector3::repeat(value));
    });
}

fn all_is_nan(s: &mut Signals<'_>) {
    place_is(&mut s.state, NAN);
    on(&mut s.state, |state| state.attitude = Quaternion::new(NAN, NAN, NAN, NAN));
}

fn scaled(q: Quaternion, by: f32) -> Quaternion {
    Quaternion::new(q.w * by, q.x * by, q.y * by, q.z * by)
}

fn delay(s: &mut Signals<'_>, steps: usize, rates: bool) {
    let (state, body_rates) = (s.past)(steps);
    s.state = Some(state);
    if rates {
        s.body_rates = body_rates;
    }
}

/// All kinds, by the part that they befall.
pub fn kinds() -> Vec<Fault> {
    let mut all = Vec::new();
    let mut add = |name, recoverable, speed_m_s, others, craft, spoil: fn(&mut Signals<'_>)| {
        all.push(Fault { name, recoverable, speed_m_s, spoil, craft, others });
    };

    // State.
    add("state: one NaN position", true, 1.0, NONE, SOUND, |s| {
        if s.step == 0 {
            on(&mut s.state, |state| state.position_m.x = NAN);
        }
    });
    add("state: NaN one sample in two", true, 1.0, LOST_PLACE, SOUND, |s| {
        if s.step.is_multiple_of(2) {
            all_is_nan(s);
        }
    });
    add("state: NaN one sample in four", true, 1.0, LOST_PLACE, SOUND, |s| {
        if s.step.is_multiple_of(4) {
            all_is_nan(s);
        }
    });
    add("state: NaN for 300 ms", true, 1.0, LOST_PLACE, SOUND, |s| {
        if is_within(s, 0.3) {
            all_is_nan(s);
        }
    });
    add("state: NaN for 500 ms", true, 1.0, LOST_PLACE, SOUND, |s| {
        if is_within(s, 0.5) {
            all_is_nan(s);
        }
    });
    add("state: NaN position and velocity for 2 s", true, 0.5, LOST_PLACE, SOUND, |s| {
        if is_within(s, 2.0) {
            place_is(&mut s.state, NAN);
        }
    });
    add("state: NaN position for good", true, 0.0, LOST_PLACE, SOUND, |s| {
        on(&mut s.state, |state| state.position_m.y = NAN);
    });
    add("state: NaN velocity for good", true, 0.5, LOST_PLACE, SOUND, |s| {
        on(&mut s.state, |state| state.velocity_m_s.z = NAN);
    });
    add("state: infinite velocity for good", true, 0.0, LOST_PLACE, SOUND, |s| {
        on(&mut s.state, |state| state.velocity_m_s.x = f32::INFINITY);
    });
    add("state: position of 3e38 for 300 ms", true, 1.0, LOST_PLACE, SOUND, |s| {
        if is_within(s, 0.3) {
            on(&mut s.state, |state| state.position_m.z = 3e38);
        }
    });
    add("state: velocity of 100 m/s for 300 ms", true, 1.0, LOST_PLACE, SOUND, |s| {
        if is_within(s, 0.3) {
            on(&mut s.state, |state| state.velocity_m_s.y = 100.0);
        }
    });
    add("state: quaternion of norm 0.71", true, 1.0, NONE, SOUND, |s| {
        on(&mut s.state, |state| state.attitude = scaled(state.attitude, 0.71));
    });
    add("state: quaternion of norm 0.98", true, 1.0, NONE, SOUND, |s| {
        on(&mut s.state, |state| state.attitude = scaled(state.attitude, 0.98));
    });
    add("state: quaternion of norm 1.05", true, 1.0, NONE, SOUND, |s| {
        on(&mut s.state, |state| state.attitude = scaled(state.attitude, 1.05));
    });
    add("state: quaternion of norm 1.39", true, 1.0, NONE, SOUND, |s| {
        on(&mut s.state, |state| state.attitude = scaled(state.attitude, 1.39));
    });
    add("state: quaternion of the other sign in every step", true, 1.0, NONE, SOUND, |s| {
        if s.step.is_multiple_of(2) {
            on(&mut s.state, |state| state.attitude = scaled(state.attitude, -1.0));
        }
    });
    add("state: zero quaternion for 300 ms", true, 1.0, LOST_ALL, SOUND, |s| {
        if is_within(s, 0.3) {
            on(&mut s.state, |state| state.attitude = scaled(state.attitude, 0.0));
        }
    });
    add("state: attitude absent for good", false, 0.0, LOST_ALL, SOUND, |s| {
        on(&mut s.state, |state| state.attitude = scaled(state.attitude, 0.0));
    });
    add("state: yaw 90 degrees wrong", false, 0.5, "PX4: EKF reset, no promise; Bitcraze: none", SOUND, |s| {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f32::consts::FRAC_PI_2);
        on(&mut s.state, |state| {
            state.attitude = Quaternion::new(turn.w, 0.0, 0.0, turn.k) * state.attitude;
        });
    });
    add("state: stands still for good", true, 0.0, LOST_PLACE, SOUND, |s| s.state = Some((s.past)(s.step as usize).0));
    add("state: stands still for 300 ms", true, 0.5, NONE, SOUND, |s| {
        if is_within(s, 0.3) {
            s.state = Some((s.past)(s.step as usize).0);
        }
    });
    add("state: 50 Hz", true, 1.0, NONE, SOUND, |s| s.state = Some((s.past)((s.step % 10) as usize).0));
    add("state: jumps by 5 m", true, 0.0, "PX4: EKF reset is followed; Bitcraze: none", SOUND, |s| {
        on(&mut s.state, |state| state.position_m.x += 5.0);
    });
    add("state: jumps by 10 m", true, 0.0, "PX4: EKF reset is followed; Bitcraze: none", SOUND, |s| {
        on(&mut s.state, |state| state.position_m.y -= 10.0);
    });
    add("state: velocity off by 0.3 m/s", true, 1.0, NONE, SOUND, |s| {
        on(&mut s.state, |state| state.velocity_m_s.x += 0.3);
    });
    add("state: position drifts with 0.2 m/s for 5 s", true, 0.0, NONE, SOUND, |s| {
        let drift = 0.2 * s.since_s().min(5.0) as f32;
        on(&mut s.state, |state| state.position_m.x += drift);
    });
    add("state: does not come for 300 ms", true, 1.0, LOST_PLACE, SOUND, |s| {
        if is_within(s, 0.3) {
            s.state = None;
        }
    });
    add("state: does not come any more", true, 0.0, LOST_PLACE, SOUND, |s| s.state = None);

    // Gyroscope and accelerometer.
    add("gyro: NaN one sample in two", true, 1.0, NONE, SOUND, |s| {
        if s.step.is_multiple_of(2) {
            s.body_rates = Vector3::repeat(NAN);
        }
    });
    add("gyro: NaN for 300 ms", true, 0.5, LOST_ALL, SOUND, |s| {
        if is_within(s, 0.3) {
            s.body_rates = Vector3::repeat(NAN);
        }
    });
    add("gyro: NaN for good", false, 0.0, LOST_ALL, SOUND, |s| s.body_rates = Vector3::repeat(NAN));
    add("gyro: dead", false, 0.0, LOST_ALL, SOUND, |s| s.body_rates = Vector3::zeros());
    add("gyro: saturated", false, 0.0, LOST_ALL, SOUND, |s| s.body_rates.x = 34.9);
    add("gyro: saturated for 100 ms", true, 0.5, NONE, SOUND, |s| {
        if is_within(s, 0.1) {
            s.body_rates.y = -34.9;
        }
    });
    add("gyro: wrong in sign", false, 0.0, "neither notices; both lose the craft", SOUND, |s| {
        s.body_rates = -s.body_rates;
    });
    add("gyro: bias of 0.2 rad/s", true, 1.0, NONE, SOUND, |s| s.body_rates.x += 0.2);
    add("gyro: ten times its noise", true, 0.5, NONE, SOUND, |s| {
        let (_, old) = (s.past)(7);
        s.body_rates += (s.body_rates - old).map(|rate| rate.clamp(-0.2, 0.2));
    });
    add("accelerometer: NaN", true, 1.0, NONE, SOUND, |s| s.felt = Some(Vector3::repeat(NAN)));
    add("accelerometer: saturated", true, 1.0, NONE, SOUND, |s| s.felt = Some(Vector3::repeat(156.9)));
    add("accelerometer: absent", true, 1.0, NONE, SOUND, |s| s.felt = None);
    add("accelerometer: 1 m/s^2 off", true, 1.0, NONE, SOUND, |s| {
        if let Some(felt) = &mut s.felt {
            *felt += Vector3::new(1.0, -1.0, 0.5);
        }
    });

    // Setpoints.
    add("setpoint: NaN position at 3 m/s", true, 3.0, "PX4: holds; Bitcraze: none, NaN is flown", SOUND, |s| {
        if let Some([p, ..]) = &mut s.asked {
            p.x = NAN;
        }
    });
    add("setpoint: NaN yaw rate at 1.4 m/s", true, 1.4, "PX4: holds; Bitcraze: none, NaN is flown", SOUND, |s| {
        s.heading[1] = NAN;
    });
    add("setpoint: infinite acceleration", true, 2.0, "PX4: holds; Bitcraze: none", SOUND, |s| {
        if let Some([.., a]) = &mut s.asked {
            a.y = f32::INFINITY;
        }
    });
    add("setpoint: bad for 50 ms", true, 1.4, "PX4: holds; Bitcraze: none", SOUND, |s| {
        if let Some([p, ..]) = s.asked.as_mut().filter(|_| s.step < 25) {
            p.z = NAN;
        }
    });
    add("setpoint: bad one in two", true, 1.0, "PX4: holds; Bitcraze: none", SOUND, |s| {
        if let Some([p, ..]) = s.asked.as_mut().filter(|_| s.step % 10 < 5) {
            p.z = NAN;
        }
    });
    add("setpoint: does not come any more", true, 2.0, LINK, SOUND, |s| s.asked = None);
    add("setpoint: a goal 50 m away for 5 s", true, 0.0, "both fly there", SOUND, |s| {
        if let Some([p, ..]) = s.asked.as_mut().filter(|_| s.step < 2500) {
            p.x += 50.0;
        }
    });
    add("setpoint: yaw step of 180 degrees with 1 m", true, 0.0, "both turn", SOUND, |s| {
        s.heading = [std::f32::consts::PI, 0.0];
        if let Some([p, ..]) = &mut s.asked {
            p.y += 1.0;
        }
    });
    add("setpoint: free fall", true, 0.0, NONE, SOUND, |s| {
        if let Some([.., a]) = s.asked.as_mut().filter(|_| s.step < 100) {
            a.z = -9.81;
        }
    });

    // Motors and battery.
    add("motor: one dead", false, 0.0, "PX4: no promise for a quadrotor; Bitcraze: tumble check", SOUND, |s| {
        s.motors[1] = 0.0;
    });
    add("motor: one at 0.7", true, 0.5, LIMITS, SOUND, |s| s.motors[2] = 0.7);
    add("motor: one at 0.85", true, 1.0, LIMITS, SOUND, |s| s.motors[0] = 0.85);
    add("motor: all at 0.8", true, 1.0, LIMITS, SOUND, |s| s.motors = [0.8; 4]);
    add("motor: one stutters", true, 0.0, LIMITS, SOUND, |s| {
        if s.step % 250 < 25 {
            s.motors[3] = 0.3;
        }
    });
    add("motor: one off for 60 ms", true, 0.0, LIMITS, SOUND, |s| {
        if s.step < 30 {
            s.motors[0] = 0.0;
        }
    });
    add(
        "motor: thrust below the weight",
        false,
        0.0,
        "PX4: flight termination by height; Bitcraze: none",
        SOUND,
        |s| {
            s.motors = [0.3; 4];
        },
    );
    add("battery: sags by 2 % a second", true, 0.5, "PX4: lands; Bitcraze: warns", SOUND, |s| {
        let left = (1.0 - 0.02 * s.since_s()).max(0.8);
        (s.motors, s.battery_v) = ([left; 4], (3.8 - 0.1 * s.since_s()) as f32);
    });
    add("battery: 2.9 V", true, 1.0, "PX4: lands; Bitcraze: warns", SOUND, |s| s.battery_v = 2.9);
    add("battery: a reading of NaN", true, 1.0, NONE, SOUND, |s| s.battery_v = NAN);

    // Timing.
    add("timing: state 20 ms late", true, 0.5, NONE, SOUND, |s| delay(s, 10, false));
    add("timing: state and gyro 10 ms late", true, 0.5, NONE, SOUND, |s| delay(s, 5, true));
    add("timing: state and gyro 60 ms late", false, 0.5, "neither notices", SOUND, |s| delay(s, 30, true));
    add("timing: one step in five is left out", true, 1.0, NONE, SOUND, |s| s.is_skipped = s.step.is_multiple_of(5));
    add("timing: no step for 20 ms", true, 1.0, "Bitcraze: watchdog asserts at 25 ms", SOUND, |s| {
        s.is_skipped = s.step < 10;
    });
    add("timing: overruns for good", false, 0.0, "Bitcraze: asserts, motors off", SOUND, |s| s.overrun = true);
    add("timing: one overrun in three", true, 1.0, NONE, SOUND, |s| s.overrun = s.step.is_multiple_of(3));

    // Craft.
    add(
        "craft: 20 % heavier than told",
        true,
        1.0,
        "PX4: hover thrust is learned; Bitcraze: none",
        Craft { mass: 1.2, ..SOUND },
        |_| (),
    );
    add(
        "craft: 20 % lighter than told",
        true,
        1.0,
        "PX4: hover thrust is learned; Bitcraze: none",
        Craft { mass: 0.8, ..SOUND },
        |_| (),
    );
    add("craft: inertia 30 % larger", true, 1.0, NONE, Craft { inertia: 1.3, ..SOUND }, |_| ());
    add("craft: motors 30 % slower", true, 1.0, NONE, Craft { lag: 1.3, ..SOUND }, |_| ());
    add("craft: centre of mass 1 mm off", true, 1.0, NONE, Craft { centre_m: 1e-3, ..SOUND }, |_| ());
    add("craft: a hand pushes with half the weight for 0.5 s", true, 0.0, NONE, SOUND, |s| {
        if is_within(s, 0.5) {
            s.push = Vector3::new(0.5, 0.0, 0.0);
        }
    });
    add("craft: a blow from above", true, 0.0, NONE, SOUND, |s| {
        if s.step < 10 {
            s.push = Vector3::new(0.0, 0.0, -5.0);
        }
    });
    add("air: wind of 3 m/s", true, 1.0, NONE, Craft { wind_m_s: 3.0, ..SOUND }, |_| ());

    // Ground and walls.
    add("wall: a goal 0.4 m behind it", true, 0.0, NONE, Craft { wall_m: Some(0.4), ..SOUND }, |s| {
        if let Some([p, ..]) = &mut s.asked {
            p.x += 0.8;
        }
    });
    add("ground: a goal 1 m below it", true, 0.0, "PX4: land detector; Bitcraze: none", SOUND, |s| {
        let down = 0.3 * s.since_s() as f32;
        if let Some([p, ..]) = &mut s.asked {
            p.z = (p.z - down).max(-1.0);
        }
    });

    // Radio.
    add("radio: silent for 400 ms", true, 1.0, LINK, SOUND, |s| {
        if is_within(s, 0.4) {
            s.silence = 2 * s.step;
        }
    });
    add("radio: silent for 1 s", true, 1.0, LINK, SOUND, |s| {
        if is_within(s, 1.0) {
            s.silence = 2 * s.step;
        }
    });
    add("radio: silent for good, estimator on board", true, 3.0, LINK, SOUND, |s| s.silence = 2 * s.step);
    add("radio: silent for good, no estimator", true, 0.0, LINK, SOUND, |s| {
        (s.silence, s.state) = (2 * s.step, None);
    });
    all
}
