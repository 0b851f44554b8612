//! The equations of [`super::super::Craft`] written out component by component, in the order in which nalgebra adds and multiplies:
//! figures, a state, goals and a wind in, each a number or a register of them; the state after a step out.

use pulp::Simd;
use quatrack_design::model::GRAVITY_M_S2;

use super::number::Number;

/// An array written out, entry by entry, with a constant for the index.
macro_rules! each {
    (@ $I:ident => $value:expr; $($i:literal)*) => { [$({ const $I: usize = $i; $value }),*] };
    (Three, $I:ident => $value:expr) => { each!(@ $I => $value; 0 1 2) };
    (Four, $I:ident => $value:expr) => { each!(@ $I => $value; 0 1 2 3) };
    (State, $I:ident => $value:expr) => { each!(@ $I => $value; 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16) };
    (Figures, $I:ident => $value:expr) => {
        each!(@ $I => $value; 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32 33 34 35 36 37 38 39 40 41 42 43)
    };
}
pub(super) use each;

/// The figures of a plain craft, in the order of the constants below.
pub(in crate::plant) type Figures = [f64; FIGURES];

pub(super) const RISE: usize = 0;
pub(super) const FALL: usize = 1;
pub(super) const LEAST: usize = 2;
pub(super) const MOST: usize = 3;
pub(super) const MASS: usize = 4;
/// Row by row.
pub(super) const INERTIA: usize = 5;
/// Likewise.
pub(super) const INVERSE: usize = 14;
pub(super) const PLACE_X: usize = 23;
pub(super) const PLACE_Y: usize = 27;
pub(super) const REACTION: usize = 31;
/// About x, y and z.
pub(super) const BIAS: usize = 35;
pub(super) const DRAG: usize = 38;
pub(super) const MOMENT: usize = 41;
pub(super) const LIFT: usize = 43;
pub(super) const FIGURES: usize = 44;

pub(super) struct InLanes<S: Simd> {
    pub(super) goals: [Number<S>; 4],
    pub(super) from: [Number<S>; 3],
    pub(super) slope: [Number<S>; 3],
    pub(super) since: Number<S>,
    pub(super) start: Number<S>,
    pub(super) step: Number<S>,
}

pub(super) type State<S> = [Number<S>; 17];

// No closures from here on: a callback of the standard library is compiled without the vector unit's instructions. And no
// loops over states: an array that is indexed by a variable stays in memory.

/// The classical Runge-Kutta method, in the order of [`crate::integrator::Method`].
#[inline(always)]
pub(super) fn advanced<S: Simd, const AIR: bool, const DIAGONAL: bool, const ONE_LAG: bool>(
    own: &[Number<S>; FIGURES],
    x: &State<S>,
    step: &InLanes<S>,
) -> State<S> {
    let (h, t) = (step.step, step.start);
    let (half, sixth, two) = (h / h.of(2.0), h / h.of(6.0), h.of(2.0));
    // Summed up as they come: four slopes at once have no room in the registers.
    let mut sum = slope::<S, AIR, DIAGONAL, ONE_LAG>(own, x, step, t);
    let k = slope::<S, AIR, DIAGONAL, ONE_LAG>(own, &moved(x, &sum, half), step, t + half);
    add_twice(&mut sum, &k, two);
    let k = slope::<S, AIR, DIAGONAL, ONE_LAG>(own, &moved(x, &k, half), step, t + half);
    add_twice(&mut sum, &k, two);
    let k = slope::<S, AIR, DIAGONAL, ONE_LAG>(own, &moved(x, &k, h), step, t + h);
    let mut next = each!(State, I => x[I] + (sum[I] + k[I]) * sixth);
    [next[6], next[7], next[8], next[9]] = unit(&next);
    next
}

#[inline(always)]
fn add_twice<S: Simd>(sum: &mut State<S>, k: &State<S>, two: Number<S>) {
    *sum = each!(State, I => sum[I] + k[I] * two);
}

#[inline(always)]
fn moved<S: Simd>(x: &State<S>, k: &State<S>, by: Number<S>) -> State<S> {
    each!(State, I => x[I] + k[I] * by)
}

/// The quaternion of a state at length 1.
#[inline(always)]
pub(super) fn unit<S: Simd>(x: &State<S>) -> [Number<S>; 4] {
    let [w, i, j, k] = [x[6], x[7], x[8], x[9]];
    let norm = ((i * i + k * k) + (j * j + w * w)).sqrt();
    [w / norm, i / norm, j / norm, k / norm]
}

