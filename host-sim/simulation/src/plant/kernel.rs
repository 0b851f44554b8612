//! Runge-Kutta steps of plain craft, one or four side by side in the lanes of the processor's vector unit: figures, states, goals
//! and winds in; states after the step out.
//!
//! Every lane has the bits of that craft flown alone, and those of [`super::Craft`]'s own equations. A craft is plain when its motors
//! differ in place and reaction alone and nothing but them and the air pushes it.

use nalgebra::{Vector3, Vector4};
use pulp::Scalar;
use quatrack_design::model::GRAVITY_M_S2;

mod equations;
mod lanes;
mod number;

pub(super) use self::equations::Figures;
use self::equations::{
    BIAS, DRAG, FALL, FIGURES, INERTIA, INVERSE, InLanes, LEAST, LIFT, MASS, MOMENT, MOST, PLACE_X, PLACE_Y, REACTION,
    RISE, advanced, back, in_air, turned, turned_from_z,
};
pub(super) use self::lanes::SideBySide;
pub(super) use self::number::LANES;
use self::number::Number;
use super::craft::LinearWind;
use super::{Craft, RigidState};

/// The inputs of one step of one plant besides its figures and its state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) goals_n: Vector4<f64>,
    pub(super) wind: LinearWind,
    pub(super) from_s: f64,
    pub(super) step_s: f64,
}

/// The figures of a craft; none where it is not plain. And whether it has air.
pub(super) fn figures(craft: &Craft) -> Option<(Figures, bool)> {
    let [first, ..] = &craft.motors.motors;
    let alike = craft.motors.motors.iter().all(|motor| {
        motor.rise_lag_s == first.rise_lag_s
            && motor.fall_lag_s == first.fall_lag_s
            && motor.thrust_min_n == first.thrust_min_n
            && motor.thrust_max_n == first.thrust_max_n
            && motor.position_m.z == 0.0
    });
    if !alike || !craft.loads.is_empty() || craft.motors.propeller.is_some() {
        return None;
    }
    let air = craft.air.unwrap_or_default();
    if air.rotors.is_some() {
        return None;
    }
    let mut figures = [0.0; FIGURES];
    figures[RISE] = first.rise_lag_s;
    figures[FALL] = first.fall_lag_s;
    figures[LEAST] = first.thrust_min_n;
    figures[MOST] = first.thrust_max_n;
    figures[MASS] = craft.body.mass_kg();
    let (inertia, inverse) = (craft.body.inertia_kg_m2(), craft.body.inverse_inertia());
    for row in 0..3 {
        for column in 0..3 {
            figures[INERTIA + 3 * row + column] = inertia[(row, column)];
            figures[INVERSE + 3 * row + column] = inverse[(row, column)];
        }
        figures[BIAS + row] = craft.motors.torque_bias_n_m[row];
        figures[DRAG + row] = air.drag_n_s_m[row];
    }
    for (i, motor) in craft.motors.motors.iter().enumerate() {
        figures[PLACE_X + i] = motor.position_m.x;
        figures[PLACE_Y + i] = motor.position_m.y;
        figures[REACTION + i] = motor.torque_per_thrust_m;
    }
    figures[MOMENT..MOMENT + 2].copy_from_slice(&air.moment_n_s);
    figures[LIFT] = air.lift_n_s2_m2;
    Some((figures, craft.air.is_some()))
}

/// Whether the principal axes of inertia are the body's: products with 0 are then left out.
fn is_diagonal(figures: &Figures) -> bool {
    let beside = |from: usize| (0..9).filter(|entry| entry % 4 != 0).all(|entry| figures[from + entry] == 0.0);
    beside(INERTIA) && beside(INVERSE)
}

/// One plant's step.
pub(super) fn alone(figures: &Figures, has_air: bool, state: &RigidState, step: &Step) -> RigidState {
    let number = |value: f64| Number(Scalar, value);
    let own = figures.map(number);
    let x = <[f64; 17]>::from(state.to_vector()).map(number);
    let step = InLanes {
        goals: <[f64; 4]>::from(step.goals_n).map(number),
        from: <[f64; 3]>::from(step.wind.from_m_s).map(number),
        slope: <[f64; 3]>::from(step.wind.slope_m_s2).map(number),
        since: number(step.wind.from_s),
        start: number(step.from_s),
        step: number(step.step_s),
    };
    let next = match (has_air, is_diagonal(figures)) {
        (false, false) => advanced::<_, false, false, false>(&own, &x, &step),
        (false, true) => advanced::<_, false, true, false>(&own, &x, &step),
        (true, false) => advanced::<_, true, false, false>(&own, &x, &step),
        (true, true) => advanced::<_, true, true, false>(&own, &x, &step),
    };
    RigidState::of_numbers(next.map(|value| value.1))
}

/// Specific force at the centre of mass of one plant in a wind, body frame, m/s^2: as [`Craft::motion`] has it.
pub(super) fn felt_m_s2(figures: &Figures, has_air: bool, state: &RigidState, wind_m_s: &Vector3<f64>) -> Vector3<f64> {
    let number = |value: f64| Number(Scalar, value);
    let own = figures.map(number);
    let x = <[f64; 17]>::from(state.to_vector()).map(number);
    let (q, two, gravity) = ([x[6], x[7], x[8], x[9]], number(2.0), number(GRAVITY_M_S2));
    let thrust = ((x[13] + x[14]) + x[15]) + x[16];
    let force = if has_air {
        let relative = std::array::from_fn(|n| x[3 + n] - number(wind_m_s[n]));
        let u = turned(&back(&q), &relative, two);
        turned(&q, &in_air(&own, thrust, &u), two)
    } else {
        turned_from_z(&q, thrust, two)
    };
    let [ahead, left, up] = force.map(|force| force / own[MASS]);
    Vector3::from(turned(&back(&q), &[ahead, left, (up - gravity) + gravity], two).map(|value| value.1))
}

#[cfg(test)]
mod tests;
