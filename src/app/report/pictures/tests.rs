//! Sizes of the pictures, and that readers of their formats can read them.

use super::*;
use crate::report::surface_view::ContactsView;

/// Bytes that no picture exceeds.
const MOST_BYTES: usize = 200_000;

/// A groove with a rough map, an edge of support, uncertainties, a net and so many contacts.
fn pictures(contacts: usize, title: &str) -> SurfacePictures {
    let places: Vec<f64> = (0..60).map(|k| -1.0 + f64::from(k) / 29.5).collect();
    let over = |value: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
        places.iter().flat_map(|x| places.iter().map(|y| value(*x, *y))).collect()
    };
    let held = |x: f64, y: f64, value: f64| if x.hypot(y) < 1.2 { value } else { f64::NAN };
    let points = places.iter().flat_map(|x| places.iter().map(move |y| [*x, *y, 0.4 * x * x]));
    let points: Vec<[f64; 3]> = points.collect();
    let spot = |k: usize| [(0.618_034 * k as f64).fract(), (k as f64 + 0.5) / contacts as f64].map(|t| 2.0 * t - 1.0);
    let touched: Vec<[f64; 3]> = (0..contacts).map(&spot).map(|[x, y]| [x, y, 0.4 * x * x]).collect();
    let view = SurfaceView {
        axes: ["x", "y"],
        places: [places.clone(), places.clone()],
        normals: vec![[0.0, 0.0, 1.0]; points.len()],
        shape_index: over(&|x, y| held(x, y, (9.0 * x).sin() * (7.0 * y).cos())),
        curvedness: over(&|x, y| held(x, y, 0.8 + 0.1 * (5.0 * x * y).sin())),
        uncertainty: Some([over(&|x, y| held(x, y, 0.01 + x * x)), over(&|x, y| held(x, y, 0.02 + y * y))]),
        uncertainty_words: "from noise alone",
        net: (
            [20, 20],
            (0..400)
                .map(|k| [k / 20, k % 20].map(|i| i as f64 / 9.5 - 1.0))
                .map(|[x, y]| [x, y, 0.4 * x * x])
                .collect(),
        ),
        contacts: Some(ContactsView {
            all: contacts,
            points: touched.clone(),
            places: (0..contacts).map(spot).collect(),
            normals: None,
            residuals: (0..contacts).map(|k| 1e-3 * (k as f64).sin()).collect(),
            feet: touched,
            left_out: vec![false; contacts],
            measured: "along z",
        }),
        points,
        ..SurfaceView::default()
    };
    SurfacePictures { view, title: title.into(), unit: Some("mm".into()), across_deg: Some(30.0) }
}

fn bytes(pictures: &SurfacePictures, name: &str, format: PictureFormat) -> Vec<u8> {
    let mut out = Vec::new();
    pictures.write(name, format, &mut out).unwrap();
    out
}

#[test]
fn every_picture_is_small_and_says_how_many_contacts_it_shows() {
    for contacts in [36, 10_000, 300_000] {
        let pictures = pictures(contacts, "a groove");
        for name in SurfacePictures::NAMES {
            for format in PictureFormat::ALL {
                let size = bytes(&pictures, name, format).len();
                assert!(size < MOST_BYTES, "{name}.{} of {contacts} contacts has {size} bytes", format.name());
            }
            let svg = String::from_utf8(bytes(&pictures, name, PictureFormat::Svg)).unwrap();
            let words = if contacts == 36 { "all 36 contacts".into() } else { format!(" of {contacts} contacts") };
            assert!(svg.contains(&words), "{name} of {contacts}");
        }
    }
}

/// Every tag of an SVG closes in its order, and every text is escaped.
fn check_xml(text: &str) {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find('<') {
        assert!(!rest[..at].contains('>'), "{}", &rest[..at]);
        rest = &rest[at + 1..];
        let end = rest.find('>').unwrap();
        let tag = &rest[..end];
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
        let name = tag.trim_start_matches('/').split([' ', '/']).next().unwrap();
        match (tag.starts_with('/'), tag.ends_with('/')) {
            (true, _) => assert_eq!(open.pop(), Some(name)),
            (false, true) => {}
            (false, false) => open.push(name),
        }
        rest = &rest[end + 1..];
    }
    assert!(open.is_empty() && !text.chars().any(|c| c.is_control() && c != '\n'));
    for entity in text.split('&').skip(1) {
        assert!(["amp;", "lt;", "gt;"].iter().any(|e| entity.starts_with(e)), "{entity}");
    }
}

/// Chunks of a PNG follow each other to its end, with their check sums.
fn check_png(bytes: &[u8]) {
    assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n"));
    let mut names = Vec::new();
    let mut rest = &bytes[8..];
    while !rest.is_empty() {
        let length = u32::from_be_bytes(rest[..4].try_into().unwrap()) as usize;
        let mut crc = flate2::Crc::new();
        crc.update(&rest[4..8 + length]);
        assert_eq!(crc.sum().to_be_bytes(), rest[8 + length..12 + length]);
        names.push(rest[4..8].to_vec());
        rest = &rest[12 + length..];
    }
    assert_eq!(names, [b"IHDR", b"IDAT", b"IEND"]);
}

/// Every object of a PDF stands where its table says.
fn check_pdf(bytes: &[u8]) {
    let text: String = bytes.iter().map(|b| char::from(*b)).collect();
    assert!(text.starts_with("%PDF-1.4\n") && text.ends_with("%%EOF\n"));
    let place: usize = text.lines().rev().nth(1).unwrap().parse().unwrap();
    let table: String = bytes[place..].iter().map(|b| char::from(*b)).collect();
    let mut table = table.lines().skip(1);
    let count: usize = table.next().unwrap().split(' ').next_back().unwrap().parse().unwrap();
    for (k, line) in table.take(count).enumerate().skip(1) {
        let at: usize = line[..10].parse().unwrap();
        assert!(bytes[at..].starts_with(format!("{k} 0 obj\n").as_bytes()), "{k}");
    }
}

#[test]
fn readers_can_read_them_whatever_the_name_holds() {
    let pictures = pictures(36, "a\u{1b}[31m<script>&\"'\u{0}) Tj (\\ 漢");
    for name in SurfacePictures::NAMES {
        let svg = String::from_utf8(bytes(&pictures, name, PictureFormat::Svg)).unwrap();
        check_xml(&svg);
        assert!(svg.contains("&lt;script&gt;&amp;") && !svg.contains("<script"));
        check_png(&bytes(&pictures, name, PictureFormat::Png));
        check_pdf(&bytes(&pictures, name, PictureFormat::Pdf));
    }
}

#[test]
fn a_view_of_nothing_has_pictures_too() {
    let empty = SurfaceView { axes: ["u", "v"], ..SurfaceView::default() };
    let mut lonely = pictures(1, "x").view;
    lonely.curvedness.fill(f64::NAN);
    lonely.shape_index.fill(f64::NAN);
    lonely.contacts = None;
    for view in [empty, lonely] {
        let pictures = SurfacePictures { view, title: String::new(), unit: None, across_deg: None };
        for name in SurfacePictures::NAMES {
            check_xml(&String::from_utf8(bytes(&pictures, name, PictureFormat::Svg)).unwrap());
            check_png(&bytes(&pictures, name, PictureFormat::Png));
        }
    }
}
