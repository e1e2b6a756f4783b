//! Remarks that a user should see beside the answer.
//!
//! ```text
//! what the contacts leave open (signs, the free side)      what was taken for an error (normals, a gain, a tilt, a departure, places)
//! ```

/// What belongs to the answer of a recognition; printed, it is a whole sentence.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Remark {
    /// The normals contradict their neighbours, so only positions are used.
    NormalsContradict,
    /// Most normals have length zero, so only positions are used.
    NormalsOfLengthZero,
    /// About half of the normals point to either side.
    SignsMixed {
        /// Share of those on the side that was taken.
        agree: f64,
    },
    /// Neither normals nor a viewpoint say which side is free.
    FreeSideAssumed,
    /// The normals lean by one factor more, or less, than positions say.
    Gain {
        /// That factor less 1: above zero, the normals are too steep.
        gain: f64,
    },
    /// The normals are all turned by one angle against the surface that positions show.
    Tilt {
        /// That angle, degrees.
        degrees: f64,
    },
    /// A departure from the simple shapes is read as shape, and may be an error of the sensor.
    DepartureAsShape {
        /// Its size, in percent of the relief.
        percent: f64,
    },
    /// A departure from the simple shapes is read as an error of the sensor.
    DepartureAsError {
        /// Its size, in percent of the relief.
        percent: f64,
    },
    /// Contacts on slopes show that x and y err.
    PlacesErr {
        /// Standard deviation along each of them, input units.
        sd: f64,
    },
    /// A cone's half angle.
    ConeIs {
        /// Half angle with its interval, degrees.
        half_angle_deg: [f64; 3],
    },
    /// A ring's radius and that of its tube.
    RingIs {
        /// Radius of the ring with its interval, input units.
        ring: [f64; 3],
        /// Radius of the tube with its interval.
        tube: [f64; 3],
    },
    /// An ellipsoid's half axes, the longest first.
    EllipsoidIs {
        /// Each with its interval, input units.
        half_axes: [[f64; 3]; 3],
    },
    /// Contacts show smaller shape than a free surface follows.
    FinerShape {
        /// Standard deviation of its height, and the length within which it changes; input units.
        size: [f64; 2],
    },
    /// Several things explain the contacts about as well as a free surface, or may do so as one thing does.
    MayBeSeveral {
        /// All of them in words, with their radius and their share of the contacts.
        things: String,
        /// Their probability against one thing, where the answer is one.
        probability: Option<f64>,
    },
    /// Contacts scatter by as much as the surface bends, which may be waves shorter than this.
    ShorterWaves {
        /// Length of the shortest wave that the contacts show, input units.
        length: f64,
    },
    /// The misfit is as large as the shape.
    MisfitOfShape,
    /// What is not flat on a plane is no shape that was tried.
    MisfitOfPlane,
}

impl Remark {
    /// Whether nothing tells which side is free.
    pub(crate) fn leaves_side_open(&self) -> bool {
        matches!(self, Remark::FreeSideAssumed | Remark::SignsMixed { .. })
    }
}

