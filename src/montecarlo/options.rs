//! Options of a study: the `[study]` section of a scene file.

/// Number of replicates of a study and confidence level of its intervals.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct StudyOptions {
    /// Replicates. Default 10,000.
    pub replicates: u64,
    /// Confidence level of the intervals, in (0, 1). Default 0.95.
    pub level: f64,
}

impl Default for StudyOptions {
    fn default() -> StudyOptions {
        StudyOptions { replicates: 10_000, level: 0.95 }
    }
}