#[inline(always)]
fn slope<S: Simd, const AIR: bool, const DIAGONAL: bool, const ONE_LAG: bool>(
    own: &[Number<S>; FIGURES],
    x: &State<S>,
    step: &InLanes<S>,
    t: Number<S>,
) -> State<S> {
    let v = [x[3], x[4], x[5]];
    let q = [x[6], x[7], x[8], x[9]];
    let rates = [x[10], x[11], x[12]];
    let f = [x[13], x[14], x[15], x[16]];
    let zero = t.of(0.0);
    let two = t.of(2.0);

    let thrust_rates = each!(Four, M => {
        let missing = step.goals[M].max(own[LEAST]).min(own[MOST]) - f[M];
        missing / if ONE_LAG { own[RISE] } else { missing.more_than(zero, own[RISE], own[FALL]) }
    });
    let thrust = ((f[0] + f[1]) + f[2]) + f[3];
    let mut torque = [own[BIAS], own[BIAS + 1], own[BIAS + 2]];
    let _ = each!(Four, M => {
        torque[0] = torque[0] + own[PLACE_Y + M] * f[M];
        torque[1] = torque[1] - own[PLACE_X + M] * f[M];
        torque[2] = torque[2] + own[REACTION + M] * f[M];
    });
    let force = if AIR {
        let since = t - step.since;
        let relative = each!(Three, N => v[N] - (step.from[N] + step.slope[N] * since));
        let u = turned(&back(&q), &relative, two);
        torque[0] = torque[0] + own[MOMENT] * u[1];
        torque[1] = torque[1] - own[MOMENT + 1] * u[0];
        turned(&q, &in_air(own, thrust, &u), two)
    } else {
        turned_from_z(&q, thrust, two)
    };
    let momentum = times::<S, DIAGONAL>(own, INERTIA, &rates);
    let gyroscopic = cross(&rates, &momentum);
    let left = [torque[0] - gyroscopic[0], torque[1] - gyroscopic[1], torque[2] - gyroscopic[2]];
    let turning = times::<S, DIAGONAL>(own, INVERSE, &left);
    let ([w, i, j, k], [p, r, s]) = (q, rates);
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

/// Force in the body frame of a thrust and of a velocity through the air.
#[inline(always)]
pub(super) fn in_air<S: Simd>(own: &[Number<S>; FIGURES], thrust: Number<S>, u: &[Number<S>; 3]) -> [Number<S>; 3] {
    let zero = thrust.of(0.0);
    let lift = own[LIFT] * (u[0] * u[0] + u[1] * u[1]);
    let along = thrust + (lift - own[DRAG + 2] * u[2]);
    [zero - own[DRAG] * u[0], zero - own[DRAG + 1] * u[1], along]
}

#[inline(always)]
pub(super) fn back<S: Simd>(q: &[Number<S>; 4]) -> [Number<S>; 4] {
    let zero = q[0].of(0.0);
    [q[0], zero - q[1], zero - q[2], zero - q[3]]
}

#[inline(always)]
fn cross<S: Simd>(a: &[Number<S>; 3], b: &[Number<S>; 3]) -> [Number<S>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A vector turned by a unit quaternion.
#[inline(always)]
pub(super) fn turned<S: Simd>(q: &[Number<S>; 4], v: &[Number<S>; 3], two: Number<S>) -> [Number<S>; 3] {
    let imaginary = [q[1], q[2], q[3]];
    let [tx, ty, tz] = cross(&imaginary, v);
    let t = [tx * two, ty * two, tz * two];
    let beside = cross(&imaginary, &t);
    [(t[0] * q[0] + beside[0]) + v[0], (t[1] * q[0] + beside[1]) + v[1], (t[2] * q[0] + beside[2]) + v[2]]
}

/// The same for a vector along z: without the products with 0.
#[inline(always)]
pub(super) fn turned_from_z<S: Simd>(q: &[Number<S>; 4], z: Number<S>, two: Number<S>) -> [Number<S>; 3] {
    let [w, i, j, k] = *q;
    let (tx, ty) = ((j * z) * two, (z.of(0.0) - i * z) * two);
    [tx * w - k * ty, ty * w + k * tx, (i * ty - j * tx) + z]
}

/// A matrix by its rows times a vector; of a diagonal one, its diagonal alone.
#[inline(always)]
fn times<S: Simd, const DIAGONAL: bool>(own: &[Number<S>; FIGURES], from: usize, v: &[Number<S>; 3]) -> [Number<S>; 3] {
    if DIAGONAL {
        return [own[from] * v[0], own[from + 4] * v[1], own[from + 8] * v[2]];
    }
    each!(Three, ROW => {
        let first = from + 3 * ROW;
        (own[first] * v[0] + own[first + 1] * v[1]) + own[first + 2] * v[2]
    })
}
