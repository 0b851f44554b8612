//! Gains over time from the design to the table: the certificate against that of a hover, gains that do not hold, the grid,
//! and the committed tables' certificates.

use std::path::Path;

use nalgebra::{SMatrix, Vector3};
use quatrack::Trajectory;
use quatrack::gains::table::{GainTable, ScheduleRows, TableKind};
use quatrack_design::certify::{
    Certificate, CertifyError, Controller, Plant, Timing, certify, certify_along, moving_decrease,
};
use quatrack_design::design::along::{GainsAlong, gains_along};
use quatrack_design::design::sampled::{Sampling, sampled_equilibrium};
use quatrack_design::design::synthesis::EquilibriumWeights;
use quatrack_design::model::flat::FlatSample;
use quatrack_design::model::flat::{ReferencePoint, reference_point};
use quatrack_plan::plan::paper::PaperTrajectory as Paper;
use quatrack_plan::plan::stored;
use quatrack_plan::trajectory::Trajectory as _;
use quatrack_simulation::gains::{Design, GainsError, OnBoardTrajectory, Problem, Table};
use serde_json::Value;

mod generated {
    #![allow(unreachable_pub)]
    include!("../../../../gains/generated/along-aggressive.rs");
    include!("../../../../gains/generated/along-mild.rs");
}

