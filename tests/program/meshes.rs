//! Triangle meshes are surfaces: contacts of coarse ones lie on the surface that was meant, fine ones are their vertices, and the
//! program finds in them what was drawn.

use std::f64::consts::TAU;

use assert_cmd::Command;
use palpate::Contacts;
use palpate::Orientation;
use palpate_app::io::{Input, ReadOptions, read_input_bytes};
use serde_json::Value;

type Vector = [f64; 3];

/// Vertices and polygons, wound anticlockwise seen from outside.
#[derive(Clone)]
struct Drawn {
    places: Vec<Vector>,
    faces: Vec<Vec<usize>>,
}

impl Drawn {
    fn cylinder(sides: usize, radius: f64, height: f64, capped: bool) -> Drawn {
        let ring = |z: f64| {
            (0..sides).map(move |k| TAU * k as f64 / sides as f64).map(move |t| [radius * t.cos(), radius * t.sin(), z])
        };
        let side = |k: usize| vec![k, (k + 1) % sides, sides + (k + 1) % sides, sides + k];
        let mut faces: Vec<Vec<usize>> = (0..sides).map(side).collect();
        if capped {
            faces.push((0..sides).rev().collect());
            faces.push((sides..2 * sides).collect());
        }
        Drawn { places: ring(0.0).chain(ring(height)).collect(), faces }
    }

    fn cone(sides: usize, radius: f64, height: f64) -> Drawn {
        let mut cone = Drawn::cylinder(sides, radius, 0.0, false);
        cone.places.truncate(sides);
        cone.places.push([0.0, 0.0, height]);
        cone.faces = (0..sides).map(|k| vec![k, (k + 1) % sides, sides]).collect();
        cone
    }

    fn cube(side: f64) -> Drawn {
        let places = (0..8).map(|bits| [0, 1, 2].map(|k| side * f64::from(bits >> k & 1))).collect();
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        Drawn { places, faces: faces.into_iter().map(Vec::from).collect() }
    }

    fn torus(around: usize, across: usize, ring: f64, tube: f64) -> Drawn {
        let place = |k: usize| {
            let [u, v] = [(k / across, around), (k % across, across)].map(|(k, n)| TAU * k as f64 / n as f64);
            let out = ring + tube * v.cos();
            [out * u.cos(), out * u.sin(), tube * v.sin()]
        };
        let face = |k: usize| {
            let (i, j) = (k / across, k % across);
            let at = |i: usize, j: usize| i % around * across + j % across;
            vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
        };
        let count = around * across;
        Drawn { places: (0..count).map(place).collect(), faces: (0..count).map(face).collect() }
    }

    /// A cylinder from z = 0 to `height` between two half balls, each of `rows` rows.
    fn capsule(sides: usize, rows: usize, radius: f64, height: f64) -> Drawn {
        let angle = |row: usize| TAU / 4.0 * row as f64 / rows as f64;
        let below = (1..=rows).map(|row| [radius * angle(row).sin(), -radius * angle(row).cos()]);
        let above = (0..rows).map(|row| [radius * angle(row).cos(), height + radius * angle(row).sin()]);
        let rings = below.chain(above).flat_map(|[r, z]| {
            (0..sides).map(move |k| TAU * k as f64 / sides as f64).map(move |t| [r * t.cos(), r * t.sin(), z])
        });
        let mut places: Vec<Vector> = rings.collect();
        let (last, pole) = (places.len() - sides, places.len());
        places.extend([[0.0, 0.0, -radius], [0.0, 0.0, height + radius]]);
        let next = |k: usize| k - k % sides + (k + 1) % sides;
        let mut faces: Vec<Vec<usize>> = (0..last).map(|k| vec![k, next(k), next(k) + sides, k + sides]).collect();
        faces.extend((0..sides).map(|k| vec![next(k), k, pole]));
        faces.extend((last..pole).map(|k| vec![k, next(k), pole + 1]));
        Drawn { places, faces }
    }

