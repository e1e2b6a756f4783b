//! Contacts that go round: bars, rings and half balls, made from their formulas; shared by tests and bench.

use palpate::Contacts;

/// Columns of touched points with normals.
#[derive(Default)]
struct Touched {
    points: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    fingers: Vec<u32>,
    stations: Vec<u32>,
}

impl Touched {
    fn touch(&mut self, finger: usize, station: usize, point: [f64; 3], normal: [f64; 3]) {
        self.points.push(point);
        self.normals.push(normal);
        self.fingers.push(finger as u32);
        self.stations.push(station as u32);
    }

    /// Contacts, labelled by lane and stop.
    fn contacts(&self) -> Contacts {
        let column = |all: &[[f64; 3]], k: usize| all.iter().map(|p| p[k]).collect::<Vec<f64>>();
        let [x, y, z] = [0, 1, 2].map(|k| column(&self.points, k));
        let [nx, ny, nz] = [0, 1, 2].map(|k| column(&self.normals, k));
        let mut contacts = Contacts::from_positions(x, y, z).with_normals(nx, ny, nz);
        contacts.finger = Some(self.fingers.clone());
        contacts.station = Some(self.stations.clone());
        contacts
    }
}

/// Fingers at heights along a bar of this radius, each `stations` stops round it.
pub(crate) fn ring_of_bar(radius: f64, fingers: usize, stations: usize) -> Contacts {
    let mut all = Touched::default();
    for f in 0..fingers {
        for s in 0..stations {
            let (sin, cos) = (s as f64 / stations as f64 * std::f64::consts::TAU).sin_cos();
            all.touch(f, s, [2.0 * f as f64, radius * cos, radius * sin], [0.0, cos, sin]);
        }
    }
    all.contacts()
}

/// Fingers round the tube of a ring (radius a of its centre line, b of the tube) at places all round it.
pub(crate) fn torus(a: f64, b: f64, fingers: usize, stations: usize) -> Contacts {
    let mut all = Touched::default();
    for f in 0..fingers {
        let (sin_f, cos_f) = (f as f64 / fingers as f64 * std::f64::consts::TAU).sin_cos();
        for s in 0..stations {
            let (sin, cos) = (s as f64 / stations as f64 * std::f64::consts::TAU).sin_cos();
            let out = a + b * cos;
            all.touch(f, s, [out * cos_f, out * sin_f, b * sin], [cos * cos_f, cos * sin_f, sin]);
        }
    }
    all.contacts()
}

/// Lanes over a half ball from rim to rim, seen from +z.
pub(crate) fn half_ball(radius: f64, fingers: usize, stations: usize) -> Contacts {
    let mut all = Touched::default();
    for f in 0..fingers {
        let (sin_f, cos_f) = ((f as f64 / (fingers - 1) as f64 - 0.5) * 2.1).sin_cos();
        for s in 0..stations {
            let (sin, cos) = ((s as f64 / (stations - 1) as f64 - 0.5) * std::f64::consts::PI).sin_cos();
            let n = [sin_f, cos_f * sin, cos_f * cos];
            all.touch(f, s, n.map(|v| radius * v), n);
        }
    }
    all.contacts()
}

/// Contacts spread over a half ball down to its rim, without lanes.
pub(crate) fn scattered_half_ball(radius: f64, count: usize) -> Contacts {
    let mut all = Touched::default();
    for k in 0..count {
        let z = k as f64 / (count - 1) as f64;
        let (sin, cos) = (k as f64 * 2.399_963_229_728_653).sin_cos();
        let across = (1.0 - z * z).sqrt();
        let n = [across * cos, across * sin, z];
        all.touch(k, 0, n.map(|v| radius * v), n);
    }
    let mut contacts = all.contacts();
    (contacts.finger, contacts.station) = (None, None);
    contacts
}

/// The contacts turned by `angle` about an axis.
pub(crate) fn turned(contacts: &Contacts, axis: [f64; 3], angle: f64) -> Contacts {
    let length = axis.iter().map(|v| v * v).sum::<f64>().sqrt();
    let [a, b, c] = axis.map(|v| v / length);
    let (sin, cos) = angle.sin_cos();
    let t = 1.0 - cos;
    let m = [
        [t * a * a + cos, t * a * b - sin * c, t * a * c + sin * b],
        [t * a * b + sin * c, t * b * b + cos, t * b * c - sin * a],
        [t * a * c - sin * b, t * b * c + sin * a, t * c * c + cos],
    ];
    let turn = |v: [f64; 3]| m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
    let mut out = contacts.clone();
    let palpate::Orientation::Normals { nx, ny, nz } = &mut out.orientation else { return out };
    for r in 0..contacts.x.len() {
        [out.x[r], out.y[r], out.z[r]] = turn([contacts.x[r], contacts.y[r], contacts.z[r]]);
        [nx[r], ny[r], nz[r]] = turn([nx[r], ny[r], nz[r]]);
    }
    out
}
