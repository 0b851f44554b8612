//! Design files to tables, and flights in simulation: the paper's and those down to the motors.

mod actuator_aware_certificate;
mod actuator_aware_design;
mod actuator_aware_gains;
mod compare;
mod gains_along;
mod gains_design;
mod gains_export;
mod gains_tables;
mod plant;
mod reproduction;
mod reproduction_extensions;
mod rigid;
mod robustness;
mod sampled_along;
mod scenario_files;
mod trajectory_refit;
mod trajectory_stored;
mod vehicle;
