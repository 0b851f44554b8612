//! A design carried out: design in; gains, certificate and table out, or the figure that fails.

use quatrack::cascade::{Air, CascadeGainError, CascadeGains};
use quatrack::gains::table::{
    CascadeFigure, CascadeRange, CascadeTable, Hash, Name, ScheduleRows, TableError, TableHead, TableKind, Vehicle,
};
use quatrack_design::certify::cascade::{CascadeCertificate, CascadeRegionCertificate, certify_cascade_region};
use quatrack_design::certify::{Certificate, Minimum, RegionCertificate, certify_region, motor_lag_limit, require};
use serde::Serialize;

use super::GainsError;
use super::board_certificate::{BoardCertificate, sha256};
use super::design::{Design, Problem};
use super::designed::Designed;
use super::kinds::{Gains, TableRows};
use super::table::Table;
use crate::vehicles;

/// A design with its gains and their certificate.
#[derive(Debug, Clone)]
pub struct Certified {
    /// The design.
    pub design: Design,
    /// SHA-256 of the design's entries.
    pub design_hash: Hash,
    /// Its gains in f64.
    pub designed: Designed,
    /// Every figure of the gains as rounded to f32.
    pub certificate: Certificate,
    /// Over the region that an actuator-aware design asks for.
    pub region: Option<RegionCertificate>,
    /// Over the region that a design of the cascade asks for.
    pub cascade_region: Option<CascadeRegionCertificate>,
    /// The certificate that the table carries.
    pub statement: BoardCertificate,
    /// The table; none where no law on board flies the gains, as those that remember past commands, or the actuator-aware ones.
    pub table: Option<Table>,
}

/// The entries over which the hash of a design is taken: all that its gains, its limits and its acceptance depend on.
#[derive(Debug, Serialize)]
pub(super) struct Essence<'a> {
    vehicle: String,
    vehicle_id: String,
    linearisation: &'static str,
    method: &'static str,
    parameters: &'a Problem,
    control_rate_hz: u32,
    rate_loop_gain_1_s: Option<f64>,
    thrust_m_s2: [f32; 2],
    body_rates_max_rad_s: [f32; 3],
    minimum: &'a Minimum,
}

impl Design {
    /// Computes the gains, certifies them as rounded to f32 and holds them against the design's own minimum.
    ///
    /// # Errors
    /// [`GainsError::Design`] and [`GainsError::Certify`] where there is nothing to certify; [`GainsError::Minimum`]
    /// with the first figure that falls short; [`GainsError::Table`] for gains that the core refuses.
    pub fn certify(&self) -> Result<Certified, GainsError> {
        let designed = Designed::of(self)?;
        let mut certificate = designed.certify(self)?;
        let mut region = None;
        if let (Problem::ActuatorAware { motor_lag_s, region: bounds, .. }, Some(gain)) =
            (&self.problem, &designed.gain_in_parts)
        {
            let period_s = 1.0 / f64::from(self.rate.hz());
            let found = certify_region(&self.vehicle, gain, *motor_lag_s, period_s, &bounds.grid())?;
            if found.spectral_radius.is_nan() || found.spectral_radius >= 1.0 {
                return Err(GainsError::Region { spectral_radius: found.spectral_radius, worst: found.worst });
            }
            region = Some(found);
            // The plant has its motors' lag already: the limit is of the whole lag, not of one on top.
            certificate.lag = vec![motor_lag_limit(&self.vehicle, gain, *motor_lag_s, period_s)?];
        }
        let cascade_region = self.cascade_region(&designed)?;
        require(&certificate, &self.minimum)?;
        let design_hash = sha256(&self.essence());
        let statement = BoardCertificate::new(self, &design_hash, &designed, &certificate);
        let head = TableHead {
            name: self.name,
            vehicle: self.table_vehicle()?,
            rate: self.rate,
            limits: self.limits,
            design_hash,
            certificate: statement.on_board(),
        };
        let table = if designed.past_command_gains.is_empty() {
            self.table(head, &designed.gains).map_err(GainsError::Table)?
        } else {
            None
        };
        Ok(Certified {
            design: self.clone(),
            design_hash,
            designed,
            certificate,
            region,
            cascade_region,
            statement,
            table,
        })
    }

