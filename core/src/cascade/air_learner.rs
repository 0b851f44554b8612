//! The coefficients of the air, estimated in flight: drag and moment by regression over accelerometer, gyroscope and the
//! commanded forces; the rest of the felt force is wind. A hundred times a second.
//!
//! All signals pass the same low-pass, LP at 8 rad/s. A force along body x and y that is felt is drag, `LP f = -d LP v`; a turning
//! that the motors do not explain is the air's moment, `i 8 (w - LP w) - LP t = (c_x v_y, -c_y v_x)` as parts. Behind a high-pass at
//! 1 rad/s, which takes biases off, each coefficient is a regression through the origin with some weight on the told figure. The
//! velocity is the **reference's**: with the measured one, a step of wind would be taken for drag.
//!
//! The felt force less that of the known drag is the wind's: `r = LP f + d LP v = d w`. It is fed forward into the moment
//! alone: as a force, a bias of the accelerometer of 0.05 g would cost 5 cm.

mod seen;

use nalgebra::Vector3;

pub(super) use self::seen::{Coefficients, Felt, SeenAir};
use super::air::Air;
use super::bounds::{between, shortened};
use crate::airframe::Airframe;

/// Time between two updates, s.
const TICK_S: f32 = 0.01;
/// Shares of the filters an update: 8 and 1 rad/s over [`TICK_S`].
const LOW_PASS: f32 = 8.0 * TICK_S / (1.0 + 4.0 * TICK_S);
const HIGH_PASS: f32 = TICK_S;
/// Weight of the told figures, and most weight of the measurements, m^2/s.
const TOLD_WEIGHT: f32 = 0.02;
const SEEN_MOST: f32 = 30.0;
/// Least drag by which a felt force is taken for a wind, 1/s.
const DRAG_LEAST_PER_S: f32 = 0.2;
/// Moment over drag beyond which the learned figures are not trusted: over the told one, or where none is told, N s^2.
const RATIO_MOST_SHARE: f32 = 1.5;
const RATIO_MOST_UNTOLD: f32 = 2.5e-3;
/// Largest felt force of a wind, m/s^2.
const WIND_MAX_M_S2: f32 = 2.0;
/// Largest specific force that an accelerometer shows, m/s^2: 32 g.
const FELT_MAX_M_S2: f32 = 314.0;

/// The told figures, in the units of the forces' parts.
#[derive(Clone, Copy, Debug)]
pub(super) struct AirLearner {
    told: Coefficients,
    /// Four levers: moment per part, m.
    levers_m: [f32; 2],
    inertia: [f32; 2],
    gyroscopic: [f32; 2],
    /// Largest part of the moment per velocity, and per felt force.
    moment_most: [f32; 2],
    ratio_most: [f32; 2],
    gust: f32,
    learn: bool,
    /// Steps between two updates.
    steps: u8,
}

impl AirLearner {
    /// For a craft that is told of air, at a control period.
    pub(super) const fn new(air: &Air, airframe: &Airframe, period_s: f32) -> Self {
        let [[cx, cy], lever] = [air.moment_n_s, [4.0 * airframe.figures().lever_arm_m; 2]];
        let [lx, ly] = lever;
        let ([ix, iy, _], [gx, gy, _]) = (airframe.mixing.inertia, airframe.mixing.gyroscopic);
        let drag = if air.drag_per_s > DRAG_LEAST_PER_S { air.drag_per_s } else { DRAG_LEAST_PER_S };
        let told = Coefficients { drag: air.drag_per_s, moment: [cx / lx, cy / ly] };
        let steps = (TICK_S / period_s + 0.5) as u8;
        Self {
            told,
            levers_m: lever,
            inertia: [ix, iy],
            gyroscopic: [gx, gy],
            moment_most: [Air::MOMENT_MAX_N_S / lx, Air::MOMENT_MAX_N_S / ly],
            ratio_most: [ratio_most(cx, drag) / lx, ratio_most(cy, drag) / ly],
            gust: air.gust,
            learn: air.learn,
            steps: if steps == 0 { 1 } else { steps },
        }
    }

    /// The air that is flown with.
    pub(super) const fn now(&self, seen: &SeenAir) -> Coefficients {
        match seen.learned {
            Some(learned) if self.learn => learned,
            _ => self.told,
        }
    }

    /// Moment per velocity that is flown with, N s.
    pub(super) const fn moment_n_s(&self, now: &Coefficients) -> [f32; 2] {
        let ([x, y], [lx, ly]) = (now.moment, self.levers_m);
        [x * lx, y * ly]
    }

