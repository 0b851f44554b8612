//! Runge-Kutta steps of plain craft, one or four side by side in the lanes of the processor's vector unit: figures, states, goals
//! and winds in; states after the step out.
//!
//! Instruction-shaping code: it writes out the equations of [`super::Craft`] component by component, in the order in which
//! nalgebra adds and multiplies, so that every lane has the bits of that craft flown alone. A craft is plain when its motors
//! differ in place and reaction alone and nothing but them and the air pushes it.

use nalgebra::Vector4;
use pulp::{Arch, Scalar, Simd, WithSimd};
use quatrack_design::model::GRAVITY_M_S2;

use super::craft::LinearWind;
use super::state::RigidVector;
use super::{Craft, RigidState};

/// Plants side by side.
pub(super) const LANES: usize = 4;

/// A number of each plant.
type Row = [f64; LANES];

/// What a plain craft is, in the order of the constants below.
pub(super) type Figures = [f64; FIGURES];

const RISE: usize = 0;
const FALL: usize = 1;
const LEAST: usize = 2;
const MOST: usize = 3;
const MASS: usize = 4;
/// Row by row.
const INERTIA: usize = 5;
/// Likewise.
const INVERSE: usize = 14;
const PLACE_X: usize = 23;
const PLACE_Y: usize = 27;
const REACTION: usize = 31;
/// About x, y and z.
const BIAS: usize = 35;
const DRAG: usize = 38;
const MOMENT: usize = 41;
const LIFT: usize = 43;
const FIGURES: usize = 44;

/// What one step of one plant needs besides its figures and its state.
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
    let next = if has_air { advanced::<_, true>(&own, &x, &step) } else { advanced::<_, false>(&own, &x, &step) };
    RigidState::from_vector(&RigidVector::from(next.map(|value| value.1)))
}

/// Four plants: their figures, states and steps by lanes.
#[derive(Clone, Debug)]
pub(super) struct SideBySide {
    figures: [Row; FIGURES],
    has_air: bool,
    state: [Row; 17],
    goals: [Row; 4],
    from: [Row; 3],
    slope: [Row; 3],
    since: Row,
    start: Row,
    step: Row,
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
            state: std::array::from_fn(|k| [f64::from(u8::from(k == 6)); LANES]),
            goals: [[0.0; LANES]; 4],
            from: [[0.0; LANES]; 3],
            slope: [[0.0; LANES]; 3],
            since: [0.0; LANES],
            start: [0.0; LANES],
            step: [0.0; LANES],
        }
    }

    /// What a lane flies next.
    pub(super) fn put(&mut self, lane: usize, state: &RigidState, step: &Step) {
        let x = <[f64; 17]>::from(state.to_vector());
        self.state.iter_mut().zip(x).for_each(|(row, value)| row[lane] = value);
        self.goals.iter_mut().zip(step.goals_n.iter()).for_each(|(row, value)| row[lane] = *value);
        self.from.iter_mut().zip(step.wind.from_m_s.iter()).for_each(|(row, value)| row[lane] = *value);
        self.slope.iter_mut().zip(step.wind.slope_m_s2.iter()).for_each(|(row, value)| row[lane] = *value);
        self.since[lane] = step.wind.from_s;
        self.start[lane] = step.from_s;
        self.step[lane] = step.step_s;
    }

    /// Flies all of them on.
    pub(super) fn advance(&mut self) {
        Arch::new().dispatch(Advance(self));
    }

    /// Where a lane is.
    pub(super) fn state(&self, lane: usize) -> RigidState {
        RigidState::from_vector(&RigidVector::from(self.state.map(|row| row[lane])))
    }
}

struct Advance<'a>(&'a mut SideBySide);

impl WithSimd for Advance<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let all = self.0;
        for part in 0..LANES / S::F64_LANES {
            let load = |row: &Row| Number(simd, S::as_simd_f64s(row).0[part]);
            let figures = all.figures.each_ref().map(load);
            let x = all.state.each_ref().map(load);
            let step = InLanes {
                goals: all.goals.each_ref().map(load),
                from: all.from.each_ref().map(load),
                slope: all.slope.each_ref().map(load),
                since: load(&all.since),
                start: load(&all.start),
                step: load(&all.step),
            };
            let next = if all.has_air {
                advanced::<_, true>(&figures, &x, &step)
            } else {
                advanced::<_, false>(&figures, &x, &step)
            };
            for (row, value) in all.state.iter_mut().zip(next) {
                S::as_mut_simd_f64s(row).0[part] = value.1;
            }
        }
    }
}

/// A number of each plant in a register.
#[derive(Clone, Copy)]
struct Number<S: Simd>(S, S::f64s);

macro_rules! operator {
    ($Trait: ident, $method: ident, $own: ident) => {
        impl<S: Simd> std::ops::$Trait for Number<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0, self.0.$own(self.1, other.1))
            }
        }
    };
}
operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);

impl<S: Simd> Number<S> {
    #[inline(always)]
    fn of(self, value: f64) -> Self {
        Self(self.0, self.0.splat_f64s(value))
    }

    /// One of two, by whether this is more than another.
    #[inline(always)]
    fn more_than(self, other: Self, then: Self, otherwise: Self) -> Self {
        Self(self.0, self.0.select_f64s(self.0.greater_than_f64s(self.1, other.1), then.1, otherwise.1))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.more_than(other, self, other)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.more_than(other, other, self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0, self.0.sqrt_f64s(self.1))
    }
}

