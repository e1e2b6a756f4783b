//! The column rules that CSV, PLY and NPZ share: which names make contacts, and which rows are fit to use.
//!
//! `x,y,z` and optionally `nx,ny,nz` or `zx,zy` (not both), `finger`, `station`, `wz,wx,wy`. Without `z` but with
//! slopes or normals the heights are zero with weight zero: slopes only. A normal that is zero, or all of whose three cells are
//! empty or NaN, is not known.

use std::collections::HashSet;

use palpate_geometry::contact::{ContactWeights, Contacts, Orientation};

use super::escape_control_chars::visible;
use super::place::{Place, Places, Runs, Unit};
use super::{Input, IoError, Points, ReadOptions, Reading};

/// A column that palpate knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Column {
    X,
    Y,
    Z,
    Nx,
    Ny,
    Nz,
    Zx,
    Zy,
    Finger,
    Station,
    Wz,
    Wx,
    Wy,
}

use Column::*;

pub(super) const COLUMNS: [Column; 13] = [X, Y, Z, Nx, Ny, Nz, Zx, Zy, Finger, Station, Wz, Wx, Wy];
const WEIGHTS: [Column; 3] = [Wz, Wx, Wy];
impl Column {
    pub(super) fn name(self) -> &'static str {
        ["x", "y", "z", "nx", "ny", "nz", "zx", "zy", "finger", "station", "wz", "wx", "wy"][self as usize]
    }

    pub(super) fn of(name: &str) -> Option<Column> {
        COLUMNS.into_iter().find(|column| column.name() == name)
    }
}

/// What the columns are to be used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Need {
    /// Contacts by all the rules.
    Contacts,
    /// Places to look at a surface: x and y, whatever else there is.
    Points,
}

impl Need {
    fn words(self) -> &'static str {
        match self {
            Need::Contacts => {
                "x,y,z; normals nx,ny,nz (or slopes zx,zy) help, and finger, station, wz,wx,wy may stand beside them"
            }
            Need::Points => "x,y",
        }
    }
}

/// Columns as read, `None` where the file has none; all of one length.
#[derive(Default)]
pub(super) struct Columns {
    values: [Option<Vec<f64>>; 13],
    /// What the file calls them, where that is another name.
    titles: [Option<String>; 13],
    /// Unit of length of the places, where the file says it.
    pub(super) unit: Option<String>,
    /// Names that were there and are not used.
    pub(super) ignored: Vec<String>,
}

impl Columns {
    /// One empty column per known name; the rest is noted. A name that stands twice is an error.
    pub(super) fn named(file: &str, names: &[&str], need: Need) -> Result<Columns, IoError> {
        Columns::titled(file, names, names, need)
    }

    /// The same of names that stand in the file as `titles`.
    pub(super) fn titled(file: &str, names: &[&str], titles: &[&str], need: Need) -> Result<Columns, IoError> {
        let mut columns = Columns::default();
        let mut seen = HashSet::with_capacity(names.len());
        for (name, title) in names.iter().zip(titles) {
            let known = Column::of(name);
            if !seen.insert(name) && !name.is_empty() {
                return Err(IoError::DuplicateColumn { file: file.into(), column: visible(name) });
            }
            match known.filter(|column| need == Need::Contacts || matches!(column, X | Y)) {
                Some(column) => {
                    columns.values[column as usize] = Some(Vec::new());
                    columns.titles[column as usize] = Some(visible(title)).filter(|title| title != name);
                }
                None => columns.ignored.push(visible(title)),
            }
        }
        columns.check_names(file, titles, need)?;
        Ok(columns)
    }

    /// What the file calls a column.
    pub(super) fn title(&self, column: Column) -> String {
        self.titles[column as usize].clone().unwrap_or_else(|| column.name().into())
    }

    pub(super) fn set(&mut self, column: Column, values: Vec<f64>) {
        self.values[column as usize] = Some(values);
    }

