//! The gains of the cascade, chain by chain, as the LQR at hover gives them.
//!
//! Forces are in parts: each motor gives `t - r - p - y`, `t - r + p + y`, `t + r + p - y`, `t + r - p + y` of the thrust, roll,
//! pitch and yaw part ([`mod@crate::airframe`] has the order). A chain's command is the negative sum of its gains times its
//! errors.

use core::fmt;

/// From the errors of height, N per unit of the thrust part.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HeightGains {
    /// Gain of the position error, N/m.
    pub position: f32,
    /// Gain of the velocity error, N s/m.
    pub velocity: f32,
    /// Gain of the error of the force, 1.
    pub force: f32,
}

/// From the errors of one horizontal direction and the tilt that moves along it: roll with y, pitch with x.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TiltGains {
    /// Of the position error, N/m; below zero for roll, which moves the craft along -y.
    pub position: f32,
    /// Of the velocity error, N s/m; of the same sign.
    pub velocity: f32,
    /// Gain of the rotation vector, N/rad.
    pub rotation: f32,
    /// Gain of the body rate, N s/rad.
    pub body_rate: f32,
    /// Gain of the error of the force, 1.
    pub force: f32,
}

/// From the errors of heading.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct YawGains {
    /// Gain of the rotation vector, N/rad.
    pub rotation: f32,
    /// Gain of the body rate, N s/rad.
    pub body_rate: f32,
    /// Gain of the error of the force, 1.
    pub force: f32,
}

/// The gains of all four chains, of the signs that close each loop; checked by [`CascadeGains::new`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CascadeGains {
    height: HeightGains,
    roll: TiltGains,
    pitch: TiltGains,
    yaw: YawGains,
}

/// A gain that is zero, not finite, of a size that no craft's is or of the sign that drives the error on.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CascadeGainError {
    /// Its place in [`CascadeGains::numbers`].
    pub index: u8,
    /// Its value.
    pub value: f32,
}

impl CascadeGains {
    /// Number of gains.
    pub const COUNT: usize = 16;

    /// Sizes beyond which a number is no gain, either way.
    const SIZE: [f32; 2] = [1e-7, 1e4];

    /// Checks gains.
    ///
    /// # Errors
    /// [`CascadeGainError`] names the first that is none.
    pub const fn new(
        height: HeightGains,
        roll: TiltGains,
        pitch: TiltGains,
        yaw: YawGains,
    ) -> Result<Self, CascadeGainError> {
        let gains = Self { height, roll, pitch, yaw };
        let numbers = gains.numbers();
        let mut rest: &[f32] = &numbers;
        let mut index = 0;
        while let Some((value, after)) = rest.split_first() {
            // Roll answers to y, along which it moves the craft backwards, with the other sign.
            let upright = if index == 3 || index == 4 { -*value } else { *value };
            if !(upright >= Self::SIZE[0] && upright <= Self::SIZE[1]) {
                return Err(CascadeGainError { index, value: *value });
            }
            rest = after;
            index += 1;
        }
        Ok(gains)
    }

    /// From [`Self::numbers`].
    ///
    /// # Errors
    /// As [`Self::new`].
    pub const fn from_numbers(numbers: [f32; Self::COUNT]) -> Result<Self, CascadeGainError> {
        let [z, vz, fz, y, vy, roll, p, fr, x, vx, pitch, q, fp, yaw, r, fy] = numbers;
        let height = HeightGains { position: z, velocity: vz, force: fz };
        let roll = TiltGains { position: y, velocity: vy, rotation: roll, body_rate: p, force: fr };
        let pitch = TiltGains { position: x, velocity: vx, rotation: pitch, body_rate: q, force: fp };
        Self::new(height, roll, pitch, YawGains { rotation: yaw, body_rate: r, force: fy })
    }

    /// For tables in the source: a bad one does not compile when it initialises a constant.
    ///
    /// # Panics
    /// At compile time, on numbers that [`Self::new`] refuses.
    pub const fn table(numbers: [f32; Self::COUNT]) -> Self {
        match Self::from_numbers(numbers) {
            Ok(gains) => gains,
            Err(_) => panic!("the table holds a number that is no gain of a cascade"),
        }
    }

    /// All numbers: height (position, velocity, force), roll and pitch (position, velocity, rotation, body rate, force), yaw
    /// (rotation, body rate, force).
    pub const fn numbers(&self) -> [f32; Self::COUNT] {
        let Self { height: z, roll, pitch, yaw } = self;
        [
            z.position,
            z.velocity,
            z.force,
            roll.position,
            roll.velocity,
            roll.rotation,
            roll.body_rate,
            roll.force,
            pitch.position,
            pitch.velocity,
            pitch.rotation,
            pitch.body_rate,
            pitch.force,
            yaw.rotation,
            yaw.body_rate,
            yaw.force,
        ]
    }

    /// Stiffer or softer in position by a factor, as [`super::Cascade::with_stiffness`] flies them.
    pub const fn scaled(&self, factor: f32) -> Self {
        let Self { height, roll, pitch, yaw } = *self;
        Self {
            height: HeightGains {
                position: height.position * factor * factor,
                velocity: height.velocity * factor,
                ..height
            },
            roll: TiltGains { position: roll.position * factor * factor, velocity: roll.velocity * factor, ..roll },
            pitch: TiltGains { position: pitch.position * factor * factor, velocity: pitch.velocity * factor, ..pitch },
            yaw,
        }
    }

    /// Gains of height.
    pub const fn height(&self) -> &HeightGains {
        &self.height
    }

    /// Gains of y and roll.
    pub const fn roll(&self) -> &TiltGains {
        &self.roll
    }

    /// Gains of x and pitch.
    pub const fn pitch(&self) -> &TiltGains {
        &self.pitch
    }

    /// Gains of heading.
    pub const fn yaw(&self) -> &YawGains {
        &self.yaw
    }
}

impl fmt::Display for CascadeGainError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [least, most] = CascadeGains::SIZE;
        write!(
            f,
            "cascade gain {} is {}; its size must be within {least} to {most}, and its sign must close the loop",
            self.index, self.value
        )
    }
}

impl core::error::Error for CascadeGainError {}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The Brushless at 50 ms.
    pub(crate) const BRUSHLESS: CascadeGains = CascadeGains::table([
        0.3125, 0.1481, 0.585, -0.2147, -0.1053, 0.2005, 0.01866, 1.999, 0.2150, 0.1060, 0.2034, 0.01918, 1.921,
        0.01115, 0.00830, 0.1490,
    ]);

    #[test]
    fn numbers_give_the_gains_back() {
        assert_eq!(CascadeGains::from_numbers(BRUSHLESS.numbers()), Ok(BRUSHLESS));
        assert_eq!(BRUSHLESS.pitch().body_rate, 0.01918);
    }

    #[test]
    fn every_gain_of_the_wrong_sign_or_no_number_is_named() {
        for index in 0..CascadeGains::COUNT {
            for factor in [-1.0, 0.0, f32::NAN, f32::INFINITY] {
                let mut numbers = BRUSHLESS.numbers();
                numbers[index] *= factor;
                let error = CascadeGains::from_numbers(numbers).unwrap_err();
                assert_eq!(usize::from(error.index), index);
            }
        }
    }
}
