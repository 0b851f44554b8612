//! The supervisor: whether the measurements may be flown on, how the craft is flown where they may not, and whether the
//! motors turn.
//!
//! One for every product. Each gives it its inputs (a link, a battery and a geofence have the image alone) and does as it
//! is told: [`Guard::order`] once a step, [`Preflight::check`] before arming.
//!
//! ```text
//!                arm, checks passed         a sound state, something to follow
//!  ┌─ OnGround ───────────────────▶ Armed ─────────────────────────────▶ Flying ◀──────────────┐
//!  │     ▲  ▲                         │                                   │   │    all well for │
//!  │     │  │ disarm                  │ link, overrun,         no place   │   │ link, reference,│ 100 ms, but after
//!  │     │  └── from every mode       │ reference, tilt                   │   │ fence, battery, │ fence, battery or
//!  │     │                           ▼                                   │   ▼ saturation      │ saturation
//!  │   Stopped ◀───────────────────────────────────────────┐              │ Holding ────────────┤
//!  │     │ arm       landed, no ground, no attitude,       │              │   │ 1.5 s; no place │
//!  └─────┴─▶ Armed   no body rates, overrun, fault         │              ▼   ▼                 │
//!        ▲                                                 └──────────── LevelAndDown ──────────┘
//!        │ arm, upright
//!     Tumbled ◀── Flying, Holding, LevelAndDown: beyond 60 degrees for 1 s, upside down for 0.6 s, no climb for 1.5 s
//! ```
//!
//! | mode | motors | leaves it |
//! |---|---|---|
//! | on the ground | off | an arm request that passes [`Preflight::check`] |
//! | armed | off | the first reference on a sound state; a reason that stops a flight |
//! | flying | the law's | trouble; disarm |
//! | holding | the law's, towards a standstill | after 1.5 s down; well again; a reason to stop; disarm |
//! | level and down | the law's, downwards at 0.3 m/s; without a place, attitude alone | landed, or after 30 s; well again; a reason to stop; disarm |
//! | stopped | off | arm, disarm; after a fault a restart alone |
//! | tumbled | off | arm, disarm |
//!
//! Nothing ever holds the last command. A craft that cannot be levelled (no body rates, no motors) stops instead of holding.
//! Times are those of [`Config::STANDARD`] and [`MonitorConfig::STANDARD`].

mod braking;
mod descent;
mod guard;
mod machine;
mod mode;
mod monitor;
mod preflight;
mod way;

pub use braking::Braking;
pub use descent::acceleration as descent_acceleration;
pub use guard::{Circumstances, Guard};
pub use machine::{Conditions, Config, Geofence, ReferenceReport, Supervisor, Verdict};
pub use mode::{Action, Fault, Mode, Reason, Tumble};
pub use monitor::{Looked, Monitor, MonitorConfig, Sample, Soundness};
pub use preflight::{ArmError, Certified, Coverage, Preflight};
pub use way::{Asked, Levelled, Order};
