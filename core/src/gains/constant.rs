//! A gain that is the same all the time, of any law: every product keeps, scales, shows and flies it.

use crate::clock::Rate;
use crate::control::{Controller, ControllerError, Law, Measured, Memory, Output, Settings, Target};
use crate::error::StepError;
use crate::law::{
    ActuatorAware, ActuatorAwareGain, Equilibrium, EquilibriumGain, FlatOutput, FlatOutputGain, IntegralAction,
    IntegralGain,
};
use crate::mixer::Parts;

/// A gain with the law that it is for.
// With a tag of its own, as [`Law`] has one.
#[repr(u8)]
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to put the larger one on")]
#[non_exhaustive]
pub enum ConstantGain {
    /// For [`Equilibrium`].
    Equilibrium(EquilibriumGain),
    /// For [`FlatOutput`].
    FlatOutput(FlatOutputGain),
    /// For [`IntegralAction`].
    Integral(IntegralGain),
    /// For [`ActuatorAware`].
    ActuatorAware(ActuatorAwareGain),
}

/// Factors on the feedback.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Of thrust, roll and pitch, which move the craft.
    pub position: f32,
    /// Of yaw, which turns it about the vertical.
    pub yaw: f32,
}

impl Scales {
    /// The gain as it is.
    pub const ONE: Self = Self { position: 1.0, yaw: 1.0 };

    /// Each within one over `margin` and `margin`; a NaN counts as the least.
    pub fn within(&self, margin: f32) -> Self {
        let (least, most) = (1.0 / margin, margin);
        let cut = |scale: f32| {
            if scale >= most {
                most
            } else if scale >= least {
                scale
            } else {
                least
            }
        };
        Self { position: cut(self.position), yaw: cut(self.yaw) }
    }
}

/// The entries of a gain that decouples, by chain: zero where a law has none. Of a gain that does not decouple, the
/// entries in the same places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decoupled {
    /// Thrust from height, climb, thrust part of the motor forces, integral of height.
    pub thrust: [f32; 4],
    /// Roll from y, its velocity, rotation (or acceleration along y), roll rate, roll part of the motor forces, integral of y.
    pub roll: [f32; 6],
    /// Pitch from x, likewise.
    pub pitch: [f32; 6],
    /// Yaw from rotation, yaw rate, yaw part of the motor forces.
    pub yaw: [f32; 3],
}

impl ConstantGain {
    /// The law, for control steps at a rate.
    ///
    /// # Errors
    /// [`ControllerError::NoActuation`] where motor forces have nothing to carry them.
    #[inline]
    pub fn law<'a>(&'a self, rate: Rate, settings: &Settings<'a>) -> Result<Law<'a>, ControllerError> {
        let Settings { feed_forward, error_form, actuation, .. } = *settings;
        Ok(match self {
            Self::Equilibrium(gain) => Law::Equilibrium(Equilibrium { gain, error_form, feed_forward }),
            Self::FlatOutput(gain) => Law::FlatOutput(FlatOutput { gain, feed_forward }),
            Self::Integral(gain) => Law::IntegralAction(IntegralAction::new(gain, rate, feed_forward)),
            Self::ActuatorAware(gain) => {
                Law::ActuatorAware(ActuatorAware::new(gain, actuation.ok_or(ControllerError::NoActuation)?))
            }
        })
    }

    /// A step of its controller, for a caller that makes it anew for each: within the limits of the settings. The law of
    /// each arm is known to the compiler, so that it costs no more than a step of a controller that is kept.
    ///
    /// # Errors
    /// As [`Controller::step`].
    #[inline(always)]
    pub fn step(
        &self,
        rate: Rate,
        settings: &Settings<'_>,
        memory: &mut Memory,
        measured: Measured<'_>,
        target: Target<'_>,
    ) -> Result<Output, StepError> {
        let Settings { limits, feed_forward, error_form, actuation, .. } = *settings;
        match self {
            Self::Equilibrium(gain) => {
                let law = Equilibrium { gain, error_form, feed_forward };
                Controller::new(law, limits).step(memory, measured, target)
            }
            Self::FlatOutput(gain) => {
                Controller::new(FlatOutput { gain, feed_forward }, limits).step(memory, measured, target)
            }
            Self::Integral(gain) => {
                let law = IntegralAction::new(gain, rate, feed_forward);
                Controller::new(law, limits).step(memory, measured, target)
            }
            Self::ActuatorAware(gain) => {
                let law = ActuatorAware::new(gain, actuation.ok_or(StepError::NoActuation)?);
                Controller::new(law, limits).step(memory, measured, target)
            }
        }
    }

    /// Whether its law gives motor forces.
    pub const fn gives_forces(&self) -> bool {
        matches!(self, Self::ActuatorAware(_))
    }

    /// With its feedback scaled.
    #[must_use]
    #[inline(never)]
    pub fn scaled(&self, scales: &Scales) -> Self {
        match self {
            _ if *scales == Scales::ONE => *self,
            Self::Equilibrium(gain) => {
                let mut rows = *gain.gain().rows();
                scale_rows(rows.as_flattened_mut(), 9, scales);
                EquilibriumGain::new(rows).map_or(*self, Self::Equilibrium)
            }
            Self::FlatOutput(gain) => {
                let mut rows = *gain.gain().rows();
                scale_rows(rows.as_flattened_mut(), 10, scales);
                FlatOutputGain::new(rows).map_or(*self, Self::FlatOutput)
            }
            Self::Integral(gain) => {
                let mut rows = gain.rows();
                scale_rows(rows.as_flattened_mut(), 12, scales);
                IntegralGain::new(rows).map_or(*self, Self::Integral)
            }
            Self::ActuatorAware(gain) => {
                let rows = scaled_to_motors(gain, scales);
                ActuatorAwareGain::new(rows).map_or(*self, Self::ActuatorAware)
            }
        }
    }

