//! A plan and its flight in; the text that is printed of them, each value beside its bound, out.

use std::fmt::Write as _;

use quatrack_plan::plan::{FlightPlan, Limit, PlannedFlight, PlannedLeg, Realised};

pub(super) fn summary(plan: &FlightPlan, flight: &PlannedFlight) -> String {
    let mut text: String = plan.notes().iter().map(|note| format!("note: {note}\n")).collect();
    for (leg, number) in flight.legs.iter().zip(1..) {
        if flight.legs.len() > 1 {
            let _ = writeln!(text, "{}curve {number} of {}", if number > 1 { "\n" } else { "" }, flight.legs.len());
        }
        text += &leg_summary(leg);
        if let Some(detour) = &leg.detour {
            let cause = detour.waypoint.map_or_else(String::new, |number| {
                format!("; without waypoint {number} it is shortest: give that one another time or more tolerance_m")
            });
            let _ = writeln!(
                text,
                "\nwarning: the curve is {:.1} times as long as the straight lines through its waypoints{cause}",
                detour.times
            );
        }
    }
    text
}

fn leg_summary(PlannedLeg { plan, curve, realised, .. }: &PlannedLeg) -> String {
    let sampled = &realised.sampled;
    let bounds = plan.bounds();
    let mut text = format!(
        "degree {}, {} spans, {} control points, {} s, {:.3} m long\n\n",
        plan.degree(),
        plan.spans(),
        curve.control_points_m().len(),
        // A duration that was found has more digits than anybody reads.
        (plan.duration_s() * 1e6).round() / 1e6,
        sampled.length_m
    );
    line(&mut text, ["", "sampled", "control points", "bound"]);
    let one = 1.0;
    let deg = 1_f64.to_degrees();
    let rows = [
        ("speed, largest, m/s", sampled.speed_max_m_s, Some(Limit::Speed), bounds.speed_max_m_s, one),
        (
            "acceleration, largest, m/s^2",
            sampled.acceleration_max_m_s2,
            bounds.acceleration_max_m_s2.map(|_| Limit::Acceleration),
            bounds.acceleration_max_m_s2,
            one,
        ),
        ("tilt, largest, deg", sampled.tilt_max_rad, Some(Limit::Tilt), bounds.tilt_max_rad, deg),
        ("thrust, least, m/s^2", sampled.thrust_min_m_s2, Some(Limit::ThrustMin), bounds.thrust_min_m_s2, one),
        ("thrust, largest, m/s^2", sampled.thrust_max_m_s2, Some(Limit::ThrustMax), bounds.thrust_max_m_s2, one),
        (
            "turn of the thrust, deg/s",
            sampled.turn_rate_max_rad_s,
            Some(Limit::BodyRate),
            bounds.body_rate_max_rad_s,
            deg,
        ),
        ("yaw rate, largest, deg/s", sampled.heading_rate_max_rad_s, None, bounds.heading_rate_max_rad_s, deg),
        ("body rate, largest, deg/s", sampled.body_rate_max_rad_s, None, None, deg),
    ];
    for (name, sampled, limit, bound, unit) in rows {
        let proved = limit.and_then(|limit| proved(realised, limit));
        let cell = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{:.4}", value * unit));
        // A bound is printed as written, but for the rounding of degrees.
        let asked = bound.map_or("-".to_owned(), |bound| format!("{}", (bound * unit * 1e9).round() / 1e9));
        line(&mut text, [name, &cell(Some(sampled)), &cell(proved), &asked]);
    }
    text.push('\n');
    line(&mut text, ["waypoint", "time, s", "missed by, m", "tolerance, m"]);
    for ((waypoint, miss), number) in plan.waypoints().iter().zip(&realised.misses_m).zip(plan.first_number()..) {
        let time = format!("{:.4}", waypoint.time_s);
        // The residual of an equality is rounding, and differs between machines.
        let miss = format!("{:.6}", (miss * 1e6).round() / 1e6);
        let tolerance = if waypoint.tolerance_m == 0.0 { "exact".to_owned() } else { waypoint.tolerance_m.to_string() };
        line(&mut text, [&number.to_string(), &time, &miss, &tolerance]);
    }
    text
}

/// Largest (or least) value of a limit that the control points prove for all t.
fn proved(realised: &Realised, limit: Limit) -> Option<f64> {
    realised.proved.iter().find(|(of, _)| *of == limit).map(|(_, value)| *value)
}

fn line(text: &mut String, [name, a, b, c]: [&str; 4]) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{name:<30} {a:>10} {b:>15} {c:>13}");
}