    /// An octahedron whose triangles are cut in four, again and again.
    fn ball(times: usize, radius: f64) -> Drawn {
        let places = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
        let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        let mut ball = Drawn { places: places.map(|p| p.map(f64::from)).into(), faces: faces.map(Vec::from).into() };
        for _ in 0..times {
            let mut middles = std::collections::BTreeMap::new();
            for face in std::mem::take(&mut ball.faces) {
                let middle = [0, 1, 2].map(|k| {
                    let (a, b) = (face[k], face[(k + 1) % 3]);
                    *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                        ball.places.push([0, 1, 2].map(|k| ball.places[a][k] + ball.places[b][k]));
                        ball.places.len() - 1
                    })
                });
                ball.faces.extend((0..3).map(|k| vec![face[k], middle[k], middle[(k + 2) % 3]]));
                ball.faces.push(middle.into());
            }
            for place in &mut ball.places {
                let length = length(*place);
                *place = place.map(|v| v / length);
            }
        }
        ball.places.iter_mut().for_each(|p| *p = p.map(|v| v * radius));
        ball
    }

    fn fans(&self) -> Vec<[usize; 3]> {
        self.faces.iter().flat_map(|f| (1..f.len() - 1).map(|k| [f[0], f[k], f[k + 1]])).collect()
    }

    fn stl(&self) -> Vec<u8> {
        let fans = self.fans();
        let mut bytes = vec![0; 80];
        bytes.extend((fans.len() as u32).to_le_bytes());
        for triangle in fans {
            bytes.extend([0; 12]);
            triangle.into_iter().flat_map(|v| self.places[v]).for_each(|v| bytes.extend((v as f32).to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    fn rows(&self, start: &str) -> String {
        self.places.iter().map(|p| format!("{start}{} {} {}\n", p[0], p[1], p[2])).collect()
    }

    fn face_rows(&self) -> String {
        let row = |f: &Vec<usize>| f.iter().fold(f.len().to_string(), |row, v| format!("{row} {v}")) + "\n";
        self.faces.iter().map(row).collect()
    }

    fn off(&self) -> String {
        format!("OFF\n{} {} 0\n{}{}", self.places.len(), self.faces.len(), self.rows(""), self.face_rows())
    }

    fn obj(&self) -> String {
        let row = |f: &Vec<usize>| f.iter().fold("f".to_string(), |row, v| format!("{row} {}", v + 1)) + "\n";
        self.rows("v ") + &self.faces.iter().map(row).collect::<String>()
    }

    fn ply(&self) -> String {
        let floats = ["x", "y", "z"].map(|name| format!("property double {name}\n")).concat();
        format!(
            "ply\nformat ascii 1.0\nelement vertex {}\n{floats}element face {}\nproperty list uchar int vertex_indices\n\
             end_header\n{}{}",
            self.places.len(),
            self.faces.len(),
            self.rows(""),
            self.face_rows()
        )
    }
}

fn length(a: Vector) -> f64 {
    a.iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn read(file: &str, bytes: &[u8]) -> (Contacts, Vec<String>) {
    let reading = read_input_bytes(file, bytes, &ReadOptions::default()).unwrap();
    let Input::Contacts(contacts) = reading.input else { panic!("a grid") };
    (contacts, reading.notes)
}

/// Places and unit normals.
fn pairs(contacts: &Contacts) -> Vec<(Vector, Vector)> {
    let Orientation::Normals { nx, ny, nz } = &contacts.orientation else { panic!("no normals") };
    let pair = |k: usize| {
        let normal = [nx[k], ny[k], nz[k]];
        ([contacts.x[k], contacts.y[k], contacts.z[k]], normal.map(|v| v / length(normal)))
    };
    (0..contacts.len()).map(pair).collect()
}

/// Largest distance of a normal from the true one.
fn worst(contacts: &Contacts, truth: impl Fn(Vector) -> Vector) -> f64 {
    let off = |(place, normal): (Vector, Vector)| length([0, 1, 2].map(|k| truth(place)[k] - normal[k]));
    pairs(contacts).into_iter().map(off).fold(0.0, f64::max)
}

#[test]
fn every_format_with_faces_is_sampled_alike() {
    let can = Drawn::cylinder(64, 5.0, 20.0, true);
    let files = [("a.off", can.off()), ("a.obj", can.obj()), ("a.ply", can.ply())];
    let readings = files.map(|(file, text)| read(file, text.as_bytes()));
    for (contacts, notes) in &readings {
        assert_eq!(contacts, &readings[0].0);
        assert!(notes[0].contains("the mesh is coarse, and its facets are sampled at"), "{notes:?}");
        // sagitta of a side of 64: 5 (1 - cos(360 / 128 degrees))
        assert!(notes[0].contains("up to 6.0e-3 beside"), "{notes:?}");
    }
    let (single, _) = read("a.stl", &can.stl());
    assert_eq!(single.len(), readings[0].0.len());
    for contacts in [&readings[0].0, &single] {
        let (mut walls, mut caps) = (0.0_f64, 0.0_f64);
        for (place, normal) in pairs(contacts) {
            let radius = place[0].hypot(place[1]);
            if normal[2].abs() > 0.5 {
                assert!(radius < 5.0 && (place[2] - if normal[2] > 0.0 { 20.0 } else { 0.0 }).abs() < 1e-12);
                caps += 1.0;
            } else {
                let off = length([normal[0] - place[0] / radius, normal[1] - place[1] / radius, normal[2]]);
                assert!((radius - 5.0).abs() < 1e-6 && off < 1e-5, "{place:?} {normal:?}");
                walls += 1.0;
            }
        }
        // evenly by area: two caps of pi r^2 beside 2 pi r h
        assert!((caps / walls - 0.25).abs() < 0.01, "{caps} {walls}");
    }
}

#[test]
fn contacts_lie_on_what_was_drawn_with_its_normals() {
    let (cone, _) = read("a.off", Drawn::cone(32, 2.0, 6.0).off().as_bytes());
    let slope = 1.0 / 10.0_f64.sqrt();
    let normal = |p: Vector| [3.0 * slope * p[0] / p[0].hypot(p[1]), 3.0 * slope * p[1] / p[0].hypot(p[1]), slope];
    assert!(worst(&cone, normal) < 1e-12);
    assert!(pairs(&cone).iter().all(|(p, _)| (p[0].hypot(p[1]) - (6.0 - p[2]) / 3.0).abs() < 1e-12));
    let torus = Drawn::torus(24, 12, 5.0, 2.0);
    let (ring, _) = read("a.obj", torus.obj().as_bytes());
    assert_eq!(ring.len(), torus.places.len());
    assert!(
        worst(&ring, |p| [0, 1, 2].map(|k| if k < 2 {
            p[k] / 2.0 * (1.0 - 5.0 / p[0].hypot(p[1]))
        } else {
            p[2] / 2.0
        })) < 1e-12
    );
    let (ball, _) = read("a.ply", Drawn::ball(3, 7.0).ply().as_bytes());
    assert!(worst(&ball, |p| p.map(|v| v / 7.0)) < 1e-12);
    let (capsule, _) = read("a.off", Drawn::capsule(32, 8, 2.0, 6.0).off().as_bytes());
    assert!(worst(&capsule, |p| [p[0] / 2.0, p[1] / 2.0, (p[2] - p[2].clamp(0.0, 6.0)) / 2.0]) < 1e-10);
    assert!(capsule.z.iter().filter(|z| (0.0..6.0).contains(*z)).count() > 500);
    // three faces are turned over, and turned back
    let mut mixed = Drawn::cylinder(40, 5.0, 20.0, true);
    [3, 17, 41].into_iter().for_each(|face| mixed.faces[face].reverse());
    let (turned, _) = read("a.off", mixed.off().as_bytes());
    let outward = |(p, n): &(Vector, Vector)| p[0] * n[0] + p[1] * n[1] + (p[2] - 10.0) * n[2];
    assert!(pairs(&turned).iter().all(|pair| outward(pair) > 0.0));
}

#[test]
fn fine_meshes_are_their_vertices_and_vertices_alone_have_no_normals() {
    // as a scanner gives it: every vertex a little off
    let mut scan = Drawn::torus(150, 60, 5.0, 2.0);
    let noise = |k: usize| 0.01 * ((k as f64 * 0.618_034).fract() - 0.5);
    scan.places.iter_mut().enumerate().for_each(|(k, p)| *p = [0, 1, 2].map(|c| p[c] + noise(3 * k + c)));
    let (contacts, notes) = read("a.stl", &scan.stl());
    assert!(notes[0].contains("normals from the triangles around each"), "{notes:?}");
    let mut first = vec![usize::MAX; scan.places.len()];
    let mut order = 0;
    for vertex in scan.fans().into_iter().flatten() {
        if first[vertex] == usize::MAX {
            first[vertex] = order;
            order += 1;
        }
    }
    assert_eq!(contacts.len(), order);
    (0..order).for_each(|v| assert_eq!(contacts.x[first[v]], f64::from(scan.places[v][0] as f32)));
    for (file, text) in [("a.off", scan.off()), ("a.obj", scan.obj()), ("a.ply", scan.ply())] {
        let (contacts, _) = read(file, text.as_bytes());
        let normals = (0..contacts.len()).map(|r| contacts.unit_normal(r).unwrap());
        let outwards = scan.places.iter().zip(normals).map(|(p, n)| {
            // the middle of the tube beside a place
            let ring = 5.0 / p[0].hypot(p[1]);
            [p[0] - ring * p[0], p[1] - ring * p[1], p[2]].iter().zip(n).map(|(a, b)| a * b).sum::<f64>()
        });
        assert!(outwards.fold(f64::INFINITY, f64::min) > 1.9, "{file}");
        assert!(scan.places.iter().zip(&contacts.z).all(|(p, z)| p[2] == *z), "{file}");
    }
    let mut alone = Drawn::cylinder(64, 5.0, 20.0, true);
    alone.faces.clear();
    for (file, text) in [("a.off", alone.off()), ("a.obj", alone.obj()), ("a.ply", alone.ply())] {
        let (contacts, _) = read(file, text.as_bytes());
        assert_eq!((contacts.len(), contacts.orientation), (128, Orientation::None), "{file}");
    }
}

/// `palpate VERB a.stl --json`, or what it says where there is no answer.
fn answer(verb: &str, drawn: &Drawn) -> Result<Value, String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.stl"), drawn.stl()).unwrap();
    let mut command = Command::cargo_bin("palpate").unwrap();
    let output = command.current_dir(folder.path()).args([verb, "a.stl", "--json"]).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    if output.status.success() { Ok(serde_json::from_slice(&output.stdout).unwrap()) } else { Err(message) }
}

/// R lies in its interval, but for the digits of 32-bit numbers.
fn holds(found: &Value, bend: f64) -> bool {
    let ends = [0, 1].map(|k| found["shape"]["R"]["interval"][k].as_f64().unwrap());
    ends[0] <= bend * (1.0 + 1e-7) && bend * (1.0 - 1e-7) <= ends[1]
}

fn kind(found: &Value) -> &str {
    found["fit"]["chosen"]["hypothesis"].as_str().unwrap()
}

#[test]
fn a_tube_is_a_pipe_and_a_can_several_things() {
    let tube = answer("fit", &Drawn::cylinder(64, 5.0, 20.0, false)).unwrap();
    assert_eq!(kind(&tube), "cylinder");
    assert!(holds(&tube, 0.2 / 2.0_f64.sqrt()), "{}", tube["shape"]["R"]);
    let can = Drawn::cylinder(64, 0.5, 1.0, true);
    let message = answer("fit", &can).unwrap_err();
    assert!(message.contains("a pipe or bar of radius 0.5") && message.contains("and a plane"), "{message}");
    let parts = answer("parts", &can).unwrap();
    let kinds: Vec<&str> = parts["parts"].as_array().unwrap().iter().map(|p| p["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["cylinder", "plane", "plane"]);
}

#[test]
fn a_cone_of_32_sides_is_a_cone() {
    let cone = answer("fit", &Drawn::cone(32, 2.0, 6.0)).unwrap();
    assert_eq!(kind(&cone), "cone");
    let notes = cone["fit"]["notes"].to_string();
    assert!(notes.contains("opens by 18.43 degrees"), "{notes}");
}

#[test]
fn a_cube_is_several_things() {
    let message = answer("fit", &Drawn::cube(3.0)).unwrap_err();
    assert!(message.contains("several things"), "{message}");
    let parts = answer("parts", &Drawn::cube(3.0)).unwrap();
    assert_eq!(parts["parts"].as_array().unwrap().len(), 6);
}

#[test]
fn coarse_balls_and_rings_are_found() {
    for times in [2, 3] {
        let ball = answer("fit", &Drawn::ball(times, 7.0)).unwrap();
        assert_eq!((kind(&ball), holds(&ball, 1.0 / 7.0)), ("sphere", true), "{}", ball["shape"]["R"]);
    }
    let ring = answer("fit", &Drawn::torus(24, 12, 5.0, 2.0)).unwrap();
    assert_eq!(kind(&ring), "torus");
}
