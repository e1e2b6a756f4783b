//! Which instruction set the kernels run on: asked of the processor once, or forced to the portable one.

use std::sync::atomic::{AtomicU8, Ordering};

use super::lanes::Kind;

/// An instruction set that this machine has.
///
/// It can only be made by asking the processor ([`Isa::best`], [`Isa::available`]), so a kernel may run the instructions
/// of any `Isa` that it is given. Nobody else can make one:
///
/// ```compile_fail,E0423
/// use palpate_numeric::simd::Isa;
/// let portable = Isa::PORTABLE;
/// let forged = Isa(unreachable!());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Isa(Kind);

/// Work on this many sites or fewer never uses 512-bit registers.
///
/// Dense 512-bit arithmetic makes many processors halt briefly, lower their clock, and keep it low for two thirds of a
/// millisecond. A few microseconds of such arithmetic gain less than the plain code around them loses. Work on more sites
/// than this takes longer than that time, and gains.
const BRIEF: usize = 1 << 12;

/// 0: not chosen yet; 1: the best there is; 2: portable.
static CHOICE: AtomicU8 = AtomicU8::new(0);

impl Isa {
    /// Plain Rust without fused multiply-add: the same bits on every machine.
    pub const PORTABLE: Isa = Isa(Kind::Portable);

    /// The widest set of this machine.
    pub fn best() -> Isa {
        Isa(Kind::best())
    }

    /// Every set of this machine, the portable one first.
    pub fn available() -> Vec<Isa> {
        let mut all = vec![Isa::PORTABLE, Isa(Kind::best().at_most_256_bits()), Isa::best()];
        all.dedup();
        all
    }

    /// The set in use: the best, or the portable one after [`Isa::force_portable`].
    pub fn active() -> Isa {
        if CHOICE.load(Ordering::Relaxed) == 2 { Isa::PORTABLE } else { Isa::best() }
    }

    /// The set for about so many sites or points in one go: [`Isa::active`], but no 512-bit set for 4096 or fewer.
    pub fn for_work(items: usize) -> Isa {
        let isa = Isa::active();
        if items <= BRIEF { Isa(isa.0.at_most_256_bits()) } else { isa }
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
            Kind::Avx2 { .. } => "avx2",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 { .. } => "avx512",
        }
    }

    pub(super) fn kind(self) -> Kind {
        self.0
    }
}
