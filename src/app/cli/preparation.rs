//! What is done to the input before it is fitted: a part is taken, normals are reversed, ignored or estimated.

use clap::Args;

use crate::io::{Input, Reading};
use palpate_geometry::contact::{Contacts, Orientation};

use super::failure::Failure;
use super::pixels::contacts_of;
use super::values;
use super::viewpoint::{sees_from_below, turned_towards};

/// Which part of the input is used, and what becomes of its normals.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Input")]
pub(super) struct PreparationFlags {
    /// Use only the contacts within R of the point X,Y,Z
    #[arg(long, value_name = "X,Y,Z,R", allow_hyphen_values = true, value_parser = values::ball)]
    near: Option<[f64; 4]>,
    /// Use only the contacts inside this box
    #[arg(long = "box", hide_short_help = true, value_name = "X0,X1,Y0,Y1,Z0,Z1", allow_hyphen_values = true, value_parser = values::bounds)]
    bounds: Option<[f64; 6]>,
    /// Normals point into the body: reverse them all
    #[arg(long)]
    flip_normals: bool,
    /// Use the positions alone, as if the file had no normals
    #[arg(long, hide_short_help = true, conflicts_with = "flip_normals")]
    ignore_normals: bool,
    /// estimate: compute normals from neighbouring positions, instead of the file's if it has any
    #[arg(long, hide_short_help = true, value_name = "HOW", value_parser = ["estimate"], conflicts_with_all = ["flip_normals", "ignore_normals"])]
    normals: Option<String>,
    /// Where the sensor stood: the side of the surface that it saw is the free side
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub(super) viewpoint: Option<[f64; 3]>,
}

impl PreparationFlags {
    /// Normals are computed, so that a viewpoint decides their side even for a model that was named.
    pub(super) fn estimates_normals(&self) -> bool {
        self.normals.is_some()
    }

    /// The file's normals are not used.
    pub(super) fn needs_no_normals(&self) -> bool {
        self.ignore_normals || self.estimates_normals()
    }

    /// Does all that was asked for; notes say what was done.
    pub(super) fn apply(&self, reading: &mut Reading) -> Result<Vec<String>, Failure> {
        let mut notes = Vec::new();
        if self.near.is_some() || self.bounds.is_some() {
            notes.push(self.take_part(reading)?);
        }
        self.prepare_normals(reading, &mut notes)?;
        self.take_side_of_grid(reading, &mut notes);
        Ok(notes)
    }

    /// Reverses, leaves out or estimates normals.
    fn prepare_normals(&self, reading: &mut Reading, notes: &mut Vec<String>) -> Result<(), Failure> {
        let file = &reading.file;
        let wrong = |what: &str| Err(Failure::Input(format!("{file}: {what}")));
        if !(self.flip_normals || self.ignore_normals || self.normals.is_some()) {
            return Ok(());
        }
        match &mut reading.input {
            Input::Contacts(contacts) => {
                let given = std::mem::take(contacts);
                *contacts = match (&given.orientation, self.normals.is_some()) {
                    (_, true) => {
                        notes.push("normals were estimated from neighbouring positions".into());
                        given
                            .with_estimated_normals(self.viewpoint.or(reading.viewpoint))
                            .map_err(|error| Failure::Input(format!("{file}: {error}")))?
                    }
                    (Orientation::None, false) if self.flip_normals => {
                        return wrong("there are no normals that --flip-normals could reverse");
                    }
                    (Orientation::None, false) => {
                        return wrong("there are no normals that --ignore-normals could leave out");
                    }
                    (Orientation::Slopes { .. }, false) if self.flip_normals => {
                        return wrong("slopes have no side that --flip-normals could reverse; it is for nx, ny, nz");
                    }
                    (_, false) if self.flip_normals => given.with_flipped_normals(),
                    _ => {
                        notes.push("the file's normals are ignored".into());
                        Contacts { orientation: Orientation::None, ..given }
                    }
                };
            }
            Input::Grid(grid) if self.ignore_normals && (grid.zx.is_some() || grid.zy.is_some()) => {
                (grid.zx, grid.zy) = (None, None);
                notes.push("the file's slopes are ignored".into());
            }
            Input::Grid(_) if self.ignore_normals => {
                return wrong("there are no slopes that --ignore-normals could leave out");
            }
            Input::Grid(_) => {
                return wrong("this is a grid of heights, which has no normals to reverse or to estimate");
            }
        }
        Ok(())
    }

