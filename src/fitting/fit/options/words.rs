//! The words for the values of options. The command line, scene files and messages all take them from here.
//!
//! ```text
//! a table (word, value) per option   ->   FromStr, Display, the list of words in a message
//! ```

use std::fmt;
use std::str::FromStr;

use super::super::error::FitError;
use super::{FrameChoice, NormalSigma, Robust, SlopeWeights, Smooth};

/// A text that is no value of an option, where this would be right.
fn unknown(expected: impl Into<String>) -> FitError {
    FitError::Word { expected: expected.into() }
}

/// What would be right is one of these words: `a, b or c`.
pub(super) fn listed<T>(words: &[(&str, T)]) -> FitError {
    let words: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
    unknown(match words.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => words.concat(),
    })
}

macro_rules! words {
    ($($option:ident { $($word:literal => $value:ident),* $(,)? })*) => {$(
        impl $option {
            /// Every word with what it means.
            pub const WORDS: &'static [(&'static str, $option)] = &[$(($word, $option::$value)),*];

            /// The word for it on the command line, in scene files and in JSON.
            pub fn name(self) -> &'static str {
                match self { $($option::$value => $word),* }
            }
        }

        impl std::fmt::Display for $option {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }

        impl std::str::FromStr for $option {
            type Err = $crate::fit::FitError;

            fn from_str(text: &str) -> Result<$option, $crate::fit::FitError> {
                let found = $option::WORDS.iter().find(|(word, _)| *word == text);
                found.map(|(_, value)| *value).ok_or_else(|| listed($option::WORDS))
            }
        }
    )*};
}

words! {
    Robust { "none" => None, "huber" => Huber, "tukey" => Tukey }
    FrameChoice { "keep" => Keep, "auto" => Auto }
}

/// Finite numbers between commas, exactly `N` of them.
fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let parsed: Result<Vec<f64>, _> = text.split(',').map(|n| n.trim().parse::<f64>()).collect();
    let array: [f64; N] = parsed.ok()?.try_into().ok()?;
    array.iter().all(|v| v.is_finite()).then_some(array)
}

impl SlopeWeights {
    /// The words; three numbers are the other way to give weights.
    pub const WORDS: &'static [(&'static str, SlopeWeights)] = &[
        ("auto", SlopeWeights::Auto),
        ("tangent", SlopeWeights::Tangent),
        ("position", SlopeWeights::Position),
        ("equal", SlopeWeights::Equal),
    ];

    /// Weights as numbers; `None` unless they are finite, none is negative, and one at least is not zero.
    pub fn explicit(weights: [f64; 3]) -> Option<SlopeWeights> {
        let sound = weights.iter().all(|w| w.is_finite() && *w >= 0.0) && weights.iter().any(|w| *w > 0.0);
        sound.then_some(SlopeWeights::Explicit(weights))
    }
}

impl FromStr for SlopeWeights {
    type Err = FitError;

    fn from_str(text: &str) -> Result<SlopeWeights, FitError> {
        if let Some((_, weights)) = SlopeWeights::WORDS.iter().find(|(word, _)| *word == text) {
            return Ok(*weights);
        }
        let words: Vec<&str> = SlopeWeights::WORDS.iter().map(|(word, _)| *word).collect();
        let expected = || unknown(format!("{} or WZ,WX,WY such as 1,10,10", words.join(", ")));
        numbers(text).and_then(SlopeWeights::explicit).ok_or_else(expected)
    }
}

impl fmt::Display for SlopeWeights {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SlopeWeights::Explicit([z, x, y]) => write!(f, "{z},{x},{y}"),
            SlopeWeights::Auto => f.write_str("auto"),
            SlopeWeights::Tangent => f.write_str("tangent"),
            SlopeWeights::Position => f.write_str("position"),
            SlopeWeights::Equal => f.write_str("equal"),
        }
    }
}

impl NormalSigma {
    /// The words; two numbers are the other way to give the noise.
    pub const WORDS: &'static [(&'static str, NormalSigma)] = &[("auto", NormalSigma::Auto)];

    /// Known standard deviations; `None` unless both are finite and above zero.
    pub fn known(z: f64, normal_deg: f64) -> Option<NormalSigma> {
        let sound = [z, normal_deg].iter().all(|v| v.is_finite() && *v > 0.0);
        sound.then_some(NormalSigma::Known { z, normal_deg })
    }
}

impl FromStr for NormalSigma {
    type Err = FitError;

