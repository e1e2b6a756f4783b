//! The program `palpate`: file formats, reports and pictures, and the command line.
//!
//! It is a part of `palpate`, which people add and install; its names may change with every release.

pub mod cli;
mod comparison;
pub mod io;
pub mod report;
