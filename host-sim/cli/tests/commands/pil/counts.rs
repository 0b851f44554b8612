//! Instructions a step: the most that the control path may cost.

use quatrack_cli::pil::image::{self, Image};
use quatrack_cli::pil::measure::{Images, InstructionReport, count};

use super::emulated::pipes_image;
use super::support::has_emulator;

/// Steps of each flight: the costs do not depend on the values, but for limits and the sign of a quaternion.
const STEPS: usize = 200;

fn report() -> InstructionReport {
    let build = |image| image::build(&image::checkout().unwrap(), image).unwrap();
    let images = Images {
        counting: build(Image::Measure),
        control_path: build(Image::ControlPath),
        motor_path: build(Image::MotorPath),
        estimator: build(Image::MeasureEstimator),
        link: build(Image::MeasureLink),
        flying: pipes_image(),
    };
    count(&images, Some(STEPS)).unwrap()
}

#[test]
fn every_part_stays_within_its_bound_when_everything_is_turned_fed_forward_and_limited() {
    if !has_emulator() {
        return;
    }
    let report = report();
    assert_eq!(report.steps, 8 * STEPS);
    let most = |name: &str| report.law[name].max;
    // Peers on the same processor, without a check: Mellinger's controller 468, a quaternion LQR in C 608.
    for name in ["LYAP-E", "LQR-E"] {
        assert!(most(name) <= 200, "{name}: {}", most(name));
    }
    for name in ["LYAP-F", "LQR-F"] {
        assert!(most(name) <= 320, "{name}: {}", most(name));
    }
    // 27 more products than the paper's tables have, each with a load and an addition.
    let (dense, structured) = (report.law["any E table"], report.law["LQR-E"]);
    assert!(dense.max <= structured.max + 3 * 27, "{dense:?}, {structured:?}");
    // A step without limits, in the heading frame or not, costs less: the counts do depend on the case.
    assert!(structured.min + 30 <= structured.max, "{structured:?}");
    assert!(report.reference.max <= 300, "{:?}", report.reference);
    assert!(report.reference_turning.max <= report.reference.max + 130, "{:?}", report.reference_turning);
    // 27 of them look at the leash.
    assert!(report.tick.max <= 905, "{:?}", report.tick);
    // With tables of every kind, and the supervisor.
    assert!(report.flash_bytes <= 26_000, "{} bytes", report.flash_bytes);
    assert!(report.flash_to_motors_bytes > report.flash_bytes, "{} bytes", report.flash_to_motors_bytes);
    // The estimator: 9 by 9 times 9 by 9 twice would be 1458 products, each with an addition and its loads; every bit is
    // compared on the way.
    // A block of the hash is some 2,500. A tag takes two to four, one of them for its second pass; a hello with its answer, whose
    // tags are the key's, and the session's own key take eleven.
    let link = report.link.unwrap();
    for frame in &link.frames {
        let bound = if frame.frame.contains("hello") { 30_000 } else { 14_000 };
        assert!(frame.without_tag <= 4_500 && frame.with_tag <= bound, "{frame:?}");
    }
    assert!(link.signature <= 22_000, "{}", link.signature);
    let estimator = report.estimator.unwrap();
    for (prediction, update) in estimator.prediction.values().zip(estimator.update.values()) {
        assert!(prediction.max <= 3_500 && update.max <= 3_200, "{prediction:?}, {update:?}");
    }
    assert!(estimator.prediction_stack_bytes <= 1_500 && estimator.update_stack_bytes <= 1_500, "{estimator:?}");
}

#[test]
fn every_call_of_the_crazyflies_stabilizer_stays_within_its_own_controllers_counts() {
    if !has_emulator() {
        return;
    }
    // Every bit is compared on the way.
    let counts = quatrack_cli::pil::crazyflie::count(&image::checkout().unwrap()).unwrap();
    let (change, rows) = counts.rows.split_last().unwrap();
    assert_eq!((rows.len(), change.table), (5 * 4, "a change"));
    // The stabilizer's task has 450 words, of which a task switch takes 51 and the task's own frame 22.
    assert!((500..=4 * (450 - 51 - 22)).contains(&counts.stack_bytes), "{} bytes", counts.stack_bytes);
    assert!(change.control_step.max <= 3_600, "{change:?}");
    for row in rows {
        // Mellinger's controller takes 590 for an attitude that is sent to it, without a check; Lee's 2,794.
        // The paper's laws take 490 and 599 of it, the supervisor's look at state and gyroscope the rest.
        let bound = if row.table == "cascade" { 2_200 } else { 700 };
        assert!(row.control_step.max <= bound && row.other_step.max <= 1_200, "{row:?}");
    }
}
