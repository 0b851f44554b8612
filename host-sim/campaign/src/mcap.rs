//! A flight as an MCAP file: a recording in; messages that Foxglove shows as a 3D scene and PlotJuggler as curves out.
//!
//! Messages are JSON. `/scene` has schema `foxglove.SceneUpdate`, `/tf` `foxglove.FrameTransform`, `/pose` and `/reference`
//! `foxglove.PoseInFrame`, and `/flight` `quatrack.FlightSample`: plain numbers by name, SI. A row every 10 ms.

use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions, Writer};
use nalgebra::{UnitQuaternion, Vector3};
use quatrack_simulation::flight::rigid_loop::RigidSample;
use quatrack_simulation::scenario::{Around, Recording};
use serde_json::{Value, json};

/// Topics, their schemas' names and these schemas' properties, each `name: type`.
const TOPICS: [(&str, &str, &str); 5] = [
    (
        "/scene",
        "foxglove.SceneUpdate",
        r#""deletions":{"type":"array","items":{"type":"object"}},"entities":{"type":"array","items":{"type":"object"}}"#,
    ),
    (
        "/tf",
        "foxglove.FrameTransform",
        r#""timestamp":{"type":"object"},"parent_frame_id":{"type":"string"},"child_frame_id":{"type":"string"},"translation":{"type":"object"},"rotation":{"type":"object"}"#,
    ),
    (
        "/pose",
        "foxglove.PoseInFrame",
        r#""timestamp":{"type":"object"},"frame_id":{"type":"string"},"pose":{"type":"object"}"#,
    ),
    (
        "/reference",
        "foxglove.PoseInFrame",
        r#""timestamp":{"type":"object"},"frame_id":{"type":"string"},"pose":{"type":"object"}"#,
    ),
    (
        "/flight",
        "quatrack.FlightSample",
        r#""time_s":{"type":"number"},"position_m":{"type":"object"},"reference_m":{"type":"object"},"error_m":{"type":"number"},"velocity_m_s":{"type":"object"},"body_rates_rad_s":{"type":"object"},"wind_m_s":{"type":"object"},"thrusts_n":{"type":"array","items":{"type":"number"}},"commands_n":{"type":"array","items":{"type":"number"}}"#,
    ),
];

/// The file of a recording of a law on a vehicle whose rotors lie this far from its axes, m.
///
/// # Errors
/// [`McapError`], of the writer.
pub fn file(recording: &Recording, law: &str, half_arm_m: f64) -> Result<Vec<u8>, McapError> {
    let options = WriteOptions::new().compression(None).library("quatrack").profile("");
    let mut writer = Writer::with_options(Cursor::new(Vec::new()), options)?;
    let mut channels = Vec::new();
    for (topic, schema, properties) in TOPICS {
        let text = format!("{{\"title\":\"{schema}\",\"type\":\"object\",\"properties\":{{{properties}}}}}");
        let schema = writer.add_schema(schema, "jsonschema", text.as_bytes())?;
        channels.push(writer.add_channel(schema, topic, "json", &BTreeMap::new())?);
    }
    let rows = recording.shown();
    for (sequence, (sample, around)) in rows.iter().enumerate() {
        let time_ns = (sample.time_s * 1e9).round() as u64;
        let messages = [
            (sequence % 10 == 0).then(|| scene(&rows, sequence, time_ns, law, half_arm_m)),
            Some(transform(sample, time_ns)),
            Some(pose(&sample.state.position_m, &sample.state.attitude, time_ns)),
            Some(pose(&sample.target_m, &UnitQuaternion::identity(), time_ns)),
            Some(numbers(sample, around)),
        ];
        for (channel_id, message) in channels.iter().zip(messages) {
            let Some(message) = message else { continue };
            let header = MessageHeader {
                channel_id: *channel_id,
                sequence: sequence as u32,
                log_time: time_ns,
                publish_time: time_ns,
            };
            writer.write_to_known_channel(&header, message.to_string().as_bytes())?;
        }
    }
    writer.finish()?;
    Ok(writer.into_inner().into_inner())
}

fn stamp(time_ns: u64) -> Value {
    json!({ "sec": time_ns / 1_000_000_000, "nsec": time_ns % 1_000_000_000 })
}

fn vector(v: &Vector3<f64>) -> Value {
    json!({ "x": v.x, "y": v.y, "z": v.z })
}

fn turn(q: &UnitQuaternion<f64>) -> Value {
    json!({ "x": q.i, "y": q.j, "z": q.k, "w": q.w })
}

fn transform(sample: &RigidSample, time_ns: u64) -> Value {
    json!({
        "timestamp": stamp(time_ns),
        "parent_frame_id": "world",
        "child_frame_id": "craft",
        "translation": vector(&sample.state.position_m),
        "rotation": turn(&sample.state.attitude),
    })
}

fn pose(position_m: &Vector3<f64>, attitude: &UnitQuaternion<f64>, time_ns: u64) -> Value {
    json!({
        "timestamp": stamp(time_ns),
        "frame_id": "world",
        "pose": { "position": vector(position_m), "orientation": turn(attitude) },
    })
}

