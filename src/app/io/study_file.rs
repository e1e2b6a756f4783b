//! A study's state on disk: checkpoints, and parts of a larger run.
//!
//! ```text
//! "palpate study 1\n"   length of the header (u64)   header (JSON)   values or counts   FNV-1a of all before (u64)
//! ```
//!
//! Numbers are little-endian; floats stand in the header as their bits, so that a state read back is the state written. The
//! header carries what the study is a function of (scene, options, seed, build, instruction set), and a reader who finds
//! another one refuses it by name. The arguments and the scene's text go along: whoever merges parts needs nothing else.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use palpate_studies::montecarlo::{
    BatchEstimate, Bins, ControlTally, ExactSum, Histogram, Store, StudyError, StudyState, Tally,
};

use super::write_atomically;

const MAGIC: &[u8] = b"palpate study 1\n";
/// Longest header that is believed.
const MOST_HEADER: u64 = 1 << 28;

/// What a study is a function of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StudyIdentity {
    /// Hash of the scene and of all options that touch a number.
    pub scene_hash: String,
    /// Seed.
    pub seed: u64,
    /// Version of the program.
    pub build: String,
    /// Instruction set of the kernels.
    pub isa: String,
    /// Replicates of the whole run.
    pub replicates: u64,
}

impl StudyIdentity {
    /// The same study, or which part of it differs.
    ///
    /// # Errors
    /// [`StudyError::Stranger`].
    pub(crate) fn check(&self, other: &StudyIdentity) -> Result<(), StudyError> {
        let pairs = [
            ("the version of palpate", self.build.clone(), other.build.clone()),
            ("the scene with its options", self.scene_hash.clone(), other.scene_hash.clone()),
            ("the seed", self.seed.to_string(), other.seed.to_string()),
            ("the instruction set", self.isa.clone(), other.isa.clone()),
            ("the number of replicates", self.replicates.to_string(), other.replicates.to_string()),
        ];
        match pairs.into_iter().find(|(_, own, other)| own != other) {
            Some((what, own, other)) => Err(StudyError::Stranger { what, own, other }),
            None => Ok(()),
        }
    }
}

/// A state with all that is needed to go on with it, or to join it to others.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StudyFile {
    /// Which study.
    pub identity: StudyIdentity,
    /// The arguments of `palpate study`, the scene first.
    pub arguments: Vec<String>,
    /// The scene as TOML.
    pub scene: String,
    /// The part of the run that was asked for.
    pub range: [u64; 2],
    /// Seconds that the replicates took.
    pub seconds: f64,
    /// Bytes of records that belong to this state.
    pub records: u64,
    /// The state.
    pub state: StudyState,
}

/// A study file that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum StudyFileError {
    /// The system said no.
    #[error("{file}: cannot be read: {source}")]
    Read {
        /// The file.
        file: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Not such a file at all.
    #[error("{file}: no checkpoint or part of a study")]
    Foreign {
        /// The file.
        file: PathBuf,
    },
    /// It was one.
    #[error("{file}: a corrupted checkpoint or part of a study: {why}")]
    Corrupted {
        /// The file.
        file: PathBuf,
        /// What does not hold.
        why: &'static str,
    },
}

#[derive(Serialize, Deserialize)]
struct Header {
    identity: StudyIdentity,
    arguments: Vec<String>,
    scene: String,
    range: [u64; 2],
    seconds: f64,
    records: u64,
    seen: [u64; 2],
    classes: [u64; 9],
    planes: u64,
    failed: u64,
    first_failure: Option<(u64, String)>,
    /// Bits.
    batches: Vec<[u64; 8]>,
    /// Words of the control; none where there is none.
    control: Vec<u64>,
    tallies: Vec<TallyHeader>,
}

#[derive(Serialize, Deserialize)]
struct TallyHeader {
    reference: u64,
    count: u64,
    undefined: u64,
    sum: Vec<i64>,
    squares: Vec<i64>,
    ends: [u64; 2],
    /// Centre and spread, where values are counted.
    bins: Option<[u64; 2]>,
    /// Values, or filled bins, that follow.
    length: u64,
}

fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

/// 128 bits that tell texts apart, as 32 hexadecimal digits: FNV-1a forwards and backwards.
pub(crate) fn text_hash(text: &str) -> String {
    let backwards: Vec<u8> = text.bytes().rev().collect();
    format!("{:016x}{:016x}", fnv1a(text.as_bytes()), fnv1a(&backwards))
}

