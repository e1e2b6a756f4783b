//! Files as newcomers write them: normals that are not known, fingers with names, a spreadsheet's first line, two touches.

use std::path::Path;

use assert_cmd::Command;

fn output(directory: &Path, line: &str) -> (String, String, Option<i32>) {
    let mut command = Command::cargo_bin("palpate").unwrap();
    let output = command.current_dir(directory).args(line.split_whitespace()).output().unwrap();
    // lines that were folded are one again
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap().replace("\n           ", " ");
    (text(output.stdout), text(output.stderr), output.status.code())
}

fn told(directory: &Path, line: &str) -> String {
    let (out, err, code) = output(directory, line);
    assert_eq!((err.as_str(), code), ("", Some(0)), "{line}");
    out
}

fn refused(directory: &Path, line: &str) -> String {
    let (_, err, code) = output(directory, line);
    assert_eq!(code, Some(2), "{line}: {err}");
    err
}

/// Places and normals of a ball of radius 20, touched at 36 places.
fn ball() -> Vec<[f64; 6]> {
    let place = |k: usize| [(k % 6) as f64 * 2.0 - 5.0, (k / 6) as f64 * 2.0 - 5.0];
    let touched = |[x, y]: [f64; 2]| {
        let z = (400.0 - x * x - y * y).sqrt();
        [x, y, z - 20.0, x / 20.0, y / 20.0, z / 20.0]
    };
    (0..36).map(place).map(touched).collect()
}

fn row(values: &[f64], separator: &str) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(separator)
}

/// The ball in a file, every second normal in place of which `unknown` stands.
fn half(path: &Path, unknown: &str) {
    let rows = ball().into_iter().enumerate().map(|(k, contact)| match k % 2 {
        0 => format!("{},{unknown}\n", row(&contact[..3], ",")),
        _ => format!("{}\n", row(&contact, ",")),
    });
    std::fs::write(path, format!("x,y,z,nx,ny,nz\n{}", rows.collect::<String>())).unwrap();
}

/// A contact whose normal is not known still tells where the surface is.
#[test]
fn normals_that_are_not_known_may_be_left_empty() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    for unknown in [",,", "nan,nan,nan", "0,0,0"] {
        half(&here.join("half.csv"), unknown);
        let words = told(here, "fit half.csv");
        assert!(words.contains("36 touched points") && words.contains("cap: like"), "{unknown}: {words}");
        assert!(words.contains("18 normals of length 0 or empty: not known"), "{unknown}: {words}");
        // a model that is named needs all of them, or none
        let named = refused(here, "fit half.csv --degree 2");
        assert!(named.contains("line 2: the normal (nx,ny,nz) is zero or empty"), "{unknown}: {named}");
        assert!(named.contains("names no model") && named.contains("--skip-invalid"), "{unknown}: {named}");
        assert!(told(here, "fit half.csv --degree 2 --ignore-normals").contains("36 touched points"));
        assert!(told(here, "fit half.csv --degree 2 --skip-invalid").contains("18 touched points"));
    }
    // part of a normal is none
    half(&here.join("half.csv"), "0.1,,0.9");
    let part = refused(here, "fit half.csv");
    assert!(part.contains("column ny") && part.contains("leave all three of nx,ny,nz empty, or write 0,0,0"), "{part}");
}

#[test]
fn fingers_may_have_names() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let names = |name: &dyn Fn(usize) -> String| -> String {
        ball().iter().enumerate().map(|(k, contact)| format!("{},{}\n", row(contact, ","), name(k / 6))).collect()
    };
    let write =
        |rows: String| std::fs::write(here.join("named.csv"), format!("x,y,z,nx,ny,nz,finger\n{rows}")).unwrap();
    write(names(&|k| ["f1", "f2", "index", "thumb", "f5", "f6"][k].into()));
    let words = told(here, "fit named.csv --degree 2");
    assert!(words.contains("numbered as they appear: f1 = 0, f2 = 1, index = 2"), "{words}");
    write(names(&|k| if k < 3 { k.to_string() } else { "index".into() }));
    let mixed = refused(here, "fit named.csv");
    assert!(mixed.contains("column finger") && mixed.contains("without the column, or under another name"), "{mixed}");
}

/// `sep=;` is how a spreadsheet is told the separator.
#[test]
fn a_spreadsheets_first_line_is_understood() {
    let directory = tempfile::tempdir().unwrap();
    let rows: String = ball().iter().map(|contact| row(contact, ";").replace('.', ",") + "\r\n").collect();
    std::fs::write(directory.path().join("excel.csv"), format!("sep=;\r\nx;y;z;nx;ny;nz\r\n{rows}")).unwrap();
    let words = told(directory.path(), "fit excel.csv");
    assert!(words.contains("36 touched points") && words.contains("cap: like"), "{words}");
}

/// One touch, or two, are too few in the same words as three.
#[test]
fn one_touch_is_told_what_is_missing() {
    let directory = tempfile::tempdir().unwrap();
    for count in [1, 2] {
        for (columns, names) in [(3, "x,y,z"), (6, "x,y,z,nx,ny,nz")] {
            let rows: String = ball().iter().take(count).map(|c| row(&c[..columns], ",") + "\n").collect();
            std::fs::write(directory.path().join("few.csv"), format!("{names}\n{rows}")).unwrap();
            let few = refused(directory.path(), "fit few.csv");
            assert!(few.contains("cannot tell a shape") && few.contains("touch a dozen places"), "{few}");
            assert!(!few.contains("certificate") && !few.contains("rank"), "{few}");
        }
    }
}

/// A viewpoint behind the surface turns all normals, and the note says why.
#[test]
fn normals_turned_by_a_viewpoint_are_said_so() {
    let directory = tempfile::tempdir().unwrap();
    let rows: String = ball().iter().map(|contact| row(contact, ",") + "\n").collect();
    std::fs::write(directory.path().join("ball.csv"), format!("x,y,z,nx,ny,nz\n{rows}")).unwrap();
    let words = told(directory.path(), "fit ball.csv --viewpoint 0,0,-100");
    assert!(words.contains("36 normals pointed away from the viewpoint: all reversed"), "{words}");
    assert!(words.contains("cup: like") && !words.contains("neighbours: reversed"), "{words}");
}
