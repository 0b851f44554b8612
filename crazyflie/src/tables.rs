//! Tables to fly: those in the image and an uploaded one in; gains as flown, scaled within what their certificate allows,
//! out.

use quatrack::gains::paper;
use quatrack::gains::table::Rows;
use quatrack::law::{ActuatorAwareGain, EquilibriumGain, FlatOutputGain};
use quatrack::nalgebra::Vector3;
use quatrack::{ActuatorAware, Airframe, AirframeFigures, Limits};

use crate::builtin;
use crate::craft::{Craft, RATE};
use crate::shared::GAINS;
use crate::upload::Sent;

/// Which table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum TableId {
    /// The craft's own actuator-aware one, for the motor lag that is stated or else for any that is published of it.
    ActuatorAware = 0,
    /// (LYAP-E) of the paper.
    LyapE = 1,
    /// (LQR-E) of the paper.
    LqrE = 2,
    /// (LYAP-F) of the paper.
    LyapF = 3,
    /// (LQR-F) of the paper.
    LqrF = 4,
    /// The one that was sent last.
    Uploaded = 5,
}

impl TableId {
    /// By its number.
    pub const fn numbered(number: u8) -> Option<Self> {
        match number {
            0 => Some(Self::ActuatorAware),
            1 => Some(Self::LyapE),
            2 => Some(Self::LqrE),
            3 => Some(Self::LyapF),
            4 => Some(Self::LqrF),
            5 => Some(Self::Uploaded),
            _ => None,
        }
    }
}

/// A gain, and with it the law that it is for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "nothing is allocated: the largest has to have its place anyway")]
pub enum Gains {
    /// Thrust and body rates from the state.
    Equilibrium(EquilibriumGain),
    /// Thrust and body rates from the flat state.
    FlatOutput(FlatOutputGain),
    /// Motor forces.
    ActuatorAware(MotorGains),
}

/// A gain for motor forces, with the craft as its design takes it.
#[derive(Clone, Copy, Debug)]
pub struct MotorGains {
    /// The gain.
    pub gain: ActuatorAwareGain,
    /// The craft, its motors with the lag of the design.
    pub airframe: Airframe,
    /// The law but for the gain, which lies beside it.
    law: ActuatorAware<'static>,
}

impl MotorGains {
    /// A gain designed for motors of a lag.
    ///
    /// # Errors
    /// [`Refusal::MotorLag`] for a lag that the control rate cannot follow.
    pub const fn new(gain: &ActuatorAwareGain, airframe: &Airframe, lag_s: f32) -> Result<Self, Refusal> {
        let figures = AirframeFigures { motor_lag_s: lag_s, ..*airframe.figures() };
        let Ok(airframe) = Airframe::new(figures) else { return Err(Refusal::MotorLag) };
        let airframe = airframe.commanded_at(RATE);
        match ActuatorAware::new(&builtin::ANY, &airframe, RATE) {
            Ok(law) => Ok(Self { gain: *gain, airframe, law }),
            Err(_) => Err(Refusal::MotorLag),
        }
    }

    /// The law.
    #[inline]
    pub fn law(&self) -> ActuatorAware<'_> {
        let mut law = self.law;
        law.gain = &self.gain;
        law
    }
}

impl PartialEq for MotorGains {
    fn eq(&self, other: &Self) -> bool {
        self.gain == other.gain && self.airframe == other.airframe
    }
}