/// Writes the file whole or not at all.
///
/// # Errors
/// As [`write_atomically`].
pub(crate) fn write_study(path: &Path, file: &StudyFile) -> Result<(), super::IoError> {
    let bytes = study_bytes(file);
    write_atomically(path, &mut |out| out.write_all(&bytes))
}

/// The bytes of such a file.
pub(crate) fn study_bytes(file: &StudyFile) -> Vec<u8> {
    let state = &file.state;
    let mut payload = Vec::new();
    let mut tallies = Vec::new();
    for tally in &state.tallies {
        let mut length = 0_u64;
        let bins = match &tally.store {
            Store::Values(values) => {
                length = values.len() as u64;
                values.iter().for_each(|v| payload.extend_from_slice(&v.to_bits().to_le_bytes()));
                None
            }
            Store::Counts(histogram) => {
                for (bin, count) in histogram.filled() {
                    length += 1;
                    payload.extend_from_slice(&(bin as u64).to_le_bytes());
                    payload.extend_from_slice(&count.to_le_bytes());
                }
                Some([histogram.bins.centre.to_bits(), histogram.bins.spread.to_bits()])
            }
        };
        tallies.push(TallyHeader {
            reference: tally.reference.to_bits(),
            count: tally.count,
            undefined: tally.undefined,
            sum: tally.sum.to_digits(),
            squares: tally.squares.to_digits(),
            ends: [tally.least.to_bits(), tally.most.to_bits()],
            bins,
            length,
        });
    }
    let bits = |batch: &BatchEstimate| std::array::from_fn(|k| batch[k / 4][k % 4].to_bits());
    let header = Header {
        identity: file.identity.clone(),
        arguments: file.arguments.clone(),
        scene: file.scene.clone(),
        range: file.range,
        seconds: file.seconds,
        records: file.records,
        seen: [state.from, state.to],
        classes: state.classes,
        planes: state.planes,
        failed: state.failed,
        first_failure: state.first_failure.clone(),
        batches: state.batches.iter().map(bits).collect(),
        control: state.control.as_ref().map_or(Vec::new(), ControlTally::to_words),
        tallies,
    };
    // plain numbers and strings: nothing here can fail to be JSON
    let header = serde_json::to_vec(&header).unwrap_or_default();
    let mut bytes = MAGIC.to_vec();
    bytes.extend_from_slice(&(header.len() as u64).to_le_bytes());
    bytes.extend_from_slice(&header);
    bytes.extend_from_slice(&payload);
    bytes.extend_from_slice(&fnv1a(&bytes).to_le_bytes());
    bytes
}

/// Reads a file back.
///
/// # Errors
/// Not there, not one of ours, or damaged.
pub(crate) fn read_study(path: &Path) -> Result<StudyFile, StudyFileError> {
    let wrong = |source| StudyFileError::Read { file: path.to_path_buf(), source };
    let mut file = File::open(path).map_err(wrong)?;
    // the first bytes alone: a stranger may be longer than the memory, and a device has no end
    let mut bytes = Vec::new();
    file.by_ref().take(MAGIC.len() as u64).read_to_end(&mut bytes).map_err(wrong)?;
    if bytes != MAGIC {
        return Err(StudyFileError::Foreign { file: path.to_path_buf() });
    }
    file.read_to_end(&mut bytes).map_err(wrong)?;
    from_bytes(&bytes).map_err(|why| StudyFileError::Corrupted { file: path.to_path_buf(), why })
}

/// Eight bytes a number, as long as there are any.
struct Words<'a>(&'a [u8]);

impl Words<'_> {
    fn next(&mut self) -> Result<u64, &'static str> {
        let (word, rest) = self.0.split_first_chunk::<8>().ok_or("it ends too early")?;
        self.0 = rest;
        Ok(u64::from_le_bytes(*word))
    }
}

