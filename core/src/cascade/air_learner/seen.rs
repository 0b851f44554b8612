//! The inputs of an update, and the memory that the air learner has from one to the next, with the coefficients that come
//! of it.

use nalgebra::Vector3;

use crate::mixer::Parts;

/// The inputs of an update.
#[derive(Clone, Copy, Debug)]
pub(in crate::cascade) struct Felt<'a> {
    /// Specific force in the body frame, m/s^2.
    pub(in crate::cascade) accelerometer: Option<&'a Vector3<f32>>,
    /// The reference's velocity in its own body frame, x and y, m/s.
    pub(in crate::cascade) body_velocity: [f32; 2],
    pub(in crate::cascade) body_rates: &'a Vector3<f32>,
    /// The motors' forces, in parts.
    pub(in crate::cascade) forces: &'a Parts,
    /// Whether the craft flies where it was sent with motors within their range.
    pub(in crate::cascade) undisturbed: bool,
}

/// The air as it is flown with.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(in crate::cascade) struct Coefficients {
    /// Drag over mass, 1/s.
    pub(in crate::cascade) drag: f32,
    /// Moment per velocity as parts of the forces, N s/m.
    pub(in crate::cascade) moment: [f32; 2],
}

impl Coefficients {
    /// Drag alone.
    pub(in crate::cascade) const fn without_moment(self) -> Self {
        Self { moment: [0.0; 2], ..self }
    }
}

/// Memory of the air learner: low-passed signals, sums of the regressions and the learned coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(in crate::cascade) struct SeenAir {
    /// The learned coefficients; nothing while the told ones are flown with.
    pub(in crate::cascade) learned: Option<Coefficients>,
    /// The wind's moment that is answered, as parts: roll and pitch, N.
    pub(in crate::cascade) wind: [f32; 2],
    /// Low-passed: felt force, velocity, body rates, torque as parts; x and y each.
    pub(super) low: [[f32; 2]; 4],
    /// Slowly low-passed, to be taken off: felt force, velocity, torque of the air.
    pub(super) slow: [[f32; 2]; 3],
    /// Sums of products: drag, moment about x, moment about y.
    pub(super) products: [f32; 3],
    pub(super) squares: [f32; 3],
    /// Steps until the next update.
    pub(in crate::cascade) wait: u8,
}

impl SeenAir {
    /// Nothing seen yet.
    pub(in crate::cascade) const NONE: Self = Self {
        learned: None,
        wind: [0.0; 2],
        low: [[0.0; 2]; 4],
        slow: [[0.0; 2]; 3],
        products: [0.0; 3],
        squares: [0.0; 3],
        wait: 0,
    };

    /// Nothing is learned and no wind answered while the craft stands on the ground; the learned figures stay.
    pub(in crate::cascade) fn rest(&mut self) {
        *self = Self { learned: self.learned, products: self.products, squares: self.squares, ..Self::NONE };
    }
}
