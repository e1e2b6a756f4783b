//! What is given, checked and put in order: positions, unit normals (zero where unknown), how many were left out.
//!
//! Contacts are sorted by their coordinates first, so that the order in which they come changes no bit of the answer.

use crate::recognition::{RecognitionError, RecognitionOptions};
use palpate_geometry::contact::{ContactError, Contacts, Grid, Orientation, Rounding};
use palpate_numeric::vector::{Vector, unit_rescaled};

/// Contacts that a patch needs without and with normals: the general surface has six parameters, and three more tell the noise.
const NEEDED: [usize; 2] = [9, 4];

/// Positions and normals in the input's coordinates.
#[derive(Clone, Debug, Default)]
pub(crate) struct Observations {
    pub(crate) points: Vec<Vector>,
    /// Unit normals, zero where there is none.
    pub(crate) normals: Option<Vec<Vector>>,
    pub(crate) missing: usize,
    /// Whether there were normals that the caller asked to ignore.
    pub(crate) ignored: bool,
    /// By how much the numbers were rounded where they were written.
    pub(crate) rounding: Rounding,
}

/// Points of a map, each of which holds its place in the chart and takes some microseconds to find: a million are ten seconds and
/// a gigabyte.
const MOST_MAP_POINTS: usize = 1_000_000;

pub(crate) fn check_options(options: &RecognitionOptions) -> Result<(), RecognitionError> {
    let wrong = |option, value, expected| Err(RecognitionError::Option { option, value, expected });
    if !(options.level > 0.0 && options.level < 1.0) {
        return wrong("level", options.level.to_string(), "a level lies between 0 and 1");
    }
    let [x, y] = options.grid;
    if x.min(y) < 2 || x.saturating_mul(y) > MOST_MAP_POINTS {
        let expected = "a recognised surface is mapped at 2 points each way at least and at 10^6 in all at most; a named model takes more";
        return wrong("grid", format!("{x}x{y}"), expected);
    }
    if !(0.0..0.5).contains(&options.inset) {
        return wrong("inset", options.inset.to_string(), "a fraction from 0 to below 0.5");
    }
    if !(options.sigma_xy >= 0.0 && options.sigma_xy.is_finite()) {
        return wrong("sigma_xy", options.sigma_xy.to_string(), "a length is 0 or above");
    }
    for (option, direction) in [("up", options.up), ("viewpoint", options.viewpoint)] {
        if let Some(v) = direction
            && (v.iter().any(|x| !x.is_finite()) || (option == "up" && v == [0.0; 3]))
        {
            return wrong(option, format!("{v:?}"), "three finite numbers, and a direction is not zero");
        }
    }
    Ok(())
}

impl Observations {
    pub(crate) fn from_contacts(
        contacts: &Contacts,
        options: &RecognitionOptions,
    ) -> Result<Observations, RecognitionError> {
        let has_normals = contacts.orientation != Orientation::None;
        if has_normals && !options.use_normals {
            let positions = Contacts { orientation: Orientation::None, ..contacts.clone() };
            return Ok(Observations { ignored: true, ..Observations::from_contacts(&positions, options)? });
        }
        match contacts.check() {
            // normals of length zero are left out and counted
            Ok(()) | Err(ContactError::ZeroNormal { .. }) => {}
            Err(error) => return Err(error.into()),
        }
        let points = (0..contacts.len()).map(|r| [contacts.x[r], contacts.y[r], contacts.z[r]]).collect();
        let normals = match &contacts.orientation {
            Orientation::None => None,
            Orientation::Normals { nx, ny, nz } => {
                Some((0..nx.len()).map(|r| unit_where_known([nx[r], ny[r], nz[r]])).collect())
            }
            Orientation::Slopes { zx, zy } => {
                Some((0..zx.len()).map(|r| unit_where_known([-zx[r], -zy[r], 1.0])).collect())
            }
        };
        let rounding = Rounding::of_contacts(contacts);
        Ok(Observations { points, normals, rounding, ..Observations::default() }.sorted())
    }

    pub(crate) fn from_grid(grid: &Grid, options: &RecognitionOptions) -> Result<Observations, RecognitionError> {
        grid.check()?;
        let slopes = grid.zx.as_ref().zip(grid.zy.as_ref());
        let mut given = Observations { ignored: slopes.is_some() && !options.use_normals, ..Observations::default() };
        let slopes = slopes.filter(|_| options.use_normals);
        let mut normals = Vec::new();
        for (i, &x) in grid.x.iter().enumerate() {
            for (j, &y) in grid.y.iter().enumerate() {
                let z = grid.z[[i, j]];
                if z.is_nan() {
                    given.missing += 1;
                    continue;
                }
                given.points.push([x, y, z]);
                if let Some((zx, zy)) = slopes {
                    let slope = [zx[[i, j]], zy[[i, j]]];
                    let known = slope.iter().all(|v| !v.is_nan());
                    normals.push(if known { unit_where_known([-slope[0], -slope[1], 1.0]) } else { [0.0; 3] });
                }
            }
        }
        given.normals = slopes.map(|_| normals);
        given.rounding = Rounding::of_grid(grid);
        Ok(given.sorted())
    }

    /// Whether there are enough for a patch.
    ///
    /// # Errors
    /// [`RecognitionError::TooFew`].
    pub(crate) fn check_number(&self) -> Result<(), RecognitionError> {
        let kind = usize::from(self.normals.is_some());
        if self.points.len() < NEEDED[kind] {
            let (found, needed) = (self.points.len(), NEEDED[kind]);
            return Err(RecognitionError::TooFew { found, needed, kind: ["without", "with"][kind] });
        }
        Ok(())
    }

    fn sorted(self) -> Observations {
        // x stands beside the number, so that contacts of different x are compared without a jump through memory
        let mut order: Vec<(f64, u32)> = self.points.iter().zip(0..).map(|(p, i)| (p[0], i)).collect();
        let rest = |i: u32| {
            let (p, n) = (self.points[i as usize], self.normals.as_ref().map_or([0.0; 3], |n| n[i as usize]));
            [p[1], p[2], n[0], n[1], n[2]]
        };
        let compare_rest = |i: u32, j: u32| {
            let (p, q) = (rest(i), rest(j));
            p.iter().zip(&q).map(|(a, b)| a.total_cmp(b)).find(|o| o.is_ne()).unwrap_or(i.cmp(&j))
        };
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then_with(|| compare_rest(a.1, b.1)));
        let taken = |of: &[Vector]| order.iter().map(|&(_, i)| of[i as usize]).collect::<Vec<Vector>>();
        Observations { points: taken(&self.points), normals: self.normals.as_deref().map(taken), ..self }
    }
}

fn unit_where_known(n: Vector) -> Vector {
    if n == [0.0; 3] { n } else { unit_rescaled(n) }
}
