//! Files as other programs write them: names, separators, point clouds, meshes, depth images, gzip. Every writer is here.

use std::io::{Cursor, Write};

use ndarray::{Array1, Array2, ShapeBuilder};
use palpate::{Contacts, Orientation};
use palpate_app::io::{Input, ReadOptions, Reading, read_input_bytes};

use super::npz::NpzWriter;

fn read(file: &str, bytes: &[u8]) -> Result<Reading, String> {
    read_input_bytes(file, bytes, &ReadOptions::default()).map_err(|e| e.to_string())
}

fn with_camera(file: &str, bytes: &[u8], camera: &str) -> Result<Reading, String> {
    let options = ReadOptions { intrinsics: Some(camera.parse().unwrap()), ..ReadOptions::default() };
    read_input_bytes(file, bytes, &options).map_err(|e| e.to_string())
}

fn contacts(reading: Reading) -> Contacts {
    match reading.input {
        Input::Contacts(contacts) => contacts,
        Input::Grid(_) => panic!("a grid"),
    }
}

/// Three contacts with normals; every number is exact in single precision and in six decimals.
const ROWS: [[f32; 6]; 3] =
    [[1.0, 2.0, 3.5, 0.0, 0.0, 1.0], [-4.25, 5.0, 6.0, 0.0, 1.0, 0.0], [7.0, -8.0, 9.125, 1.0, 0.0, 0.0]];

fn expected() -> Contacts {
    let column = |k: usize| ROWS.iter().map(|row| f64::from(row[k])).collect::<Vec<f64>>();
    Contacts::from_positions(column(0), column(1), column(2)).with_normals(column(3), column(4), column(5))
}

fn rows(separator: &str, fields: usize) -> String {
    let row = |row: &[f32; 6]| row[..fields].iter().map(f32::to_string).collect::<Vec<_>>().join(separator) + "\n";
    ROWS.iter().map(row).collect()
}

fn gzip(content: &[u8]) -> Vec<u8> {
    let mut out = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    out.write_all(content).unwrap();
    out.finish().unwrap()
}

/// A PCD of all rows; `data` is what follows its header.
fn pcd(kind: &str, points: usize, data: &[u8]) -> Vec<u8> {
    let header = format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z _ normal_x normal_y normal_z\n\
         SIZE 4 4 4 1 4 4 4\nTYPE F F F U F F F\nCOUNT 1 1 1 3 1 1 1\nWIDTH {points}\nHEIGHT 1\n\
         VIEWPOINT 0 0 -2.5 1 0 0 0\nPOINTS {points}\nDATA {kind}\n"
    );
    [header.as_bytes(), data].concat()
}

fn pcd_binary() -> Vec<u8> {
    let row = |row: &[f32; 6]| {
        let numbers = |k: std::ops::Range<usize>| row[k].iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
        [numbers(0..3), vec![9; 3], numbers(3..6)].concat()
    };
    pcd("binary", 3, &ROWS.iter().flat_map(row).collect::<Vec<u8>>())
}

/// LZF of runs of equal bytes and literals.
fn lzf(content: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    let mut at = 0;
    while at < content.len() {
        let run = content[at..].iter().take(200).take_while(|b| at > 0 && **b == content[at - 1]).count();
        if run >= 9 {
            out.extend([7 << 5, (run - 9) as u8, 0]);
            at += run;
        } else if run >= 3 {
            out.extend([((run - 2) as u8) << 5, 0]);
            at += run;
        } else {
            out.extend([0, content[at]]);
            at += 1;
        }
    }
    out
}

fn pcd_compressed() -> Vec<u8> {
    let column = |k: usize| ROWS.iter().flat_map(|row| row[k].to_le_bytes()).collect::<Vec<u8>>();
    let content = [column(0), column(1), column(2), vec![9; 9], column(3), column(4), column(5)].concat();
    let packed = lzf(&content);
    let sizes = [packed.len() as u32, content.len() as u32].map(u32::to_le_bytes).concat();
    pcd("binary_compressed", 3, &[sizes, packed].concat())
}

