//! Files in and out.

pub mod scene_file;
