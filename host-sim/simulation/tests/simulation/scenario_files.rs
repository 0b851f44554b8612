//! Any text as a scenario file: a scenario that can be started, or an error of one line that shows no more than a little of it.

use std::path::Path;

use proptest::prelude::*;
use proptest::sample::{Index, select};
use quatrack_simulation::scenario::Scenario;
use quatrack_simulation::scenario::file::ScenarioFile;

/// Every key, in its table; the first have none.
const KEYS: [(&str, &[&str]); 9] = [
    ("", &["course", "speed_m_s", "step_m", "duration_s", "law", "laws", "setpoints", "estimator", "seed", "other"]),
    ("air", &["of", "drag_per_s", "moment_n_m_per_m_s", "wind_m_s", "gust_rms_m_s"]),
    (
        "errors",
        &[
            "mass_factor",
            "inertia_factor",
            "lag_ms",
            "lag_rise_ms",
            "lag_fall_ms",
            "delay_ms",
            "thrust_factor",
            "thrust_factor_end",
            "torque_bias_n_m",
            "centre_of_mass_m",
            "motor_strength",
            "gyro_bias_rad_s",
            "accelerometer_bias_m_s2",
        ],
    ),
    ("told", &["mass_kg", "lag_ms", "drag_per_s", "moment_n_m_per_m_s"]),
    ("noise", &["gyro_rad_s", "accelerometer_m_s2", "position_m", "velocity_m_s", "attitude_rad"]),
    ("filter", &["prediction_hz", "position_hz", "drag_per_s", "latency_ms", "phase_ms"]),
    ("start", &["offset_m", "velocity_m_s", "turn_rad"]),
    ("battery", &["charge"]),
    ("vary", &["a", "errors"]),
];

fn value() -> impl Strategy<Value = String> {
    let number = prop_oneof![
        8 => (-3.0_f64..3.0).prop_map(|value| format!("{value:?}")),
        2 => (-400.0_f64..400.0).prop_map(|value| format!("{value:?}")),
        1 => any::<i64>().prop_map(|value| value.to_string()),
        1 => any::<f64>().prop_filter("TOML has these as words", |value| value.is_finite()).prop_map(|v| format!("{v:e}")),
        1 => select(vec!["nan", "inf", "-inf", "0.0", "-0.0", "5e-324"]).prop_map(str::to_owned),
    ];
    let word = select(vec![
        "eight", "hover", "step", "mild", "quatrack", "lqr-e", "lee", "exact", "kalman", "vehicle", "100hz",
    ]);
    let text = prop_oneof![4 => word.prop_map(str::to_owned), 1 => any::<String>()];
    prop_oneof![
        6 => number.clone(),
        3 => prop::collection::vec(number, 0..5).prop_map(|values| format!("[{}]", values.join(", "))),
        3 => text.prop_map(|text| format!("{text:?}")),
        1 => Just("true".to_owned()),
    ]
}

fn text() -> impl Strategy<Value = String> {
    let vehicle = select(vec!["crazyflie-2.1", "crazyflie-2.1-brushless", "crazyflie-2.2", ""]);
    let lines = prop::collection::vec((any::<Index>(), any::<Index>(), value()), 0..6);
    (vehicle, lines).prop_map(|(vehicle, lines)| {
        let mut tables: [String; KEYS.len()] = KEYS.map(|(table, _)| match table {
            "" => format!("vehicle = \"{vehicle}\"\n"),
            table => format!("[{table}]\n"),
        });
        let empty = tables.clone();
        for (table, key, value) in lines {
            let at = table.index(KEYS.len());
            tables[at] += &format!("{} = {value}\n", key.get(KEYS[at].1));
        }
        // Tables of which nothing is said are left out.
        tables
            .into_iter()
            .zip(empty)
            .enumerate()
            .filter(|(at, (table, empty))| *at == 0 || table != empty)
            .map(|(_, (table, _))| table)
            .collect()
    })
}

/// Whether a scenario came of it. An error is one line, and shows no more than a little of the text.
fn read(text: &str) -> Result<bool, TestCaseError> {
    let checked = ScenarioFile::parse(text, "scenario")
        .and_then(|file| Scenario::checked(&file, "scenario", Path::new("/nowhere")));
    match checked {
        Ok(scenario) => {
            // Told figures without sense are a law's to refuse.
            let _ = scenario.law.start(&scenario.vehicle, &scenario.told);
            Ok(true)
        }
        Err(error) => {
            let line = error.to_string();
            prop_assert!(line.chars().count() < 1000 && !line.chars().any(char::is_control), "{line:?}");
            Ok(false)
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn any_values_are_a_scenario_or_an_error_of_one_line(text in text()) {
        read(&text)?;
    }

    #[test]
    fn so_is_a_file_that_was_altered_anywhere(at in any::<Index>(), length in 0_usize..20, with in any::<String>()) {
        let whole = include_str!("../../../../docs/scenarios/brushed-eight.toml");
        prop_assert!(read(whole)?);
        let start = whole.floor_char_boundary(at.index(whole.len()));
        let end = whole.floor_char_boundary((start + length).min(whole.len()));
        read(&format!("{}{with}{}", &whole[..start], &whole[end..]))?;
    }

    #[test]
    fn no_error_has_a_character_that_a_terminal_obeys(at in any::<Index>(), with in "[\\x00-\\x1f\\x7f\\u{202e}]{1,5}") {
        let whole = include_str!("../../../../docs/scenarios/brushed-eight.toml");
        let start = whole.floor_char_boundary(at.index(whole.len()));
        let (before, after) = whole.split_at(start);
        read(&format!("{before}{with}{after}"))?;
        // As TOML writes such characters in a string.
        let escaped: String = with.chars().map(|c| format!("\\u{:04X}", u32::from(c))).collect();
        for key in ["vehicle", "course", "law", "laws", "estimator", "setpoints", "air", "other"] {
            let head = if key == "vehicle" { "" } else { "vehicle = \"crazyflie-2.1\"\n" };
            read(&format!("{head}{key} = \"{escaped}lee\""))?;
        }
    }
}
