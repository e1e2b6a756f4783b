//! The paper's EP2: several fingers slide side by side along the surface and stop at stations.
//!
//! ```text
//! finger f, station s:  (x, y) = centre + f (cos a, sin a) + s (-sin a, cos a)       a = 0: fingers slide along y
//! point tip           contact over (x, y)
//! spherical tip       contact P with P + rho n(P) over (x, y): tip and surface share their normal
//! path = around       finger f at length f along a cylinder or at angle f round a torus, station s at angle s round the
//!                     bar or the tube, 0 on top
//! path = scan         no fingers: points a spacing apart all over a body of solids, or those of it that an eye sees
//! ```
//!
//! Order: finger, then station, then repeat. A second sweep has fingers of its own, numbered onwards.

mod tip;

use super::SceneError;
use super::error::{finite, not_negative, positive};
use super::surface::{Surface, SurfacePoint};
use crate::scene::rotation::sin_cos_deg;

/// How the fingers of a sweep come to the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum SweepPath {
    /// Down onto it, from above.
    #[default]
    Down,
    /// Round it: a cylinder or a torus.
    Around,
    /// No fingers at all: a scanner sees a body of solids.
    Scan,
}

/// Fingers, stations and tips of one sweep.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sweep {
    /// Whether the fingers come down onto the surface or go round it.
    pub path: SweepPath,
    /// Offset of each finger across the sweep: input units, round a torus degrees.
    pub fingers: Vec<f64>,
    /// Stops along the sweep, in the order they are made; any spacing; degrees where it goes around.
    pub stations: Vec<f64>,
    /// Touches at each stop; the same site, fresh draws.
    pub repeats: usize,
    /// Rotation of the sweep about `centre`: degrees from +x towards +y, 0 slides along y.
    pub angle_deg: f64,
    /// Where fingers and stations are measured from.
    pub centre: [f64; 2],
    /// Radius of the spherical tips; 0 is a point.
    pub tip_radius: f64,
    /// Whether sites off the surface are left out; otherwise they are refused.
    pub skip_unreachable: bool,
    /// Of a scan: the distance between points, input units.
    #[cfg_attr(feature = "serde", serde(default))]
    pub spacing: f64,
    /// Of a scan: where the scanner stands; without one it sees every side.
    #[cfg_attr(feature = "serde", serde(default))]
    pub eye: Option<[f64; 3]>,
}

/// `count` values from `from` to `to`, both ends included; one value: the middle.
pub fn linspace(from: f64, to: f64, count: usize) -> Vec<f64> {
    if count == 1 {
        return vec![0.5 * (from + to)];
    }
    let last = (count.max(2) - 1) as f64;
    (0..count).map(|i| if i + 1 == count { to } else { from + (to - from) * (i as f64 / last) }).collect()
}

/// One touch to be made, with what is true there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// Finger, counted over all sweeps.
    pub finger: u32,
    /// Station, counted from 0 on each finger.
    pub station: u32,
    /// Where the tip's centre comes down.
    pub aim: [f64; 2],
    /// Horizontal unit vector in which the finger slides.
    pub direction: [f64; 2],
    /// Distance along the finger's path.
    pub along: f64,
    /// Where it touches.
    pub touch: SurfacePoint,
}

/// Most touches of one sweep: a hundred bytes each, so about 1 GB; a larger number is more likely a typing error.
pub const MAX_TOUCHES: usize = 10_000_000;

impl Sweep {
    /// Point tips at `fingers` x `stations`, once each, along y.
    pub fn new(fingers: Vec<f64>, stations: Vec<f64>) -> Sweep {
        Sweep {
            path: SweepPath::Down,
            fingers,
            stations,
            repeats: 1,
            angle_deg: 0.0,
            centre: [0.0; 2],
            tip_radius: 0.0,
            skip_unreachable: false,
            spacing: 0.0,
            eye: None,
        }
    }

    /// Point tips that go round a cylinder or a torus: `fingers` are places along the bar, input units, or round the ring,
    /// degrees; `stations` are degrees round the bar or the tube, 0 on top.
    pub fn around(fingers: Vec<f64>, stations: Vec<f64>) -> Sweep {
        Sweep { path: SweepPath::Around, ..Sweep::new(fingers, stations) }
    }

    /// The same sweep with spherical tips of this radius; 0 is a point.
    pub fn with_tip_radius(self, tip_radius: f64) -> Sweep {
        Sweep { tip_radius, ..self }
    }

