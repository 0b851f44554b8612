//! Plans against their waypoints and bounds, and trajectory files.

mod bounds;
mod files;
mod flights;
mod on_board_trajectory;
mod paper;
mod polynomial;
mod times_and_headings;
mod trajectory_csv;
mod trajectory_file;
