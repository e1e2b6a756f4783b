//! Where in a file a contact came from, so that a message about contact 17 can name a line.

/// A row of a file, in the file's own words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Line of a text file, counted from 1.
    Line(usize),
    /// Entry of the arrays, counted from 0 as NumPy does.
    Entry(usize),
    /// Vertex of a mesh or a binary PLY, counted from 0.
    Vertex(usize),
    /// Triangle of a coarse mesh that was sampled, counted from 0 without those that have no area.
    Facet(usize),
    /// Point of a binary PCD, counted from 0.
    Point(usize),
    /// Pixel of an image, counted from 0 along its rows.
    Pixel(usize),
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Place::Line(n) => write!(f, "line {n}"),
            Place::Entry(n) => write!(f, "entry {n}"),
            Place::Vertex(n) => write!(f, "vertex {n}"),
            Place::Facet(n) => write!(f, "facet {n}"),
            Place::Point(n) => write!(f, "point {n}"),
            Place::Pixel(n) => write!(f, "pixel {n}"),
        }
    }
}

/// An increasing sequence held as runs of consecutive numbers: the lines of rows are nearly always one run.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Runs {
    /// (index, number) where each run begins.
    starts: Vec<(usize, usize)>,
    len: usize,
}

impl Runs {
    pub(super) fn push(&mut self, number: usize) {
        let follows = self.starts.last().is_some_and(|&(index, start)| start + (self.len - index) == number);
        if !follows {
            self.starts.push((self.len, number));
        }
        self.len += 1;
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Number at `index`; past the end, as if the last run went on.
    pub(super) fn get(&self, index: usize) -> usize {
        match self.starts.partition_point(|&(start, _)| start <= index) {
            0 => index,
            run => {
                let (start, number) = self.starts[run - 1];
                number + (index - start)
            }
        }
    }
}

impl FromIterator<usize> for Runs {
    fn from_iter<I: IntoIterator<Item = usize>>(numbers: I) -> Runs {
        let mut runs = Runs::default();
        numbers.into_iter().for_each(|n| runs.push(n));
        runs
    }
}

/// The place of every contact.
#[derive(Clone, Debug, PartialEq)]
pub struct Places {
    rows: Runs,
    numbers: Runs,
    unit: Unit,
}

/// What the rows of a format are called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    Line,
    Entry,
    Vertex,
    Facet,
    Point,
    Pixel,
}

impl Unit {
    pub(super) fn place(self, number: usize) -> Place {
        match self {
            Unit::Line => Place::Line(number),
            Unit::Entry => Place::Entry(number),
            Unit::Vertex => Place::Vertex(number),
            Unit::Facet => Place::Facet(number),
            Unit::Point => Place::Point(number),
            Unit::Pixel => Place::Pixel(number),
        }
    }
}

impl Places {
    /// `numbers[row]` is the line (entry, vertex) of each row that was read; `kept[contact]` the row of each contact.
    pub(super) fn new(unit: Unit, numbers: Runs, kept: Option<&[usize]>) -> Places {
        Places { rows: kept.into_iter().flatten().copied().collect(), numbers, unit }
    }

    /// Where contact `index` (from 0) stands.
    pub fn of(&self, index: usize) -> Place {
        self.unit.place(self.numbers.get(self.rows.get(index)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_give_back_what_was_pushed() {
        let numbers = [2, 3, 4, 7, 8, 20, 22, 23];
        let runs: Runs = numbers.into_iter().collect();
        assert_eq!(runs.starts.len(), 4);
        for (index, number) in numbers.into_iter().enumerate() {
            assert_eq!(runs.get(index), number);
        }
    }

    #[test]
    fn contacts_find_their_lines_through_rows_left_out() {
        let lines: Runs = [3, 4, 6, 7].into_iter().collect();
        let all = Places::new(Unit::Line, lines.clone(), None);
        assert_eq!(all.of(2), Place::Line(6));
        let some = Places::new(Unit::Line, lines, Some(&[0, 2, 3]));
        assert_eq!([some.of(0), some.of(1), some.of(2)], [Place::Line(3), Place::Line(6), Place::Line(7)]);
    }
}