fn numbers(sample: &RigidSample, around: &Around) -> Value {
    let state = &sample.state;
    json!({
        "time_s": sample.time_s,
        "position_m": vector(&state.position_m),
        "reference_m": vector(&sample.target_m),
        "error_m": sample.position_error_m().norm(),
        "velocity_m_s": vector(&state.velocity_m_s),
        "body_rates_rad_s": vector(&state.body_rates_rad_s),
        "wind_m_s": vector(&around.wind_m_s),
        "thrusts_n": state.thrusts_n.as_slice(),
        "commands_n": sample.commands_n.as_slice(),
    })
}

/// Rotors in the craft's frame, and in the world the course with the way flown so far.
fn scene(rows: &[(RigidSample, Around)], until: usize, time_ns: u64, law: &str, half_arm_m: f64) -> Value {
    let colour = |r: f64, g: f64, b: f64, a: f64| json!({ "r": r, "g": g, "b": b, "a": a });
    let corners = [(1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
    let rotors: Vec<Value> = corners
        .iter()
        .map(|(x, y)| {
            json!({
                "pose": { "position": vector(&(Vector3::new(*x, *y, 0.0) * half_arm_m)), "orientation": turn(&UnitQuaternion::identity()) },
                "size": { "x": 1.4 * half_arm_m, "y": 1.4 * half_arm_m, "z": 0.1 * half_arm_m },
                "bottom_scale": 1.0,
                "top_scale": 1.0,
                "color": if *x > 0.0 { colour(0.1, 0.1, 0.1, 1.0) } else { colour(0.04, 0.42, 0.8, 1.0) },
            })
        })
        .collect();
    let line = |points: Vec<Value>, colour: Value| {
        json!({
            "type": 0,
            "pose": { "position": vector(&Vector3::zeros()), "orientation": turn(&UnitQuaternion::identity()) },
            "thickness": 2.0,
            "scale_invariant": true,
            "points": points,
            "color": colour,
            "colors": [],
            "indices": [],
        })
    };
    let course = rows.iter().step_by(5).map(|(sample, _)| vector(&sample.target_m)).collect();
    let way = rows.iter().take(until + 1).step_by(5).map(|(sample, _)| vector(&sample.state.position_m)).collect();
    let entity = |id: &str, frame: &str, cylinders: Vec<Value>, lines: Vec<Value>| {
        json!({
            "timestamp": stamp(time_ns),
            "frame_id": frame,
            "id": id,
            "lifetime": { "sec": 0, "nsec": 0 },
            "frame_locked": true,
            "metadata": [{ "key": "law", "value": law }],
            "arrows": [], "cubes": [], "spheres": [], "cylinders": cylinders, "lines": lines, "triangles": [], "texts": [],
            "models": [],
        })
    };
    let lines = vec![line(course, colour(0.6, 0.6, 0.6, 0.8)), line(way, colour(0.04, 0.42, 0.8, 1.0))];
    json!({
        "deletions": [],
        "entities": [entity("craft", "craft", rotors, Vec::new()), entity("way", "world", Vec::new(), lines)],
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use quatrack_simulation::scenario::Scenario;
    use quatrack_simulation::scenario::file::ScenarioFile;

    use super::*;

    #[test]
    fn the_reader_gives_back_the_flight() {
        let text = "vehicle = \"crazyflie-2.1\"\ncourse = \"step\"\nstep_m = 0.2\nduration_s = 0.5\n";
        let scenario = Scenario::checked(&ScenarioFile::parse(text, "test").unwrap(), "test", Path::new("")).unwrap();
        let mut law = scenario.law.start(&scenario.vehicle, &scenario.told).unwrap();
        let recording = scenario.record(law.as_mut(), &scenario.flown(None)).unwrap();
        let bytes = file(&recording, "quatrack", scenario.vehicle.motors().half_arm_m()).unwrap();
        let samples = &recording.flight.samples;
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        for message in mcap::MessageStream::new(&bytes).unwrap() {
            let message = message.unwrap();
            let (topic, schema) = (message.channel.topic.clone(), message.channel.schema.as_ref().unwrap());
            let (_, name, _) = TOPICS.iter().find(|(known, ..)| *known == topic).unwrap();
            assert_eq!((schema.name.as_str(), schema.encoding.as_str()), (*name, "jsonschema"));
            serde_json::from_slice::<Value>(&schema.data).unwrap();
            let value: Value = serde_json::from_slice(&message.data).unwrap();
            let index = counts.entry(topic.clone()).or_default();
            if topic == "/flight" {
                // A number's last digit may be another after JSON.
                let [read, flown] = [value["position_m"]["x"].as_f64().unwrap(), samples[*index].state.position_m.x];
                assert!((read - flown).abs() <= 4.0 * f64::EPSILON * flown.abs(), "{read} {flown}");
                assert_eq!(message.log_time, (samples[*index].time_s * 1e9).round() as u64);
            }
            *index += 1;
        }
        assert_eq!(
            (counts["/flight"], counts["/tf"], counts["/scene"]),
            (samples.len(), samples.len(), samples.len().div_ceil(10))
        );
    }
}
