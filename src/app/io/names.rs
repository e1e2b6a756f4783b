//! What other programs call the columns: `X`, `Nx`, `normal_x`, `Normals:0`, `//X`, `x [mm]` all have a name of ours.
//!
//! A name counts by its letters and digits alone, in lower case, without a unit in brackets or behind it (`x_mm`); of a path
//! (`pose.position.x`) its last two parts count. A name that is written as
//! palpate writes it goes before all others, so that a table with both `x` and `X` keeps its meaning.

use std::borrow::Cow;
use std::str::FromStr;

use super::IoError;
use super::columns::{COLUMNS, Column};
use super::escape_control_chars::visible;

/// Names by letters and digits, beside [`Column::name`] itself.
const OTHERS: [(&str, &str); 39] = [
    ("px", "x"),
    ("py", "y"),
    ("pz", "z"),
    ("xpos", "x"),
    ("ypos", "y"),
    ("zpos", "z"),
    ("translationx", "x"),
    ("translationy", "y"),
    ("translationz", "z"),
    ("posx", "x"),
    ("posy", "y"),
    ("posz", "z"),
    ("positionx", "x"),
    ("positiony", "y"),
    ("positionz", "z"),
    ("pointx", "x"),
    ("pointy", "y"),
    ("pointz", "z"),
    ("pointsx", "x"),
    ("pointsy", "y"),
    ("pointsz", "z"),
    ("points0", "x"),
    ("points1", "y"),
    ("points2", "z"),
    ("normalx", "nx"),
    ("normaly", "ny"),
    ("normalz", "nz"),
    ("normalsx", "nx"),
    ("normalsy", "ny"),
    ("normalsz", "nz"),
    ("normals0", "nx"),
    ("normals1", "ny"),
    ("normals2", "nz"),
    ("normal0", "nx"),
    ("normal1", "ny"),
    ("normal2", "nz"),
    ("dzdx", "zx"),
    ("dzdy", "zy"),
    ("fingerid", "finger"),
];

/// Our name for `name`, if it is written in one of the ways above.
fn ours(name: &str) -> Option<&'static str> {
    let (bare, _) = without_unit(name);
    let parts: Vec<&str> = bare.split(['.', '/']).filter(|part| !part.is_empty()).collect();
    let last = parts.len().saturating_sub(2);
    known(bare).or_else(|| known(&parts[last..].concat()).filter(|_| last > 0))
}

/// Our name for letters and digits.
fn known(bare: &str) -> Option<&'static str> {
    let key: String = bare.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect();
    let other = OTHERS.iter().find(|(other, _)| *other == key).map(|(_, ours)| *ours);
    Column::of(&key).map(Column::name).or(other)
}

/// A name without its unit, and the unit of length that stands with it.
fn without_unit(name: &str) -> (&str, Option<&'static str>) {
    let name = name.trim_end();
    let bracket = match name.chars().next_back() {
        Some(']') => name.rfind('['),
        Some(')') => name.rfind('('),
        _ => None,
    };
    if let Some(at) = bracket {
        return (&name[..at], unit_of_length(&name[at..]));
    }
    // a name that is known as it stands has no unit: dz/dx, x_m of a column m beside x
    let behind = name.rfind(['_', ' ']).filter(|_| known(name).is_none());
    match behind.and_then(|at| Some((&name[..at], unit_of_length(&name[at + 1..])?))) {
        Some((bare, unit)) if known(bare).is_some() || bare.contains(['.', '/']) => (bare, Some(unit)),
        _ => (name, None),
    }
}

/// Units of length as they stand in headers.
const UNITS: [&str; 10] = ["nm", "um", "\u{b5}m", "mm", "cm", "dm", "m", "km", "in", "inch"];

/// The unit of length that a word is, with or without brackets.
pub(super) fn unit_of_length(word: &str) -> Option<&'static str> {
    let bare = word.trim_matches(|c: char| c.is_whitespace() || "[]()\"".contains(c)).to_lowercase();
    UNITS.into_iter().find(|unit| *unit == bare)
}

