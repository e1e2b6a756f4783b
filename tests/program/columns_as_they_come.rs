//! Tables with the names, units and rows that other programs write: what is read, and what is said where it is not.

use std::path::Path;

use serde_json::Value;

use super::command_line::{output, told};

/// A folder with the contacts of the built-in bar, and what writes them under another header.
fn bench() -> (tempfile::TempDir, String) {
    let directory = tempfile::tempdir().unwrap();
    told(directory.path(), "simulate bar -o bar.csv");
    let bar = std::fs::read_to_string(directory.path().join("bar.csv")).unwrap();
    (directory, bar)
}

fn with_header(directory: &Path, bar: &str, header: &str) -> Value {
    let (_, rows) = bar.split_once('\n').unwrap();
    std::fs::write(directory.join("t.csv"), format!("{header}\n{rows}")).unwrap();
    serde_json::from_str(&told(directory, "fit t.csv --json")).unwrap()
}

#[test]
fn headers_of_other_programs_give_the_same_answer() {
    let (directory, bar) = bench();
    let here = directory.path();
    let plain = with_header(here, &bar, "x,y,z,nx,ny,nz,finger,station");
    assert!(plain.get("unit").is_none());
    for (header, unit) in [
        ("px,py,pz,normal_x,normal_y,normal_z,finger,station", None),
        ("x_mm,y_mm,z_mm,nx,ny,nz,finger,station", Some("mm")),
        ("pose.position.x,pose.position.y,pose.position.z,normal.x,normal.y,normal.z,finger,station", None),
        ("x [m],y [m],z [m],nx [-],ny [-],nz [-],finger,station", Some("m")),
        ("x,y,z,nx,ny,nz,finger,station\nmm,mm,mm,-,-,-,,", Some("mm")),
        ("x,y,z,nx,ny,nz,finger,station\n60", None),
        ("x,y,z,nx,ny,nz,finger,station\nmm,mm,mm,,,,,\n60", Some("mm")),
    ] {
        let found = with_header(here, &bar, header);
        assert_eq!(found["shape"], plain["shape"], "{header}");
        assert_eq!(found.get("unit").and_then(Value::as_str), unit, "{header}");
    }
    assert!(told(here, "fit t.csv").contains("per mm; 0.707/radius"));
    assert!(told(here, "fit t.csv --unit inch").contains("per inch"));
}

#[test]
fn columns_are_what_they_are_said_to_be() {
    let (directory, bar) = bench();
    let here = directory.path();
    let (_, rows) = bar.split_once('\n').unwrap();
    let header = "tipX,tipY,tipZ,n1,n2,n3,finger,station";
    std::fs::write(here.join("t.csv"), format!("{header}\n{rows}")).unwrap();
    let said = "--columns x=tipX,y=tipY,z=tipZ,nx=n1,ny=n2,nz=n3";
    let [found, plain] = [format!("fit t.csv {said} --json"), "fit bar.csv --json".into()]
        .map(|line| serde_json::from_str::<Value>(&told(here, &line)).unwrap());
    assert_eq!(found["shape"], plain["shape"]);
    assert!(told(here, &format!("parts t.csv {said}")).contains("cylinder"));
    for (line, words) in [
        ("fit t.csv", &["no column x", "tipX,tipY", "--columns x=NAME"][..]),
        ("parts t.csv", &["no column x", "--columns x=NAME"]),
        ("fit t.csv --columns x=tipx,y=tipY,z=tipZ", &["no column tipx", "nearest is tipX"]),
        ("parts t.csv --columns x=tipX,y=tipY,z=tap", &["no column tap", "there are tipX,tipY,tipZ"]),
        ("fit t.csv --columns q=tipX", &["--columns", "there is no \"q\""]),
        ("parts parts-box --columns x=a", &["a scene has no columns"]),
    ] {
        let (_, err, code) = output(here, line);
        assert!(code == Some(2) && words.iter().all(|word| err.contains(word)), "{line}: {err}");
    }
}

/// Whoever has to find a number looks for the name that stands in the file.
#[test]
fn messages_speak_of_the_names_of_the_file() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let rows = "0,0,0,0,0,1\n1,0,0,0,0,1\n0,1,nan,0,0,1\n1,1,zero,0,0,1\n";
    let header = "pos_x_mm,pos_y_mm,pos_z_mm,normal_x,normal_y,normal_z";
    for (text, words) in [
        (format!("{header}\n{rows}"), "column pos_z_mm"),
        (format!("{header}\n{}", rows.replace("nan", "0")), "column pos_z_mm: \"zero\" is not a number"),
        (format!("{header}\n0,0,0,,0,1\n"), "column normal_x: \"\" is not a number; where a normal is not known"),
        (format!("x,y,z\nmm,mm,m\n{rows}"), "x is in mm and z in m; places need one unit"),
        (format!("x_mm,y,z_m\n{rows}"), "x_mm is in mm and z_m in m"),
    ] {
        std::fs::write(here.join("t.csv"), text).unwrap();
        let (_, err, code) = output(here, "fit t.csv");
        assert!(code == Some(2) && err.contains(words), "{words}: {err}");
    }
}