    /// A grid has the side of +z; where the viewpoint is on the other, its pixels are contacts with the side that was seen.
    fn take_side_of_grid(&self, reading: &mut Reading, notes: &mut Vec<String>) {
        let (Input::Grid(grid), Some(eye)) = (&reading.input, self.viewpoint) else { return };
        let pixels = contacts_of(grid);
        if sees_from_below(&pixels, eye) {
            notes.push("the viewpoint is below the grid, whose lower side is taken for the free one".into());
            reading.input = Input::Contacts(turned_towards(pixels, eye, &mut Vec::new()));
        }
    }

    /// Numbers of the contacts in the part that was asked for, where one was.
    pub(super) fn kept(&self, contacts: &Contacts) -> Option<Vec<u32>> {
        let at = |r: usize| [contacts.x[r], contacts.y[r], contacts.z[r]];
        let asked = self.near.is_some() || self.bounds.is_some();
        asked.then(|| (0..contacts.len()).filter(|&r| self.holds(at(r))).map(|r| r as u32).collect())
    }

    fn holds(&self, [x, y, z]: [f64; 3]) -> bool {
        let near = |[a, b, c, r]: [f64; 4]| (x - a).hypot(y - b).hypot(z - c) <= r;
        let inside = |[x0, x1, y0, y1, z0, z1]: [f64; 6]| {
            (x0..=x1).contains(&x) && (y0..=y1).contains(&y) && (z0..=z1).contains(&z)
        };
        self.near.is_none_or(near) && self.bounds.is_none_or(inside)
    }

    /// Leaves only the part that was asked for.
    fn take_part(&self, reading: &mut Reading) -> Result<String, Failure> {
        let (taken, all) = match &mut reading.input {
            Input::Contacts(contacts) => {
                let all = contacts.len();
                let kept = self.kept(contacts).unwrap_or_default();
                *contacts = contacts.in_order(&kept);
                // lines are those of the whole file, and would name the wrong rows
                reading.places = None;
                (kept.len(), all)
            }
            Input::Grid(grid) => {
                let (mut taken, mut all) = (0, 0);
                for ((i, j), z) in grid.z.indexed_iter_mut().filter(|(_, z)| !z.is_nan()) {
                    all += 1;
                    if self.holds([grid.x[i], grid.y[j], *z]) {
                        taken += 1;
                    } else {
                        *z = f64::NAN;
                        for slope in [&mut grid.zx, &mut grid.zy].into_iter().flatten() {
                            slope[[i, j]] = f64::NAN;
                        }
                    }
                }
                (taken, all)
            }
        };
        taken_part([taken, all]).map_err(|what| Failure::Input(format!("{}: {what}", reading.file)))
    }

    /// Why contacts that come in pieces cannot be prepared so, where they cannot.
    pub(super) fn check_pieces(&self) -> Result<(), &'static str> {
        match (self.estimates_normals(), self.viewpoint) {
            (true, _) => {
                Err("normals are estimated of all contacts at once, which would take more memory than --memory allows")
            }
            (false, Some(_)) => {
                Err("a viewpoint changes nothing for an adaptive surface: --flip-normals reverses normals")
            }
            (false, None) => Ok(()),
        }
    }

    /// The same for contacts of which the part was taken before.
    pub(super) fn without_part(&self) -> PreparationFlags {
        PreparationFlags { near: None, bounds: None, ..self.clone() }
    }

    /// What is said of the part that was asked for, where one was, by the contacts in it and by all; an error where none are.
    pub(super) fn part_note(&self, taken_and_all: [usize; 2]) -> Option<Result<String, &'static str>> {
        (self.near.is_some() || self.bounds.is_some()).then(|| taken_part(taken_and_all))
    }
}

fn taken_part([taken, all]: [usize; 2]) -> Result<String, &'static str> {
    if taken == 0 {
        return Err("no contact lies in the part that --near or --box asks for");
    }
    Ok(format!("{taken} of {all} contacts are in the part that was asked for"))
}