struct InLanes<S: Simd> {
    goals: [Number<S>; 4],
    from: [Number<S>; 3],
    slope: [Number<S>; 3],
    since: Number<S>,
    start: Number<S>,
    step: Number<S>,
}

type State<S> = [Number<S>; 17];

/// The classical Runge-Kutta method, in the order of [`crate::integrator::Method`].
#[inline(always)]
fn advanced<S: Simd, const AIR: bool>(own: &[Number<S>; FIGURES], x: &State<S>, step: &InLanes<S>) -> State<S> {
    let (h, t) = (step.step, step.start);
    let half = h / h.of(2.0);
    let k1 = slope::<S, AIR>(own, x, step, t);
    let k2 = slope::<S, AIR>(own, &moved(x, &k1, half), step, t + half);
    let k3 = slope::<S, AIR>(own, &moved(x, &k2, half), step, t + half);
    let k4 = slope::<S, AIR>(own, &moved(x, &k3, h), step, t + h);
    let (sixth, two) = (h / h.of(6.0), h.of(2.0));
    std::array::from_fn(|i| x[i] + (k1[i] + k2[i] * two + k3[i] * two + k4[i]) * sixth)
}

#[inline(always)]
fn moved<S: Simd>(x: &State<S>, k: &State<S>, by: Number<S>) -> State<S> {
    std::array::from_fn(|i| x[i] + k[i] * by)
}

#[inline(always)]
fn slope<S: Simd, const AIR: bool>(
    own: &[Number<S>; FIGURES],
    x: &State<S>,
    step: &InLanes<S>,
    t: Number<S>,
) -> State<S> {
    let v = [x[3], x[4], x[5]];
    let rates = [x[10], x[11], x[12]];
    let f = [x[13], x[14], x[15], x[16]];
    let zero = t.of(0.0);
    let two = t.of(2.0);
    // The unit quaternion of what is integrated.
    let [w, i, j, k] = [x[6], x[7], x[8], x[9]];
    let norm = ((i * i + k * k) + (j * j + w * w)).sqrt();
    let q = [w / norm, i / norm, j / norm, k / norm];

    let thrust_rates: [Number<S>; 4] = std::array::from_fn(|m| {
        let missing = step.goals[m].max(own[LEAST]).min(own[MOST]) - f[m];
        missing / missing.more_than(zero, own[RISE], own[FALL])
    });
    let mut force = [zero, zero, ((f[0] + f[1]) + f[2]) + f[3]];
    let mut torque = [own[BIAS], own[BIAS + 1], own[BIAS + 2]];
    for (m, thrust) in f.iter().enumerate() {
        torque[0] = torque[0] + own[PLACE_Y + m] * *thrust;
        torque[1] = torque[1] - own[PLACE_X + m] * *thrust;
        torque[2] = torque[2] + own[REACTION + m] * *thrust;
    }
    if AIR {
        let since = t - step.since;
        let relative = std::array::from_fn(|n| v[n] - (step.from[n] + step.slope[n] * since));
        let back = [q[0], zero - q[1], zero - q[2], zero - q[3]];
        let u = turned(&back, &relative, two);
        let lift = own[LIFT] * (u[0] * u[0] + u[1] * u[1]);
        force[0] = zero - own[DRAG] * u[0];
        force[1] = zero - own[DRAG + 1] * u[1];
        force[2] = force[2] + (lift - own[DRAG + 2] * u[2]);
        torque[0] = torque[0] + own[MOMENT] * u[1];
        torque[1] = torque[1] - own[MOMENT + 1] * u[0];
    }
    let force = turned(&q, &force, two);
    let momentum = times(own, INERTIA, &rates);
    let gyroscopic = cross(&rates, &momentum);
    let turning = times(own, INVERSE, &std::array::from_fn(|n| torque[n] - gyroscopic[n]));
    // Of the quaternion as it is: its length stays what it was.
    let [p, r, s] = rates;
    let by_half = t.of(0.5);
    [
        v[0],
        v[1],
        v[2],
        force[0] / own[MASS],
        force[1] / own[MASS],
        force[2] / own[MASS] - t.of(GRAVITY_M_S2),
        (((zero - i * p) - j * r) - k * s) * by_half,
        ((w * p + j * s) - k * r) * by_half,
        ((w * r - i * s) + k * p) * by_half,
        ((w * s + i * r) - j * p) * by_half,
        turning[0],
        turning[1],
        turning[2],
        thrust_rates[0],
        thrust_rates[1],
        thrust_rates[2],
        thrust_rates[3],
    ]
}

#[inline(always)]
fn cross<S: Simd>(a: &[Number<S>; 3], b: &[Number<S>; 3]) -> [Number<S>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A vector turned by a unit quaternion.
#[inline(always)]
fn turned<S: Simd>(q: &[Number<S>; 4], v: &[Number<S>; 3], two: Number<S>) -> [Number<S>; 3] {
    let imaginary = [q[1], q[2], q[3]];
    let t = cross(&imaginary, v).map(|value| value * two);
    let beside = cross(&imaginary, &t);
    std::array::from_fn(|n| (t[n] * q[0] + beside[n]) + v[n])
}

/// A matrix by its rows times a vector.
#[inline(always)]
fn times<S: Simd>(own: &[Number<S>; FIGURES], from: usize, v: &[Number<S>; 3]) -> [Number<S>; 3] {
    std::array::from_fn(|row| {
        let entry = |column: usize| own[from + 3 * row + column] * v[column];
        (entry(0) + entry(1)) + entry(2)
    })
}

#[cfg(test)]
mod tests;
