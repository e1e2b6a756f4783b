//! Readers and writers of contacts: what goes out comes back, and what is wrong says where.

use std::io::{Cursor, Write};

use ndarray::{Array1, Array2, ShapeBuilder};
use palpate::{ContactWeights, Contacts, Orientation};
use palpate_app::io::{ContactFormat, Input, Place, ReadOptions, Reading, read_input_bytes, write_contacts};
use proptest::prelude::*;

use super::npz::NpzWriter;

fn read(file: &str, bytes: &[u8]) -> Result<Reading, String> {
    // what the library says, and the options that it names as remedies; the command line makes flags of them
    read_input_bytes(file, bytes, &ReadOptions::default()).map_err(|e| format!("{e} {:?}", e.remedies()))
}

fn read_skipping(file: &str, bytes: &[u8]) -> Result<Reading, String> {
    read_input_bytes(file, bytes, &ReadOptions { skip_invalid: true, ..ReadOptions::default() })
        .map_err(|e| e.to_string())
}

fn contacts(reading: Reading) -> Contacts {
    match reading.input {
        Input::Contacts(contacts) => contacts,
        Input::Grid(_) => panic!("a grid"),
    }
}

fn written(contacts: &Contacts, format: ContactFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_contacts(contacts, format, None, &mut bytes).unwrap();
    bytes
}

fn finite() -> impl Strategy<Value = f64> {
    prop_oneof![any::<f64>().prop_filter("finite", |v| v.is_finite()), -1e3..1e3]
}

prop_compose! {
    fn any_contacts()(g in 1_usize..40)(
        x in prop::collection::vec(finite(), g),
        y in prop::collection::vec(finite(), g),
        z in prop::collection::vec(finite(), g),
        a in prop::collection::vec(finite(), g),
        b in prop::collection::vec(finite(), g),
        kind in 0..3,
        finger in prop::option::of(prop::collection::vec(any::<u32>(), g)),
        station in prop::option::of(prop::collection::vec(0_u32..9, g)),
        wz in prop::option::of(prop::collection::vec(0.5..1e9, g)),
        wx in prop::option::of(prop::collection::vec(0.0..1e9, g)),
    ) -> Contacts {
        let ones = vec![1.0; x.len()];
        let orientation = match kind {
            0 => Orientation::None,
            1 => Orientation::Normals { nx: a, ny: b, nz: ones },
            _ => Orientation::Slopes { zx: a, zy: b },
        };
        let wx = wx.filter(|_| orientation != Orientation::None);
        Contacts { x, y, z, orientation, finger, station, weights: ContactWeights { z: wz, x: wx, y: None } }
    }
}

proptest! {
    #[test]
    fn every_format_gives_back_the_same_bits(contacts in any_contacts()) {
        for format in [ContactFormat::Csv, ContactFormat::Npz, ContactFormat::Ply] {
            let reading = read("-", &written(&contacts, format)).unwrap();
            prop_assert_eq!(&reading.input, &Input::Contacts(contacts.clone()));
            prop_assert_eq!(reading.skipped, 0);
        }
    }

    #[test]
    fn cut_and_changed_bytes_never_panic(
        contacts in any_contacts(), at in any::<prop::sample::Index>(), byte in any::<u8>(), cut in any::<bool>()
    ) {
        for format in [ContactFormat::Csv, ContactFormat::Npz, ContactFormat::Ply] {
            let mut bytes = written(&contacts, format);
            let at = at.index(bytes.len());
            bytes[at] = byte;
            if cut {
                bytes.truncate(at);
            }
            let _ = read("-", &bytes);
            let _ = read_skipping("-", &bytes);
        }
    }

    #[test]
    fn any_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300), head in 0_usize..4) {
        let mut whole = [&b""[..], b"ply\n", b"PK\x03\x04", b"x,y,z\n"][head].to_vec();
        whole.extend(bytes);
        let _ = read("-", &whole);
        let _ = read_skipping("-", &whole);
    }
}