fn from_bytes(bytes: &[u8]) -> Result<StudyFile, &'static str> {
    let (body, sum) = bytes.split_last_chunk::<8>().ok_or("it ends too early")?;
    if fnv1a(body) != u64::from_le_bytes(*sum) {
        return Err("its checksum is another's");
    }
    let mut words = Words(&body[MAGIC.len()..]);
    let length = words.next()?;
    if length > MOST_HEADER || length as usize > words.0.len() {
        return Err("its header is longer than the file");
    }
    let (header, payload) = words.0.split_at(length as usize);
    let header: Header = serde_json::from_slice(header).map_err(|_| "its header is of another version")?;
    let mut words = Words(payload);
    let tallies = header.tallies.iter().map(|tally| read_tally(tally, &mut words)).collect::<Result<_, _>>()?;
    let batch = |bits: &[u64; 8]| {
        [[0, 1, 2, 3].map(|k| f64::from_bits(bits[k])), [4, 5, 6, 7].map(|k| f64::from_bits(bits[k]))]
    };
    let control = match header.control.is_empty() {
        true => None,
        false => Some(ControlTally::from_words(&header.control).ok_or("its control has another length")?),
    };
    Ok(StudyFile {
        identity: header.identity,
        arguments: header.arguments,
        scene: header.scene,
        range: header.range,
        seconds: header.seconds,
        records: header.records,
        state: StudyState {
            from: header.seen[0],
            to: header.seen[1],
            tallies,
            classes: header.classes,
            planes: header.planes,
            failed: header.failed,
            first_failure: header.first_failure,
            batches: header.batches.iter().map(batch).collect(),
            control,
        },
    })
}

fn read_tally(header: &TallyHeader, words: &mut Words<'_>) -> Result<Tally, &'static str> {
    if header.length > words.0.len() as u64 / 8 {
        return Err("it ends too early");
    }
    let store = match header.bins {
        None => Store::Values(
            (0..header.length).map(|_| words.next().map(f64::from_bits)).collect::<Result<Vec<f64>, _>>()?,
        ),
        Some([centre, spread]) => {
            let bins = Bins { centre: f64::from_bits(centre), spread: f64::from_bits(spread) };
            let mut histogram = Histogram::new(bins);
            for _ in 0..header.length {
                let (bin, count) = (words.next()?, words.next()?);
                if !histogram.put(bin as usize, count) {
                    return Err("a bin is out of range");
                }
            }
            Store::Counts(Box::new(histogram))
        }
    };
    let sum = |digits: &[i64]| ExactSum::from_digits(digits).ok_or("a sum has wrong digits");
    Ok(Tally {
        reference: f64::from_bits(header.reference),
        count: header.count,
        undefined: header.undefined,
        sum: sum(&header.sum)?,
        squares: sum(&header.squares)?,
        least: f64::from_bits(header.ends[0]),
        most: f64::from_bits(header.ends[1]),
        store,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(bins: Option<Bins>) -> StudyFile {
        let mut tally = Tally::new(0.5, bins);
        tally.extend(&[0.4, 0.5, f64::NAN, 0.6, 0.55]);
        let state = StudyState {
            from: 3,
            to: 8,
            tallies: vec![tally.clone(), tally],
            classes: [0, 0, 0, 0, 0, 0, 4, 0, 0],
            planes: 1,
            failed: 1,
            first_failure: Some((5, "flat".into())),
            batches: vec![[[0.1, f64::NAN, 0.3, 0.4], [1.0, 2.0, 3.0, f64::INFINITY]]],
            control: ControlTally::from_words(&[3; ControlTally::WORDS]),
        };
        let identity = StudyIdentity {
            scene_hash: text_hash("scene"),
            seed: 7,
            build: "0".into(),
            isa: "portable".into(),
            replicates: 10,
        };
        StudyFile {
            identity,
            arguments: vec!["study".into()],
            scene: "# a scene".into(),
            range: [3, 8],
            seconds: 0.25,
            records: 99,
            state,
        }
    }

    #[test]
    fn a_state_comes_back_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        for bins in [None, Some(Bins { centre: 0.5, spread: 0.125 })] {
            let path = folder.path().join("part");
            write_study(&path, &file(bins)).unwrap();
            let back = read_study(&path).unwrap();
            assert_eq!(study_bytes(&back), study_bytes(&file(bins)));
        }
    }

    #[test]
    fn every_damaged_byte_is_noticed() {
        let bytes = study_bytes(&file(None));
        for k in (MAGIC.len()..bytes.len()).step_by(7) {
            let mut damaged = bytes.clone();
            damaged[k] ^= 1;
            assert!(from_bytes(&damaged).is_err(), "byte {k}");
        }
        for length in [MAGIC.len(), MAGIC.len() + 5, bytes.len() / 2, bytes.len() - 1] {
            assert!(from_bytes(&bytes[..length]).is_err());
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("other");
        std::fs::write(&path, "x,y,z\n").unwrap();
        assert!(matches!(read_study(&path), Err(StudyFileError::Foreign { .. })));
    }
}
