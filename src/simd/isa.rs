//! Which instruction set the kernels run on: asked of the processor once, or forced to the portable one.

use std::sync::atomic::{AtomicU8, Ordering};

/// An instruction set that this machine has.
///
/// It can only be made by asking the processor ([`Isa::best`], [`Isa::available`]), which is what makes calling a
/// kernel with it sound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Isa(Kind);

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Kind {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

/// Dense 512-bit arithmetic makes a processor of that time lower its clock, halt for the change, and stay there for two
/// thirds of a millisecond: what a few microseconds of it gain, the plain code around them loses several times over. Work
/// on more sites than this takes longer than that.
const BRIEF: usize = 1 << 12;

/// 0: not chosen yet; 1: the best there is; 2: portable.
static CHOICE: AtomicU8 = AtomicU8::new(0);

impl Isa {
    /// Plain Rust without fused multiply-add: the same bits on every machine.
    pub const PORTABLE: Isa = Isa(Kind::Portable);

    /// The widest set of this machine.
    pub fn best() -> Isa {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::is_x86_feature_detected as has;
            let avx2 = has!("avx2") && has!("fma") && has!("bmi2");
            if avx2 && has!("avx512f") && has!("avx512dq") && has!("avx512vl") && has!("avx512bw") {
                return Isa(Kind::Avx512);
            }
            if avx2 {
                return Isa(Kind::Avx2);
            }
        }
        Isa::PORTABLE
    }

    /// Every set of this machine, the portable one first.
    pub fn available() -> Vec<Isa> {
        match Isa::best().0 {
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => vec![Isa::PORTABLE, Isa(Kind::Avx2), Isa(Kind::Avx512)],
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => vec![Isa::PORTABLE, Isa(Kind::Avx2)],
            Kind::Portable => vec![Isa::PORTABLE],
        }
    }

    /// The set in use: the best, or the portable one after [`Isa::force_portable`].
    pub fn active() -> Isa {
        if CHOICE.load(Ordering::Relaxed) == 2 { Isa::PORTABLE } else { Isa::best() }
    }

    /// The set for about so many sites or points in one go: [`Isa::active`], but no 512-bit set for 4096 or fewer.
    pub fn for_work(items: usize) -> Isa {
        let isa = Isa::active();
        #[cfg(target_arch = "x86_64")]
        if items <= BRIEF && isa.0 == Kind::Avx512 {
            return Isa(Kind::Avx2);
        }
        isa
    }

    /// From now on the whole process takes the portable path (`--portable`), for the same bits on different machines.
    pub fn force_portable() {
        CHOICE.store(2, Ordering::Relaxed);
    }

    /// The name that results record: `portable`, `avx2` or `avx512`.
    pub fn name(self) -> &'static str {
        match self.0 {
            Kind::Portable => "portable",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => "avx512",
        }
    }

    pub(super) fn kind(self) -> Kind {
        self.0
    }
}