    /// The same sweep with so many touches at each stop.
    pub fn with_repeats(self, repeats: usize) -> Sweep {
        Sweep { repeats, ..self }
    }

    /// A scan with points `spacing` apart, from all sides or as seen by an eye.
    pub fn scan(spacing: f64, eye: Option<[f64; 3]>) -> Sweep {
        Sweep { path: SweepPath::Scan, spacing, eye, ..Sweep::new(Vec::new(), Vec::new()) }
    }

    fn check(&self) -> Result<(), SceneError> {
        let touches = self.fingers.len().saturating_mul(self.stations.len()).saturating_mul(self.repeats);
        if touches > MAX_TOUCHES {
            let expected = "fingers x stations x repeats may be ten million at most";
            return Err(SceneError::range("sweep: touches", touches as f64, expected));
        }
        for (key, list) in [("sweep.fingers", &self.fingers), ("sweep.stations", &self.stations)] {
            if list.is_empty() {
                return Err(SceneError::List { key: key.into(), expected: "at least one is needed" });
            }
            list.iter().try_for_each(|value| finite(key, *value))?;
        }
        if self.repeats == 0 {
            return Err(SceneError::range("sweep.repeats", 0.0, "at least one touch at each stop is needed"));
        }
        finite("sweep.angle_deg", self.angle_deg)?;
        self.centre.iter().try_for_each(|value| finite("sweep.centre", *value))?;
        not_negative("sweep.tip_radius", self.tip_radius)
    }

    /// `[sin, cos]` of the sweep's angle.
    fn sin_cos(&self) -> [f64; 2] {
        let (sin, cos) = sin_cos_deg(self.angle_deg);
        [sin, cos]
    }

    /// Where the tip's centre comes down.
    #[inline]
    fn aim(&self, [sin, cos]: [f64; 2], across: f64, along: f64) -> [f64; 2] {
        [self.centre[0] + (across * cos - along * sin), self.centre[1] + (across * sin + along * cos)]
    }

    /// One touch with all that an effect may ask of it; `finger` and `first_finger` are counted over all sweeps.
    pub(crate) fn site(&self, first_finger: u32, finger: u32, station: u32, touch: SurfacePoint) -> Site {
        let [sin, cos] = self.sin_cos();
        let along = self.stations.get(station as usize).copied().unwrap_or(0.0);
        let aim = match self.path {
            SweepPath::Down => self.aim([sin, cos], self.fingers[(finger - first_finger) as usize], along),
            SweepPath::Around | SweepPath::Scan => [touch.point[0], touch.point[1]],
        };
        Site { finger, station, aim, direction: [-sin, cos], along, touch }
    }

    /// Touches the surface at every site and adds what was touched.
    ///
    /// # Errors
    /// Numbers out of range; a site off the surface, unless those are skipped (then: when none is left).
    pub(crate) fn touch(&self, surface: &Surface, first_finger: u32, into: &mut Touched) -> Result<(), SceneError> {
        if self.path == SweepPath::Scan {
            return self.see(surface, first_finger, into);
        }
        self.check()?;
        if self.path == SweepPath::Around && surface.around(0.0, 0.0).is_none() {
            return Err(SceneError::Clash {
                first: "sweep.path = \"around\"".into(),
                second: format!("surface.kind = \"{}\"", surface.body.kind()),
                why: "only a cylinder and a torus can be gone round".into(),
            });
        }
        let total = self.fingers.len() * self.stations.len();
        into.reserve(total * self.repeats);
        let angle = self.sin_cos();
        let mut missed = None;
        let mut reachable = 0;
        for (finger, &across) in self.fingers.iter().enumerate() {
            for (station, &along) in self.stations.iter().enumerate() {
                let aim = self.aim(angle, across, along);
                let found = match self.path {
                    SweepPath::Down => contact(surface, aim, self.tip_radius),
                    SweepPath::Around | SweepPath::Scan => surface.around(across, along),
                };
                match found {
                    Some(touch) => {
                        reachable += 1;
                        into.add(touch, first_finger + finger as u32, station as u32, self.repeats);
                    }
                    None => missed = missed.or(Some((finger as u32, station as u32, aim))),
                }
            }
        }
        into.reachable += reachable;
        into.total += total;
        match missed {
            Some((finger, station, [x, y])) if !self.skip_unreachable || reachable == 0 => {
                let hint = surface.needed(x, y).map_or(String::new(), |(name, needed)| {
                    format!(", whose {name} would have to be at least {needed:.6} there")
                });
                let kind = surface.body.kind();
                Err(SceneError::Unreachable { finger, station, x, y, kind, hint, reachable, total })
            }
            _ => Ok(()),
        }
    }
}

