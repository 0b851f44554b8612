//! A gain that is the same all the time, of any law: every product keeps, scales, shows and flies it.

use crate::clock::Rate;
use crate::control::{Controller, Law, Measured, Memory, Output, Settings, Target};
use crate::error::StepError;
use crate::law::{Equilibrium, EquilibriumGain, FlatOutput, FlatOutputGain, IntegralAction, IntegralGain};

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
    /// Thrust from height, climb, integral of height.
    pub thrust: [f32; 3],
    /// Roll from y, its velocity, rotation (or acceleration along y), integral of y.
    pub roll: [f32; 4],
    /// Pitch from x, likewise.
    pub pitch: [f32; 4],
    /// Yaw from rotation.
    pub yaw: f32,
}

impl ConstantGain {
    /// The law, for control steps at a rate.
    #[inline]
    pub fn law(&self, rate: Rate, settings: &Settings<'_>) -> Law<'_> {
        let Settings { feed_forward, error_form, .. } = *settings;
        match self {
            Self::Equilibrium(gain) => Law::Equilibrium(Equilibrium { gain, error_form, feed_forward }),
            Self::FlatOutput(gain) => Law::FlatOutput(FlatOutput { gain, feed_forward }),
            Self::Integral(gain) => Law::IntegralAction(IntegralAction::new(gain, rate, feed_forward)),
        }
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
        let Settings { limits, feed_forward, error_form, .. } = *settings;
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
        }
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
                Decoupled { thrust: [z, vz, 0.0], roll: [y, vy, ay, 0.0], pitch: [x, vx, ax, 0.0], yaw: q3 }
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
    Decoupled { thrust: [z, vz, iz], roll: [y, vy, q1, iy], pitch: [x, vx, q2, ix], yaw: q3 }
}

/// Multiplies rows, but for the last, by one factor, and the last by the other.
#[inline(never)]
fn scale_rows(entries: &mut [f32], last: usize, scales: &Scales) {
    let others = entries.len().saturating_sub(last);
    for (index, entry) in entries.iter_mut().enumerate() {
        *entry *= if index < others { scales.position } else { scales.yaw };
    }
}
