//! Do the posteriors of whole bodies tell the truth? Bodies in random pose, touched in part or all round, a fit each.
//!
//!     cargo bench --bench calibration                           2,000 bodies of every kind
//!     cargo bench --bench calibration -- --bodies 100 --only cone --seed 5
//!     cargo bench --bench calibration -- --parts 0.3,0.2,0.12   the same of small parts, shares of the way round
//!     cargo bench --bench calibration -- --sizes prior          the same of bodies whose sizes are drawn as the prior has them
//!     cargo bench --bench calibration -- --cells 200            coverage by kind, part, contacts and noise: so many fits a cell
//!     cargo bench --bench calibration -- --tuning 120           what each setting of `Tuning` moves, on so many bodies
//!     cargo bench --bench calibration -- --learn 40             settings of priors under which the laboratory's bodies are most probable
//!     cargo bench --bench calibration -- --learn 1 --corpus DIR the same of a folder of files of contacts
//!
//! ```text
//! rank    which of the intervals of level 1/6, 2/6 ... 5/6 still holds the truth: all six shares are 1/6 where the law is right
//! p       of chi^2 on those shares
//! kind    the probability that was said, in tenths, beside the share that was right
//! ```

mod cells;
mod learn;
mod ranks;
mod tuning;

use std::path::PathBuf;

use palpate::recognition::Tuning;
use palpate_laboratory::bodies::{BodyKind, SizeLaw};

/// What the command line says.
pub(crate) struct Wishes {
    bodies: u64,
    /// Fits a cell; `None` for ranks.
    cells: Option<u64>,
    /// Bodies on which settings are moved.
    tuning: Option<u64>,
    /// Bodies of every kind from which priors are learned.
    learn: Option<u64>,
    /// Files from which they are learned instead.
    corpus: Option<PathBuf>,
    seed: u64,
    only: Vec<String>,
    /// How sizes of bodies are drawn.
    sizes: SizeLaw,
    /// Shares of the way round of which bodies are touched for the ranks.
    parts: Vec<f64>,
}

impl Wishes {
    fn kinds(&self) -> impl Iterator<Item = BodyKind> + '_ {
        let wanted = |kind: &BodyKind| self.only.is_empty() || self.only.iter().any(|word| word == kind.name());
        BodyKind::ALL.into_iter().filter(wanted)
    }
}

fn main() -> Result<(), String> {
    let wishes = wishes()?;
    if let Some(count) = wishes.learn {
        return learn::print(&wishes, count);
    }
    match (wishes.tuning, wishes.cells) {
        (Some(count), _) => return tuning::print(&wishes, count),
        (None, Some(fits)) => cells::print(&wishes, fits),
        (None, None) => ranks::print(&wishes),
    }
    Ok(())
}

fn wishes() -> Result<Wishes, String> {
    let parts = vec![1.0, 0.5, 0.3];
    let mut wishes = Wishes {
        bodies: 2000,
        cells: None,
        tuning: None,
        learn: None,
        corpus: None,
        seed: 71_300_001,
        sizes: SizeLaw::Even,
        only: Vec::new(),
        parts,
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        // cargo adds it for every bench
        if word == "--bench" {
            continue;
        }
        let value = words.next().ok_or_else(|| format!("{word} needs a value"))?;
        let number = || value.parse::<u64>().map_err(|error| format!("{word} {value}: {error}"));
        match word.as_str() {
            "--bodies" => wishes.bodies = number()?,
            "--cells" => wishes.cells = Some(number()?),
            "--tuning" => wishes.tuning = Some(number()?),
            "--learn" => wishes.learn = Some(number()?),
            "--corpus" => wishes.corpus = Some(PathBuf::from(&value)),
            "--seed" => wishes.seed = number()?,
            "--parts" => {
                let each =
                    value.split(',').map(|part| part.parse::<f64>().map_err(|error| format!("{word} {part}: {error}")));
                wishes.parts = each.collect::<Result<Vec<f64>, String>>()?;
            }
            "--sizes" => wishes.sizes = size_law(&value)?,
            "--only" => wishes.only.push(value.clone()),
            _ => {
                return Err(format!(
                    "{word} is not known: --bodies, --cells, --tuning, --learn, --corpus, --seed, --parts, --sizes, --only"
                ));
            }
        }
    }
    Ok(wishes)
}

fn size_law(word: &str) -> Result<SizeLaw, String> {
    match word {
        "even" => Ok(SizeLaw::Even),
        "prior" => Ok(SizeLaw::Prior { half_axes: Tuning::default().half_axes }),
        _ => Err(format!("--sizes {word} is not known: even, prior")),
    }
}
