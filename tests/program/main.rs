//! Tests of the program and of what it reads and writes: verbs, bad input, file formats, scene files, the JSON schema.

#![cfg(feature = "cli")]

mod adaptive;
mod cli_bad_input;
mod cli_study;
mod cli_verbs;
mod columns_as_they_come;
mod command_line;
mod deadlines;
mod diff;
mod draws;
mod explore;
mod files_as_they_come;
mod first_impression;
mod first_try;
mod formats;
mod frontier;
mod fuzz_seeds;
mod hostile;
mod large_grids;
mod large_tables;
mod live;
mod meshes;
mod newcomers_files;
mod npz;
mod options_matter;
mod options_table;
mod outputs;
mod parts;
mod readers;
mod report_page;
mod scene_file;
mod schema;
mod several;
mod side_and_axes;
mod unplaced;
mod words;
