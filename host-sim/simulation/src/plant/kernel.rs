//! Runge-Kutta steps of plain craft, one or four side by side in the lanes of the processor's vector unit: figures, states, goals
//! and winds in; states after the step out.
//!
//! Every lane has the bits of that craft flown alone, and those of [`super::Craft`]'s own equations. A craft is plain when its motors
//! differ in place and reaction alone and nothing but them and the air pushes it.

use nalgebra::{Quaternion, UnitQuaternion, Vector3, Vector4};
use pulp::{Arch, Scalar, Simd, WithSimd};
use quatrack_design::model::GRAVITY_M_S2;

mod equations;

use self::equations::{
    BIAS, DRAG, FALL, FIGURES, INERTIA, INVERSE, InLanes, LEAST, LIFT, MASS, MOMENT, MOST, Number, PLACE_X, PLACE_Y,
    REACTION, RISE, Row, advanced, back, each, in_air, loaded, turned, turned_from_z,
};
pub(super) use self::equations::{Figures, LANES};
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

/// Four plants: their figures, states and steps by lanes.
#[derive(Clone, Debug)]
pub(super) struct SideBySide {
    figures: [Row; FIGURES],
    has_air: bool,
    /// [`is_diagonal`] of all.
    diagonal: bool,
    /// Whether the motors of each lag by as much on their way up as down.
    one_lag: bool,
    state: [Row; 17],
    goals: [Row; 4],
    from: [Row; 3],
    slope: [Row; 3],
    /// Of the wind's beginning, of the step's, and the step's length, s.
    times: [Row; 3],
    /// 0 where the state is finite.
    finite: Row,
    arch: Arch,
}

impl SideBySide {
    /// Of plants, some of which may be left out; there is air where one of them has some.
    pub(super) fn new(plants: &[Option<(Figures, bool)>; LANES]) -> Self {
        // A lane that is left out flies like another, and nobody looks at it.
        let other = plants.iter().flatten().next().map_or([1.0; FIGURES], |(figures, _)| *figures);
        let of = |lane: usize| plants[lane].map_or(other, |(figures, _)| figures);
        let lanes = [0, 1, 2, 3].map(of);
        Self {
            figures: std::array::from_fn(|k| lanes.map(|figures| figures[k])),
            has_air: plants.iter().flatten().any(|(_, has_air)| *has_air),
            diagonal: lanes.iter().all(is_diagonal),
            one_lag: lanes.iter().all(|figures| figures[RISE] == figures[FALL]),
            state: std::array::from_fn(|k| [f64::from(u8::from(k == 6)); LANES]),
            goals: [[0.0; LANES]; 4],
            from: [[0.0; LANES]; 3],
            slope: [[0.0; LANES]; 3],
            times: [[0.0; LANES]; 3],
            finite: [0.0; LANES],
            arch: Arch::new(),
        }
    }

    /// Sets the state of a lane.
    pub(super) fn put_state(&mut self, lane: usize, state: &RigidState) {
        let x = <[f64; 17]>::from(state.to_vector());
        self.state.iter_mut().zip(x).for_each(|(row, value)| row[lane] = value);
    }

    /// The next step of a lane, from its present state.
    #[inline]
    pub(super) fn put_step(&mut self, lane: usize, step: &Step) {
        for i in 0..4 {
            self.goals[i][lane] = step.goals_n[i];
        }
        if self.has_air {
            for i in 0..3 {
                self.from[i][lane] = step.wind.from_m_s[i];
                self.slope[i][lane] = step.wind.slope_m_s2[i];
            }
        }
        for (row, time_s) in self.times.iter_mut().zip([step.wind.from_s, step.from_s, step.step_s]) {
            row[lane] = time_s;
        }
    }

    /// Flies all of them on.
    pub(super) fn advance(&mut self) {
        let arch = self.arch;
        arch.dispatch(Advance(self));
    }

    /// A wind that stays the same.
    pub(super) fn put_wind(&mut self, lane: usize, wind_m_s: &Vector3<f64>) {
        for i in 0..3 {
            (self.from[i][lane], self.slope[i][lane]) = (wind_m_s[i], 0.0);
        }
    }

    /// The same for a step in which the goals alone are new.
    #[inline]
    pub(super) fn put_goals(&mut self, lane: usize, goals_n: &Vector4<f64>, from_s: f64, step_s: f64) {
        for i in 0..4 {
            self.goals[i][lane] = goals_n[i];
        }
        for (row, time_s) in self.times.iter_mut().zip([from_s, from_s, step_s]) {
            row[lane] = time_s;
        }
    }

    /// The state of a lane after a step.
    #[inline]
    pub(super) fn take(&self, lane: usize, state: &mut RigidState) {
        let x = &self.state;
        for i in 0..3 {
            state.position_m[i] = x[i][lane];
            state.velocity_m_s[i] = x[3 + i][lane];
            state.body_rates_rad_s[i] = x[10 + i][lane];
        }
        for i in 0..4 {
            state.thrusts_n[i] = x[13 + i][lane];
        }
        let attitude = Quaternion::new(x[6][lane], x[7][lane], x[8][lane], x[9][lane]);
        state.attitude = UnitQuaternion::new_unchecked(attitude);
    }

    /// Whether every number of a lane is finite after a step.
    #[inline]
    pub(super) fn is_finite(&self, lane: usize) -> bool {
        self.finite[lane] == 0.0
    }
}

struct Advance<'a>(&'a mut SideBySide);

impl WithSimd for Advance<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let all = self.0;
        for part in 0..LANES / S::F64_LANES {
            let figures = each!(Figures, I => loaded(simd, &all.figures[I], part));
            let x = each!(State, I => loaded(simd, &all.state[I], part));
            let step = InLanes {
                goals: each!(Four, I => loaded(simd, &all.goals[I], part)),
                from: each!(Three, I => loaded(simd, &all.from[I], part)),
                slope: each!(Three, I => loaded(simd, &all.slope[I], part)),
                since: loaded(simd, &all.times[0], part),
                start: loaded(simd, &all.times[1], part),
                step: loaded(simd, &all.times[2], part),
            };
            // Most crafts have the body's axes for axes of inertia, and one lag: they have code of their own.
            let next = match (all.has_air, all.diagonal, all.one_lag) {
                (false, true, true) => advanced::<_, false, true, true>(&figures, &x, &step),
                (true, true, true) => advanced::<_, true, true, true>(&figures, &x, &step),
                (false, true, false) => advanced::<_, false, true, false>(&figures, &x, &step),
                (true, true, false) => advanced::<_, true, true, false>(&figures, &x, &step),
                (false, false, _) => advanced::<_, false, false, false>(&figures, &x, &step),
                (true, false, _) => advanced::<_, true, false, false>(&figures, &x, &step),
            };
            // 0 for every number that is finite.
            let mut sum = next[0].of(0.0);
            let _ = each!(State, I => {
                S::as_mut_simd_f64s(&mut all.state[I]).0[part] = next[I].1;
                sum = sum + next[I] * sum.of(0.0);
            });
            S::as_mut_simd_f64s(&mut all.finite).0[part] = sum.1;
        }
    }
}

#[cfg(test)]
mod tests;