impl Sweep {
    /// Scans the surface and adds what was seen.
    fn see(&self, surface: &Surface, first_finger: u32, into: &mut Touched) -> Result<(), SceneError> {
        positive("sweep.spacing", self.spacing)?;
        self.eye.iter().flatten().try_for_each(|value| finite("sweep.eye", *value))?;
        let Some(points) = surface.scan(self.spacing, self.eye) else {
            return Err(SceneError::Clash {
                first: "sweep.path = \"scan\"".into(),
                second: format!("surface.kind = \"{}\"", surface.body.kind()),
                why: "only solids are scanned, and those from outside".into(),
            });
        };
        if points.is_empty() || points.len() > MAX_TOUCHES {
            let expected = "a spacing that leaves one point at least and ten million at most is needed";
            return Err(SceneError::range("sweep.spacing", self.spacing, expected));
        }
        into.reserve(points.len());
        into.reachable += points.len();
        into.total += points.len();
        for (station, touch) in points.into_iter().enumerate() {
            into.add(touch, first_finger, station as u32, 1);
        }
        Ok(())
    }
}

/// What the sweeps touched, touch by touch, and how many of the sites asked for they reached.
#[derive(Debug, Default)]
pub(crate) struct Touched {
    pub points: Vec<SurfacePoint>,
    pub fingers: Vec<u32>,
    pub stations: Vec<u32>,
    pub reachable: usize,
    pub total: usize,
}

impl Touched {
    fn reserve(&mut self, more: usize) {
        self.points.reserve(more);
        self.fingers.reserve(more);
        self.stations.reserve(more);
    }

    #[inline]
    fn add(&mut self, touch: SurfacePoint, finger: u32, station: u32, repeats: usize) {
        for _ in 0..repeats {
            self.points.push(touch);
            self.fingers.push(finger);
            self.stations.push(station);
        }
    }
}

/// Where a tip of this radius that comes down over `aim` touches first.
#[inline]
pub(super) fn contact(surface: &Surface, aim: [f64; 2], tip_radius: f64) -> Option<SurfacePoint> {
    if tip_radius == 0.0 { surface.at(aim[0], aim[1]) } else { tip::rolled(surface, aim, tip_radius) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touched(sweep: &Sweep, surface: &Surface) -> Result<Touched, SceneError> {
        let mut touched = Touched::default();
        sweep.touch(surface, 0, &mut touched).map(|()| touched)
    }

    #[test]
    fn order_is_finger_then_station_then_repeat_and_both_ends_are_met() {
        let mut sweep = Sweep::new(vec![-4.0, 0.0, 4.0], linspace(-4.0, 4.0, 6));
        sweep.repeats = 2;
        let touched = touched(&sweep, &Surface::plane()).unwrap();
        assert_eq!(touched.points.len(), 36);
        let sites: Vec<_> =
            (0..36).map(|i| sweep.site(0, touched.fingers[i], touched.stations[i], touched.points[i])).collect();
        let labels: Vec<_> = sites.iter().map(|s| (s.finger, s.station, s.aim)).collect();
        assert_eq!(labels[0], (0, 0, [-4.0, -4.0]));
        assert_eq!(labels[1], labels[0]);
        assert_eq!(labels[2].1, 1);
        assert_eq!(sites[35].aim, [4.0, 4.0]);
    }

    #[test]
    fn a_ball_too_small_for_the_patch_is_refused_with_the_size_it_needs() {
        let sweep = Sweep::new(vec![-4.0, 0.0, 4.0], linspace(-4.0, 4.0, 9));
        let small = Surface::sphere(5.5);
        let error = touched(&sweep, &small).err().unwrap();
        assert!(matches!(error, SceneError::Unreachable { finger: 0, station: 0, reachable: 23, total: 27, .. }));
        assert!(error.to_string().contains("5.656854"), "{error}");
        let skipping = Sweep { skip_unreachable: true, ..sweep.clone() };
        assert_eq!(touched(&skipping, &small).unwrap().points.len(), 23);
        let large = Surface::sphere(5.7);
        assert!(touched(&sweep, &large).is_ok());
    }
}
