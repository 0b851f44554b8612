//! The air learned on circles whose air, wind and bias are known.

use super::*;
use crate::mixer::Parts;

const CRAFT: Airframe = Airframe::CRAZYFLIE_2_1_BRUSHLESS;
const H: f32 = 0.002;
/// The air that is true in these tests.
const DRAG: f32 = 0.45;
const MOMENT: [f32; 2] = [7e-4, 9e-4];

/// The coefficients after flying a circle of 1 m/s for some seconds, with an accelerometer that is off, in a wind.
fn known(air: &Air, seconds: f32, bias: f32, wind: f32, speed: f32) -> (AirLearner, SeenAir) {
    let learner = AirLearner::new(air, &CRAFT, H);
    let mut seen = SeenAir::NONE;
    for step in 0..(seconds / H) as u32 {
        let (sin, cos) = crate::math::sin_cos(1.5 * H * step as f32);
        let (vx, vy) = (speed * cos, speed * sin);
        let felt = Vector3::new(-DRAG * (vx - wind) + bias, -DRAG * vy, 9.81);
        let lever = 4.0 * CRAFT.figures().lever_arm_m;
        let [cx, cy] = MOMENT;
        // The motors hold against the moment: the craft does not turn.
        let forces = Parts { thrust: 0.1, roll: -cx * vy / lever, pitch: cy * (vx - wind) / lever, yaw: 0.0 };
        let felt = Felt {
            accelerometer: Some(&felt),
            body_velocity: [vx, vy],
            body_rates: &Vector3::zeros(),
            forces: &forces,
            undisturbed: true,
        };
        learner.step(&mut seen, &felt);
    }
    (learner, seen)
}

#[test]
fn the_air_is_learned_from_nothing_at_any_bias() {
    let untold = Air { learn: true, ..Air::NONE };
    let (learner, seen) = known(&untold, 30.0, 0.5, 0.0, 1.0);
    // The told zero keeps 0.1 of 30 m^2/s for drag, of 15 for each moment.
    assert!((learner.now(&seen).drag / DRAG - 1.0).abs() < 0.01, "{}", learner.now(&seen).drag);
    for (found, wanted) in learner.moment_n_s(&learner.now(&seen)).iter().zip(MOMENT) {
        assert!((found / wanted - 1.0).abs() < 0.02, "{found} {wanted}");
    }
}

#[test]
fn a_wind_at_hover_teaches_nothing_and_is_answered_in_the_moment() {
    let air = Air::BRUSHLESS;
    let (learner, seen) = known(&air, 3.0, 0.0, 1.0, 0.0);
    assert_eq!(learner.now(&seen), learner.told);
    // The share of the moment of 1 m/s that c / d tells from a felt 0.45 m/s^2.
    let lever = 4.0 * CRAFT.figures().lever_arm_m;
    let pitch = -air.gust * 7.3e-4 / 0.353 * DRAG / lever;
    let [roll, found] = seen.wind;
    assert!(roll == 0.0 && (found / pitch - 1.0).abs() < 1e-5, "{found} {pitch}");
}

#[test]
fn without_an_accelerometer_the_told_air_is_flown() {
    let learner = AirLearner::new(&Air::BRUSHED, &CRAFT, H);
    let mut seen = SeenAir::NONE;
    for accelerometer in [None, Some(Vector3::new(f32::NAN, 0.0, 0.0)), Some(Vector3::new(0.0, 1e9, 0.0))] {
        for _ in 0..20 {
            let felt = Felt {
                accelerometer: accelerometer.as_ref(),
                body_velocity: [1.0, 0.0],
                body_rates: &Vector3::zeros(),
                forces: &Parts { thrust: 0.1, roll: 0.0, pitch: 0.0, yaw: 0.0 },
                undisturbed: true,
            };
            learner.step(&mut seen, &felt);
        }
    }
    assert_eq!((learner.now(&seen), seen.wind), (learner.told, [0.0; 2]));
}

#[test]
fn it_forgets_nothing_at_rest_but_the_wind() {
    let (learner, mut seen) = known(&Air::BRUSHED, 10.0, 0.0, 1.0, 1.0);
    let now = learner.now(&seen);
    assert!(seen.wind != [0.0; 2]);
    seen.rest();
    assert_eq!((learner.now(&seen), seen.wind), (now, [0.0; 2]));
}