fn npy(descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let text = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': ({shape}), }}\n");
    [b"\x93NUMPY\x01\x00", &(text.len() as u16).to_le_bytes()[..], text.as_bytes(), data].concat()
}

fn every_format() -> Vec<(&'static str, Vec<u8>)> {
    let ascii: String =
        ROWS.iter().map(|r| format!("{} {} {} 9 9 9 {} {} {}\n", r[0], r[1], r[2], r[3], r[4], r[5])).collect();
    let decimal_comma = format!("X;Y;Z;Normal_X;Normal_Y;Normal_Z\r\n{}", rows(";", 6).replace('.', ","));
    let paraview: String =
        ROWS.iter().map(|r| format!("{},{},{},{},{},{}\n", r[3], r[4], r[5], r[0], r[1], r[2])).collect();
    let names = ["Normals:0", "Normals:1", "Normals:2", "Points:0", "Points:1", "Points:2"].map(|n| format!("{n:?}"));
    let obj = |kind: &str, k: usize| {
        ROWS.iter().map(|r| format!("{kind} {} {} {}\n", r[k], r[k + 1], r[k + 2])).collect::<String>()
    };
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float X\nproperty float Y\nproperty float Z\n\
               property float normal_x\nproperty float normal_y\nproperty float normal_z\nend_header\n";
    let numbers = |order: Vec<f32>| order.into_iter().flat_map(f32::to_le_bytes).collect::<Vec<u8>>();
    let by_column = (0..6).flat_map(|k| ROWS.map(|row| row[k])).collect();
    vec![
        ("capitals.csv", format!("X,Y,Z,Nx,Ny,Nz\n{}", rows(",", 6)).into()),
        ("tabs.tsv", format!("x\ty\tz\tnx\tny\tnz\n{}", rows("\t", 6)).into()),
        ("decimal.csv", decimal_comma.into()),
        ("cloudcompare.txt", format!("//X Y Z Nx Ny Nz\n{}", rows(" ", 6)).into()),
        ("commented.csv", format!("# made elsewhere\n# x y z nx ny nz\n{}", rows(";", 6)).into()),
        ("paraview.csv", format!("{}\n{paraview}", names.join(",")).into()),
        ("bare.xyz", rows(" ", 6).into()),
        ("bare.xyzn", rows("  ", 6).into()),
        ("aliases.ply", format!("{ply}{}", rows(" ", 6)).into()),
        ("ascii.pcd", pcd("ascii", 3, ascii.as_bytes())),
        ("binary.pcd", pcd_binary()),
        ("compressed.pcd", pcd_compressed()),
        ("normals.off", format!("NOFF\n3 0 0\n{}", rows(" ", 6)).into()),
        ("model.obj", format!("{}{}f 1//1 2//2 3//3\n", obj("v", 0), obj("vn", 3)).into()),
        ("rows.npy", npy("<f4", "False", "3, 6", &numbers(ROWS.concat()))),
        ("columns.npy", npy("<f4", "True", "3, 6", &numbers(by_column))),
    ]
}

#[test]
fn every_format_gives_the_same_contacts_packed_or_not() {
    for (file, bytes) in every_format() {
        let reading = read(file, &bytes).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(reading.notes.iter().any(|n| n.contains("no header")), file.starts_with("bare"), "{file}");
        assert_eq!(reading.viewpoint, file.ends_with("pcd").then_some([0.0, 0.0, -2.5]), "{file}");
        assert_eq!(contacts(reading), expected(), "{file}");
        assert_eq!(contacts(read(&format!("{file}.gz"), &gzip(&bytes)).unwrap()), expected(), "{file}.gz");
    }
}

