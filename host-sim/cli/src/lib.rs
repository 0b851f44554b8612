//! The `quatrack` command, and the parts of it that no other crate needs: the image on its processor, and figures.
//!
//! ```text
//! cli          arguments and files in; tables, files and an exit code out
//!   pil        the image on its processor, emulated or real: flown, compared, counted
//!   figures    Figures 2 to 5, as SVG and PNG
//! ```
//!
//! Below it are `quatrack_simulation`, `quatrack_plan` and `quatrack_design`.

pub mod cli;
pub mod figures;
pub mod pil;