/// The unit that the names of places have, where they have one.
///
/// # Errors
/// [`IoError::Units`] where they have several.
pub(super) fn unit_in<'a>(
    file: &str,
    places: impl Iterator<Item = (&'a str, Option<&'static str>)>,
) -> Result<Option<String>, IoError> {
    let named: Vec<(&str, &str)> = places.filter_map(|(name, unit)| Some((name, unit?))).collect();
    let Some((first, unit)) = named.first() else { return Ok(None) };
    match named.iter().find(|(_, other)| other != unit) {
        None => Ok(Some((*unit).into())),
        Some((second, other)) => Err(IoError::Units {
            file: file.into(),
            columns: [visible(first), visible(second)],
            units: [unit, other].map(|unit| (*unit).to_string()),
        }),
    }
}

/// The unit of length in a name.
pub(super) fn unit_of_name(name: &str) -> Option<&'static str> {
    without_unit(name).1
}

/// Which columns of a file stand for which of ours, as `x=px,y=py,z=pz`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnNames(Vec<(&'static str, String)>);

impl FromStr for ColumnNames {
    type Err = String;

    fn from_str(text: &str) -> Result<ColumnNames, String> {
        let mut found: Vec<(&'static str, String)> = Vec::new();
        for pair in text.split(',') {
            let (ours, theirs) =
                pair.split_once('=').ok_or("names are needed as x=NAME,y=NAME,z=NAME, the file's own behind =")?;
            let (ours, theirs) = (ours.trim(), theirs.trim());
            let column = Column::of(ours).ok_or_else(|| {
                let known: Vec<&str> = COLUMNS.into_iter().map(Column::name).collect();
                format!("there is no {ours:?} to give a column to; there are {}", known.join(", "))
            })?;
            if theirs.is_empty() || found.iter().any(|(known, other)| *known == column.name() || other == theirs) {
                return Err(format!("{pair:?}: each name stands once, on either side of ="));
            }
            found.push((column.name(), theirs.into()));
        }
        Ok(ColumnNames(found))
    }
}

impl ColumnNames {
    /// Our name for a name of the file, where one is said.
    fn ours(&self, theirs: &str) -> Option<&'static str> {
        self.0.iter().find(|(_, said)| said == theirs.trim()).map(|(ours, _)| *ours)
    }

    /// Whether a column of ours is given by another name.
    fn gives(&self, ours: &str) -> bool {
        self.0.iter().any(|(said, _)| *said == ours)
    }

    /// That every name is one of the file's.
    fn check(&self, file: &str, names: &[&str]) -> Result<(), IoError> {
        let there = |said: &str| names.iter().any(|name| name.trim() == said);
        let Some((_, said)) = self.0.iter().find(|(_, said)| !there(said)) else { return Ok(()) };
        let lower = said.to_lowercase();
        let alike = names.iter().map(|name| (strsim::jaro_winkler(&lower, &name.trim().to_lowercase()), name.trim()));
        let nearest = alike.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, name)| visible(name)).unwrap_or_default();
        let found = names.iter().map(|name| visible(name.trim())).collect();
        Err(IoError::NoSuchColumn { file: file.into(), name: visible(said), nearest, found })
    }
}

/// The names with those that mean a known column written as that column.
///
/// # Errors
/// `IoError::DuplicateColumn` where two names mean one column and neither is written as ours; [`IoError::NoSuchColumn`] where
/// `said` names one that is not there.
pub(super) fn in_our_words<'a>(
    file: &str,
    names: &[&'a str],
    said: Option<&ColumnNames>,
) -> Result<Vec<Cow<'a, str>>, IoError> {
    let Some(said) = said else { return by_custom(file, names) };
    said.check(file, names)?;
    // what is said goes before all customs, and a column that another stands for is none of ours
    let others: Vec<&str> = names.iter().copied().filter(|name| said.ours(name).is_none()).collect();
    let mut customary = by_custom(file, &others)?.into_iter().zip(others);
    let each = names.iter().map(|name| match said.ours(name) {
        Some(ours) => Cow::Borrowed(ours),
        None => match customary.next() {
            Some((ours, theirs)) if said.gives(&ours) => Cow::Owned(format!("{theirs} (not used)")),
            Some((ours, _)) => ours,
            None => Cow::Borrowed(*name),
        },
    });
    Ok(each.collect())
}

