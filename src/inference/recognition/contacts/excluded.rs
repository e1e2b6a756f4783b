//! What the normals were used for, and how many contacts and normals were set aside or changed.

/// What the normals were used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum NormalsUse {
    /// They are measurements of their own, and used as data.
    Believed,
    /// They were computed from the positions, and only tell the free side.
    DerivedFromPositions,
    /// Too many of them contradict the surface; only positions are used.
    Contradicting,
    /// There are none.
    Absent,
    /// The caller asked not to use them.
    Ignored,
}

impl NormalsUse {
    /// The words used in every output.
    pub fn name(self) -> &'static str {
        match self {
            NormalsUse::Believed => "used",
            NormalsUse::DerivedFromPositions => "derived from the positions, not used",
            NormalsUse::Contradicting => "contradicting the positions, not used",
            NormalsUse::Absent => "absent",
            NormalsUse::Ignored => "ignored",
        }
    }
}

/// Contacts and normals that were set aside or changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Dropped {
    /// Contacts too far off the surface to belong to it.
    pub(crate) outliers: usize,
    /// Missing pixels of a grid.
    pub(crate) missing: usize,
    /// Normals of length zero.
    pub(crate) normals_of_length_zero: usize,
    /// Normals more than 60 degrees off the surface's.
    pub(crate) normals_against: usize,
    /// Normals that were reversed to agree with their neighbours.
    pub(crate) normals_flipped: usize,
}