impl Gains {
    /// The entries that make up the gain where it falls apart as designs at hover do: thrust from height, roll from y,
    /// pitch from x, yaw from heading. [`crate::shared::Gains`] has what stands where.
    pub fn shown(&self) -> [f32; GAINS] {
        match self {
            Self::Equilibrium(gain) => {
                let [t, p, q, r] = *gain.gain().rows();
                let [_, _, tz, _, _, _, _, _, tv] = t;
                let [_, py, _, pq, _, _, _, pv, _] = p;
                let [qx, _, _, _, qq, _, qv, _, _] = q;
                let [_, _, _, _, _, rq, _, _, _] = r;
                [tz, tv, 0.0, 0.0, py, pv, pq, 0.0, 0.0, 0.0, qx, qv, qq, 0.0, 0.0, 0.0, rq, 0.0, 0.0]
            }
            Self::FlatOutput(gain) => {
                let [[x, _, _, vx, ..], [_, y, _, _, vy, ..], [_, _, z, _, _, vz, ..], jx, jy, _, yaw] =
                    *gain.gain().rows();
                let ([_, _, _, _, _, _, ax, ..], [_, _, _, _, _, _, _, ay, ..]) = (jx, jy);
                let [.., q3] = yaw;
                [z, vz, 0.0, 0.0, y, vy, ay, 0.0, 0.0, 0.0, x, vx, ax, 0.0, 0.0, 0.0, q3, 0.0, 0.0]
            }
            Self::ActuatorAware(MotorGains { gain, .. }) => {
                let [m1, m2, m3, _] = *gain.gain().rows();
                let [_, _, _, _, _, _, _, _, _, _, _, _, same, side, opposite, end, _, _, _] = m1;
                let [_, _, _, _, _, _, _, _, yaw, _, _, yaw_rate, ..] = m2;
                let [x, y, z, vx, vy, vz, roll, pitch, _, p, q, _, _, _, _, _, ix, iy, iz] = m3;
                let [thrust, of_roll, of_pitch, of_yaw] = [
                    same + side + opposite + end,
                    same + side - opposite - end,
                    same - side - opposite + end,
                    same - side + opposite - end,
                ];
                [z, vz, thrust, iz, y, vy, roll, p, of_roll, iy, x, vx, pitch, q, of_pitch, ix, yaw, yaw_rate, of_yaw]
            }
        }
    }
}

/// A table as it is flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table {
    /// Which.
    pub id: TableId,
    /// Its gain.
    pub gains: Gains,
    /// The loop stays stable with each of its channels weakened or strengthened by this factor, all at once.
    pub margin: f32,
    /// What it may command; what its own head says, or nothing.
    pub limits: Limits,
}

/// Factors on the feedback.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Of thrust, roll and pitch.
    pub position: f32,
    /// Of yaw.
    pub yaw: f32,
}

/// Why a table is not flown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Refusal {
    /// There is no such table.
    Unknown = 1,
    /// Nothing has been sent yet, or what was sent was refused.
    NothingUploaded = 2,
    /// Its certificate ends at a shorter motor lag than this craft's.
    MotorLag = 3,
    /// What was sent is no sound table with a certificate.
    Table = 4,
    /// It is for another vehicle or control rate.
    Vehicle = 5,
    /// It is for a law that is not flown here.
    Law = 6,
}

impl Table {
    /// A table in the image, or the uploaded one, for a craft.
    ///
    /// # Errors
    /// [`Refusal`].
    #[inline(never)]
    pub fn choose(number: u8, craft: &Craft, uploaded: Option<&Sent>) -> Result<Self, Refusal> {
        let motor_lag_s = craft.motor_lag_s;
        let id = TableId::numbered(number).ok_or(Refusal::Unknown)?;
        let (gains, margin, lag_max_s) = match id {
            TableId::ActuatorAware => return Self::actuator_aware(craft),
            TableId::LyapE => (Gains::Equilibrium(paper::LYAP_E), builtin::LYAP_E.0, builtin::LYAP_E.1),
            TableId::LqrE => (Gains::Equilibrium(paper::LQR_E), builtin::LQR_E.0, builtin::LQR_E.1),
            TableId::LyapF => (Gains::FlatOutput(paper::LYAP_F), builtin::LYAP_F.0, builtin::LYAP_F.1),
            TableId::LqrF => (Gains::FlatOutput(paper::LQR_F), builtin::LQR_F.0, builtin::LQR_F.1),
            TableId::Uploaded => return Self::uploaded(uploaded.ok_or(Refusal::NothingUploaded)?, craft),
        };
        let margin = behind_motors(margin, motor_lag_s, lag_max_s)?;
        Ok(Self { id, gains, margin, limits: Limits::NONE })
    }