#[test]
fn header_in_any_order_comments_quotes_and_windows_line_ends() {
    let text = "\u{feff}# touched on a Tuesday\r\n\r\nstation, z ,\"the, finger\",x,y\r\n3,0.5,\"a, b\",1,2\r\n # aside\r\n4,.25,c,1e1,-2.\r\n";
    let reading = read("a.csv", text.as_bytes()).unwrap();
    assert_eq!(reading.ignored, ["the, finger"]);
    let places = reading.places.clone().unwrap();
    assert_eq!([places.of(0), places.of(1)], [Place::Line(4), Place::Line(6)]);
    let c = contacts(reading);
    assert_eq!((c.x, c.y, c.z), (vec![1.0, 10.0], vec![2.0, -2.0], vec![0.5, 0.25]));
    assert_eq!(c.station, Some(vec![3, 4]));
}

#[test]
fn slopes_without_heights_weigh_the_heights_zero() {
    let c = contacts(read("a.csv", b"x,y,zx,zy\n1,2,0.1,0.2\n").unwrap());
    assert_eq!((c.z, c.weights.z), (vec![0.0], Some(vec![0.0])));
}

#[test]
fn every_bad_csv_says_where_and_what() {
    let cases: [(&str, &[&str]); 19] = [
        ("", &["empty", "x,y,z"]),
        ("# only words\n", &["empty"]),
        ("x,y,z\n", &["no rows"]),
        ("x,y\n1,2\n", &["no column z", "it has x,y"]),
        ("x,z\n1,2\n", &["no column y"]),
        ("a,b,c\n1,2,3\n", &["no column x", "a,b,c"]),
        ("x,y,z,x\n1,2,3,4\n", &["column x stands twice"]),
        ("x,y,z,nx,ny\n1,2,3,4,5\n", &["no column nz"]),
        ("x,y,z,zx\n1,2,3,4\n", &["no column zy"]),
        ("x,y,z,nx,ny,nz,zx,zy\n1,2,3,0,0,1,0,0\n", &["both normals", "slopes"]),
        ("x,y,z\n1,2,3\n1,abc,3\n", &["line 3", "column y", "\"abc\"", "not a number"]),
        ("x,y,z\n1,2,\n", &["line 2", "column z", "\"\""]),
        ("x,y,z\n# c\n1,nan,3\n", &["line 3", "column y", "NaN", "skip_invalid"]),
        ("x,y,z\n1,2,-inf\n", &["line 2", "column z", "-inf"]),
        ("x,y,z\n1,2,3\n1,2\n", &["line 3", "2 fields", "3"]),
        ("x,y,z,nx,ny,nz\n1,2,3,0,0,0\n", &["line 2", "normal", "zero"]),
        ("x,y,z,wz\n1,2,3,-1\n", &["line 2", "column wz", "negative"]),
        ("x,y,z,finger\n1,2,3,1.5\n", &["line 2", "column finger", "1.5"]),
        ("1,2,3\n4,5,6\n", &["line 1", "not a header", "x,y,z"]),
    ];
    for (text, words) in cases {
        let message = read("my.csv", text.as_bytes()).expect_err(text);
        assert!(message.starts_with("my.csv"), "{message}");
        words.iter().for_each(|word| assert!(message.contains(word), "{text:?}: {message:?} lacks {word:?}"));
    }
    assert!(read("my.csv", b"x,y,z\n1,2,\xff\n").unwrap_err().contains("line 2"));
    assert!(read("my.csv", b"x,y,z,wx\n1,2,3,1\n").unwrap_err().contains("wx weighs"));
    assert!(read("my.csv", b"x,y,zx,zy,wz\n1,2,3,1,1\n").unwrap_err().contains("wz weighs z"));
}