fn by_custom<'a>(file: &str, names: &[&'a str]) -> Result<Vec<Cow<'a, str>>, IoError> {
    let exact: Vec<&str> = names.iter().copied().filter(|name| Column::of(name).is_some()).collect();
    let mut taken: Vec<&str> = Vec::new();
    let mut found = Vec::with_capacity(names.len());
    for &name in names {
        match ours(name).filter(|column| *column != name && !exact.contains(column)) {
            Some(column) if taken.contains(&column) => {
                return Err(IoError::DuplicateColumn {
                    file: file.into(),
                    column: format!("{column} ({})", visible(name)),
                });
            }
            Some(column) => {
                taken.push(column);
                found.push(Cow::Borrowed(column));
            }
            None => found.push(Cow::Borrowed(name)),
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_other_programs_are_known() {
        let cases = [
            ("X,Y,Z,Nx,Ny,Nz", "x,y,z,nx,ny,nz"),
            ("//X,Y,Z", "x,y,z"),
            ("Points:0,Points:1,Points:2,Normals_0,Normals_1,Normals_2", "x,y,z,nx,ny,nz"),
            ("x [mm],y (mm),Z,normal_x,NormalY,normal.z", "x,y,z,nx,ny,nz"),
            ("x,y,X,temperature,dz/dx,zy", "x,y,X,temperature,zx,zy"),
            ("px,py,pz,nx", "x,y,z,nx"),
            ("x_mm,y_mm,z_mm,normal_x", "x,y,z,nx"),
            ("/tip/pose.position.x,pose.position.y,pose/position/z,pose.orientation.x", "x,y,z,pose.orientation.x"),
            ("pos_x_m,pos_y_m,z m,mass_m", "x,y,z,mass_m"),
            ("x,px,y,py", "x,px,y,py"),
        ];
        for (theirs, expected) in cases {
            let names: Vec<&str> = theirs.split(',').collect();
            assert_eq!(in_our_words("f", &names, None).unwrap().join(","), expected);
        }
        assert!(in_our_words("f", &["X", "Points:0"], None).unwrap_err().to_string().contains("stands twice"));
    }

    #[test]
    fn units_stand_in_brackets_or_behind() {
        let units = ["x [mm]", "x (MM)", "x_mm", "pose.position.x_m", "x", "mass_m", "x [px]"].map(unit_of_name);
        assert_eq!(units, [Some("mm"), Some("mm"), Some("mm"), Some("m"), None, None, None]);
        let pairs = |names: [&'static str; 2]| unit_in("f", names.into_iter().map(|name| (name, unit_of_name(name))));
        assert_eq!(pairs(["x_mm", "y"]).unwrap(), Some("mm".into()));
        let message = pairs(["x_mm", "y [m]"]).unwrap_err().to_string();
        assert!(message.contains("x_mm is in mm") && message.contains("y [m] in m"), "{message}");
    }

    #[test]
    fn what_is_said_goes_before_customs() {
        let said: ColumnNames = "x=a,z=x".parse().unwrap();
        let words = in_our_words("f", &["a", "y", "x", "X"], Some(&said)).unwrap();
        assert_eq!(words.join(","), "x,y,z,X (not used)");
        let message = in_our_words("f", &["aa", "y", "x"], Some(&said)).unwrap_err().to_string();
        assert!(message.contains("no column a;") && message.contains("nearest is aa"), "{message}");
        for wrong in ["x", "q=a", "x=a,x=b", "x=a,y=a", "x="] {
            assert!(wrong.parse::<ColumnNames>().is_err(), "{wrong}");
        }
    }
}
