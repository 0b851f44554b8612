//! Section III and Section IV of the paper, and more beyond them: equations solved, gains designed and certified.

mod analysis_section_three;
mod analysis_structure;
mod carex;
mod certify;
mod certify_gains;
mod far_apart;
mod lyapunov;
mod paper;
mod paper_tables;
mod riccati;
mod sampled;
mod sampled_equations;
