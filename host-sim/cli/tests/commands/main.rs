//! The command as it is typed, and the figures that it draws.

mod campaign;
mod cli;
mod compare;
mod figures;
mod figures_png;
mod fly_course;
mod fly_scenario;
mod gains;
mod identify;
mod keys;
mod pil;
mod trajectories;
