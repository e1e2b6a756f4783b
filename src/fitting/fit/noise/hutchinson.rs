//! Probes of Hutchinson's estimator `tr A^-1 B = mean z' A^-1 B z` over z of signs (M. F. Hutchinson, *Commun. Stat. Simul.
//! Comput.* 18 (1989) 1059).

use palpate_numeric::draws::Lcg;

/// Signs from Knuth's MMIX generator, one probe after another. Any fixed sequence will do; it has no seed, so that a fit is
/// a function of its data and options alone.
#[derive(Debug)]
pub struct Signs(Lcg);

impl Signs {
    /// From the beginning.
    pub(crate) fn new() -> Signs {
        Signs(Lcg::new(0x9E37_79B9_7F4A_7C15))
    }

    /// The next one, 1 or -1.
    pub(crate) fn sign(&mut self) -> f64 {
        if self.0.uniform() < 0.5 { 1.0 } else { -1.0 }
    }
}
