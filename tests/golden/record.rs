//! Tables kept in `benches/runs`: how they are written, read, and held against what is computed now.

use std::path::PathBuf;

fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("benches/runs").join(format!("{name}.md"))
}

/// Writes a table between its heading and the command that prints it.
pub(crate) fn write(name: &str, title: &str, table: &str) {
    let text = format!("# {title}\n\n`cargo bench --bench hard_cases -- --record`\n\n```text\n{table}\n```\n");
    std::fs::write(path(name), text).unwrap();
}

/// The recorded table.
pub(crate) fn read(name: &str) -> String {
    let text = std::fs::read_to_string(path(name)).unwrap();
    let (_, rest) = text.split_once("```text\n").unwrap();
    rest.split_once("\n```").unwrap().0.to_string()
}

/// How far a number may be from the recorded one: `relative` of it or `absolute`, whichever is more.
pub(crate) struct Tolerance {
    pub relative: f64,
    pub absolute: f64,
}

/// The same words in the same order, and numbers within the tolerance. Another instruction set rounds otherwise.
pub(crate) fn assert_like(found: &str, recorded: &str, tolerance: &Tolerance) {
    let (a, b): (Vec<&str>, Vec<&str>) = (found.split_whitespace().collect(), recorded.split_whitespace().collect());
    assert_eq!(a.len(), b.len(), "\nfound    {found}\nrecorded {recorded}");
    for (one, other) in a.iter().zip(&b) {
        let like = match (one.parse::<f64>(), other.parse::<f64>()) {
            (Ok(x), Ok(y)) => (x - y).abs() <= (tolerance.relative * y.abs()).max(tolerance.absolute),
            _ => one == other,
        };
        assert!(like, "{one} is not {other}\nfound    {found}\nrecorded {recorded}");
    }
}
