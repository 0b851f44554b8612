//! Attitude and velocity by the inertial sensors and the position together: those of a log's own estimator in; those with which
//! gyroscope and accelerometer lead to the positions of the log out.
//!
//! A filter that does not know of drag leans by as much as the drag is of g, 7 degrees at 2 m/s, and one that is told no heading turns away
//! with the gyroscope's bias, by 0.3 rad in a minute. Both would go into drag and airflow moment, which are across the body. Neither is
//! needed here: gravity tells the tilt, and the direction of the acceleration tells the heading, once a log is looked at from both ends.
//!
//! Kalman's filter and the smoother of Rauch, Tung and Striebel over `[t b v p s k]`, about a reference attitude R_0: `R = exp(t) R_0`,
//! `R' = R (w - b)x`, `v' = R f - g`, `p' = v`, with the gyroscope w, its bias b and the accelerometer f. The log's position is
//! `p + s v + k v'`: a filter of bandwidth w that does not know of a drag d is off by `d v / (w^2 + 1.4 w D + D^2)`, D for the
//! derivative, so that s is `d / w^2` and k is `-1.4 d / w^3`. It is done again about the result, since R is not linear.

use nalgebra::{Matrix3, SMatrix, SVector, UnitQuaternion, Vector3};
use quatrack_design::model::GRAVITY_M_S2;

use super::STEP_S;
use super::grid::Grid;

/// Errors of attitude, gyroscope, velocity and position; the lag s and the second-order lag k of the estimator's position.
const STATES: usize = 14;
const TURN: usize = 0;
const BIAS: usize = 3;
const VELOCITY: usize = 6;
const POSITION: usize = 9;
const FIRST_LAG: usize = 12;
const SECOND_LAG: usize = 13;

/// Rounds about a better reference each.
const ROUNDS: usize = 2;

/// Deviations at the start: attitude, rad, gyroscope's bias, rad/s, velocity, m/s, position, m.
const AT_START: [f64; 4] = [0.1, 0.05, 0.5, 0.1];
/// Deviations of the lags at the start, s and s^2: a filter of 5 rad/s that does not know of a drag of 0.5 1/s has 0.02 s and 0.006 s^2.
const LAGS_AT_START: [f64; 2] = [0.03, 0.006];
/// Errors of gyroscope and accelerometer over a step of the grid, between their samples, rad/s and m/s^2.
const GYRO: f64 = 0.03;
const FORCE: f64 = 0.5;
/// The same where a sample is missing.
const MISSING: [f64; 2] = [3.0, 20.0];
/// Random steps of the gyroscope's bias, rad/s, and of the position, m, in a step of the grid.
const BIAS_WALKS: f64 = 1e-5;
const POSITION_WALKS: f64 = 1e-5;
/// Random steps of the lags, s and s^2: without them, ten minutes of rounding leave no covariance.
const LAG_WALKS: [f64; 2] = [3e-6, 3e-7];
/// Of a sample. An estimated position is off by 5 mm for a tenth of a second or more: by so much that all of its samples in that time
/// tell as much as one of them. So for a velocity where there is no position, m/s.
const SEEN_POSITION_M: f64 = 0.02;
const SEEN_VELOCITY_M_S: f64 = 0.2;
/// Of a sample, rad: the log's attitude itself counts for little, where nothing else tells the heading.
const SEEN_TURN: f64 = 3.0;

/// Attitude and velocity at every point.
pub(super) type Motion = (Vec<UnitQuaternion<f64>>, Vec<Vector3<f64>>);

type Vector = SVector<f64, STATES>;
type Matrix = SMatrix<f64, STATES, STATES>;

/// The estimate of one step by what was before it.
struct Filtered {
    state: Vector,
    covariance: Matrix,
}

/// What a step of the grid does to the state: `x' = F x + u`, noise Q.
struct Step {
    carry: Matrix,
    push: Vector,
    noise: Vector,
}

/// Attitude and velocity of a grid as its inertial sensors have them; none where they are no numbers.
pub(super) fn smoothed(grid: &Grid) -> Option<Motion> {
    if grid.len() < 2 {
        return None;
    }
    let mut grid = grid.clone();
    let logged = Logged { attitude: grid.attitude.clone(), velocity: grid.velocity.clone() };
    for _ in 0..ROUNDS {
        let states = round(&grid, &logged);
        if !states.iter().all(|state| state.iter().all(|value| value.is_finite())) {
            return None;
        }
        for (i, state) in states.iter().enumerate() {
            let turn: Vector3<f64> = state.fixed_rows::<3>(TURN).into_owned();
            grid.attitude[i] = UnitQuaternion::from_scaled_axis(turn) * grid.attitude[i];
            grid.velocity[i] = state.fixed_rows::<3>(VELOCITY).into_owned();
        }
    }
    Some((grid.attitude, grid.velocity))
}

fn round(grid: &Grid, logged: &Logged) -> Vec<Vector> {
    let count = grid.len();
    let mut filtered: Vec<Filtered> = Vec::with_capacity(count);
    let mut now = at_start(grid);
    logged.correct(grid, &mut now, 0);
    filtered.push(now);
    for i in 1..count {
        let step = step(grid, i - 1);
        let before = &filtered[i - 1];
        let mut now =
            Filtered { state: step.carry * before.state + step.push, covariance: carried(&before.covariance, &step) };
        logged.correct(grid, &mut now, i);
        filtered.push(now);
    }
    let mut states: Vec<Vector> = filtered.iter().map(|one| one.state).collect();
    for i in (0..count - 1).rev() {
        let step = step(grid, i);
        let Filtered { state, covariance } = &filtered[i];
        let ahead = carried(covariance, &step);
        let Some(factor) = ahead.cholesky() else { continue };
        let news = states[i + 1] - (step.carry * state + step.push);
        states[i] = state + covariance * step.carry.tr_mul(&factor.solve(&news));
    }
    states
}

