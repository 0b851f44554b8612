//! Folders of campaigns: whose files they hold, and whose they do not touch.

use std::fs;

use super::{Bench, SCENARIO, flown, quatrack};

fn refused(arguments: &[&str], named: &[&str]) {
    let run = quatrack(arguments);
    let said = String::from_utf8(run.stderr).unwrap();
    assert_eq!(run.status.code(), Some(2), "{arguments:?}: {said}");
    assert!(named.iter().all(|part| said.contains(part)), "{named:?}: {said}");
}

#[test]
fn a_folder_is_merged_into_itself_by_any_of_its_names() {
    let bench = Bench::new("campaign-same");
    let [scenario, out] = ["s.toml", "out"].map(|name| bench.path(name));
    fs::write(&scenario, SCENARIO).unwrap();
    flown(&["campaign", &scenario, "--runs", "6", "--out", &out]);
    let rows = bench.bytes("out/rows.csv");
    for name in ["out/.", "./out", "out/../out"] {
        flown(&["campaign", "merge", &out, "--out", &bench.path(name)]);
        assert!(bench.bytes("out/rows.csv") == rows, "{name}");
    }
    // Shards beside their whole, merged once more.
    let parts = bench.path("parts");
    for shard in ["1/2", "2/2"] {
        flown(&["campaign", &scenario, "--runs", "6", "--shard", shard, "--out", &parts]);
    }
    for _ in 0..2 {
        flown(&["campaign", "merge", &parts]);
        assert!(bench.bytes("parts/rows.csv") == rows);
    }
}

#[test]
fn files_of_others_are_not_replaced() {
    let bench = Bench::new("campaign-others");
    let scenario = bench.path("s.toml");
    fs::write(&scenario, SCENARIO).unwrap();
    for (folder, file) in [("a", "scenario.toml"), ("b", "rows.csv"), ("c", "rows-2-of-3.csv")] {
        let (out, own) = (bench.path(folder), "my,own,data\n1,2,3\n");
        fs::create_dir_all(&out).unwrap();
        fs::write(bench.0.join(folder).join(file), own).unwrap();
        refused(&["campaign", &scenario, "--runs", "2", "--out", &out], &[file, "choose another --out"]);
        assert_eq!(bench.bytes(&format!("{folder}/{file}")), own.as_bytes());
        assert_eq!(fs::read_dir(&out).unwrap().count(), 1, "something was written");
    }
    // A craft called as a campaign calls its own.
    let vehicle = include_str!("../../../../../gains/vehicles/crazyflie-2.1-legacy.toml");
    fs::create_dir_all(bench.0.join("d")).unwrap();
    fs::write(bench.0.join("d/vehicle.toml"), vehicle.replace("0.029", "0.030")).unwrap();
    fs::write(bench.0.join("d/mine.toml"), vehicle).unwrap();
    let own = SCENARIO.replace("\"crazyflie-2.1-brushless\"", "\"mine.toml\"");
    fs::write(bench.0.join("d/sc.toml"), own).unwrap();
    let there = bench.path("d");
    refused(&["campaign", &bench.path("d/sc.toml"), "--runs", "2", "--out", &there], &["d/vehicle.toml"]);
}

#[test]
fn rows_that_were_changed_are_named_and_stay() {
    let bench = Bench::new("campaign-changed");
    let [scenario, out] = ["s.toml", "out"].map(|name| bench.path(name));
    fs::write(&scenario, SCENARIO).unwrap();
    let fly = ["campaign", &scenario, "--runs", "4", "--out", &out];
    flown(&fly);
    let rows = String::from_utf8(bench.bytes("out/rows.csv")).unwrap();
    let line = rows.lines().nth(3).unwrap();
    for (changed, named) in [
        (rows.replace('\n', "\r\n"), "the first line is not the header"),
        (rows.replace(line, "1,quatrack"), "line 4 is not the row of run 1"),
        (rows.replace(&format!("{line}\n"), ""), "line 4 is not the row of run 1"),
    ] {
        fs::write(bench.0.join("out/rows.csv"), &changed).unwrap();
        refused(&fly, &["rows.csv", named]);
        refused(&["campaign", "summary", &out], &["rows.csv", named]);
        assert_eq!(bench.bytes("out/rows.csv"), changed.as_bytes());
    }
}