    pub(super) fn get(&self, column: Column) -> Option<&[f64]> {
        self.values[column as usize].as_deref()
    }

    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.values[X as usize].as_ref().map_or(0, Vec::len)
    }

    /// Leaves the rows of `kept`, in their order.
    pub(super) fn keep(&mut self, kept: &[usize]) {
        for values in self.values.iter_mut().flatten() {
            *values = kept.iter().map(|&row| values[row]).collect();
        }
    }

    pub(super) fn has(&self, column: Column) -> bool {
        self.values[column as usize].is_some()
    }

    pub(super) fn get_mut(&mut self, column: Column) -> Option<&mut Vec<f64>> {
        self.values[column as usize].as_mut()
    }

    fn has_any(&self, columns: &[Column]) -> bool {
        columns.iter().any(|c| self.has(*c))
    }

    fn check_names(&self, file: &str, names: &[&str], need: Need) -> Result<(), IoError> {
        let (normals, slopes) = (self.has_any(&[Nx, Ny, Nz]), self.has_any(&[Zx, Zy]));
        if normals && slopes {
            return Err(IoError::NormalsAndSlopes { file: file.into() });
        }
        let mut needed = vec![X, Y];
        if normals {
            needed.extend([Nx, Ny, Nz]);
        } else if slopes {
            needed.extend([Zx, Zy]);
        } else if need == Need::Contacts {
            needed.push(Z);
        }
        if let Some(missing) = needed.into_iter().find(|c| !self.has(*c)) {
            let found = names.iter().map(|n| visible(n)).collect();
            return Err(IoError::MissingColumn {
                file: file.into(),
                column: missing.name(),
                found,
                needed: need.words(),
            });
        }
        let of_nothing = |weight: Column, of| IoError::WeightOfNothing { file: file.into(), weight: weight.name(), of };
        if self.has(Wz) && !self.has(Z) {
            return Err(of_nothing(Wz, "z"));
        }
        match [Wx, Wy].into_iter().find(|w| self.has(*w) && !normals && !slopes) {
            Some(weight) => Err(of_nothing(weight, "zx,zy")),
            None => Ok(()),
        }
    }

    /// No row has a fault.
    fn is_sound(&self) -> bool {
        let column = |c: Column| self.values[c as usize].as_deref().unwrap_or_default();
        let (nx, ny, nz) = (column(Nx), column(Ny), column(Nz));
        let zero = |((x, y), z): ((&f64, &f64), &f64)| *x == 0.0 && *y == 0.0 && *z == 0.0;
        COLUMNS.into_iter().all(|c| column(c).iter().all(|v| v.is_finite()))
            && WEIGHTS.into_iter().all(|c| column(c).iter().all(|w| *w >= 0.0))
            && [Finger, Station].into_iter().all(|c| column(c).iter().all(|v| is_label(*v)))
            && !nx.iter().zip(ny).zip(nz).any(zero)
    }

    /// The first thing wrong with row `row`, if anything.
    fn fault(&self, file: &str, row: usize, options: &ReadOptions, place: &dyn Fn(usize) -> Place) -> Option<IoError> {
        let present = COLUMNS.into_iter().filter_map(|c| self.values[c as usize].as_ref().map(|v| (c, v[row])));
        let (mut normal_length, mut has_normal) = (0.0_f64, false);
        for (column, value) in present {
            let file = || file.to_string();
            let (place, name) = (|| place(row), self.title(column));
            if !value.is_finite() {
                return Some(IoError::NotFinite { file: file(), place: place(), column: name, value });
            }
            if WEIGHTS.contains(&column) && value < 0.0 {
                return Some(IoError::NegativeWeight { file: file(), place: place(), column: name, value });
            }
            if matches!(column, Finger | Station) && !is_label(value) {
                return Some(IoError::Label { file: file(), place: place(), column: name, value });
            }
            if matches!(column, Nx | Ny | Nz) {
                has_normal = true;
                normal_length = normal_length.max(value.abs());
            }
        }
        let zero = has_normal && normal_length == 0.0 && !options.keep_zero_normals;
        zero.then(|| IoError::ZeroNormal { file: file.into(), place: place(row) })
    }

    /// Checks every row and makes contacts of those that hold: the last step of every reader of contacts. `numbers` are the
    /// lines (entries, vertices) of the rows, called `unit`.
    ///
    /// # Errors
    /// The first fault of a row, unless such rows are counted out; no row that holds.
    pub(super) fn into_reading(
        mut self,
        file: &str,
        (numbers, unit): (Runs, Unit),
        options: &ReadOptions,
    ) -> Result<Reading, IoError> {
        self.unknown_normals();
        let kept = self.sound_rows(file, options, &|row| unit.place(numbers.get(row)))?;
        let left = kept.as_ref().map_or(self.len(), Vec::len);
        let skipped = self.len() - left;
        if left == 0 {
            return Err(IoError::NoRows { file: file.into(), skipped });
        }
        if let Some(kept) = &kept {
            self.keep(kept);
        }
        Ok(Reading {
            input: Input::Contacts(self.contacts(left)),
            file: file.into(),
            skipped,
            ignored: self.ignored,
            places: Some(Places::new(unit, numbers, kept.as_deref())),
            notes: Vec::new(),
            viewpoint: None,
            unit: self.unit,
        })
    }

    /// Three cells that are empty or NaN are a normal that is not known, which is written as zero.
    fn unknown_normals(&mut self) {
        let all_unknown = |row: usize| [Nx, Ny, Nz].iter().all(|c| self.get(*c).is_some_and(|v| v[row].is_nan()));
        let unknown: Vec<usize> = (0..self.len()).filter(|&row| all_unknown(row)).collect();
        for column in [Nx, Ny, Nz] {
            if let Some(values) = self.get_mut(column) {
                unknown.iter().for_each(|&row| values[row] = 0.0);
            }
        }
    }

    /// The rows without a fault, `None` where that is every row.
    fn sound_rows(
        &self,
        file: &str,
        options: &ReadOptions,
        place: &dyn Fn(usize) -> Place,
    ) -> Result<Option<Vec<usize>>, IoError> {
        let rows = self.len();
        let mut kept: Option<Vec<usize>> = None;
        // column by column first: nearly every file is sound, and a pass along memory costs next to nothing
        let suspects = if self.is_sound() { 0 } else { rows };
        for row in 0..suspects {
            match self.fault(file, row, options, place) {
                Some(fault) if !options.skip_invalid => return Err(fault),
                Some(_) => {
                    kept.get_or_insert_with(|| (0..row).collect());
                }
                None => {
                    if let Some(kept) = &mut kept {
                        kept.push(row);
                    }
                }
            }
        }
        Ok(kept)
    }

    /// Checks every row and gives x and y back.
    pub(super) fn into_points(self, file: &str, place: &dyn Fn(usize) -> Place) -> Result<Points, IoError> {
        let column = |c: Column| self.values[c as usize].clone().unwrap_or_default();
        let (x, y) = (column(X), column(Y));
        if x.is_empty() {
            return Err(IoError::NoRows { file: file.into(), skipped: 0 });
        }
        match (0..x.len()).find_map(|row| self.fault(file, row, &ReadOptions::default(), place)) {
            Some(fault) => Err(fault),
            None => Ok(Points { x, y }),
        }
    }

    fn contacts(&mut self, rows: usize) -> Contacts {
        let mut take = |column: Column| self.values[column as usize].take();
        let mut column = |c: Column| take(c).unwrap_or_default();
        let (x, y) = (column(X), column(Y));
        let orientation = match (column(Nx), column(Ny), column(Nz), column(Zx), column(Zy)) {
            (nx, ny, nz, _, _) if !nx.is_empty() => Orientation::Normals { nx, ny, nz },
            (_, _, _, zx, zy) if !zx.is_empty() => Orientation::Slopes { zx, zy },
            _ => Orientation::None,
        };
        let (z, weight_z) = match (take(Z), take(Wz)) {
            (Some(z), weight) => (z, weight),
            (None, _) => (vec![0.0; rows], Some(vec![0.0; rows])),
        };
        let labels = |values: Option<Vec<f64>>| values.map(|v| v.into_iter().map(|label| label as u32).collect());
        let finger = labels(take(Finger));
        let station = labels(take(Station));
        let weights = ContactWeights { z: weight_z, x: take(Wx), y: take(Wy) };
        Contacts { x, y, z, orientation, finger, station, weights }
    }
}