impl std::fmt::Display for Remark {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Remark::NormalsContradict => {
                write!(f, "the normals contradict their neighbours everywhere and are not used")
            }
            Remark::NormalsOfLengthZero => write!(f, "most normals have length zero; only positions are used"),
            Remark::SignsMixed { agree } => write!(
                f,
                "about half of the normals point to the other side ({:.0} % agree): the free side, and with it the sign of S, \
                 is uncertain; name it by a viewpoint or by reversing the normals",
                100.0 * agree
            ),
            Remark::FreeSideAssumed => {
                write!(
                    f,
                    "nothing tells which side is free, so that it may as well be hollow: name a place on that side by --viewpoint X,Y,Z, or give normals"
                )
            }
            Remark::Gain { gain } => write!(
                f,
                "the normals are {:.0} % {} than the positions say, all alike: how strongly the surface bends was taken from the \
                 positions; --ignore-normals does without normals",
                100.0 * gain.abs(),
                if *gain > 0.0 { "steeper" } else { "flatter" }
            ),
            Remark::Tilt { degrees } => write!(
                f,
                "the normals are all turned by {degrees:.1} degrees against the surface that the positions show, as by a sensor that sits \
                 askew: S and R do not change by that"
            ),
            Remark::DepartureAsShape { percent } => write!(
                f,
                "a departure of {percent:.1} % of the relief is read as shape, but may be an error of the sensor: the intervals \
                 hold both"
            ),
            Remark::DepartureAsError { percent } => {
                write!(f, "a departure of {percent:.1} % of the relief is read as an error of the sensor, not as shape")
            }
            Remark::PlacesErr { sd } => write!(
                f,
                "contacts on slopes scatter more than on level ground: x and y err by about {}, and the answer counts that",
                two_digits(*sd)
            ),
            Remark::ConeIs { half_angle_deg: [value, lo, hi] } => write!(
                f,
                "the cone opens by {} degrees to each side of its axis, between {} and {}",
                digits(*value),
                digits(*lo),
                digits(*hi)
            ),
            Remark::RingIs { ring: [ring, a, b], tube: [tube, c, d] } => write!(
                f,
                "the ring has a radius of {} (between {} and {}), and its tube one of {} (between {} and {})",
                digits(*ring),
                digits(*a),
                digits(*b),
                digits(*tube),
                digits(*c),
                digits(*d)
            ),
            Remark::EllipsoidIs { half_axes } => {
                let [longest, middle, shortest] = half_axes
                    .map(|[value, lo, hi]| format!("{} (between {} and {})", digits(value), digits(lo), digits(hi)));
                write!(f, "the ellipsoid has half axes of {longest}, {middle} and {shortest}")
            }
            Remark::FinerShape { size: [height, length] } => write!(
                f,
                "the contacts also show shape of about {height:.2e} within {length:.2e} that this surface does not follow; the bounds \
                 allow for it"
            ),
            Remark::MayBeSeveral { things, probability: None } => write!(
                f,
                "several things explain the contacts about as well: {things}; contacts beside their edges would tell"
            ),
            Remark::MayBeSeveral { things, probability: Some(p) } => write!(
                f,
                "with a probability of {:.0} % these are several things: {things}; more contacts would tell",
                100.0 * p
            ),
            Remark::ShorterWaves { length } => {
                write!(
                    f,
                    "what is read as scatter may be waves or steps of the surface: the contacts are too few to show waves shorter than some {}",
                    two_digits(*length)
                )
            }
            Remark::MisfitOfShape => {
                write!(f, "the misfit is as large as the shape itself: the class describes only its coarsest part")
            }
            Remark::MisfitOfPlane => write!(f, "what is not flat here is a pattern that none of the shapes describes"),
        }
    }
}

/// Two digits, without an exponent where the number is of ordinary size.
fn two_digits(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

/// Four digits.
fn digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Scripts look for these words in the JSON documents.
    #[test]
    fn the_words_of_a_remark_stay() {
        let said = |remark: Remark| remark.to_string();
        assert_eq!(
            said(Remark::Gain { gain: -0.304 }),
            "the normals are 30 % flatter than the positions say, all alike: how strongly the surface bends was taken from the positions; \
             --ignore-normals does without normals"
        );
        assert_eq!(
            said(Remark::Tilt { degrees: 7.91 }),
            "the normals are all turned by 7.9 degrees against the surface that the positions show, as by a sensor that sits askew: S and R \
             do not change by that"
        );
        assert_eq!(
            said(Remark::DepartureAsShape { percent: 3.21 }),
            "a departure of 3.2 % of the relief is read as shape, but may be an error of the sensor: the intervals hold both"
        );
        assert_eq!(
            said(Remark::PlacesErr { sd: 0.3149 }),
            "contacts on slopes scatter more than on level ground: x and y err by about 0.31, and the answer counts that"
        );
        assert_eq!(
            said(Remark::SignsMixed { agree: 0.52 }),
            "about half of the normals point to the other side (52 % agree): the free side, and with it the sign of S, is uncertain; \
             name it by a viewpoint or by reversing the normals"
        );
    }
}