    /// The craft's own: the gain that is certified for the stated lag, flown with it; with none stated the one for any
    /// published lag, flown with that of its design.
    ///
    /// # Errors
    /// [`Refusal::MotorLag`] for a stated lag that none is certified for, [`Refusal::Unknown`] where the craft has none.
    #[inline(never)]
    pub fn actuator_aware(craft: &Craft) -> Result<Self, Refusal> {
        let Some(lag_s) = craft.stated_lag_s else { return Self::for_any_published_lag(craft) };
        let designs = builtin::ACTUATOR_AWARE.get(craft.index).ok_or(Refusal::Unknown)?;
        let holds = |design: &&builtin::Design| {
            let [shortest_s, longest_s] = design.stated_s;
            lag_s >= shortest_s && lag_s <= longest_s
        };
        let design = designs.iter().find(holds).ok_or(Refusal::MotorLag)?;
        Self::designed(design, craft, lag_s, design.margin)
    }

    /// The craft's own for any motor lag that is published of it.
    ///
    /// # Errors
    /// [`Refusal::Unknown`] where there is none.
    #[inline(never)]
    pub fn for_any_published_lag(craft: &Craft) -> Result<Self, Refusal> {
        let [.., design] = builtin::ACTUATOR_AWARE.get(craft.index).ok_or(Refusal::Unknown)?;
        let (lag_s, margin) = builtin::ANY_LAG.get(craft.index).ok_or(Refusal::Unknown)?;
        Self::designed(design, craft, *lag_s, *margin)
    }

    fn designed(design: &builtin::Design, craft: &Craft, lag_s: f32, margin: f32) -> Result<Self, Refusal> {
        let gains = Gains::ActuatorAware(MotorGains::new(&design.gain, &craft.airframe, lag_s)?);
        Ok(Self { id: TableId::ActuatorAware, gains, margin, limits: Limits::NONE })
    }

    #[inline(never)]
    fn uploaded(sent: &Sent, craft: &Craft) -> Result<Self, Refusal> {
        let (head, gains) = match sent {
            Sent::BodyRates(table) => {
                let gains = match table.table().rows() {
                    Rows::Equilibrium(rows) => EquilibriumGain::new(rows).map(Gains::Equilibrium),
                    Rows::FlatOutput(rows) => FlatOutputGain::new(rows).map(Gains::FlatOutput),
                    Rows::Integral(_) => return Err(Refusal::Law),
                };
                (table.head(), gains.map_err(|_| Refusal::Table)?)
            }
            Sent::Motors(table) => {
                let gains = MotorGains::new(table.table().gain(), &craft.airframe, table.table().lag().lag_s())?;
                (table.table().head(), Gains::ActuatorAware(gains))
            }
        };
        let certificate = &head.certificate;
        let margin =
            behind_motors(certificate.all_channels.gain_factor, craft.motor_lag_s, certificate.motor_lag_max_s)?;
        Ok(Self { id: TableId::Uploaded, gains, margin, limits: head.limits })
    }

    /// The same with its feedback scaled, as far as its margin allows.
    #[inline(never)]
    pub fn scaled(&self, scales: &Scales) -> Self {
        let (least, most) = (1.0 / self.margin, self.margin);
        let within = |scale: f32| {
            if scale >= most {
                most
            } else if scale >= least {
                scale
            } else {
                least
            }
        };
        let scales = Scales { position: within(scales.position), yaw: within(scales.yaw) };
        let gains = match &self.gains {
            _ if scales == Scales::ONE => self.gains,
            Gains::Equilibrium(gain) => scale_equilibrium(gain, &scales),
            Gains::FlatOutput(gain) => scale_flat_output(gain, &scales),
            Gains::ActuatorAware(motors) => scale_actuator_aware(motors, &scales),
        };
        Self { gains, ..*self }
    }
}

impl Scales {
    /// The table as it is.
    pub const ONE: Self = Self { position: 1.0, yaw: 1.0 };
}

