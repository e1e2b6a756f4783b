//! Whether contacts fill a volume instead of lying on surfaces: leaves, foam, or random places.
//!
//! ```text
//! r_k          distance of a contact's k-th neighbour          contacts within r grow as r^D: D = 2 on a surface, 3 in a volume
//! D_k          ln 2 / mean ln(r_2k / r_k)                      over k, 2k = 4, 8, .. up to an eighth of all
//! a volume     D_k > volume for every k                        noise fills space within its own size, and sheets beyond it do not
//! ```
//!
//! The correlation dimension of P. Grassberger and I. Procaccia, *Physica D* 9 (1983) 189, by neighbours.

use super::tuning::PartsTuning;
use palpate_geometry::neighbours::Neighbours;
use palpate_numeric::vector::Vector;

/// Contacts that are looked at, and of these places whose neighbours are counted.
const LOOKED_AT: [usize; 2] = [4000, 300];

/// The least power with which contacts grow in number around each of them, where that is more than on any surface.
pub(super) fn filled(points: &[Vector], tuning: &PartsTuning) -> Option<f64> {
    let some: Vec<Vector> = points.iter().step_by(points.len().div_ceil(LOOKED_AT[0]).max(1)).copied().collect();
    // none is no number of neighbours
    let [from, one_of] = tuning.volume_neighbours.map(|count| count.max(1));
    let most = some.len() / one_of;
    if some.len() < tuning.volume_from {
        return None;
    }
    let tree = Neighbours::new(&some);
    let step = some.len().div_ceil(LOOKED_AT[1]).max(1);
    // the contact itself is the first that is found
    let around: Vec<Vec<f64>> =
        some.iter().step_by(step).map(|p| tree.nearest(*p, most + 1).iter().map(|(d, _)| d.sqrt()).collect()).collect();
    let scales = std::iter::successors(Some(from), |k| Some(2 * k)).take_while(|k| 2 * k <= most);
    let power = |k: usize| {
        let growth: f64 = around.iter().map(|r| (r[2 * k] / r[k]).ln()).sum();
        std::f64::consts::LN_2 * around.len() as f64 / growth
    };
    let least = scales.map(power).fold(f64::INFINITY, f64::min);
    (least > tuning.volume && least.is_finite()).then_some(least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::draws::EffectDraws;

    /// So many numbers that are all between -1 and 1.
    fn drawn(count: u64, seed: u64) -> Vec<Vector> {
        let draws = EffectDraws::new(seed, "volume");
        let one = |k: u64| {
            let mut at = [0.0; 3];
            draws.uniforms(k, 0, 3, &mut at);
            at.map(|v| 2.0 * v - 1.0)
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn boxes_and_balls_are_filled_and_surfaces_are_not() {
        let tuning = PartsTuning::default();
        for seed in 1..=4 {
            for count in [200, 1000, 9000] {
                let cube = drawn(count, seed);
                assert!(filled(&cube, &tuning).is_some(), "{count} in a cube, {seed}");
                let ball: Vec<Vector> =
                    cube.iter().copied().filter(|p| p.iter().map(|v| v * v).sum::<f64>() < 1.0).collect();
                assert!(
                    filled(&ball, &tuning).is_some() || ball.len() < tuning.volume_from,
                    "{count} in a ball, {seed}"
                );
                let sheet: Vec<Vector> = cube.iter().map(|[x, y, z]| [*x, *y, 0.2 * x * x + 0.05 * z]).collect();
                assert_eq!(filled(&sheet, &tuning), None, "{count} on a sheet, {seed}");
                let walls: Vec<Vector> = cube.iter().map(|[x, y, z]| [*x, *y, 0.3 * z.signum()]).collect();
                assert_eq!(filled(&walls, &tuning), None, "{count} on two walls, {seed}");
            }
        }
    }
}