/// What has a header is known from a pipe, which has no name.
#[test]
fn a_pipe_works_like_a_file() {
    for (file, bytes) in every_format().into_iter().filter(|(file, _)| !file.starts_with("bare")) {
        assert_eq!(contacts(read("standard input", &bytes).unwrap()), expected(), "{file}");
    }
    assert!(read("standard input", rows(" ", 6).as_bytes()).unwrap_err().contains("not a header"));
}

#[test]
fn cut_and_changed_bytes_never_panic() {
    for (file, bytes) in every_format() {
        for at in 0..bytes.len() {
            let _ = read(file, &bytes[..at]);
            for byte in [0, b'-', b'9', b'\n', 0xff] {
                let mut changed = bytes.clone();
                changed[at] = byte;
                let _ = read(file, &changed);
            }
        }
    }
}

#[test]
fn clouds_without_normals_and_with_counts() {
    let pts = format!("3\n{}", rows(" ", 3));
    let c = contacts(read("scan.pts", pts.as_bytes()).unwrap());
    assert_eq!((c.len(), c.orientation, c.z), (3, Orientation::None, expected().z));
    let coloured = "2\n1 2 3 -700 10 20 30\n4 5 6 -701 10 20 30\n";
    assert_eq!(read("scan.pts", coloured.as_bytes()).unwrap().ignored, ["intensity", "red", "green", "blue"]);
    // pixels of a depth camera that saw nothing
    let nan = [f32::NAN; 3].map(f32::to_le_bytes).concat();
    let mut bytes = pcd_binary();
    let start = bytes.len() - 3 * 27;
    bytes[start + 27..start + 39].copy_from_slice(&nan);
    let reading = read("a.pcd", &bytes).unwrap();
    assert!(reading.notes[0].contains("1 points without a measurement"), "{:?}", reading.notes);
    assert_eq!(contacts(reading).x, [1.0, 7.0]);
}

#[test]
fn depth_images_of_every_kind_are_one() {
    let depth = Array2::from_shape_fn((3, 4), |(v, u)| if (v, u) == (1, 2) { 0.0 } else { (100 + 10 * v + u) as f64 });
    let camera = "50,60,1.5,1";
    type Fill<'a> = &'a dyn Fn(&mut NpzWriter<Cursor<Vec<u8>>>);
    let npz = |fill: Fill| {
        let mut writer = NpzWriter::new(Cursor::new(Vec::new()));
        fill(&mut writer);
        writer.finish().unwrap().into_inner()
    };
    let bare = npz(&|w| w.add_array("depth", &depth).unwrap());
    let by_names = npz(&|w| {
        w.add_array("depth", &depth).unwrap();
        for (name, value) in [("fx", 50.0), ("fy", 60.0), ("cx", 1.5), ("cy", 1.0)] {
            w.add_array(name, &Array1::from(vec![value])).unwrap();
        }
    });
    let by_matrix = npz(&|w| {
        let mut turned = Array2::zeros((3, 4).f());
        turned.assign(&depth);
        w.add_array("depth", &turned).unwrap();
        let k = [50.0, 0.0, 1.5, 0.0, 60.0, 1.0, 0.0, 0.0, 1.0];
        w.add_array("K", &Array2::from_shape_vec((3, 3), k.to_vec()).unwrap()).unwrap();
    });
    let bytes: Vec<u8> = depth.iter().flat_map(|v| v.to_le_bytes()).collect();
    let found = [
        with_camera("d.npz", &bare, camera),
        read("d.npz", &by_names),
        read("d.npz", &by_matrix),
        with_camera("d.npy", &npy("<f8", "False", "3, 4", &bytes), camera),
    ]
    .map(|reading| reading.unwrap());
    assert_eq!(found[0].viewpoint, Some([0.0; 3]));
    let found = found.map(contacts);
    found.windows(2).for_each(|pair| assert_eq!(pair[0], pair[1]));
    assert_eq!((found[0].len(), found[0].z[0], found[0].x[0]), (11, 100.0, -1.5 * 100.0 / 50.0));
    assert!(read("d.npz", &bare).unwrap_err().contains("intrinsics"));
    assert!(read("d.npy", &npy("<f8", "False", "3, 4", &bytes)).unwrap_err().contains("[3, 4]"));
}