/// A finger or a station: a whole number that fits 32 bits.
fn is_label(value: f64) -> bool {
    value.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&value)
}

/// The columns of contacts as they are written: names and values, in the order of [`COLUMNS`].
pub(super) fn columns_of(contacts: &Contacts) -> Vec<(Column, std::borrow::Cow<'_, [f64]>)> {
    use std::borrow::Cow::{Borrowed, Owned};
    let labels = |values: &[u32]| Owned(values.iter().map(|&label| f64::from(label)).collect::<Vec<_>>());
    // heights that all weigh nothing were never measured: slopes only, as it was read
    let slopes_only = contacts.weights.z.as_ref().is_some_and(|w| w.iter().all(|w| *w == 0.0))
        && contacts.orientation != Orientation::None;
    let mut columns = vec![(X, Borrowed(&contacts.x[..])), (Y, Borrowed(&contacts.y))];
    if !slopes_only {
        columns.push((Z, Borrowed(&contacts.z)));
    }
    match &contacts.orientation {
        Orientation::None => {}
        Orientation::Normals { nx, ny, nz } => {
            columns.extend([(Nx, Borrowed(&nx[..])), (Ny, Borrowed(ny)), (Nz, Borrowed(nz))])
        }
        Orientation::Slopes { zx, zy } => columns.extend([(Zx, Borrowed(&zx[..])), (Zy, Borrowed(zy))]),
    }
    columns.extend(contacts.finger.as_ref().map(|v| (Finger, labels(v))));
    columns.extend(contacts.station.as_ref().map(|v| (Station, labels(v))));
    let weights = &contacts.weights;
    for (column, values) in [(Wz, &weights.z), (Wx, &weights.x), (Wy, &weights.y)] {
        if let Some(values) = values.as_ref().filter(|_| column != Wz || !slopes_only) {
            columns.push((column, Borrowed(values)));
        }
    }
    columns
}
