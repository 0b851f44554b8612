//! Four plants in the lanes of the vector unit: their figures, states and steps in, lane by lane; their states after
//! the step out.

use nalgebra::{Quaternion, UnitQuaternion, Vector3, Vector4};
use pulp::{Arch, Simd, WithSimd};

use super::equations::{FALL, FIGURES, Figures, InLanes, RISE, advanced, each};
use super::number::{LANES, Row, loaded};
use super::{Step, is_diagonal};
use crate::plant::RigidState;

/// Four plants: their figures, states and steps by lanes.
#[derive(Clone, Debug)]
pub(in crate::plant) struct SideBySide {
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
    pub(in crate::plant) fn new(plants: &[Option<(Figures, bool)>; LANES]) -> Self {
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
    pub(in crate::plant) fn put_state(&mut self, lane: usize, state: &RigidState) {
        let x = <[f64; 17]>::from(state.to_vector());
        self.state.iter_mut().zip(x).for_each(|(row, value)| row[lane] = value);
    }

    /// The next step of a lane, from its present state.
    #[inline]
    pub(in crate::plant) fn put_step(&mut self, lane: usize, step: &Step) {
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
    pub(in crate::plant) fn advance(&mut self) {
        let arch = self.arch;
        arch.dispatch(Advance(self));
    }

    /// A wind that stays the same.
    pub(in crate::plant) fn put_wind(&mut self, lane: usize, wind_m_s: &Vector3<f64>) {
        for i in 0..3 {
            (self.from[i][lane], self.slope[i][lane]) = (wind_m_s[i], 0.0);
        }
    }

    /// The same for a step in which the goals alone are new.
    #[inline]
    pub(in crate::plant) fn put_goals(&mut self, lane: usize, goals_n: &Vector4<f64>, from_s: f64, step_s: f64) {
        for i in 0..4 {
            self.goals[i][lane] = goals_n[i];
        }
        for (row, time_s) in self.times.iter_mut().zip([from_s, from_s, step_s]) {
            row[lane] = time_s;
        }
    }

    /// The state of a lane after a step.
    #[inline]
    pub(in crate::plant) fn take(&self, lane: usize, state: &mut RigidState) {
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
    pub(in crate::plant) fn is_finite(&self, lane: usize) -> bool {
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
