//! The struct behind the Crazyflie's parameters and log variables: `quatrack.h` has it field by field as the object does.

use std::mem::{align_of, offset_of, size_of};
use std::path::Path;

use quatrack_crazyflie::craft::Platform;
use quatrack_crazyflie::shared::{Gains, Learned, Log, Parameters, Shared};
use quatrack_crazyflie::upload::Packet;

/// A struct of the header: where its fields lie by the rules of C, and its size.
fn layout(header: &str, name: &str) -> (Vec<usize>, usize) {
    let end = header.find(&format!("}} {name};")).unwrap_or_else(|| panic!("no {name}"));
    let begin = header[..end].rfind("typedef struct {").unwrap() + "typedef struct {".len();
    let (mut at, mut alignment, mut offsets) = (0_usize, 1, Vec::new());
    // Comments hold semicolons.
    let mut body = header[begin..end].to_owned();
    while let Some(from) = body.find("/*") {
        let to = from + body[from..].find("*/").unwrap() + 2;
        body.replace_range(from..to, "");
    }
    for field in body.split(';').map(str::trim).filter(|field| !field.is_empty()) {
        let (kind, field) = field.split_once(' ').unwrap();
        let size = match kind {
            "float" => size_of::<f32>(),
            "int16_t" | "uint16_t" => size_of::<u16>(),
            "uint8_t" => size_of::<u8>(),
            _ => panic!("{kind}"),
        };
        let count = field.split_once('[').map_or(1, |(_, count)| count.trim_end_matches(']').parse().unwrap());
        at = at.next_multiple_of(size);
        offsets.push(at);
        at += size * count;
        alignment = alignment.max(size);
    }
    (offsets, at.next_multiple_of(alignment))
}

macro_rules! assert_lies_as {
    ($header:expr, $name:literal, $type:ty, [$($field:ident),+]) => {
        let (offsets, size) = layout($header, $name);
        assert_eq!(offsets, [$(offset_of!($type, $field)),+], $name);
        assert_eq!(size, size_of::<$type>(), $name);
    };
}

#[test]
fn every_field_of_the_header_lies_where_the_objects_does() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crazyflie/app/src/quatrack.h");
    let header = &std::fs::read_to_string(path).unwrap();
    assert_lies_as!(
        header,
        "quatrackParameters_t",
        Parameters,
        [
            position_scale,
            yaw_scale,
            leash_m,
            speed_m_s,
            acceleration_m_s2,
            roll_pitch_rate_rad_s,
            yaw_rate_rad_s,
            motor_lag_s,
            drag_per_s,
            moment_x_n_s,
            moment_y_n_s,
            gust,
            goal_speed_m_s,
            goal_climb_m_s,
            tilt_deg,
            table,
            feed_forward,
            learn
        ]
    );
    assert_lies_as!(
        header,
        "quatrackLog_t",
        Log,
        [
            error_mm,
            rotation_mrad,
            forces,
            limited,
            cycles,
            mode,
            table,
            bad_states,
            bad_setpoints,
            limited_steps,
            jumps,
            refused_tables,
            refusal,
            put_back,
            parameter,
            reason
        ]
    );
    assert_lies_as!(
        header,
        "quatrackLearned_t",
        Learned,
        [drag_per_s, moment_n_s, motor_share, disturbance_m_s2, stands]
    );
    assert_lies_as!(header, "quatrackGains_t", Gains, [scale_min, scale_max, entries]);
    assert_lies_as!(header, "quatrackPlatform_t", Platform, [mass_kg, arm_m, thrust_max_n, torque_per_thrust_m]);
    assert_lies_as!(header, "quatrackPacket_t", Packet, [length, bytes]);
    // One after the other, padded as C does.
    let (_, parameters) = layout(header, "quatrackParameters_t");
    let (_, log) = layout(header, "quatrackLog_t");
    assert_eq!(offset_of!(Shared, log), parameters);
    let (_, learned) = layout(header, "quatrackLearned_t");
    let learned_at = (parameters + log).next_multiple_of(align_of::<Learned>());
    assert_eq!(offset_of!(Shared, learned), learned_at);
    assert_eq!(offset_of!(Shared, gains), learned_at + learned);
    // One log packet.
    assert_eq!(offset_of!(Log, bad_states), 26);
}