    /// Moves the memory on by a control step.
    #[inline(always)]
    pub(super) fn step(&self, seen: &mut SeenAir, felt: &Felt<'_>) {
        if seen.wait > 0 {
            seen.wait -= 1;
            return;
        }
        seen.wait = self.steps - 1;
        let is_sound = |a: &&Vector3<f32>| a.x.abs() <= FELT_MAX_M_S2 && a.y.abs() <= FELT_MAX_M_S2;
        match felt.accelerometer.filter(is_sound) {
            Some(accelerometer) => self.update(seen, felt, [accelerometer.x, accelerometer.y]),
            None => seen.wind = [0.0; 2],
        }
    }

    #[inline(never)]
    fn update(&self, seen: &mut SeenAir, felt: &Felt<'_>, force: [f32; 2]) {
        let (w, f) = (felt.body_rates, felt.forces);
        let [gx, gy] = self.gyroscopic;
        let torque = [f.roll - gx * (w.y * w.z), f.pitch - gy * (w.x * w.z)];
        let [low_force, low_velocity, low_rates, low_torque] = &mut seen.low;
        let force = followed(low_force, force, LOW_PASS);
        let velocity = followed(low_velocity, felt.body_velocity, LOW_PASS);
        let [p, q] = *low_rates;
        let [p1, q1] = followed(low_rates, [w.x, w.y], LOW_PASS);
        let [tx, ty] = followed(low_torque, torque, LOW_PASS);
        let [ix, iy] = self.inertia;
        let per_tick = 1.0 / TICK_S;
        let of_air = [ix * (p1 - p) * per_tick - tx, iy * (q1 - q) * per_tick - ty];

        if self.learn {
            let [slow_force, slow_velocity, slow_torque] = &mut seen.slow;
            let [ax, ay] = without(force, followed(slow_force, force, HIGH_PASS));
            let [vx, vy] = without(velocity, followed(slow_velocity, velocity, HIGH_PASS));
            let [mx, my] = without(of_air, followed(slow_torque, of_air, HIGH_PASS));
            if felt.undisturbed {
                let (xx, yy) = (TICK_S * (vx * vx), TICK_S * (vy * vy));
                let added = [-(vx * ax + vy * ay), vy * mx, -(vx * my)];
                self.regress(seen, added, [xx + yy, yy, xx]);
            }
        }

        let now = self.now(seen);
        let drag = now.drag;
        let [fx, fy] = force;
        let [vx, vy] = velocity;
        let [rx, ry] = shortened([fx + drag * vx, fy + drag * vy], WIND_MAX_M_S2);
        let per_drag = self.gust / if drag > DRAG_LEAST_PER_S { drag } else { DRAG_LEAST_PER_S };
        let ([cx, cy], [most_x, most_y]) = (now.moment, self.ratio_most);
        let (most_x, most_y) = (self.gust * most_x, self.gust * most_y);
        seen.wind = [between(cx * per_drag, 0.0, most_x) * ry, -between(cy * per_drag, 0.0, most_y) * rx];
    }

    /// Adds products and squares, and solves.
    fn regress(&self, seen: &mut SeenAir, products: [f32; 3], squares: [f32; 3]) {
        let [mx, my] = self.told.moment;
        let [most_x, most_y] = self.moment_most;
        let of = |product: &mut f32, square: &mut f32, added: (f32, f32), told: f32, most: f32| {
            *product += TICK_S * added.0;
            *square += added.1;
            if *square > SEEN_MOST {
                *product *= SEEN_MOST / *square;
                *square = SEEN_MOST;
            }
            between((*product + TOLD_WEIGHT * told) / (*square + TOLD_WEIGHT), 0.0, most)
        };
        let ([pd, px, py], [sd, sx, sy]) = (&mut seen.products, &mut seen.squares);
        let ([ad, ax, ay], [bd, bx, by]) = (products, squares);
        let drag = of(pd, sd, (ad, bd), self.told.drag, Air::DRAG_MAX_PER_S);
        let moment = [of(px, sx, (ax, bx), mx, most_x), of(py, sy, (ay, by), my, most_y)];
        seen.learned = Some(Coefficients { drag, moment });
    }
}

/// Most moment over drag, N s^2.
const fn ratio_most(moment: f32, drag: f32) -> f32 {
    if moment > 0.0 { RATIO_MOST_SHARE * moment / drag } else { RATIO_MOST_UNTOLD }
}

/// A first-order filter's new value.
#[inline(always)]
fn followed(filter: &mut [f32; 2], [x, y]: [f32; 2], share: f32) -> [f32; 2] {
    let [a, b] = *filter;
    *filter = [a + share * (x - a), b + share * (y - b)];
    *filter
}

#[inline(always)]
fn without([x, y]: [f32; 2], [a, b]: [f32; 2]) -> [f32; 2] {
    [x - a, y - b]
}

#[cfg(test)]
mod tests;
