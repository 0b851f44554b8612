//! The figures over which a table of the cascade is certified: a region and the air that is told, each as a design
//! states it.

use serde::Serialize;

use crate::certify::cascade::CascadeRegion;

/// How far a table of the cascade is certified, all at once.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CascadeBounds {
    /// Shortest and longest time constant of the motors, s.
    pub lag_s: [f64; 2],
    /// How much heavier or lighter than told the craft may be, as a share.
    pub mass_share: f64,
    /// The same of its inertia.
    pub inertia_share: f64,
    /// The same about yaw, where another is known of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub yaw_inertia_share: Option<f64>,
    /// Least and most force of a motor over its command.
    pub force_share: [f64; 2],
    /// Longest delay of commands, s.
    pub delay_s: f64,
    /// Most drag, 1/s.
    pub drag_per_s: f64,
    /// Most moment of the air about x and y, N s.
    pub moment_n_s: [f64; 2],
}

/// The air of a table of the cascade.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CascadeAir {
    /// Drag that is told, 1/s.
    pub drag_per_s: f64,
    /// Moment that is told, N s.
    pub moment_n_s: [f64; 2],
    /// How much of the identified air that is: margins are stated in the whole of it.
    pub share_of_identified: f64,
    /// Share of the wind's moment that is fed forward.
    pub gust: f64,
    /// Whether the air is learned in flight.
    pub learn: bool,
}

impl CascadeBounds {
    /// The region's grid: the ends of everything, of the lags five in even steps of ratio.
    pub(super) fn region(&self) -> CascadeRegion {
        let around = |share: f64| if share > 0.0 { vec![1.0 - share, 1.0 + share] } else { vec![1.0] };
        let up_to = |most: f64| if most > 0.0 { vec![0.0, most] } else { vec![0.0] };
        let [shortest_s, longest_s] = self.lag_s;
        let all = CascadeRegion::in_air(shortest_s, longest_s);
        let believed = all.believed_drags_per_s.iter().copied().fold(0.0, f64::max);
        CascadeRegion {
            mass_factors: around(self.mass_share),
            inertia_factors: around(self.inertia_share),
            yaw_inertia_factors: self.yaw_inertia_share.map(around),
            command_factors: self.force_share.to_vec(),
            delays_s: up_to(self.delay_s),
            drags_per_s: up_to(self.drag_per_s),
            // Over the most, which is the craft's own here.
            moment_factors: vec![0.0, 1.0],
            believed_drags_per_s: up_to(believed),
            believed_ratio_factors: vec![0.0, 1.5],
            ..all
        }
    }

    /// The same before the craft has learned its motors' share.
    pub(super) fn region_unseen(&self) -> CascadeRegion {
        CascadeRegion { torque_factors: self.force_share.to_vec(), ..self.region().before_its_motors_are_seen() }
    }
}
