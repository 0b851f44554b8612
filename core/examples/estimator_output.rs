//! The output of somebody else's estimator as the state that the controller takes: north-east-down, quaternion scalar last,
//! body x forward, y right and z down, rates in degrees a second.
//!
//! `cargo run --package quatrack --example estimator_output`

use quatrack::nalgebra::Vector3;
use quatrack::{Quaternion, RigidState, State};

/// A message as it arrives, in the units and frames of its sender.
struct Estimate {
    position_ned_m: [f32; 3],
    velocity_ned_m_s: [f32; 3],
    /// x, y, z, w: forward-right-down body to north-east-down world.
    attitude_xyzw: [f32; 4],
    body_rates_deg_s: [f32; 3],
}

/// Here the world is z up (x north, y west) and the body x forward, y left, z up: both frames are the sender's turned
/// by half a turn about x, which keeps x and turns the signs of y and z. A rotation between two frames that are turned
/// alike has the same angle about the turned axis.
fn rigid_state(estimate: &Estimate) -> RigidState {
    let turned = |[x, y, z]: [f32; 3]| Vector3::new(x, -y, -z);
    let [x, y, z, w] = estimate.attitude_xyzw;
    let state = State {
        position_m: turned(estimate.position_ned_m),
        attitude: Quaternion::new(w, x, -y, -z),
        velocity_m_s: turned(estimate.velocity_ned_m_s),
    };
    RigidState { state, body_rates_rad_s: turned(estimate.body_rates_deg_s.map(f32::to_radians)) }
}

fn main() -> Result<(), Box<dyn core::error::Error>> {
    // One metre up, nose up by 10 degrees, climbing.
    let (sin, cos) = (5.0_f32.to_radians().sin(), 5.0_f32.to_radians().cos());
    let found = rigid_state(&Estimate {
        position_ned_m: [0.0, 0.0, -1.0],
        velocity_ned_m_s: [0.0, 0.0, -0.2],
        attitude_xyzw: [0.0, sin, 0.0, cos],
        body_rates_deg_s: [0.0, 45.0, 0.0],
    });
    // The check names the fault: a norm of 57 says that degrees went where numbers belong.
    let state = found.state.validated()?;
    let thrust_axis = state.attitude.thrust_axis();
    println!("height {} m, climbing at {} m/s", state.position_m.z, state.velocity_m_s.z);
    // Nose up: the thrust points backwards.
    println!("thrust axis {:.3} {:.3} {:.3}", thrust_axis.x, thrust_axis.y, thrust_axis.z);
    println!("pitch rate {:.3} rad/s", found.body_rates_rad_s.y);
    assert!(thrust_axis.x < 0.0 && found.body_rates_rad_s.y < 0.0);
    Ok(())
}
