//! Parameters as the owner has set them, each within its range. One that is NaN is put back to its default.

use core::sync::atomic::Ordering::Relaxed;

use quatrack::cascade::{Air, CascadeLimits};
use quatrack::gains::Scales;
use quatrack::math::sin_cos;
use quatrack::nalgebra::Vector3;
use quatrack::{FeedForward, Leash, Limits};

use crate::control::Settings;
use crate::craft::Craft;
use crate::shaping::Bounds;
use crate::shared::{AtomicF32, Parameters};
use crate::tables::Tuning;
use crate::units::RAD_PER_DEG;

/// The defaults of all that may be NaN, in the order of [`Parameters`].
fn defaults(craft: &Craft) -> [f32; Parameters::FLOATS] {
    let Air { drag_per_s, moment_n_s: [moment_x, moment_y], gust, .. } = craft.air;
    let CascadeLimits { speed_m_s, climb_m_s, .. } = CascadeLimits::STANDARD;
    [1.0, 1.0, 1.0, 1.5, 4.0, 20.0, 10.0, 0.0, drag_per_s, moment_x, moment_y, gust, speed_m_s, climb_m_s, TILT_DEG]
}

/// Largest tilt on the way to a place that is far off, degrees.
const TILT_DEG: f32 = 54.5;

/// Puts parameters that are NaN back to their defaults; the last of them, if any, counted from 1.
pub(crate) fn put_back(parameters: &Parameters, craft: &Craft) -> Option<u16> {
    let mut last = None;
    for (index, (value, default)) in (1..).zip(parameters.floats().into_iter().zip(defaults(craft))) {
        if value.get().is_nan() {
            value.set(default);
            last = Some(index);
        }
    }
    last
}

/// Another craft takes a craft's place: a value that was the one's default becomes the other's.
pub(crate) fn replace(parameters: &Parameters, craft: &Craft, other: &Craft) {
    for (value, (own, others)) in parameters.floats().into_iter().zip(defaults(craft).into_iter().zip(defaults(other)))
    {
        if value.get() == own {
            value.set(others);
        }
    }
}

/// The owner's tuning of a table.
pub(crate) fn tuning(parameters: &Parameters, craft: &Craft) -> Tuning {
    let moment_n_s = [&parameters.moment_x_n_s, &parameters.moment_y_n_s];
    let (sin, cos) = sin_cos(within(&parameters.tilt_deg, 6.0, 75.0) * RAD_PER_DEG);
    Tuning {
        scales: Scales { position: parameters.position_scale.get(), yaw: parameters.yaw_scale.get() },
        air: Air {
            drag_per_s: within(&parameters.drag_per_s, 0.0, Air::DRAG_MAX_PER_S),
            moment_n_s: moment_n_s.map(|moment| within(moment, 0.0, Air::MOMENT_MAX_N_S)),
            gust: within(&parameters.gust, 0.0, 1.0),
            learn: parameters.learn.load(Relaxed) != 0,
            ..craft.air
        },
        limits: CascadeLimits {
            speed_m_s: within(&parameters.goal_speed_m_s, 0.1, 10.0),
            climb_m_s: within(&parameters.goal_climb_m_s, 0.1, 10.0),
            tilt_tangent: sin / cos,
        },
    }
}

/// The motors' lag as the owner knows it, s; 0 where it is not stated.
pub(crate) fn motor_lag_s(parameters: &Parameters) -> f32 {
    within(&parameters.motor_lag_s, 0.0, 1.0)
}

/// The owner's settings beside the table, within the limits of the table in the air.
pub(crate) fn settings(parameters: &Parameters, craft: &Craft, table: &Limits) -> Settings {
    let roll_pitch = within(&parameters.roll_pitch_rate_rad_s, 0.5, 100.0);
    let yaw = within(&parameters.yaw_rate_rad_s, 0.5, 100.0);
    Settings {
        bounds: Bounds {
            leash: Leash { length_m: within(&parameters.leash_m, Leash::SHORTEST_M, Leash::LONGEST_M) },
            speed_m_s: within(&parameters.speed_m_s, 0.1, 5.0),
            acceleration_m_s2: within(&parameters.acceleration_m_s2, 0.5, 10.0),
        },
        limits: Limits::of(craft.airframe(), Vector3::new(roll_pitch, roll_pitch, yaw)).within(table),
        feed_forward: if parameters.feed_forward.load(Relaxed) == 0 { FeedForward::Without } else { FeedForward::With },
    }
}

/// A parameter within its range.
fn within(value: &AtomicF32, least: f32, most: f32) -> f32 {
    let value = value.get();
    if value >= most {
        most
    } else if value >= least {
        value
    } else {
        least
    }
}
