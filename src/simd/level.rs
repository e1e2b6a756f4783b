//! Which instruction set the kernels run on: asked of the processor once, or forced to the portable one.

use std::sync::atomic::{AtomicU8, Ordering};

/// An instruction set that this machine has.
///
/// It can only be made by asking the processor ([`Level::best`], [`Level::available`]), which is what makes calling a
/// kernel with it sound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Level(Kind);

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

impl Level {
    /// Plain Rust without fused multiply-add: the same bits on every machine.
    pub const PORTABLE: Level = Level(Kind::Portable);

    /// The widest set of this machine.
    pub fn best() -> Level {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::is_x86_feature_detected as has;
            let avx2 = has!("avx2") && has!("fma") && has!("bmi2");
            if avx2 && has!("avx512f") && has!("avx512dq") && has!("avx512vl") && has!("avx512bw") {
                return Level(Kind::Avx512);
            }
            if avx2 {
                return Level(Kind::Avx2);
            }
        }
        Level::PORTABLE
    }

    /// Every set of this machine, the portable one first.
    pub fn available() -> Vec<Level> {
        match Level::best().0 {
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => vec![Level::PORTABLE, Level(Kind::Avx2), Level(Kind::Avx512)],
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => vec![Level::PORTABLE, Level(Kind::Avx2)],
            Kind::Portable => vec![Level::PORTABLE],
        }
    }

    /// The set in use: the best, or the portable one after [`Level::force_portable`].
    pub fn active() -> Level {
        if CHOICE.load(Ordering::Relaxed) == 2 { Level::PORTABLE } else { Level::best() }
    }

    /// The set for about so many sites or points in one go: [`Level::active`], but no 512-bit set for 4096 or fewer.
    pub fn for_work(items: usize) -> Level {
        let level = Level::active();
        #[cfg(target_arch = "x86_64")]
        if items <= BRIEF && level.0 == Kind::Avx512 {
            return Level(Kind::Avx2);
        }
        level
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
