//! What other programs call the columns: `X`, `Nx`, `normal_x`, `Normals:0`, `//X`, `x [mm]` all have a name of ours.
//!
//! A name counts by its letters and digits alone, in lower case, without a unit in brackets. A name that is written as
//! palpate writes it goes before all others, so that a table with both `x` and `X` keeps its meaning.

use std::borrow::Cow;

use super::IoError;
use super::columns::Column;
use super::escape_control_chars::visible;

/// Names by letters and digits, beside [`Column::name`] itself.
const OTHERS: [(&str, &str); 30] = [
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
    let bare = match name.trim_end().chars().next_back() {
        Some(']') => name.rfind('[').map_or(name, |at| &name[..at]),
        Some(')') => name.rfind('(').map_or(name, |at| &name[..at]),
        _ => name,
    };
    let key: String = bare.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect();
    let other = OTHERS.iter().find(|(other, _)| *other == key).map(|(_, ours)| *ours);
    Column::of(&key).map(Column::name).or(other)
}

/// The names with those that mean a known column written as that column.
///
/// # Errors
/// [`IoError::DuplicateColumn`] where two names mean one column and neither is written as ours.
pub(super) fn in_our_words<'a>(file: &str, names: &[&'a str]) -> Result<Vec<Cow<'a, str>>, IoError> {
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
        ];
        for (theirs, expected) in cases {
            let names: Vec<&str> = theirs.split(',').collect();
            assert_eq!(in_our_words("f", &names).unwrap().join(","), expected);
        }
        assert!(in_our_words("f", &["X", "Points:0"]).unwrap_err().to_string().contains("stands twice"));
    }
}
