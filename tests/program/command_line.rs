//! A line as it is typed in a directory, and what the program says.

use std::path::Path;

use assert_cmd::Command;

/// Standard output, standard error and exit code.
pub(crate) fn output(directory: &Path, line: &str) -> (String, String, Option<i32>) {
    let mut command = Command::cargo_bin("palpate").unwrap();
    let output = command.current_dir(directory).args(line.split_whitespace()).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (text(output.stdout), text(output.stderr), output.status.code())
}

/// Standard output of a line that succeeds and has nothing to say beside it.
pub(crate) fn told(directory: &Path, line: &str) -> String {
    let (out, err, code) = output(directory, line);
    assert_eq!((err.as_str(), code), ("", Some(0)), "{line}");
    out
}
