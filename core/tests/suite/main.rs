//! What the core promises by itself: laws, link, gain tables, mixer, supervisor.

mod gain_table_files;
mod link_frames;
mod link_upload;
mod mixer;
mod supervisor_properties;
