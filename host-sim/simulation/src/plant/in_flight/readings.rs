//! A plant in; its readings out: state, time, wind, voltage, limits, and the specific force of an accelerometer.

use nalgebra::{Vector3, Vector4};

use super::Plant;
use crate::plant::craft::LinearWind;
use crate::plant::kernel;
use crate::plant::supply::Supply;
use crate::plant::{Motion, RigidState};

impl Plant {
    /// Its state.
    pub fn state(&self) -> &RigidState {
        &self.state
    }

    /// Whether every number of its state is finite.
    pub fn is_finite(&self) -> bool {
        self.finite
    }

    /// Time since the start, s.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Velocity of the air at the craft, world frame, m/s.
    pub fn wind_m_s(&self) -> &Vector3<f64> {
        &self.wind_m_s
    }

    /// Root mean square of the turbulence so far, along the mean wind, across it and upwards, m/s.
    pub fn realised_gust_rms_m_s(&self) -> Option<Vector3<f64>> {
        self.wind.realised_rms_m_s()
    }

    /// Voltage at the motors, V; 0 where nothing depends on it.
    #[inline]
    pub fn voltage_v(&self) -> f64 {
        self.supply.voltage_v(&self.state.thrusts_n)
    }

    /// Charge of the battery from 0 to 1, where there is one.
    pub fn charge(&self) -> Option<f64> {
        match self.supply {
            Supply::Constant(_) => None,
            Supply::Battery { charge, .. } => Some(charge),
        }
    }

    /// Least and most command that a motor takes, N; others are cut to them.
    pub fn command_limits_n(&self) -> [f64; 2] {
        self.converter.limits_n
    }

    /// Least and most thrust that each motor can be commanded to now, N.
    pub fn thrust_limits_n(&self) -> [Vector4<f64>; 2] {
        self.converter.limits_n.map(|limit_n| self.goals_n(Some(self.converter.acting(&Vector4::repeat(limit_n)))))
    }

    /// The reading of an accelerometer at the centre of mass, body frame, m/s^2: that of [`Self::motion`], for less.
    pub fn specific_force_m_s2(&mut self) -> Vector3<f64> {
        match &self.plain {
            Some((figures, has_air)) => kernel::felt_m_s2(figures, *has_air, &self.state, &self.wind_m_s),
            None => self.motion().specific_force_m_s2,
        }
    }

    /// Specific force at the centre of mass under the commands that act now.
    pub fn motion(&mut self) -> Motion {
        let (commands_n, _) = self.line.at(self.time_s);
        let goals_n = self.goals_n(commands_n.map(|commands_n| self.converter.acting(&commands_n)));
        let wind = LinearWind { from_s: self.time_s, from_m_s: self.wind_m_s, slope_m_s2: Vector3::zeros() };
        self.craft.motion(&self.state, &goals_n, &wind, self.time_s)
    }
}
