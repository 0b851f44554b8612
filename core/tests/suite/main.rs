//! The core's promises by itself: laws, link, gain tables, mixer, supervisor.

mod control;
mod flatness;
mod gain_table_files;
mod laws;
mod laws_beyond;
mod link_frames;
mod link_upload;
mod mixer;
mod motors;
mod supervisor_properties;
mod twin;
