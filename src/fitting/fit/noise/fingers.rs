//! Which contact of a finger follows which, and how far: errors that change slowly along a finger are shared by neighbours.
//!
//! ```text
//! cov(e_i, e_j) = s^2 exp(-distance/l) along one finger, 0 between fingers        rho_i = rho^(d_i/d), d the median step
//! whitened   (e_i - rho_i e_(i-1)) / sqrt(1 - rho_i^2)                            log det = sum log(1 - rho_i^2)
//! ```
//!
//! The process of G. E. Uhlenbeck and L. S. Ornstein, *Phys. Rev.* 36 (1930) 823, which forgets everything but the last
//! touch, so that whitening takes one subtraction.

use palpate_geometry::contact::Contacts;
use palpate_numeric::statistics::{ExponentialCorrelation, upper_median};

/// Fewest steps along fingers from which a correlation could be told.
const FEWEST_STEPS: usize = 6;
/// Largest correlation of two touches: repeats in one place share nearly all of their error.
const CLOSEST: f64 = 0.995;

/// Touches of the fingers in their order.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fingers {
    /// Number of a site, that of the touch before it, and the distance in median steps; every finger from its first touch on.
    links: Vec<(u32, u32, f64)>,
}

impl Fingers {
    /// Of contacts that say which finger made them; `numbers` are their places in the user's order. Stations are the order
    /// of touch where they are given, else that in which the contacts came. Contacts whose height counts nothing are left
    /// out.
    pub(crate) fn of(contacts: &Contacts, numbers: Option<&[u32]>) -> Option<Fingers> {
        let finger = contacts.finger.as_ref()?;
        let counts = |r: usize| contacts.weights.z.as_ref().is_none_or(|w| w[r] != 0.0);
        let number = |r: usize| numbers.map_or(r as u32, |n| n[r]);
        let station = |r: usize| contacts.station.as_ref().map_or(0, |s| s[r]);
        let mut order: Vec<usize> = (0..contacts.len()).filter(|&r| counts(r)).collect();
        order.sort_unstable_by_key(|&r| (finger[r], station(r), number(r)));
        let mut links = Vec::new();
        for (before, r) in order.iter().zip(order.iter().skip(1)).filter(|(before, r)| finger[**before] == finger[**r])
        {
            let along = |column: &[f64]| column[*r] - column[*before];
            let distance = along(&contacts.x).hypot(along(&contacts.y)).hypot(along(&contacts.z));
            links.push((*r as u32, *before as u32, distance));
        }
        let steps: Vec<f64> = links.iter().map(|l| l.2).filter(|d| *d > 0.0).collect();
        if steps.len() < FEWEST_STEPS {
            return None;
        }
        let median = upper_median(steps)?;
        links.iter_mut().for_each(|link| link.2 /= median);
        Some(Fingers { links })
    }

    /// Rows made independent whose errors correlate by `rho` over a median step.
    pub(crate) fn whiten<const N: usize>(&self, rho: f64, rows: &mut [[f64; N]]) {
        self.each(rho, |site, before, along, across| {
            let previous = rows[before];
            rows[site].iter_mut().zip(previous).for_each(|(v, p)| *v = (*v - along * p) * across);
        });
    }

    /// The same of rows that stand one after the other in `values`, `columns` numbers each.
    pub(crate) fn whiten_rows(&self, rho: f64, columns: usize, values: &mut [f64]) {
        self.each(rho, |site, before, along, across| {
            for k in 0..columns {
                values[site * columns + k] =
                    (values[site * columns + k] - along * values[before * columns + k]) * across;
            }
        });
    }

    /// Every finger from its last touch back, so that a row is changed after all that need it.
    fn each(&self, rho: f64, mut change: impl FnMut(usize, usize, f64, f64)) {
        for (site, before, distance) in self.links.iter().rev() {
            let along = correlation(rho, *distance);
            change(*site as usize, *before as usize, along, 1.0 / (1.0 - along * along).sqrt());
        }
    }

    /// Log of the determinant of the errors' correlations.
    pub(crate) fn log_det(&self, rho: f64) -> f64 {
        self.links.iter().map(|(_, _, distance)| (1.0 - correlation(rho, *distance).powi(2)).ln()).sum()
    }

    /// Correlation of neighbouring values over its standard deviation for independent ones.
    pub(crate) fn evident(&self, values: &[f64]) -> f64 {
        let product: f64 =
            self.links.iter().map(|(site, before, _)| values[*site as usize] * values[*before as usize]).sum();
        let square = values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64;
        if square > 0.0 { product / square / (self.links.len() as f64).sqrt() } else { 0.0 }
    }
}