/// What the motors of a craft can do in the paper's terms, within body rates that its owner allows, rad/s, and within
/// what a table says of itself: the tighter of each. Where nothing is left of the thrust, the table's counts for nothing.
pub fn limits_within(airframe: &Airframe, body_rates_rad_s: Vector3<f32>, table: &Limits) -> Limits {
    let figures = airframe.figures();
    let per_mass = 4.0 / figures.mass_kg;
    let (min, max) = (figures.force_min_n * per_mass, figures.force_max_n * per_mass);
    let (table_rates, lesser) = (table.body_rates_max_rad_s(), |a: f32, b: f32| if a < b { a } else { b });
    let rates = Vector3::new(
        lesser(body_rates_rad_s.x, table_rates.x),
        lesser(body_rates_rad_s.y, table_rates.y),
        lesser(body_rates_rad_s.z, table_rates.z),
    );
    let (table_min, table_max) = (table.thrust_min_m_s2(), table.thrust_max_m_s2());
    let tighter_min = if table_min > min { table_min } else { min };
    let tighter = Limits::new(tighter_min, lesser(max, table_max), rates);
    tighter.or_else(|_| Limits::new(min, max, rates)).unwrap_or(Limits::NONE)
}

/// What is left of a margin of the commands behind motors that lag, through the body-rate loop: half of what the lag
/// leaves on its way to the longest that is stable.
fn behind_motors(margin: f32, motor_lag_s: f32, lag_max_s: f32) -> Result<f32, Refusal> {
    let left = 1.0 - motor_lag_s / lag_max_s;
    if left >= 0.0 { Ok(1.0 + 0.5 * left * (margin - 1.0)) } else { Err(Refusal::MotorLag) }
}

/// Multiplies rows, but for the last, by one factor, and the last by the other.
#[inline(never)]
fn scale_rows(entries: &mut [f32], last: usize, scales: &Scales) {
    let others = entries.len().saturating_sub(last);
    for (index, entry) in entries.iter_mut().enumerate() {
        *entry *= if index < others { scales.position } else { scales.yaw };
    }
}

#[inline(never)]
fn scale_equilibrium(gain: &EquilibriumGain, scales: &Scales) -> Gains {
    let mut rows = *gain.gain().rows();
    scale_rows(rows.as_flattened_mut(), 9, scales);
    Gains::Equilibrium(EquilibriumGain::new(rows).unwrap_or(*gain))
}

#[inline(never)]
fn scale_flat_output(gain: &FlatOutputGain, scales: &Scales) -> Gains {
    let mut rows = *gain.gain().rows();
    scale_rows(rows.as_flattened_mut(), 10, scales);
    Gains::FlatOutput(FlatOutputGain::new(rows).unwrap_or(*gain))
}

/// In the parts of the forces that move the craft and turn it: column by column they are taken apart and put together
/// again. The block of the motors is symmetric, and stays so to the bit: its sixteen entries are four numbers.
#[inline(never)]
fn scale_actuator_aware(motors: &MotorGains, scales: &Scales) -> Gains {
    let gain = &motors.gain;
    let mut rows = *gain.gain().rows();
    {
        let [m1, m2, m3, m4] = &mut rows;
        scale_columns([m1, m2, m3, m4], scales);
    }
    if gain.is_decoupled() {
        let [.., same, side, opposite, end, _, _, _] = rows[0];
        let lying = [
            [same, side, opposite, end],
            [side, same, end, opposite],
            [opposite, end, same, side],
            [end, opposite, side, same],
        ];
        for (row, block) in rows.iter_mut().zip(lying) {
            let [_, _, _, _, _, _, _, _, _, _, _, _, a, b, c, d, _, _, _] = row;
            [*a, *b, *c, *d] = block;
        }
    }
    Gains::ActuatorAware(MotorGains { gain: ActuatorAwareGain::new(rows).unwrap_or(*gain), ..*motors })
}

/// On slices, of whose length the compiler knows nothing and therefore unrolls nothing.
#[inline(never)]
fn scale_columns([m1, m2, m3, m4]: [&mut [f32]; 4], scales: &Scales) {
    let (s, y) = (scales.position, scales.yaw);
    for (((k1, k2), k3), k4) in m1.iter_mut().zip(m2).zip(m3).zip(m4) {
        // The yaw part of a column has the signs - + - +.
        let yaw = 0.25 * ((*k2 - *k1) + (*k4 - *k3));
        let change = (y - s) * yaw;
        [*k1, *k2, *k3, *k4] = [*k1 * s - change, *k2 * s + change, *k3 * s - change, *k4 * s + change];
    }
}
