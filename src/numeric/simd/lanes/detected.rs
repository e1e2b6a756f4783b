//! Which vector types this machine can run: asked of the processor, and kept as values that nothing else can make.
//!
//! A kernel reaches the wide types only by way of a [`Kind`]: the types have no name outside this folder, and the values
//! that stand for them ([`Detected`]) are made in [`Kind::best`] alone, after the processor was asked.

#[cfg(target_arch = "x86_64")]
use super::Lanes;
#[cfg(target_arch = "x86_64")]
use super::{avx2::Avx2, avx512::Avx512};

/// A value of such a type proves that the processor has the instruction set of its vector type.
#[cfg(target_arch = "x86_64")]
pub(in crate::simd) trait Detected: Copy {
    /// The vector type.
    type Lanes: Lanes;
}

/// Proof that the processor has AVX2, FMA and BMI2.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(in crate::simd) struct Avx2Detected(());

/// Proof that the processor has AVX-512 F, DQ, VL and BW, and all of [`Avx2Detected`].
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(in crate::simd) struct Avx512Detected(());

#[cfg(target_arch = "x86_64")]
impl Detected for Avx2Detected {
    type Lanes = Avx2;
}

#[cfg(target_arch = "x86_64")]
impl Detected for Avx512Detected {
    type Lanes = Avx512;
}

/// An instruction set, with the proof that this machine has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(in crate::simd) enum Kind {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2 {
        detected: Avx2Detected,
    },
    #[cfg(target_arch = "x86_64")]
    Avx512 {
        detected: Avx512Detected,
    },
}

impl Kind {
    /// The widest set of this machine.
    pub(in crate::simd) fn best() -> Kind {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::is_x86_feature_detected as has;
            let avx2 = has!("avx2") && has!("fma") && has!("bmi2");
            if avx2 && has!("avx512f") && has!("avx512dq") && has!("avx512vl") && has!("avx512bw") {
                return Kind::Avx512 { detected: Avx512Detected(()) };
            }
            if avx2 {
                return Kind::Avx2 { detected: Avx2Detected(()) };
            }
        }
        Kind::Portable
    }

    /// The same set, or AVX2 in place of AVX-512, which contains it.
    pub(in crate::simd) fn at_most_256_bits(self) -> Kind {
        match self {
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 { .. } => Kind::Avx2 { detected: Avx2Detected(()) },
            other => other,
        }
    }
}
