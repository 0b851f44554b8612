//! Tables in the image of the Crazyflie controller: which is flown for which lag, and with which certificate.

use nalgebra::DMatrix;
use quatrack::gains::cascade as tables;
use quatrack::gains::{Scales, paper};
use quatrack::{Air, CascadeGains, CascadeLimits};
use quatrack_crazyflie::craft::{Craft as FirmwareCraft, KNOWN};
use quatrack_crazyflie::tables::{Brought, Gain, Refusal, Table, TableId, Tuning};
use quatrack_design::certify::cascade::{CascadeCraft, CascadeRegion};
use quatrack_design::design::discretise::zero_order_hold;
use quatrack_simulation::crazyflie::Sensors;
use quatrack_simulation::vehicles;

use crate::setpoints::flight::CRAFTS;

pub(crate) const QUIET: Sensors = Sensors { gyro_noise_rad_s: 0.0, estimate_steps: 1 };
pub(crate) const LAG_S: f32 = 0.02;

pub(crate) fn craft_of(index: usize) -> FirmwareCraft {
    FirmwareCraft::with(KNOWN[index].airframe, &KNOWN[index], index).unwrap()
}

pub(crate) const TUNING: Tuning = Tuning { scales: Scales::ONE, air: Air::NONE, limits: CascadeLimits::STANDARD };

/// The lag that a cascade reckons with, s, and its gains.
pub(crate) fn flown(table: &Table) -> (f32, CascadeGains) {
    let Gain::Cascade(_, gains) = &table.gain else { panic!("no cascade") };
    (table.actuation.airframe().figures().motor_lag_s, *gains)
}

/// The gains of each known craft for stated lags: the longest that each is for, s.
pub(crate) fn stated() -> [[(f32, CascadeGains); 3]; 3] {
    [
        [
            (0.036, tables::CRAZYFLIE_2_1_20_MS.table.gains),
            (0.08, tables::CRAZYFLIE_2_1_63_MS.table.gains),
            (0.126, tables::CRAZYFLIE_2_1_100_MS.table.gains),
        ],
        [
            (0.036, tables::UPGRADE_KIT_20_MS.table.gains),
            (0.08, tables::UPGRADE_KIT_63_MS.table.gains),
            (0.126, tables::UPGRADE_KIT_100_MS.table.gains),
        ],
        [
            (0.032, tables::BRUSHLESS_20_MS.table.gains),
            (0.07, tables::BRUSHLESS_50_MS.table.gains),
            (0.126, tables::BRUSHLESS_110_MS.table.gains),
        ],
    ]
}

#[test]
fn a_stated_lag_is_flown_with_the_gains_that_are_certified_for_it() {
    for (index, (of_craft, (unstated, unstated_s))) in
        stated().into_iter().zip([(2, 0.1), (2, 0.1), (1, 0.05)]).enumerate()
    {
        let craft = craft_of(index);
        let chosen = |lag_s: f32| Table::choose(0, &craft.with_motor_lag(lag_s), &TUNING, Brought::default());
        let mut shortest_s = 0.004;
        for (longest_s, gains) in of_craft {
            for lag_s in [shortest_s, longest_s] {
                // Brushless motors as slow as that are flown with a table for 50 to 126 ms, as it is.
                let flown_s = if gains == tables::BRUSHLESS_110_MS.table.gains { 0.11 } else { lag_s };
                assert_eq!(flown(&chosen(lag_s).unwrap()), (flown_s, gains), "{index} at {lag_s} s");
            }
            shortest_s = longest_s + 0.001;
        }
        for lag_s in [0.0039, 0.127, 1.0] {
            assert_eq!(chosen(lag_s).err(), Some(Refusal::MotorLag), "{index} at {lag_s} s");
        }
        assert_eq!(flown(&chosen(0.0).unwrap()), (unstated_s, of_craft[unstated].1), "{index}");
    }
}

