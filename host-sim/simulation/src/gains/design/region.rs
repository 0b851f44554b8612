//! The region of a design of the cascade: what its file states, and where it asks for that, the intervals that were identified of the
//! vehicle, in; the bounds that the loop is certified over out.

use quatrack_design::certify::cascade::{CascadeAir, CascadeBounds};
use quatrack_design::vehicle::{Interval, Vehicle};

use super::entry::{check, missing};
use super::problem::IdentifiedBound;
use crate::gains::GainsError;
use crate::gains::file::{RegionEntry, RegionSource};

/// Delays in a region, ms: each period of it is a state.
const LONGEST_DELAY_MS: f64 = 50.0;
/// Most that mass or inertia may be off, percent.
const MOST_PERCENT: f64 = 90.0;
/// Most drag of the region where a design states none, 1/s.
const MOST_DRAG_PER_S: f64 = 0.6;
/// Most moment of the region over the identified one where a design states none.
const MOST_MOMENT: f64 = 1.2;
/// Inertia about yaw where flights told that about roll and pitch alone, percent: what the built-in tables are certified for.
const UNTOLD_YAW_PERCENT: f64 = 30.0;

/// Bounds in range, and which of them were identified.
pub(super) struct Region {
    pub(super) lags_ms: [f64; 2],
    pub(super) bounds: CascadeBounds,
    pub(super) from: Vec<IdentifiedBound>,
}

/// The stated bounds. Missing ones come from the vehicle's intervals where the design says `from = "identified"`; else they are
/// zero, but for the air's.
pub(super) fn resolved(
    entry: &RegionEntry,
    vehicle: &Vehicle,
    air: &CascadeAir,
    here: &dyn ToString,
) -> Result<Region, GainsError> {
    let identified =
        (entry.from == Some(RegionSource::Identified)).then(|| intervals(entry, vehicle, air)).transpose()?;
    let (found, from) = identified.unwrap_or_default();
    let lags_ms = entry.motor_lag_ms.or(found.lags_ms);
    let lags_ms = lags_ms.ok_or_else(|| missing("region.motor_lag_ms", here, "motor_lag_ms = [50.0, 126.0]"))?;
    let percent = |key: &str, stated: Option<f64>, found: Option<f64>| {
        let value = stated.or(found).unwrap_or_default();
        check((0.0..=MOST_PERCENT).contains(&value), key, value, format!("from 0 to {MOST_PERCENT}")).map(|()| value)
    };
    let mass_percent = percent("region.mass_percent", entry.mass_percent, found.mass_percent)?;
    let inertia_percent = percent("region.inertia_percent", entry.inertia_percent, found.inertia_percent)?;
    let delay_ms = entry.delay_ms.or(found.delay_ms).unwrap_or_default();
    let must = format!("from 0 to {LONGEST_DELAY_MS}");
    check((0.0..=LONGEST_DELAY_MS).contains(&delay_ms), "region.delay_ms", delay_ms, must)?;
    let [least, most] = entry.force_percent.unwrap_or([100.0; 2]);
    check((10.0..=100.0).contains(&least), "region.force_percent", least, "from 10 to 100 percent")?;
    check((100.0..=1000.0).contains(&most), "region.force_percent", most, "from 100 to 1000 percent")?;
    let told = [air.drag_per_s, air.moment_n_s[0], air.moment_n_s[1]];
    let whole = told.map(|told| told / air.share_of_identified);
    let drag_per_s = entry.drag_per_s.or(found.drag_per_s).unwrap_or_else(|| MOST_DRAG_PER_S.max(whole[0]));
    let stated = entry.moment_n_m_per_m_s.or(found.moment_n_s);
    let moment_n_s = stated.unwrap_or_else(|| [whole[1], whole[2]].map(|moment| MOST_MOMENT * moment));
    let must = |told: f64| format!("from {told}, which is told, to 10");
    check((told[0]..=10.0).contains(&drag_per_s), "region.drag_per_s", drag_per_s, must(told[0]))?;
    for (moment, told) in moment_n_s.into_iter().zip(air.moment_n_s) {
        check((told..=10.0).contains(&moment), "region.moment_n_m_per_m_s", moment, must(told))?;
    }
    Ok(Region {
        lags_ms,
        bounds: CascadeBounds {
            lag_s: lags_ms.map(|lag_ms| 1e-3 * lag_ms),
            mass_share: 1e-2 * mass_percent,
            inertia_share: 1e-2 * inertia_percent,
            yaw_inertia_share: found.yaw_inertia_percent.map(|percent| 1e-2 * percent),
            force_share: [1e-2 * least, 1e-2 * most],
            delay_s: 1e-3 * delay_ms,
            drag_per_s,
            moment_n_s,
        },
        from,
    })
}