    /// The region of a design of the cascade, stable all over.
    fn cascade_region(&self, designed: &Designed) -> Result<Option<CascadeRegionCertificate>, GainsError> {
        let (Problem::Cascade { motor_lag_s, air, region, .. }, Gains::Cascade(gains)) =
            (&self.problem, &designed.gains)
        else {
            return Ok(None);
        };
        let period_s = 1.0 / f64::from(self.rate.hz());
        let found = certify_cascade_region(&self.vehicle, **gains, *motor_lag_s, air, region, period_s)?;
        let unstable = |chain: &&CascadeCertificate| chain.spectral_radius.is_nan() || chain.spectral_radius >= 1.0;
        match found.seen.iter().chain(&found.unseen).find(unstable) {
            Some(CascadeCertificate { chain, worst, spectral_radius, .. }) => Err(GainsError::CascadeRegion {
                chain: *chain,
                spectral_radius: *spectral_radius,
                worst: Box::new(*worst),
            }),
            None => Ok(Some(found)),
        }
    }

    fn table(&self, head: TableHead, gains: &Gains) -> Result<Option<Table>, TableError> {
        Ok(Some(match gains.rows() {
            TableRows::Fixed(rows) => Table::new(head, &rows)?,
            TableRows::Chains(gains) => Table::of_cascade(head, &self.cascade_table(gains)?)?,
            TableRows::ActuatorAware(_) => return Ok(None),
            TableRows::OverTime(gains) => {
                let (trajectory, steps_per_knot) = self.problem.schedule().unwrap_or_default();
                Table::over_time(&head, &ScheduleRows { trajectory, steps_per_knot, gains: &gains })?
            }
        }))
    }

    fn cascade_table(&self, gains: [f32; 16]) -> Result<CascadeTable, TableError> {
        let Problem::Cascade { motor_lag_s, air, region, .. } = &self.problem else {
            return Err(TableError::Kind { found: TableKind::Cascade.number() });
        };
        let refused = |error: CascadeGainError| TableError::Cascade {
            figure: CascadeFigure::Gain { index: error.index },
            value: error.value,
        };
        let pair = |pair: [f64; 2]| pair.map(|value| value as f32);
        Ok(CascadeTable {
            gains: CascadeGains::from_numbers(gains).map_err(refused)?,
            motor_lag_s: *motor_lag_s as f32,
            air: Air {
                drag_per_s: air.drag_per_s as f32,
                drag_along_share: 1.0,
                moment_n_s: pair(air.moment_n_s),
                gust: air.gust as f32,
                learn: air.learn,
            },
            certified: CascadeRange {
                motor_lag_s: pair(region.lag_s),
                mass_share: region.mass_share as f32,
                inertia_share: region.inertia_share as f32,
                force_share: pair(region.force_share),
                delay_s: region.delay_s as f32,
                drag_per_s: region.drag_per_s as f32,
                moment_n_s: pair(region.moment_n_s),
            },
        })
    }

    pub(super) fn essence(&self) -> Essence<'_> {
        let rates = self.limits.body_rates_max_rad_s();
        let (linearisation, method) = self.problem.named();
        Essence {
            vehicle: self.vehicle.name().to_owned(),
            vehicle_id: format!("{:08x}", vehicles::id(&self.vehicle)),
            linearisation,
            method,
            parameters: &self.problem,
            control_rate_hz: self.rate.hz(),
            rate_loop_gain_1_s: self.rate_loop_gain_1_s,
            thrust_m_s2: [self.limits.thrust_min_m_s2(), self.limits.thrust_max_m_s2()],
            body_rates_max_rad_s: [rates.x, rates.y, rates.z],
            minimum: &self.minimum,
        }
    }

    fn table_vehicle(&self) -> Result<Vehicle, GainsError> {
        let name = Name::new(self.vehicle.name()).map_err(|error| GainsError::Vehicle {
            vehicle: self.vehicle.name().to_owned(),
            reason: error.to_string(),
        })?;
        Ok(Vehicle { name, id: vehicles::id(&self.vehicle) })
    }
}

impl Certified {
    /// Why there is no table, where there is none.
    pub fn why_no_table(&self) -> &'static str {
        match self.design.problem {
            Problem::ActuatorAware { .. } => {
                "no board flies the actuator-aware law any more, so it has gains and a certificate alone; for a table write \
                 method = \"cascade\" and leave [weights] out"
            }
            _ => {
                "no law on board remembers its last commands, so delay_samples above 0 has gains and a certificate alone; for a \
                 table set delay_samples = 0"
            }
        }
    }

    /// The table as a file; nothing where there is none.
    pub fn to_bytes(&self) -> Option<Vec<u8>> {
        self.table.as_ref()?.to_bytes()
    }
}