#[test]
fn a_table_at_a_stated_lag_is_stable_with_that_off_by_a_quarter_and_everything_else_off() {
    for (name, of_craft) in CRAFTS.into_iter().zip(stated()) {
        let vehicle = vehicles::by_name(name).unwrap();
        let air = if name.ends_with("brushless") { Air::BRUSHLESS } else { Air::BRUSHED };
        let told = air.moment_n_s.map(f64::from);
        let mut shortest_s = 0.004;
        for (longest_s, gains) in of_craft {
            let as_stated = gains != tables::BRUSHLESS_110_MS.table.gains;
            let ends_s = if as_stated { vec![shortest_s, longest_s] } else { vec![0.11] };
            for lag_s in ends_s.into_iter().map(f64::from) {
                let craft = CascadeCraft {
                    // 80 % of the identified air are told.
                    moment_n_s: told.map(|moment| moment / 0.8),
                    told_drag_per_s: f64::from(air.drag_per_s),
                    told_moment_n_s: told,
                    gust: f64::from(air.gust),
                    ..CascadeCraft::new(&vehicle, gains.numbers().map(f64::from), lag_s, 0.002)
                };
                let ends = |values: &[f64]| vec![values[0], values[values.len() - 1]];
                let [from_s, to_s] = if as_stated { [0.75, 1.25].map(|share| share * lag_s) } else { [0.05, 0.126] };
                let all = CascadeRegion::in_air(from_s, to_s);
                let region = CascadeRegion {
                    lags_s: ends(&all.lags_s),
                    mass_factors: ends(&all.mass_factors),
                    inertia_factors: ends(&all.inertia_factors),
                    command_factors: ends(&all.command_factors),
                    delays_s: ends(&all.delays_s),
                    drags_per_s: ends(&all.drags_per_s),
                    moment_factors: ends(&all.moment_factors),
                    believed_drags_per_s: ends(&all.believed_drags_per_s),
                    believed_ratio_factors: ends(&all.believed_ratio_factors),
                    ..all
                };
                let radii = region.certify(&craft).unwrap().map(|found| found.spectral_radius);
                println!("{name}, {lag_s} s: {radii:.5?}");
                // As the tables at their own lags.
                // Over so wide a range of lags the Brushless is stable with little to spare.
                let most = if as_stated { [0.9988, 0.9988, 0.9982, 0.9995] } else { [0.9999, 0.9999, 0.9982, 0.9995] };
                assert!(radii.iter().zip(most).all(|(radius, most)| *radius < most), "{name}, {lag_s} s: {radii:?}");
            }
            shortest_s = longest_s;
        }
    }
}

#[test]
fn the_crafts_are_those_of_the_vehicle_files() {
    for (known, name) in KNOWN.iter().zip(["crazyflie-2.1", "crazyflie-2.1-upgrade-kit", "crazyflie-2.1-brushless"]) {
        let vehicle = vehicles::by_name(name).unwrap();
        let figures = known.airframe.figures();
        assert_eq!((known.vehicle.name.as_str(), known.vehicle.id), (vehicle.name(), vehicles::id(&vehicle)), "{name}");
        assert_eq!(figures.mass_kg, vehicle.mass_kg() as f32, "{name}");
        let motors = vehicle.motors();
        for (found, wanted) in [
            (figures.lever_arm_m, motors.half_arm_m()),
            (figures.torque_per_thrust_m, motors.torque_per_thrust_m),
            (figures.force_max_n, motors.thrust_max_n),
        ] {
            assert!((f64::from(found) / wanted - 1.0).abs() < 1e-3, "{name}: {found}, not {wanted}");
        }
    }
}

/// Spectral radius of hover behind the body-rate loop of bandwidth `1 / (2 lag)`, along x and turned about y: the gains of
/// position, attitude (of q2) and velocity.
fn lateral_radius([kx, kq, kv]: [f64; 3], lag_s: f64) -> f64 {
    const G: f64 = 9.81;
    let mut a = DMatrix::zeros(5, 5);
    (a[(0, 1)], a[(1, 2)], a[(2, 3)], a[(3, 4)], a[(4, 4)]) = (1.0, G, 1.0, 1.0, -1.0 / lag_s);
    let mut b = DMatrix::zeros(5, 1);
    b[(4, 0)] = 1.0 / lag_s;
    let held = zero_order_hold(&a, &b, 0.002).unwrap();
    let gain = DMatrix::from_row_slice(1, 5, &[kx, kv, 0.5 * kq, 1.0, 0.0]) * (0.5 / lag_s);
    let poles = (held.a - held.b * gain).complex_eigenvalues();
    poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max)
}

#[test]
fn the_longest_lags_of_the_papers_tables_are_where_hover_becomes_unstable() {
    let craft = craft_of(0);
    for (number, gain) in [(TableId::LqrE, &paper::LQR_E), (TableId::LyapE, &paper::LYAP_E)] {
        let is_flown =
            |lag_s: f32| Table::choose(number as u8, &craft.with_motor_lag(lag_s), &TUNING, Brought::default()).is_ok();
        let longest_s =
            (40_u16..1000).map(|steps| f32::from(steps) / 1e4).take_while(|lag_s| is_flown(*lag_s)).last().unwrap();
        let pitch = gain.gain().rows()[2].map(f64::from);
        let radius = |lag_s: f64| lateral_radius([pitch[0], pitch[4], pitch[6]], lag_s);
        let longest_s = f64::from(longest_s);
        assert!(radius(longest_s) < 1.0 && radius(1.01 * longest_s) > 1.0, "{number:?}: {longest_s} s");
    }
}
