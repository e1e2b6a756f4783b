//! Remarks that a user should see beside the answer.
//!
//! ```text
//! what the contacts leave open (signs, the free side)      what was taken for an error (normals, a gain, a departure, places)
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
    /// The misfit is as large as the shape.
    MisfitOfShape,
    /// What is not flat on a plane is no shape that was tried.
    MisfitOfPlane,
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
                write!(f, "the sign of S takes +z for the free side: name a viewpoint where it is not")
            }
            Remark::Gain { gain } => write!(
                f,
                "the normals are {:.0} % {} than the positions say, all alike: how strongly the surface bends was taken from the \
                 positions; --ignore-normals does without normals",
                100.0 * gain.abs(),
                if *gain > 0.0 { "steeper" } else { "flatter" }
            ),
            Remark::DepartureAsShape { percent } => write!(
                f,
                "a departure of {percent:.1} % of the relief is read as shape, but may be an error of the sensor: the intervals \
                 hold both"
            ),
            Remark::DepartureAsError { percent } => {
                write!(f, "a departure of {percent:.1} % of the relief is read as an error of the sensor, not as shape")
            }
            Remark::PlacesErr { sd } => {
                // two digits, without an exponent where the number is of ordinary size
                let rounded: f64 = format!("{sd:.1e}").parse().unwrap_or(*sd);
                write!(
                    f,
                    "contacts on slopes scatter more than on level ground: x and y err by about {rounded}, and the answer \
                     counts that"
                )
            }
            Remark::MisfitOfShape => {
                write!(f, "the misfit is as large as the shape itself: the class describes only its coarsest part")
            }
            Remark::MisfitOfPlane => write!(f, "what is not flat here is a pattern that none of the shapes describes"),
        }
    }
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