    /// The entries by chain.
    pub fn decoupled(&self) -> Decoupled {
        match self {
            Self::Equilibrium(gain) => around_hover(gain.gain().rows(), [[0.0; 3]; 4]),
            Self::Integral(gain) => {
                let rows = gain.rows();
                let integrals = rows.map(|[.., x, y, z]| [x, y, z]);
                around_hover(
                    &rows.map(|[x, y, z, q1, q2, q3, vx, vy, vz, ..]| [x, y, z, q1, q2, q3, vx, vy, vz]),
                    integrals,
                )
            }
            Self::FlatOutput(gain) => {
                let [[x, _, _, vx, ..], [_, y, _, _, vy, ..], [_, _, z, _, _, vz, ..], jx, jy, _, yaw] =
                    *gain.gain().rows();
                let ([_, _, _, _, _, _, ax, ..], [_, _, _, _, _, _, _, ay, ..]) = (jx, jy);
                let [.., q3] = yaw;
                Decoupled {
                    thrust: [z, vz, 0.0, 0.0],
                    roll: [y, vy, ay, 0.0, 0.0, 0.0],
                    pitch: [x, vx, ax, 0.0, 0.0, 0.0],
                    yaw: [q3, 0.0, 0.0],
                }
            }
            Self::ActuatorAware(gain) => {
                // M3 has all but yaw with a positive sign, M2 has yaw with one.
                let [m1, m2, m3, _] = *gain.gain().rows();
                let [_, _, _, _, _, _, _, _, _, _, _, _, same, side, across, end, _, _, _] = m1;
                let [_, _, _, _, _, _, _, _, yaw, _, _, yaw_rate, ..] = m2;
                let [x, y, z, vx, vy, vz, roll, pitch, _, p, q, _, _, _, _, _, ix, iy, iz] = m3;
                Decoupled {
                    thrust: [z, vz, same + side + across + end, iz],
                    roll: [y, vy, roll, p, same + side - across - end, iy],
                    pitch: [x, vx, pitch, q, same - side - across + end, ix],
                    yaw: [yaw, yaw_rate, same - side + across - end],
                }
            }
        }
    }
}

/// Of `[T p q r]` from `[x y z q1 q2 q3 vx vy vz]` and from `[ix iy iz]`.
fn around_hover([t, p, q, r]: &[[f32; 9]; 4], [it, ip, iq, _]: [[f32; 3]; 4]) -> Decoupled {
    let [_, _, z, _, _, _, _, _, vz] = *t;
    let [_, y, _, q1, _, _, _, vy, _] = *p;
    let [x, _, _, _, q2, _, vx, _, _] = *q;
    let [_, _, _, _, _, q3, _, _, _] = *r;
    let ([_, _, iz], [_, iy, _], [ix, _, _]) = (it, ip, iq);
    Decoupled {
        thrust: [z, vz, 0.0, iz],
        roll: [y, vy, q1, 0.0, 0.0, iy],
        pitch: [x, vx, q2, 0.0, 0.0, ix],
        yaw: [q3, 0.0, 0.0],
    }
}

/// Multiplies rows, but for the last, by one factor, and the last by the other.
#[inline(never)]
fn scale_rows(entries: &mut [f32], last: usize, scales: &Scales) {
    let others = entries.len().saturating_sub(last);
    for (index, entry) in entries.iter_mut().enumerate() {
        *entry *= if index < others { scales.position } else { scales.yaw };
    }
}

/// In the parts of the forces that move the craft and turn it: column by column they are taken apart and put together
/// again. The block of the motors is symmetric, and stays so to the bit: its sixteen entries are four numbers.
fn scaled_to_motors(gain: &ActuatorAwareGain, scales: &Scales) -> [[f32; 19]; 4] {
    let mut rows = *gain.gain().rows();
    {
        let [m1, m2, m3, m4] = &mut rows;
        scale_columns([m1, m2, m3, m4], scales);
    }
    if gain.is_decoupled() {
        let [.., same, side, across, end, _, _, _] = rows[0];
        let lying = [
            [same, side, across, end],
            [side, same, end, across],
            [across, end, same, side],
            [end, across, side, same],
        ];
        for (row, block) in rows.iter_mut().zip(lying) {
            let [_, _, _, _, _, _, _, _, _, _, _, _, a, b, c, d, _, _, _] = row;
            [*a, *b, *c, *d] = block;
        }
    }
    rows
}

/// On slices, of whose length the compiler knows nothing and therefore unrolls nothing.
#[inline(never)]
fn scale_columns([m1, m2, m3, m4]: [&mut [f32]; 4], scales: &Scales) {
    let (s, y) = (scales.position, scales.yaw);
    for (((k1, k2), k3), k4) in m1.iter_mut().zip(m2).zip(m3).zip(m4) {
        let yaw = 0.25 * Parts::four_times_of([*k1, *k2, *k3, *k4]).yaw;
        let change = (y - s) * yaw;
        [*k1, *k2, *k3, *k4] = [*k1 * s - change, *k2 * s + change, *k3 * s - change, *k4 * s + change];
    }
}