    fn from_str(text: &str) -> Result<NormalSigma, FitError> {
        const EXPECTED: &str =
            "auto, or Z,DEG: the sd of z in input units and of the normals in degrees, such as 0.02,5";
        if let Some((_, sigma)) = NormalSigma::WORDS.iter().find(|(word, _)| *word == text) {
            return Ok(*sigma);
        }
        let known = numbers::<2>(text).and_then(|[z, normal_deg]| NormalSigma::known(z, normal_deg));
        known.ok_or_else(|| unknown(EXPECTED))
    }
}

impl fmt::Display for NormalSigma {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NormalSigma::Auto => f.write_str("auto"),
            NormalSigma::Known { z, normal_deg } => write!(f, "{z},{normal_deg}"),
        }
    }
}

impl Smooth {
    /// The words; a number is the other way to give the penalty.
    pub const WORDS: &'static [(&'static str, Smooth)] = &[("none", Smooth::None), ("auto", Smooth::Auto)];

    /// The penalty as a number; `None` unless it is finite and not negative.
    pub fn lambda(lambda: f64) -> Option<Smooth> {
        (lambda.is_finite() && lambda >= 0.0).then_some(Smooth::Lambda(lambda))
    }

    /// Lambda and aspect; `None` unless lambda is not negative and the aspect above zero.
    fn stretched([lambda, aspect]: [f64; 2]) -> Option<Smooth> {
        (lambda >= 0.0 && aspect > 0.0).then_some(Smooth::Stretched { lambda, aspect })
    }
}

impl FromStr for Smooth {
    type Err = FitError;

    fn from_str(text: &str) -> Result<Smooth, FitError> {
        if let Some((_, smooth)) = Smooth::WORDS.iter().find(|(word, _)| *word == text) {
            return Ok(*smooth);
        }
        let number = |text: &str| numbers::<1>(text).map(|[lambda]| lambda).filter(|l| l.is_finite() && *l >= 0.0);
        let chosen = match text.strip_prefix("third=") {
            Some(third) => number(third).map(Smooth::Third).or_else(|| Smooth::stretched(numbers(third)?)),
            None => number(text).map(Smooth::Lambda),
        };
        const EXPECTED: &str =
            "none, auto, LAMBDA >= 0 such as 1e-6, or third=LAMBDA or third=LAMBDA,ASPECT for third derivatives";
        chosen.ok_or_else(|| unknown(EXPECTED))
    }
}

impl fmt::Display for Smooth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Smooth::None => f.write_str("none"),
            Smooth::Auto => f.write_str("auto"),
            Smooth::Lambda(lambda) => write!(f, "{lambda}"),
            Smooth::Third(lambda) => write!(f, "third={lambda}"),
            Smooth::Stretched { lambda, aspect } => write!(f, "third={lambda},{aspect}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Method;

    #[test]
    fn every_word_is_read_back_from_what_is_shown() {
        for (word, method) in Method::WORDS {
            assert_eq!((word.parse(), method.to_string().as_str()), (Ok(*method), *word));
        }
        for weights in ["auto", "tangent", "position", "equal", "1,10,0.5"] {
            assert_eq!(weights.parse::<SlopeWeights>().unwrap().to_string(), weights);
        }
        for sigma in ["auto", "0.02,5"] {
            assert_eq!(sigma.parse::<NormalSigma>().unwrap().to_string(), sigma);
        }
        for smooth in ["none", "auto", "0.001", "third=0.001", "third=0.001,1.25"] {
            assert_eq!(smooth.parse::<Smooth>().unwrap().to_string(), smooth);
        }
    }

    #[test]
    fn what_is_no_word_is_answered_with_the_words() {
        assert_eq!("pgc".parse::<Method>().unwrap_err().to_string(), "auto, cholesky, qr, kronecker or pcg");
        assert_eq!("turn".parse::<FrameChoice>().unwrap_err().to_string(), "keep or auto");
        assert!(SlopeWeights::explicit([0.0; 3]).is_none() && SlopeWeights::explicit([1.0, f64::NAN, 1.0]).is_none());
        assert!(NormalSigma::known(0.0, 1.0).is_none() && Smooth::lambda(-1.0).is_none());
        for smooth in ["third=", "third=1,", "third=-1,1", "third=1,0", "third=1,2,3", "1,2"] {
            assert!(smooth.parse::<Smooth>().is_err(), "{smooth}");
        }
    }
}
