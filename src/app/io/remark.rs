//! A remark that goes into a file of contacts, in the forms that the formats have room for.

/// For a comment: without line ends, which would end it.
pub(super) fn one_line(remark: &str) -> String {
    remark.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// For an array's name: the words before the first colon, joined by underscores.
pub(super) fn array_name(remark: &str) -> String {
    let words: Vec<&str> = remark.split(':').next().unwrap_or(remark).split_whitespace().collect();
    words.join("_")
}