#[test]
fn shards_of_two_numbers_are_not_counted_together() {
    let bench = Bench::new("campaign-numbers");
    let [scenario, out] = ["s.toml", "out"].map(|name| bench.path(name));
    fs::write(&scenario, SCENARIO).unwrap();
    flown(&["campaign", &scenario, "--runs", "6", "--shard", "1/2", "--out", &out]);
    for shard in ["1/3", "1/1"] {
        let arguments = ["campaign", &scenario, "--runs", "6", "--shard", shard, "--out", &out];
        refused(&arguments, &["holds shard 1/2; fly --shard I/2"]);
    }
    // From elsewhere.
    fs::copy(bench.0.join("out/rows-1-of-2.csv"), bench.0.join("out/rows-1-of-3.csv")).unwrap();
    refused(&["campaign", "summary", &out], &["holds shard 1/3 beside others of 2"]);
}

#[test]
fn a_growing_campaign_has_no_columns_until_it_is_whole() {
    let bench = Bench::new("campaign-grows");
    let [scenario, out] = ["s.toml", "out"].map(|name| bench.path(name));
    fs::write(&scenario, SCENARIO).unwrap();
    flown(&["campaign", &scenario, "--runs", "3", "--out", &out]);
    let card = bench.bytes("out/campaign.json");
    // Another process flies: nothing of the campaign changes.
    let rows = fs::File::open(bench.0.join("out/rows.csv")).unwrap();
    rows.lock().unwrap();
    refused(&["campaign", &scenario, "--runs", "9", "--out", &out], &["is being written by another process"]);
    assert!(bench.bytes("out/campaign.json") == card && bench.0.join("out/rows.parquet").exists());
    drop(rows);
    flown(&["campaign", &scenario, "--runs", "5", "--out", &out]);
    assert!(bench.0.join("out/rows.parquet").exists());
}

#[test]
fn rows_do_not_depend_on_how_the_scenario_is_called() {
    let bench = Bench::new("campaign-called");
    fs::create_dir_all(bench.0.join("sub")).unwrap();
    // Both ends and the middle divide 1000 Hz, hardly anything between them does: those runs are refused.
    let rates = "{ uniform = [50.0, 200.0] }";
    let text = format!("estimator = \"kalman\"\n{SCENARIO}filter.prediction_hz = {rates}\n");
    for name in ["s.toml", "sub/s.toml"] {
        fs::write(bench.0.join(name), &text).unwrap();
        let out = bench.path(&format!("of-{}", name.replace('/', "-")));
        let said = flown(&["campaign", &bench.path(name), "--runs", "4", "--out", &out]);
        assert!(
            said.contains("note: 8 of 8 flights were refused, which no share counts; run 0: filter.prediction_hz = "),
            "{said}"
        );
    }
    let rows = bench.bytes("of-s.toml/rows.csv");
    assert!(rows == bench.bytes("of-sub-s.toml/rows.csv"));
    assert!(!String::from_utf8(rows).unwrap().contains("s.toml"));
}

#[test]
fn a_replay_leaves_the_campaigns_scenario() {
    let bench = Bench::new("campaign-own");
    let [scenario, out] = ["s.toml", "out"].map(|name| bench.path(name));
    fs::write(&scenario, SCENARIO).unwrap();
    flown(&["campaign", &scenario, "--runs", "2", "--out", &out]);
    let own = bench.path("out/../out/scenario.toml");
    refused(
        &["campaign", "replay", &out, "--run", "1", "--scenario-out", &own],
        &["the scenario of the whole campaign"],
    );
    refused(&["report", &out, "--without-paper", "--within-m", "nan"], &["--within-m"]);
    flown(&["campaign", "replay", &out, "--run", "1"]);
}