#[test]
fn invalid_rows_are_counted_out_only_when_asked() {
    let text = b"x,y,z,nx,ny,nz\n1,2,3,0,0,1\n1,nan,3,0,0,1\n1,2,3,0,0,0\n1,2\n1,2,x,0,0,1\n5,6,7,0,1,0\n";
    assert!(read("a.csv", text).is_err());
    let reading = read_skipping("a.csv", text).unwrap();
    assert_eq!(reading.skipped, 4);
    assert_eq!(reading.places.as_ref().unwrap().of(1), Place::Line(7));
    let c = contacts(reading);
    assert_eq!((c.len(), c.x[1], c.y[1], c.z[1]), (2, 5.0, 6.0, 7.0));
    assert!(read_skipping("a.csv", b"x,y,z\nnan,1,1\n").unwrap_err().contains("all 1"));
}

fn npz(fill: impl FnOnce(&mut NpzWriter<Cursor<Vec<u8>>>)) -> Vec<u8> {
    let mut writer = NpzWriter::new(Cursor::new(Vec::new()));
    fill(&mut writer);
    writer.finish().unwrap().into_inner()
}

#[test]
fn a_grid_of_float32_in_fortran_order_is_read_as_x_by_y() {
    let z = Array2::from_shape_vec((2, 3).f(), vec![1_f32, 4.0, 2.0, 5.0, 3.0, f32::NAN]).unwrap();
    let bytes = npz(|w| {
        w.add_array("x", &Array1::from(vec![0_i32, 1])).unwrap();
        w.add_array("y", &Array1::from(vec![0.0, 0.5, 1.0])).unwrap();
        w.add_array("z", &z).unwrap();
        w.add_array("temperature", &Array1::from(vec![true])).unwrap();
    });
    let reading = read("g.npz", &bytes).unwrap();
    assert_eq!(reading.ignored, ["temperature"]);
    let Input::Grid(grid) = reading.input else { panic!("contacts") };
    assert_eq!((grid.x, grid.y), (vec![0.0, 1.0], vec![0.0, 0.5, 1.0]));
    assert_eq!((grid.z[[0, 0]], grid.z[[0, 2]], grid.z[[1, 0]], grid.z[[1, 1]]), (1.0, 3.0, 4.0, 5.0));
    assert!(grid.z[[1, 2]].is_nan());
}

#[test]
fn every_bad_grid_says_which_array() {
    type Fill = fn(&mut NpzWriter<Cursor<Vec<u8>>>);
    let cases: [(Fill, &[&str]); 5] = [
        (
            |w| {
                w.add_array("x", &Array1::from(vec![0.0, 0.0])).unwrap();
                w.add_array("y", &Array1::from(vec![0.0, 1.0])).unwrap();
                w.add_array("z", &Array2::<f64>::zeros((2, 2))).unwrap();
            },
            &["axis x", "does not increase", "entry 1"],
        ),
        (
            |w| {
                w.add_array("x", &Array1::from(vec![0.0, 1.0, 2.0])).unwrap();
                w.add_array("y", &Array1::from(vec![0.0, 1.0])).unwrap();
                w.add_array("z", &Array2::<f64>::zeros((2, 3))).unwrap();
            },
            &["z is [2, 3]", "[3, 2]", "[x, y]"],
        ),
        (|w| w.add_array("z", &Array2::<f64>::zeros((2, 3))).unwrap(), &["no column x"]),
        (
            |w| {
                w.add_array("x", &Array1::from(vec![0.0, 1.0, 2.0])).unwrap();
                w.add_array("y", &Array1::from(vec![0.0, 1.0])).unwrap();
                w.add_array("z", &Array1::from(vec![0.0, 1.0, 2.0])).unwrap();
            },
            &["array y", "x has 3"],
        ),
        (
            |w| {
                w.add_array("x", &Array1::from(vec![0.0])).unwrap();
                w.add_array("y", &Array1::from(vec![false])).unwrap();
                w.add_array("z", &Array1::from(vec![0.0])).unwrap();
            },
            &["array y", "float64"],
        ),
    ];
    for (fill, words) in cases {
        let message = read("g.npz", &npz(fill)).unwrap_err();
        words.iter().for_each(|word| assert!(message.contains(word), "{message:?} lacks {word:?}"));
    }
    assert!(read("g.npz", b"nothing of the kind").unwrap_err().contains("np.savez"));
}