fn at_start(grid: &Grid) -> Filtered {
    let mut state = Vector::zeros();
    state.fixed_rows_mut::<3>(VELOCITY).copy_from(&grid.velocity[0]);
    if let Some(position) = grid.position.first() {
        state.fixed_rows_mut::<3>(POSITION).copy_from(position);
    }
    let deviation = Vector::from_fn(|j, _| if j < FIRST_LAG { AT_START[j / 3] } else { LAGS_AT_START[j - FIRST_LAG] });
    Filtered { state, covariance: Matrix::from_diagonal(&deviation.component_mul(&deviation)) }
}

/// From point `i` of the grid to the next.
fn step(grid: &Grid, i: usize) -> Step {
    let h = STEP_S;
    let (here, next) = (grid.attitude[i], grid.attitude[i + 1]);
    let turned = UnitQuaternion::from_scaled_axis(0.5 * h * (grid.gyro[i] + grid.gyro[i + 1]));
    let off = (here * turned * next.inverse()).scaled_axis();
    let force = 0.5 * (here * grid.specific_force[i] + next * grid.specific_force[i + 1]);
    let fall = force - Vector3::new(0.0, 0.0, GRAVITY_M_S2);
    let across = -force.cross_matrix();
    let mut carry = Matrix::identity();
    carry.fixed_view_mut::<3, 3>(TURN, BIAS).copy_from(&(here.to_rotation_matrix().into_inner() * -h));
    carry.fixed_view_mut::<3, 3>(VELOCITY, TURN).copy_from(&(across * h));
    carry.fixed_view_mut::<3, 3>(POSITION, TURN).copy_from(&(across * (0.5 * h * h)));
    carry.fixed_view_mut::<3, 3>(POSITION, VELOCITY).copy_from(&(Matrix3::identity() * h));
    let mut push = Vector::zeros();
    push.fixed_rows_mut::<3>(TURN).copy_from(&off);
    push.fixed_rows_mut::<3>(VELOCITY).copy_from(&(fall * h));
    push.fixed_rows_mut::<3>(POSITION).copy_from(&(fall * (0.5 * h * h)));
    let [gyro, force] = if grid.on_board[i] && grid.on_board[i + 1] { [GYRO, FORCE] } else { MISSING };
    let deviations = [gyro * h, BIAS_WALKS, force * h, POSITION_WALKS];
    let deviation = |j: usize| if j < FIRST_LAG { deviations[j / 3] } else { LAG_WALKS[j - FIRST_LAG] };
    Step { carry, push, noise: Vector::from_fn(|j, _| deviation(j).powi(2)) }
}

fn carried(covariance: &Matrix, step: &Step) -> Matrix {
    let product = step.carry * covariance * step.carry.transpose();
    // Rounding takes its symmetry away, and then its sign.
    let mut ahead = 0.5 * (product + product.transpose());
    for j in 0..STATES {
        ahead[(j, j)] += step.noise[j];
    }
    ahead
}

/// What a log has beside the inertial sensors and the position.
struct Logged {
    attitude: Vec<UnitQuaternion<f64>>,
    velocity: Vec<Vector3<f64>>,
}

impl Logged {
    fn correct(&self, grid: &Grid, now: &mut Filtered, i: usize) {
        if !grid.pose[i] {
            return;
        }
        let turn = (self.attitude[i] * grid.attitude[i].inverse()).scaled_axis();
        now.see(TURN, &turn, SEEN_TURN);
        match grid.position.get(i) {
            Some(position) => {
                let force = grid.attitude[i] * grid.specific_force[i] - Vector3::new(0.0, 0.0, GRAVITY_M_S2);
                now.see_position(position, &grid.velocity[i], &force);
            }
            None => now.see(VELOCITY, &self.velocity[i], SEEN_VELOCITY_M_S),
        }
    }
}

impl Filtered {
    /// Three states that are seen as they are, one after the other.
    fn see(&mut self, from: usize, seen: &Vector3<f64>, deviation: f64) {
        for axis in 0..3 {
            let j = from + axis;
            let column: Vector = self.covariance.column(j).into_owned();
            let gain = column / (column[j] + deviation * deviation);
            self.state += gain * (seen[axis] - self.state[j]);
            self.covariance -= gain * column.transpose();
        }
    }

    /// A position with the lags of an estimator's.
    fn see_position(&mut self, seen: &Vector3<f64>, velocity: &Vector3<f64>, acceleration: &Vector3<f64>) {
        for axis in 0..3 {
            let mut row = Vector::zeros();
            (row[POSITION + axis], row[FIRST_LAG], row[SECOND_LAG]) = (1.0, velocity[axis], acceleration[axis]);
            let column = self.covariance * row;
            let gain = column / (row.dot(&column) + SEEN_POSITION_M * SEEN_POSITION_M);
            self.state += gain * (seen[axis] - row.dot(&self.state));
            self.covariance -= gain * column.transpose();
        }
    }
}
