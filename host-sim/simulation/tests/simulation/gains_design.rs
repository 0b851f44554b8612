//! Design files: values that are read, and values that are refused with a line that names the key, its value and the
//! remedy.

use std::path::Path;

use quatrack_design::design::synthesis::{EquilibriumWeights, FlatWeights};
use quatrack_simulation::gains::{Design, Gains, GainsError, Method, Problem};

const LQR_E: &str = include_str!("../../../../gains/lqr-e.toml");
const LQR_F: &str = include_str!("../../../../gains/lqr-f.toml");
const LYAP_F: &str = include_str!("../../../../gains/lyap-f.toml");
const LQI_E: &str = include_str!("../../../../gains/lqi-e.toml");
const ALONG: &str = include_str!("../../../../gains/along-aggressive.toml");
const SAMPLED: &str = include_str!("../../../../gains/sampled-lqr-e.toml");

fn read(text: &str) -> Result<Design, GainsError> {
    Design::from_toml("mine", text, Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../gains")))
}

fn edited(text: &str, from: &str, to: &str) -> Result<Design, GainsError> {
    assert!(text.contains(from), "nothing to edit: {from}");
    read(&text.replacen(from, to, 1))
}

#[test]
fn the_committed_designs_are_the_papers() {
    let design = read(LQR_E).unwrap();
    assert_eq!(design.problem, Problem::Equilibrium(Method::Lqr { weights: EquilibriumWeights::paper() }));
    assert_eq!((design.rate.hz(), design.vehicle.name()), (500, "crazyflie-2.1"));
    // 4 * 0.12 N over 29 g.
    assert!((design.limits.thrust_max_m_s2() - 16.5517).abs() < 1e-4);
    assert_eq!(design.minimum.delay_s, Some(0.01));
    let design = read(LQR_F).unwrap();
    assert_eq!(design.problem, Problem::FlatOutput(Method::Lqr { weights: FlatWeights::paper() }));
    assert_eq!(read(LYAP_F).unwrap().problem, Problem::FlatOutput(Method::Lyapunov { mu_1_s: 2.0 }));
}

#[test]
fn entries_that_cannot_be_used_are_named_with_value_and_remedy() {
    let cases: &[(&str, &str, &str, &[&str])] = &[
        (LQR_E, "method", "methid", &["line 4", "`methid = \"lqr\"`", "expected one of", "`method`"]),
        (LQR_E, "\"lqr\"", "\"lqg\"", &["line 4", "lqg", "`sampled-lqr`"]),
        (LQR_E, "= 500", "= -5", &["control_rate_hz = -5"]),
        (LQR_E, "= 500", "= 20000", &["control_rate_hz = 20000: must be from 1 to 10000"]),
        (LQR_E, "\"crazyflie-2.1\"", "\"boeing\"", &["vehicle = \"boeing\"", "crazyflie-2.1-brushless"]),
        (LQR_E, "\"crazyflie-2.1\"", "\"no/such.toml\"", &["vehicle = \"no/such.toml\"", "cannot be read"]),
        (LQR_E, "[100.0, 100.0, 100.0]", "[1.0, 2.0]", &["position = [1.0, 2.0]", "length 2"]),
        (LQR_E, "[100.0, 100.0, 100.0]", "[1.0, nan, 1.0]", &["weights.position = NaN: must be 0, or from"]),
        (LQR_E, "[100.0, 100.0, 100.0]", "[1.0, -2.0, 1.0]", &["weights.position = -2"]),
        (LQR_E, "thrust_input = 0.01", "thrust_input = 0.0", &["weights.thrust_input = 0: must be from"]),
        (LQR_E, "thrust_input = 0.01", "", &["weights.thrust_input is missing", "equilibrium", "a number"]),
        (
            LQR_E,
            "attitude",
            "acceleration",
            &["weights.acceleration = [10.0, 10.0, 10.0] does not belong", "leave it out"],
        ),
        (LQR_F, "q3 = 20.0", "", &["weights.q3 is missing", "flat-output"]),
        (LQR_F, "q3 = 20.0", "q3 = 20.0\nthrust_input = 1.0", &["weights.thrust_input = 1.0 does not belong"]),
        (LQR_E, "\"lqr\"", "\"lyapunov\"", &["mu_1_s is missing", "mu_1_s = 2.0"]),
        (LQR_E, "\"lqr\"", "\"lqr\"\nmu_1_s = 2.0", &["mu_1_s = 2 does not belong to method = \"lqr\""]),
        (LYAP_F, "mu_1_s = 2.0", "mu_1_s = 0.0", &["mu_1_s = 0: must be from"]),
        (LYAP_F, "[minimum]", "[weights]\nq3 = 1.0\n[minimum]", &["[weights]", "lyapunov"]),
        (LQR_E, "\"lqr\"", "\"lqr\"\ndelay_samples = 1", &["delay_samples = 1 does not belong"]),
        (
            SAMPLED,
            "\"sampled-lqr\"",
            "\"sampled-lqr\"\ndelay_samples = 21",
            &["delay_samples = 21: must be from 0 to 20"],
        ),
        (LQR_E, "\"lqr\"", "\"lqi\"", &["weights.position_integral is missing; method = \"lqi\" needs it"]),
        (LQR_F, "\"lqr\"", "\"lqi\"", &["method = \"lqi\" does not belong to linearisation = \"flat-output\""]),
        (LQR_E, "\"lqr\"", "\"along\"", &["trajectory is missing; method = \"along\" needs it"]),
        (LQR_F, "\"lqr\"", "\"along\"", &["method = \"along\" does not belong to linearisation = \"flat-output\""]),
        (
            LQR_E,
            "\"lqr\"",
            "\"lqr\"\ntrajectory = \"mild\"",
            &["trajectory = \"mild\" does not belong to method = \"lqr\""],
        ),
        (ALONG, "\"aggressive\"", "\"no/such.csv\"", &["trajectory = \"no/such.csv\"", "cannot be read"]),
        (ALONG, "\"aggressive\"", "\"../plans/mild.toml\"", &["mild.toml", "a plan", "quatrack plan"]),
        (ALONG, "[50.0, 50.0, 50.0]", "[50.0, 0.0, 50.0]", &["weights = 0: must be above 0 for each error"]),
        (ALONG, "_hz = 100", "_hz = 100\ndelay_samples = 1", &["delay_samples = 1 does not belong"]),
        (LQI_E, "\"lqi\"", "\"lqr\"", &["weights.position_integral = [50.0, 50.0, 50.0] does not belong"]),
        (LQR_E, "= 20.0", "= 0.0", &["rate_loop_gain_1_s = 0"]),
        (LQR_E, "gain_factor_all = 2.0", "gain_factor_all = 0.9", &["minimum.gain_factor_all = 0.9: must be above 1"]),
        (LQR_E, "phase_all_deg = 40.0", "phase_all_deg = 200.0", &["minimum.phase_all_deg = 200"]),
        (LQR_E, "delay_ms = 10.0", "delay_s = 0.01", &["delay_s = 0.01", "`delay_ms`"]),
        (
            LQR_E,
            "[minimum]",
            "[limits]\nthrust_max_m_s2 = 20.0\n[minimum]",
            &["limits.thrust_max_m_s2 = 20", "up to 16.55"],
        ),
        (
            LQR_E,
            "[minimum]",
            "[limits]\nthrust_min_m_s2 = 9.9\n[minimum]",
            &["limits.thrust_min_m_s2 = 9.9", "g = 9.81"],
        ),
        (
            LQR_E,
            "[minimum]",
            "[limits]\nbody_rates_max_rad_s = [20, 20, 11]\n[minimum]",
            &["limits.body_rates_max_rad_s = 11: must be above 0, up to 10"],
        ),
    ];
    for (text, from, to, named) in cases {
        let error = edited(text, from, to).expect_err(to);
        let line = error.to_string();
        assert!(!line.contains('\n') && !error.is_verdict(), "{line}");
        for word in *named {
            assert!(line.contains(word), "{to}: `{word}` is not named in {line}");
        }
    }
    for (name, word) in [("", "0 bytes"), ("a-name-of-32-characters-in-total", "32 bytes"), ("two words", "0x20")] {
        let error = Design::from_toml(name, LQR_E, Path::new("")).expect_err(name).to_string();
        assert!(error.starts_with("the file's name is the table's name") && error.contains(word), "{error}");
    }
}

#[test]
fn a_mode_that_the_weights_do_not_see_is_told() {
    for text in [LQR_E, SAMPLED] {
        let error = edited(text, "[100.0, 100.0, 100.0]", "[0.0, 0.0, 0.0]").unwrap().certify().expect_err("unseen");
        assert!(error.to_string().contains("(Q, A) is not detectable"), "{error}");
    }
}

#[test]
fn tighter_limits_and_a_vehicle_of_a_file_go_into_the_table() {
    let text = LYAP_F.replace("\"crazyflie-2.1\"", "\"vehicles/crazyflie-2.1-brushless.toml\"");
    let limits = "[limits]\nthrust_max_m_s2 = 15.0\nbody_rates_max_rad_s = [6, 5, 4]\n[minimum]";
    let certified = edited(&text, "[minimum]", limits).unwrap().certify().unwrap();
    let head = *certified.table.unwrap().head();
    assert_eq!((head.name.as_str(), head.vehicle.name.as_str()), ("mine", "crazyflie-2.1-brushless"));
    assert_eq!(head.limits.thrust_max_m_s2(), 15.0);
    assert_eq!(head.limits.body_rates_max_rad_s().as_slice(), [6.0, 5.0, 4.0]);
}

#[test]
fn hashes_follow_their_contents() {
    let hashes = |text: &str| {
        let certified = read(text).unwrap().certify().unwrap();
        (certified.design_hash, certified.table.unwrap().head().certificate.hash)
    };
    let of_design = hashes(LYAP_F);
    assert_eq!(hashes(&LYAP_F.replace("description = \"", "description = \"Another word. ")), of_design, "words");
    let asks_more = hashes(&LYAP_F.replace("delay_ms = 10.0", "delay_ms = 11.0"));
    assert!(asks_more.0 != of_design.0 && asks_more.1 != of_design.1, "asked for more");
    let faster = hashes(&LYAP_F.replace("mu_1_s = 2.0", "mu_1_s = 2.0000001"));
    assert!(faster.0 != of_design.0 && faster.1 != of_design.1, "other gains");
}

#[test]
fn a_known_delay_is_designed_for_and_certified_but_makes_no_table() {
    let certified =
        edited(SAMPLED, "\"sampled-lqr\"", "\"sampled-lqr\"\ndelay_samples = 2").unwrap().certify().unwrap();
    assert_eq!((certified.designed.past_command_gains.len(), certified.certificate.delay_samples), (2, 2));
    assert!(certified.table.is_none() && matches!(certified.designed.gains, Gains::Equilibrium(_)));
}
