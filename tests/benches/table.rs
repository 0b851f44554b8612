//! The measurements of the benchmarks before this one, as the README has them: `cargo bench --package quatrack-tests`
//! ends with it.

use std::path::{Path, PathBuf};

use serde_json::Value;

/// Groups in the order of the table, and the content of one iteration.
const GROUPS: [(&str, &str); 6] = [
    ("step", "one control step"),
    ("plant", "2 ms of the plant"),
    ("flight", "the eight of 30 s, alone"),
    ("campaign", "the eight of 30 s, one of 16 runs"),
    ("riccati", "an equation of n states"),
    ("plan", "a trajectory of the paper"),
];

fn read(path: &Path) -> Option<Value> {
    serde_json::from_slice(&std::fs::read(path).ok()?).ok()
}

/// One benchmark: its name, and the estimate of its time, s, for each element.
fn measured(folder: &Path) -> Option<(String, f64)> {
    let (about, found) = (read(&folder.join("benchmark.json"))?, read(&folder.join("estimates.json"))?);
    let function = about["function_id"].as_str().unwrap_or_default();
    let name = about["value_str"].as_str().map_or_else(|| function.to_owned(), |value| format!("{function}, {value}"));
    // The slope of time over iterations, where it was measured so.
    let time_ns = found["slope"]["point_estimate"].as_f64().or_else(|| found["mean"]["point_estimate"].as_f64())?;
    Some((name, 1e-9 * time_ns / about["throughput"]["Elements"].as_f64().unwrap_or(1.0)))
}

fn folders(path: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
    entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect()
}

fn shown(time_s: f64) -> String {
    let (size, unit) = match time_s {
        t if t < 1e-6 => (1e9, "ns"),
        t if t < 1e-3 => (1e6, "us"),
        t if t < 1.0 => (1e3, "ms"),
        _ => (1.0, "s"),
    };
    let digits = 2_usize.saturating_sub((time_s * size).log10().floor() as usize);
    format!("{:.digits$} {unit}", time_s * size)
}

fn main() {
    let own = std::env::current_exe().expect("a program has a path");
    // target/release/deps/table-...
    let target = own.ancestors().nth(3).expect("cargo puts it three folders deep").join("criterion");
    println!("| benchmark | | time |\n|---|---|---|");
    for (group, about) in GROUPS {
        // A benchmark's folder, or one more for its value.
        let mut found: Vec<(String, f64)> = folders(&target.join(group))
            .iter()
            .flat_map(|folder| folders(folder).into_iter().map(|inner| inner.join("new")).chain([folder.join("new")]))
            .filter_map(|folder| measured(&folder))
            .collect();
        found.sort_by(|a, b| a.1.total_cmp(&b.1));
        for (name, time_s) in found {
            println!("| {group}: {name} | {about} | {} |", shown(time_s));
        }
    }
}
