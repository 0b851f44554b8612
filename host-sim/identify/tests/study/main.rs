//! The accuracy of `quatrack identify`: random crafts fly in simulation, and their figures are looked for in their logs.
//!
//! ```sh
//! cargo test --release -p quatrack-identify --test study -- --nocapture                        # 12 crafts
//! cargo test --release -p quatrack-identify --test study -- --nocapture --ignored two_hundred  # others
//! cargo test --release -p quatrack-identify --test study -- --nocapture --ignored fresh        # 30 others
//! cargo test --release -p quatrack-identify --test study -- --nocapture --ignored stage        # stage by stage
//! ```
//!
//! `STUDY_CRAFTS` says how many where it is set, `STUDY_VERBOSE` prints every figure of every craft.

mod craft;
mod slow;
mod smooth;

use std::collections::BTreeMap;

use craft::Craft;
use quatrack_identify::identify;
use quatrack_identify::log::ColumnMap;
use quatrack_simulation::vehicles;

/// The errors between a craft and its log.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Conditions {
    /// The core's Kalman filter instead of the truth.
    estimator: bool,
    /// Of all sensors; gusts, biases.
    noise: bool,
    /// 0 to 20 ms of commands, inertial sensors and pose, each.
    delays: bool,
    /// Every fourth craft on a battery, with the force by powers of command and voltage.
    battery: bool,
}

const ALL: Conditions = Conditions { estimator: true, noise: true, delays: true, battery: true };

const MAP: &str = r#"
[time]
column = "t"
unit = "s"
[position]
columns = ["px", "py", "pz"]
unit = "m"
[velocity]
columns = ["vx", "vy", "vz"]
unit = "m/s"
[attitude]
columns = ["qx", "qy", "qz", "qw"]
form = "xyzw"
[gyroscope]
columns = ["gx", "gy", "gz"]
unit = "rad/s"
[accelerometer]
columns = ["ax", "ay", "az"]
unit = "m/s^2"
[motors]
columns = ["m1", "m2", "m3", "m4"]
full = 1.0
[voltage]
column = "v"
unit = "V"
"#;

/// Of one figure over all crafts.
#[derive(Default)]
struct Tally {
    errors: Vec<f64>,
    inside: usize,
    half_widths: Vec<f64>,
    refused: usize,
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn study(name: &str, seeds: std::ops::Range<u64>, conditions: &Conditions) -> BTreeMap<&'static str, Tally> {
    let map = ColumnMap::parse(MAP, "study").unwrap();
    let mut tallies: BTreeMap<&'static str, Tally> = BTreeMap::new();
    let (mut lost, mut flown) = (0, 0);
    for seed in seeds {
        let craft = Craft::random(seed, conditions);
        let recording = craft.fly();
        if let Some(why) = &recording.flight.lost {
            println!("{seed}: lost at {:.1} s: {}", why.time_s, why.reason);
            lost += 1;
            continue;
        }
        flown += 1;
        let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("study-{name}-{seed}.csv"));
        std::fs::write(&path, craft.log(&recording)).unwrap();
        let base = vehicles::by_name(craft.scenario.vehicle.name()).unwrap();
        let report = match identify(&[&path], &map, &base, craft.mass_kg) {
            Ok(report) => report,
            Err(error) => {
                println!("{seed}: {error}");
                continue;
            }
        };
        let _ = std::fs::remove_file(&path);
        let verbose = std::env::var("STUDY_VERBOSE").is_ok();
        if verbose {
            println!("{seed} phase {} explained {:.4?}", craft.phase, report.fit.explained);
        }
        for (figure, truth) in &craft.truth {
            let tally = tallies.entry(figure).or_default();
            match &report.fit.figures[figure] {
                Ok(e) => {
                    // A delay may be 0: its error is in ms.
                    let scale = if *figure == "delay_ms" { 100.0 } else { *truth };
                    tally.errors.push((e.value - truth) / scale);
                    tally.half_widths.push(0.5 * (e.high - e.low) / scale);
                    tally.inside += usize::from(e.low <= *truth && *truth <= e.high);
                    if verbose {
                        println!(
                            "{seed} {figure} {:+.1} % +-{:.1}",
                            100.0 * (e.value - truth) / scale,
                            50.0 * (e.high - e.low) / scale
                        );
                    }
                }
                Err(why) => {
                    tally.refused += 1;
                    if verbose {
                        println!("{seed} {figure} {why}");
                    }
                }
            }
        }
    }
    println!("{name}: {flown} crafts, {lost} lost, {conditions:?}");
    println!("  {:<22} median error, bias, half interval (%; delay: ms)   inside   told", "");
    for (figure, tally) in &tallies {
        println!(
            "  {figure:<22} {:>6.1} {:>+6.1} {:>6.1}   {:>3} of {:<3}  {} not told",
            100.0 * median(tally.errors.iter().map(|e| e.abs()).collect()),
            100.0 * median(tally.errors.clone()),
            100.0 * median(tally.half_widths.clone()),
            tally.inside,
            tally.errors.len(),
            tally.refused
        );
    }
    tallies
}

/// Medians of the error as shares, and how many of the true values are inside their intervals.
fn hold(tallies: &BTreeMap<&'static str, Tally>) {
    for (figure, tally) in tallies {
        let error = median(tally.errors.iter().map(|e| e.abs()).collect());
        // A delay is in units of 0.1 s.
        let most = match *figure {
            "delay_ms" => 0.02,
            "thrust_full_n" | "hover_command" => 0.01,
            _ => 0.05,
        };
        // A median of a few says little: inertia z is told on every third craft.
        assert!(error < most || tally.errors.len() < 8, "{figure}: median error {error}");
        let flown = tally.errors.len() + tally.refused;
        assert!(tally.inside * 10 >= 9 * tally.errors.len(), "{figure}: {} of {flown} inside", tally.inside);
        let must_be_told = *figure != "inertia_z_kg_m2";
        assert!(
            !must_be_told || tally.errors.len() * 10 >= 9 * flown,
            "{figure}: {} of {flown} told",
            tally.errors.len()
        );
    }
}

fn count(usual: u64) -> u64 {
    std::env::var("STUDY_CRAFTS").ok().and_then(|count| count.parse().ok()).unwrap_or(usual)
}

#[test]
fn a_dozen_random_crafts_are_known_again() {
    hold(&study("gate", 0..count(12), &ALL));
}

#[test]
#[ignore = "30 flights of a minute"]
fn a_fresh_sample_is_known_again() {
    hold(&study("fresh", 100..100 + count(30), &ALL));
}

#[test]
#[ignore = "200 flights of a minute"]
fn two_hundred_random_crafts_are_known_again() {
    hold(&study("study", 1000..1000 + count(200), &ALL));
}

#[test]
#[ignore = "many flights"]
fn stage_by_stage() {
    let crafts = count(12);
    let ideal = Conditions { estimator: false, noise: false, delays: false, battery: false };
    study("ideal", 0..crafts, &ideal);
    study("battery", 0..crafts, &Conditions { battery: true, ..ideal });
    study("estimator", 0..crafts, &Conditions { estimator: true, ..ideal });
    study("noise", 0..crafts, &Conditions { noise: true, ..ideal });
    study("delays", 0..crafts, &Conditions { delays: true, ..ideal });
}