const AGGRESSIVE: &str = include_str!("../../../../gains/along-aggressive.toml");
const COMMITTED: [(Paper, &ScheduleRows<'static>, &[u8], &str); 2] = [
    (
        Paper::Aggressive,
        &generated::ALONG_AGGRESSIVE,
        include_bytes!("../../../../gains/generated/along-aggressive.bin"),
        include_str!("../../../../gains/generated/along-aggressive.json"),
    ),
    (
        Paper::Mild,
        &generated::ALONG_MILD,
        include_bytes!("../../../../gains/generated/along-mild.bin"),
        include_str!("../../../../gains/generated/along-mild.json"),
    ),
];

fn read(text: &str) -> Result<Design, GainsError> {
    Design::from_toml("mine", text, Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../gains")))
}

fn at_rest() -> ReferencePoint {
    let zero = Vector3::zeros();
    reference_point(&FlatSample {
        position_m: zero,
        velocity_m_s: zero,
        acceleration_m_s2: zero,
        jerk_m_s3: zero,
        heading_rad: 0.0,
        heading_rate_rad_s: 0.0,
    })
}

/// The letter W as it is stored, and the design along it for 100 Hz, not yet on its grid.
fn the_w() -> (impl Fn(f64) -> ReferencePoint, GainsAlong) {
    let course = OnBoardTrajectory::named("aggressive", Path::new("")).unwrap();
    let duration_s = course.trajectory().duration_s();
    let reference = move |time_s: f64| reference_point(&course.trajectory().at(time_s));
    let along = gains_along(&reference, duration_s, &EquilibriumWeights::paper(), &Sampling::at_rate(100), 21).unwrap();
    (reference, along)
}

#[test]
fn along_a_hover_the_certificate_is_that_of_the_hover() {
    let (weights, sampling) = (EquilibriumWeights::paper(), Sampling::at_rate(100));
    let along = gains_along(|_| at_rest(), 0.4, &weights, &sampling, 20).unwrap();
    let found = certify_along(|_| at_rest(), &along, Some(20.0)).unwrap();
    let gain = sampled_equilibrium(&weights, &sampling).unwrap().gain;
    let expected =
        certify(&Plant::equilibrium(), &Controller::memoryless(gain), &Timing::at_rate(100), Some(20.0)).unwrap();
    let figures = |certificate: &Certificate| -> Vec<f64> {
        let margins = &certificate.sampled.margins;
        let each = margins.each.iter().flat_map(|channel| [channel.balanced.alpha, channel.sensitivity.alpha]);
        let in_rate_loop = certificate.motors_in_rate_loop.iter().flatten();
        let limits = certificate.delay.iter().chain(&certificate.lag).chain(in_rate_loop);
        let all = [margins.all.balanced.alpha, margins.all.alpha_at_most, certificate.sampled.spectral_radius];
        each.chain(limits.map(|limit| limit.stable_to_s)).chain(all).collect()
    };
    let pairs: Vec<_> = figures(&found).into_iter().zip(figures(&expected)).collect();
    assert_eq!(pairs.len(), 8 + 15 + 3);
    for (index, (found, expected)) in pairs.into_iter().enumerate() {
        // f64 against 32 digits, and the recursion's gain against the stationary one: 1e-12 of the gain. The phase of a
        // margin is refined to 1e-8.
        assert!((found - expected).abs() < 1e-6 * expected, "figure {index}: {found}, hover {expected}");
    }
    // In the Riccati equation's own P the slowest pole leaves at least its square of V.
    let figures = found.along.unwrap();
    assert_eq!((figures.knots, figures.steps), (3, 41));
    assert!(found.sampled.decrease.holds);
    assert!(figures.largest_ratio < 1.0 && figures.largest_ratio >= expected.sampled.spectral_radius.powi(2) - 1e-9);
}

#[test]
fn a_spoiled_gain_does_not_decrease() {
    let (reference, sound) = the_w();
    let holds = |along: &GainsAlong| moving_decrease(&reference, along).unwrap().holds;
    assert!(holds(&sound));
    let edited = |edit: &dyn Fn(&mut SMatrix<f64, 4, 9>)| {
        let mut spoiled = sound.clone();
        edit(&mut spoiled.gains[20]);
        spoiled
    };
    // The pitch rate pushes away from the reference.
    let away = edited(&|gain| gain.row_mut(2).neg_mut());
    assert!(!holds(&away));
    let error = certify_along(&reference, &away, None).unwrap_err();
    let CertifyError::UnstableAtKnot { knot: 20, spectral_radius, .. } = error else { panic!("{error}") };
    assert!(spectral_radius > 1.0);
    // Frozen it is stable; but the decrease that the design counts on is not there.
    assert!(!holds(&edited(&|gain| *gain *= 0.3)));
    // A thousandth of an entry costs a thousandth of a step's decrease, at most.
    assert!(holds(&edited(&|gain| *gain *= 1.001)));
    // Gains of a design are not those of another spacing.
    let mut short = sound.clone();
    short.gains.pop();
    assert!(matches!(moving_decrease(&reference, &short), Err(CertifyError::Schedule { knots: 58, p: 1219 })));
}

#[test]
fn the_grid_gives_the_same_gains_on_any_processor() {
    let (_, along) = the_w();
    let step = along.grid_step();
    // From 0 to 72.26 in steps of 2^-12.
    assert_eq!(step, 1.0 / 4096.0);
    let gridded = along.clone().on_grid();
    let schedule = &generated::ALONG_AGGRESSIVE;
    for ((free, fixed), table) in along.gains.iter().zip(&gridded.gains).zip(schedule.gains) {
        for (row, column) in (0..4).flat_map(|row| (0..9).map(move |column| (row, column))) {
            let (free, fixed) = (free[(row, column)], fixed[(row, column)]);
            assert!((free - fixed).abs() <= 0.5 * step && fixed == f64::from(table[row][column]));
            // Far from the edge between two steps beside the 1e-12 by which processors differ.
            assert!((0.5 - ((free - fixed) / step).abs()) > 1e-7, "{free} is at the edge");
        }
    }
}

#[test]
fn the_committed_tables_are_for_the_trajectories_on_board() {
    for (paper, rows, bytes, document) in COMMITTED {
        let table = GainTable::from_bytes(bytes).unwrap();
        let schedule = table.schedule().unwrap();
        assert_eq!(TableKind::of(bytes), Ok(TableKind::AlongTrajectory));
        assert_eq!(schedule.trajectory(), Trajectory::new(stored::pieces(paper)).unwrap().checksum());
        assert_eq!((schedule.trajectory(), schedule.steps_per_knot()), (rows.trajectory, rows.steps_per_knot));
        assert!(schedule.knots() == rows.gains.len() && rows.gains.len() <= 60);
        let document: Value = serde_json::from_str(document).unwrap();
        for (knot, gain) in rows.gains.iter().enumerate() {
            assert_eq!(schedule.gain(knot), Some(*gain));
            let written: [[f32; 9]; 4] = serde_json::from_value(document["gain"]["k"][knot].clone()).unwrap();
            assert_eq!(written, *gain);
        }
        let certificate = &document["certificate"];
        assert_eq!(certificate["sampled"]["decrease"]["holds"], true);
        // The stated figure is just below the computed one: rounded down to four digits.
        let stated = table.head().certificate;
        let least = |limits: &Value| {
            limits.as_array().unwrap().iter().map(|limit| limit["stable_to_s"].as_f64().unwrap()).fold(10.0, f64::min)
        };
        let all = &certificate["sampled"]["margins"]["all"]["balanced"];
        for (stated, found) in [
            (stated.all_channels.phase_rad, all["phase_rad"].as_f64().unwrap()),
            (stated.delay_max_s, least(&certificate["delay"])),
            (stated.motor_lag_max_s, least(&certificate["lag"]).min(least(&certificate["motors_in_rate_loop"]))),
        ] {
            assert!((0.999..1.0 + 5e-6).contains(&(f64::from(stated) / found)), "{stated} of {found}");
        }
        assert_eq!(document["certificate_sha256"], stated.hash.to_string());
    }
}

#[test]
fn a_design_reads_its_trajectory_and_keeps_its_minimum() {
    let design = read(AGGRESSIVE).unwrap();
    assert_eq!(design.problem.named(), ("equilibrium", "along"));
    let Problem::Along { trajectory, steps_per_knot: 21, .. } = &design.problem else { panic!("{design:?}") };
    assert_eq!(trajectory.checksum(), generated::ALONG_AGGRESSIVE.trajectory);
    let error = read(&AGGRESSIVE.replace("phase_all_deg = 40.0", "phase_all_deg = 60.0")).unwrap().certify();
    let error = error.expect_err("54 degrees");
    assert!(error.is_verdict() && error.to_string().contains("all channels at once is 54.4"), "{error}");
    // A second of rest at 25 Hz: 26 knots, and the same table as a file and as a value.
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let header = "duration,x^0,x^1,x^2,x^3,x^4,x^5,x^6,x^7,y^0,y^1,y^2,y^3,y^4,y^5,y^6,y^7,z^0,z^1,z^2,z^3,z^4,z^5,z^6,\
                  z^7,yaw^0,yaw^1,yaw^2,yaw^3,yaw^4,yaw^5,yaw^6,yaw^7";
    std::fs::write(folder.join("rest.csv"), format!("{header}\n1.0{}\n", ",0".repeat(32))).unwrap();
    std::fs::write(folder.join("moves.csv"), format!("{header}\n1.0,0,1{}\n", ",0".repeat(30))).unwrap();
    let of =
        |file: &str| Design::from_toml("rest", &AGGRESSIVE.replace("\"aggressive\"", &format!("\"{file}\"")), folder);
    let certified = of("rest.csv").unwrap().certify().unwrap();
    let table = certified.table.as_ref().expect("a table over time");
    let bytes = table.to_bytes().unwrap();
    let read = GainTable::from_bytes(&bytes).unwrap();
    assert_eq!((read.head(), read.schedule().unwrap().knots()), (table.head(), 51));
    assert_eq!(Table::from_bytes(&bytes).as_ref(), Ok(table));
    let error = of("moves.csv").expect_err("it ends at 1 m/s").to_string();
    assert!(error.starts_with("trajectory = \"moves.csv\": must be one that ends at rest"), "{error}");
}