#[test]
fn what_is_not_understood_is_told_what_it_looks_like() {
    let workbook = {
        let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
        archive.start_file("xl/workbook.xml", zip::write::SimpleFileOptions::default()).unwrap();
        archive.finish().unwrap().into_inner()
    };
    let no_x = String::from_utf8_lossy(&pcd("ascii", 0, b"")).replace("FIELDS x", "FIELDS q");
    let counted = |x: usize| String::from_utf8_lossy(&pcd("ascii", 0, b"")).replace("COUNT 1", &format!("COUNT {x}"));
    let (without, twice) = (counted(0), counted(2));
    let cut = pcd_binary();
    let cases: [(&str, &[u8], &[&str]); 15] = [
        ("a.csv", b"\xff\xd8\xff\xe0", &["a JPEG image", "CSV", "PCD"]),
        ("a.csv", b"<!doctype html>", &["HTML"]),
        ("a.csv", b"{\"x\": [1]}", &["JSON"]),
        ("a.xlsx", &workbook, &["an Excel workbook"]),
        ("a.pcd", no_x.as_bytes(), &["no column x", "q,y,z"]),
        ("a.pcd", without.as_bytes(), &["the COUNT of x is 0; it must be 1"]),
        ("a.pcd", twice.as_bytes(), &["the COUNT of x is 2; it must be 1"]),
        ("a.pcd", &cut[..cut.len() - 1], &["3 points of 27 bytes", "cut short"]),
        ("a.pcd", b"x,y,z\n", &["PCD", "DATA"]),
        ("a.stl", b"x,y,z\n", &["STL", "solid"]),
        ("a.png", b"x,y,z\n1,2,3\n", &["PNG"]),
        ("a.npy", b"\x93NUMPY", &["NPY", "header is broken"]),
        ("a.npz", b"nothing", &["np.savez"]),
        ("a.xyz", b"1 2 3 4\n", &["not a header"]),
        ("a.csv.gz", b"\x1f\x8b\x08\x00", &["gzip", "cut short"]),
    ];
    for (file, bytes, words) in cases {
        let message = read(file, bytes).expect_err(file);
        assert!(message.starts_with(file), "{message}");
        words.iter().for_each(|word| assert!(message.contains(word), "{message:?} lacks {word:?}"));
    }
    for ending in ["csv", "xyz", "pts", "pcd", "off", "obj", "stl", "npy", "npz", "png", "ply"] {
        assert!(read(&format!("a.{ending}"), b"").unwrap_err().contains("empty"), "{ending}");
    }
}

/// A ball before a depth camera bulges towards it: a cap, though its depths make a bowl.
#[test]
fn what_a_depth_camera_sees_is_the_free_side() {
    let folder = tempfile::tempdir().unwrap();
    let (radius, away) = (50.0, 200.0);
    let depth = Array2::from_shape_fn((40, 40), |(v, u)| {
        let [x, y] = [u, v].map(|k| (k as f64 - 19.5) / 120.0);
        // |d (x, y, 1) - (0, 0, away)| = radius, the nearer root
        let (a, c) = (x * x + y * y + 1.0, away * away - radius * radius);
        (away - (away * away - a * c).max(0.0).sqrt()) / a
    });
    let mut writer = NpzWriter::new(std::fs::File::create(folder.path().join("d.npz")).unwrap());
    writer.add_array("depth", &depth).unwrap();
    writer.finish().unwrap();
    let output = assert_cmd::Command::cargo_bin("palpate")
        .unwrap()
        .current_dir(folder.path())
        .args(["fit", "d.npz", "--intrinsics", "120,120,19.5,19.5", "--json"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["shape"]["class"], "cap");
    assert!((document["shape"]["radius"].as_f64().unwrap() - radius).abs() < 0.01 * radius, "{}", document["shape"]);
}
