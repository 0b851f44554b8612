//! The head of a table, beside the gains: its vehicle, and the computed figures of its closed loop.

use core::f32::consts::PI;
use core::fmt;

use super::name::Name;

/// A vehicle, by name and by the parameters that a design used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Vehicle {
    /// Its name.
    pub name: Name,
    /// Which parameters it has (mass, inertia, motors): another number for other parameters.
    pub id: u32,
}

impl fmt::Display for Vehicle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (id {:08x})", self.name, self.id)
    }
}

/// A SHA-256. The board compares and reports it; it does not compute one. All zeros means there is none.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Hash(pub [u8; 32]);

impl Hash {
    /// None.
    pub const NONE: Self = Self([0; 32]);
}

impl fmt::Display for Hash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for Hash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// Disk-based margins at the plant's input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// The loop stays stable under every gain from one over this to this; above 1.
    pub gain_factor: f32,
    /// The loop stays stable under every phase shift of up to this, rad; above 0.
    pub phase_rad: f32,
}

/// Figures computed from the gains as the table stores them, for the closed loop at the table's rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certificate {
    /// SHA-256 of the certificate as a document.
    pub hash: Hash,
    /// The least margins of the four channels, each disturbed alone.
    pub one_channel: Margins,
    /// The margins with all four channels disturbed at once, each in its own way.
    pub all_channels: Margins,
    /// The largest delay at the plant's input that stays stable, s.
    pub delay_max_s: f32,
    /// The largest time constant of the motors that stays stable, s.
    pub motor_lag_max_s: f32,
    /// Largest difference of an entry from the gain designed in `f64`, over the largest entry.
    pub f32_distance: f32,
}

/// A figure of a [`Certificate`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Figure {
    /// Gain factor of [`Certificate::one_channel`].
    OneChannelGain,
    /// Phase of [`Certificate::one_channel`], rad.
    OneChannelPhase,
    /// Gain factor of [`Certificate::all_channels`].
    AllChannelsGain,
    /// Phase of [`Certificate::all_channels`], rad.
    AllChannelsPhase,
    /// [`Certificate::delay_max_s`].
    DelayMax,
    /// [`Certificate::motor_lag_max_s`].
    MotorLagMax,
    /// [`Certificate::f32_distance`].
    F32Distance,
}

impl Certificate {
    /// Largest factor that is taken for a gain margin.
    pub const GAIN_FACTOR_MAX: f32 = 1e3;
    /// Longest delay and lag that are taken for certified, s: a search that finds no end states this.
    pub const TIME_MAX_S: f32 = 10.0;
    /// Largest distance from the `f64` gains: rounding to nearest moves an entry by less than 6e-8 of it.
    pub const F32_DISTANCE_MAX: f32 = 1e-6;

    /// The figures, each with the largest value it may have.
    const fn figures(&self) -> [(Figure, f32, f32); 7] {
        let (one, all) = (&self.one_channel, &self.all_channels);
        [
            (Figure::OneChannelGain, one.gain_factor, Self::GAIN_FACTOR_MAX),
            (Figure::OneChannelPhase, one.phase_rad, PI),
            (Figure::AllChannelsGain, all.gain_factor, Self::GAIN_FACTOR_MAX),
            (Figure::AllChannelsPhase, all.phase_rad, PI),
            (Figure::DelayMax, self.delay_max_s, Self::TIME_MAX_S),
            (Figure::MotorLagMax, self.motor_lag_max_s, Self::TIME_MAX_S),
            (Figure::F32Distance, self.f32_distance, Self::F32_DISTANCE_MAX),
        ]
    }

    /// The first figure that certifies nothing, with its value: a gain factor of 1 or less, a phase or time of 0 or less, a
    /// figure above its maximum, NaN.
    pub(super) fn says_nothing(&self) -> Option<(Figure, f32)> {
        let says_something = |(figure, value, max): &(Figure, f32, f32)| {
            let certifies = match figure {
                Figure::OneChannelGain | Figure::AllChannelsGain => *value > 1.0,
                Figure::F32Distance => *value >= 0.0,
                _ => *value > 0.0,
            };
            certifies && *value <= *max
        };
        let (figure, value, _) = self.figures().into_iter().find(|figure| !says_something(figure))?;
        Some((figure, value))
    }
}

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::OneChannelGain => "gain margin of one channel",
            Self::OneChannelPhase => "phase margin of one channel (rad)",
            Self::AllChannelsGain => "gain margin of all channels",
            Self::AllChannelsPhase => "phase margin of all channels (rad)",
            Self::DelayMax => "largest delay (s)",
            Self::MotorLagMax => "largest motor lag (s)",
            Self::F32Distance => "distance from the f64 gains",
        })
    }
}
