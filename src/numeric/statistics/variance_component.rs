//! The variance of one kind of rows of a least-squares fit, from its residuals and what the unknowns have taken of it.
//!
//! ```text
//! sigma_b^2 = RSS_b / (n_b - tr H_b)        H_b = E_b (E'WE)^-1 E_b' W_b
//! ```
//!
//! Where several kinds weigh each other, H depends on the variances: the fits iterate this to its fixed point, each with the
//! extrapolation that its cost asks for. H. D. Patterson and R. Thompson, *Biometrika* 58 (1971) 545.

/// One kind of rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VarianceComponent {
    /// Sum of squared residuals.
    pub squares: f64,
    /// Number of rows.
    pub rows: f64,
    /// Trace of the hat matrix over them: how many unknowns they determine.
    pub trace: f64,
}

impl VarianceComponent {
    /// Degrees of freedom that are left.
    pub fn freedom(self) -> f64 {
        self.rows - self.trace
    }

    /// Standard deviation; `None` where no more than `least` degrees of freedom are left.
    pub fn sd(self, least: f64) -> Option<f64> {
        let freedom = self.freedom();
        (freedom > least).then(|| (self.squares / freedom).sqrt())
    }

    /// Standard deviation over at least one degree of freedom.
    pub fn sd_of_one_at_least(self) -> f64 {
        (self.squares / self.freedom().max(1.0)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknowns_that_rows_determine_cost_degrees_of_freedom() {
        let component = VarianceComponent { squares: 8.0, rows: 5.0, trace: 3.0 };
        assert_eq!((component.freedom(), component.sd(0.5), component.sd(2.0)), (2.0, Some(2.0), None));
        assert_eq!(VarianceComponent { trace: 5.0, ..component }.sd_of_one_at_least(), 8.0_f64.sqrt());
    }
}
