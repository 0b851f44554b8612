//! Any law with its gain, chosen at run time: one type, so that one controller flies every kind of table.

#[cfg(feature = "cascade")]
use crate::cascade::Cascade;
#[cfg(feature = "actuator-aware")]
use crate::law::ActuatorAware;
use crate::law::{AlongTrajectory, Equilibrium, FlatOutput, IntegralAction};

/// Any law.
// With a tag of its own, where one in a gap between fields would take five instructions of every step to be read.
#[repr(u8)]
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Law<'a> {
    /// Linear in the state's error around hover.
    Equilibrium(Equilibrium<'a>),
    /// Linear in the flat state's error, through the flat map.
    FlatOutput(FlatOutput<'a>),
    /// Around hover with the integral of the position error.
    IntegralAction(IntegralAction<'a>),
    /// Gains over time along a trajectory.
    AlongTrajectory(AlongTrajectory<'a>),
    /// Straight to motor forces, with the motors' lag in the model.
    #[cfg(feature = "actuator-aware")]
    ActuatorAware(ActuatorAware<'a>),
    /// Straight to motor forces, in nested loops with limits, told of the air.
    #[cfg(feature = "cascade")]
    Cascade(&'a Cascade),
}

impl Law<'_> {
    #[cfg(feature = "actuator-aware")]
    /// Whether it follows motor forces: it then takes measured body rates, and a target made with
    /// [`super::Target::with_forces`] for the craft of its [`crate::Actuation`].
    #[inline]
    pub const fn follows_forces(&self) -> bool {
        matches!(self, Self::ActuatorAware(_))
    }

    #[cfg(feature = "cascade")]
    /// Whether it takes a target made with [`super::Target::with_sample`], and measured body rates.
    #[inline]
    pub const fn follows_samples(&self) -> bool {
        matches!(self, Self::Cascade(_))
    }

    /// Whether it moves on the integral of the position error.
    #[inline]
    pub const fn integrates(&self) -> bool {
        match self {
            #[cfg(feature = "actuator-aware")]
            Self::ActuatorAware(_) => true,
            Self::IntegralAction(_) => true,
            _ => false,
        }
    }

    /// Whether the integral of one means the same to the other: both are of one kind that integrates.
    pub(crate) const fn integrates_like(&self, other: &Self) -> bool {
        match (self, other) {
            #[cfg(feature = "actuator-aware")]
            (Self::ActuatorAware(_), Self::ActuatorAware(_)) => true,
            (Self::IntegralAction(_), Self::IntegralAction(_)) => true,
            _ => false,
        }
    }
}

impl<'a> From<Equilibrium<'a>> for Law<'a> {
    fn from(law: Equilibrium<'a>) -> Self {
        Self::Equilibrium(law)
    }
}

impl<'a> From<FlatOutput<'a>> for Law<'a> {
    fn from(law: FlatOutput<'a>) -> Self {
        Self::FlatOutput(law)
    }
}

impl<'a> From<IntegralAction<'a>> for Law<'a> {
    fn from(law: IntegralAction<'a>) -> Self {
        Self::IntegralAction(law)
    }
}

impl<'a> From<AlongTrajectory<'a>> for Law<'a> {
    fn from(law: AlongTrajectory<'a>) -> Self {
        Self::AlongTrajectory(law)
    }
}

#[cfg(feature = "actuator-aware")]
impl<'a> From<ActuatorAware<'a>> for Law<'a> {
    fn from(law: ActuatorAware<'a>) -> Self {
        Self::ActuatorAware(law)
    }
}

#[cfg(feature = "cascade")]
impl<'a> From<&'a Cascade> for Law<'a> {
    fn from(law: &'a Cascade) -> Self {
        Self::Cascade(law)
    }
}