/// What intervals come to, in the units of a design's keys.
#[derive(Default)]
struct Found {
    lags_ms: Option<[f64; 2]>,
    mass_percent: Option<f64>,
    inertia_percent: Option<f64>,
    yaw_inertia_percent: Option<f64>,
    delay_ms: Option<f64>,
    drag_per_s: Option<f64>,
    moment_n_s: Option<[f64; 2]>,
}

/// Intervals of a vehicle's file, and those that were taken.
struct Intervals<'a> {
    vehicle: &'a Vehicle,
    taken: Vec<IdentifiedBound>,
}

impl Intervals<'_> {
    fn take(&mut self, key: &'static str, figure: &'static str) -> Option<[f64; 2]> {
        let Interval { low, high, source } = self.vehicle.identified().get(figure)?.clone();
        self.taken.push(IdentifiedBound { key, figure, low, high, source });
        Some([low, high])
    }

    fn need(&mut self, key: &'static str, figure: &'static str) -> Result<[f64; 2], GainsError> {
        self.take(key, figure).ok_or_else(|| GainsError::Missing {
            key: format!("identified.{figure}"),
            with: "region.from = \"identified\"".to_owned(),
            example: "the vehicle's file has it where `quatrack identify` could tell the figure; else state the region's own key",
        })
    }
}

/// Intervals for all that the design does not state itself. A mass is weighed, not identified: what is off of the height's loop is the
/// thrust per mass.
fn intervals(
    entry: &RegionEntry,
    vehicle: &Vehicle,
    air: &CascadeAir,
) -> Result<(Found, Vec<IdentifiedBound>), GainsError> {
    let mut all = Intervals { vehicle, taken: Vec::new() };
    let mut found = Found::default();
    if entry.motor_lag_ms.is_none() {
        found.lags_ms = Some(all.need("motor_lag_ms", "lag_ms")?);
    }
    if entry.mass_percent.is_none() {
        let figure = "thrust_per_mass_m_s2";
        let [low, high] = all.need("mass_percent", figure)?;
        let force = vehicle.flown().force.ok_or_else(|| missing("[motors.force]", &"region.from", "full_n = 0.124"))?;
        let told = 4.0 * force.full_n / vehicle.mass_kg();
        // Less thrust per mass is more mass.
        check(low > 0.0, &format!("identified.{figure}.low"), low, "above 0")?;
        found.mass_percent = Some(1e2 * (told / low - 1.0).max(1.0 - told / high).max(0.0));
    }
    if entry.inertia_percent.is_none() {
        let inertia = vehicle.inertia_kg_m2();
        let off = |[low, high]: [f64; 2], axis: usize| {
            let told = inertia[(axis, axis)];
            1e2 * (high / told - 1.0).max(1.0 - low / told).max(0.0)
        };
        let x = off(all.need("inertia_percent", "inertia_x_kg_m2")?, 0);
        let y = off(all.need("inertia_percent", "inertia_y_kg_m2")?, 1);
        let z = all.take("inertia_percent", "inertia_z_kg_m2").map(|interval| off(interval, 2));
        found.inertia_percent = Some(x.max(y));
        found.yaw_inertia_percent = Some(z.unwrap_or(UNTOLD_YAW_PERCENT).max(x).max(y));
    }
    if entry.delay_ms.is_none() {
        let [_, most] = all.need("delay_ms", "delay_ms")?;
        found.delay_ms = Some(most.max(0.0));
    }
    if entry.drag_per_s.is_none() {
        let [x, y] = ["drag_x_per_s", "drag_y_per_s"].map(|figure| all.take("drag_per_s", figure));
        found.drag_per_s = x.zip(y).map(|([_, x], [_, y])| x.max(y).max(air.drag_per_s));
    }
    if entry.moment_n_m_per_m_s.is_none() {
        let figures = ["moment_x_n_m_per_m_s", "moment_y_n_m_per_m_s"];
        let [x, y] = figures.map(|figure| all.take("moment_n_m_per_m_s", figure));
        let [told_x, told_y] = air.moment_n_s;
        found.moment_n_s = x.zip(y).map(|([_, x], [_, y])| [x.max(told_x), y.max(told_y)]);
    }
    Ok((found, all.taken))
}