fn correlation(rho: f64, distance: f64) -> f64 {
    ExponentialCorrelation::Step(rho).at(distance).min(CLOSEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_fingers() -> Contacts {
        let x = vec![0.0, 1.0, 3.0, 4.0, 5.0, 0.0, 1.0, 2.0, 3.0, 4.0];
        let y = vec![0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0];
        Contacts { finger: Some(vec![0, 0, 0, 0, 0, 7, 7, 7, 7, 7]), ..Contacts::from_positions(x, y, vec![0.0; 10]) }
    }

    /// Values that change sign from touch to touch correlate by minus one, 8 links of them by sqrt(8) standard deviations; a
    /// single value correlates with nothing.
    #[test]
    fn neighbours_of_opposite_sign_are_evidence_of_their_number() {
        let fingers = Fingers::of(&two_fingers(), None).unwrap();
        let values: Vec<f64> = (0..10).map(|r| if r % 2 == 0 { 0.3 } else { -0.3 }).collect();
        assert!((fingers.evident(&values) + 8.0_f64.sqrt()).abs() < 1e-14);
        let lone: Vec<f64> = (0..10).map(|r| if r == 4 { 2.0 } else { 0.0 }).collect();
        assert_eq!(fingers.evident(&lone), 0.0);
    }

    /// Whitening is the inverse of a factor of the covariance exp(-distance/l).
    #[test]
    fn whitened_errors_have_the_covariance_of_the_kernel() {
        let contacts = two_fingers();
        let fingers = Fingers::of(&contacts, None).unwrap();
        let (rho, n) = (0.8_f64, contacts.len());
        let mut rows: Vec<f64> = (0..n * n).map(|k| f64::from(u8::from(k / n == k % n))).collect();
        fingers.whiten_rows(rho, n, &mut rows);
        let covariance = |i: usize, j: usize| {
            let distance = (contacts.x[i] - contacts.x[j]).abs();
            if contacts.y[i] == contacts.y[j] { rho.powf(distance) } else { 0.0 }
        };
        for i in 0..n {
            for j in 0..n {
                let mut sum = 0.0;
                (0..n).for_each(|a| (0..n).for_each(|b| sum += rows[i * n + a] * covariance(a, b) * rows[j * n + b]));
                assert!((sum - f64::from(u8::from(i == j))).abs() < 1e-12, "{i} {j} {sum}");
            }
        }
        // the step of length 2 counts twice
        let expected = 7.0 * (1.0 - rho * rho).ln() + (1.0 - rho.powi(4)).ln();
        assert!((fingers.log_det(rho) - expected).abs() < 1e-12);
    }

    #[test]
    fn the_order_of_the_contacts_does_not_matter_where_stations_are_given() {
        let contacts = Contacts { station: Some((0..10).map(|r| r % 5).collect()), ..two_fingers() };
        let backwards: Vec<u32> = (0..10).rev().collect();
        let turned = Fingers::of(&contacts.in_order(&backwards), None).unwrap();
        let links: Vec<_> = turned.links.iter().map(|(a, b, d)| (9 - a, 9 - b, *d)).collect();
        assert_eq!(links, Fingers::of(&contacts, None).unwrap().links);
        assert_eq!(Fingers::of(&Contacts { finger: None, ..contacts }, None), None);
    }

    /// Rows of an array and rows one after the other are whitened alike; a repeat in one place shares nearly everything.
    #[test]
    fn repeats_in_one_place_are_whitened_by_the_closest_correlation() {
        let mut contacts = two_fingers();
        (contacts.x[2], contacts.z[2]) = (1.0, 0.0);
        contacts.z[9] = 1.5;
        let fingers = Fingers::of(&contacts, None).unwrap();
        let mut rows: Vec<[f64; 2]> = (0..10).map(|r| [(r as f64).sin(), (2.0 * r as f64).cos()]).collect();
        let mut flat: Vec<f64> = rows.iter().flatten().copied().collect();
        let before = rows.clone();
        fingers.whiten(0.7, &mut rows);
        fingers.whiten_rows(0.7, 2, &mut flat);
        assert_eq!(rows.iter().flatten().copied().collect::<Vec<f64>>(), flat);
        // steps of 1, but for the repeat, the way back over 3, and the last one up a slope
        let ways = [1.0, 0.0, 3.0, 1.0, 1.0, 1.0, 1.0, 1.0_f64.hypot(1.5)];
        let sites = [1, 2, 3, 4, 6, 7, 8, 9];
        let mut log_det = 0.0;
        for (site, way) in sites.into_iter().zip(ways) {
            let rho = 0.7_f64.powf(way).min(0.995);
            log_det += (1.0 - rho * rho).ln();
            for k in 0..2 {
                let expected = (before[site][k] - rho * before[site - 1][k]) / (1.0 - rho * rho).sqrt();
                assert!((rows[site][k] - expected).abs() < 1e-12, "{site} {k}");
            }
        }
        assert_eq!([rows[0], rows[5]], [before[0], before[5]]);
        assert!((fingers.log_det(0.7) - log_det).abs() < 1e-12);
        assert_eq!(fingers.log_det(0.0), 0.0);
    }

    /// Contacts whose height counts nothing are passed over, and fewer than six steps tell nothing.
    #[test]
    fn six_steps_are_the_fewest() {
        let with = |weights: Vec<f64>| {
            let mut contacts = two_fingers();
            contacts.weights.z = Some(weights);
            Fingers::of(&contacts, None)
        };
        let weights = |zeros: &[usize]| (0..10).map(|r| f64::from(u8::from(!zeros.contains(&r)))).collect::<Vec<f64>>();
        let seven = with(weights(&[2])).unwrap();
        // from the second to the fourth touch it is 3
        assert_eq!(seven.links[..2], [(1, 0, 1.0), (3, 1, 3.0)]);
        assert_eq!(with(weights(&[2, 4])).unwrap().links.len(), 6);
        assert_eq!(with(weights(&[2, 4, 9])), None);
        // without stations the places in the user's order count
        let mut contacts = two_fingers();
        contacts.finger = Some(vec![3; 10]);
        let numbers: Vec<u32> = (0..10).rev().collect();
        let backwards = Fingers::of(&contacts, Some(&numbers)).unwrap();
        assert!(backwards.links.iter().all(|(site, before, _)| site + 1 == *before), "{backwards:?}");
        assert_eq!(backwards.evident(&[0.0; 10]), 0.0);
    }
}