/// A stored member whose header promises a million million numbers: refused before memory is asked for.
#[test]
fn a_header_may_promise_what_it_likes() {
    for shape in ["1000000000000", "99999999999999999999", "1000000000000, 1000000000000"] {
        let dict = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape},), }}\n");
        let mut member = b"\x93NUMPY\x01\x00".to_vec();
        member.extend((dict.len() as u16).to_le_bytes());
        member.extend(dict.as_bytes());
        member.extend([0; 64]);
        let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
        archive.start_file("x.npy", zip::write::SimpleFileOptions::default()).unwrap();
        archive.write_all(&member).unwrap();
        let bytes = archive.finish().unwrap().into_inner();
        let message = read("big.npz", &bytes).unwrap_err();
        assert!(message.contains("array x"), "{message}");
    }
    for format in ["ascii", "binary_little_endian"] {
        let header = format!(
            "ply\nformat {format} 1.0\nelement vertex 1000000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n"
        );
        let message = read("big.ply", header.as_bytes()).unwrap_err();
        assert!(message.contains("1000000000000"), "{message}");
    }
    // an element without properties takes no bytes in binary: counting to 10^18 would take years
    let hollow = b"ply\nformat binary_little_endian 1.0\nelement hollow 1000000000000000000\nelement vertex 1\nproperty float x\nend_header\n";
    assert!(read("hollow.ply", hollow).unwrap_err().contains("hollow"));
}

#[test]
fn ascii_ply_of_other_programs_is_read() {
    let text = "ply\nformat ascii 1.0\ncomment made elsewhere\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty float nx\nproperty float ny\nproperty float nz\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n1 2 .5 255 0 0 1\n-1. 2 3 0 0 0 -1\n3 0 1 0\n";
    let reading = read("a.ply", text.as_bytes()).unwrap();
    assert_eq!(reading.ignored, ["red"]);
    assert_eq!(reading.places.as_ref().unwrap().of(0), Place::Line(15));
    let c = contacts(reading);
    assert_eq!((c.x, c.z), (vec![1.0, -1.0], vec![0.5, 3.0]));
    assert_eq!(c.orientation, Orientation::Normals { nx: vec![0.0; 2], ny: vec![0.0; 2], nz: vec![1.0, -1.0] });
    let nan = text.replace("1 2 .5", "1 nan .5");
    assert!(read("a.ply", nan.as_bytes()).unwrap_err().contains("line 15, column y"));
    assert_eq!(read_skipping("a.ply", nan.as_bytes()).unwrap().skipped, 1);
    let twice = text.replace("uchar red", "uchar x");
    assert!(read("a.ply", twice.as_bytes()).unwrap_err().contains("x twice"));
    let short = text.replace("vertex 2", "vertex 6");
    assert!(read("a.ply", short.as_bytes()).unwrap_err().contains("promises 6 of element vertex"));
}

#[test]
fn big_endian_ply_with_a_list_before_the_vertices_is_read() {
    let mut bytes = b"ply\nformat binary_big_endian 1.0\nelement strip 1\nproperty list uchar short index\nelement vertex 1\nproperty double x\nproperty float y\nproperty int z\nend_header\n".to_vec();
    bytes.extend([2, 0, 1, 0, 2]);
    bytes.extend(1.25_f64.to_be_bytes());
    bytes.extend((-2.5_f32).to_be_bytes());
    bytes.extend((-7_i32).to_be_bytes());
    let c = contacts(read("b.ply", &bytes).unwrap());
    assert_eq!((c.x[0], c.y[0], c.z[0]), (1.25, -2.5, -7.0));
}
