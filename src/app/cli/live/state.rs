//! What a run leaves for the next one: the touches that count, and how their lines are read.

use std::path::Path;

use serde::{Deserialize, Serialize};

use palpate_geometry::contact::{ContactError, Contacts, Orientation};

use crate::cli::failure::Failure;
use crate::io::{read_bytes, visible, write_atomically};

/// The word that says what the file is.
const STATE_SCHEMA: &str = "palpate.live.state/1";

/// The file of `--save` and `--resume`.
#[derive(Debug, Serialize, Deserialize)]
pub(in crate::cli) struct LiveState {
    schema: String,
    /// Touches that ever came.
    pub(super) touches: u64,
    /// Time of the last touch, where its lines said it.
    pub(super) time: Option<f64>,
    /// Names of the columns, where a table was read.
    pub(super) header: Option<String>,
    /// Places that a scene was touched at after its own sweeps.
    pub(super) planned: Vec<[f64; 2]>,
    /// The touches that count.
    pub(super) contacts: Contacts,
}

impl LiveState {
    /// Of so many touches, of which these count.
    pub(in crate::cli) fn new(touches: u64, contacts: Contacts) -> LiveState {
        LiveState { schema: STATE_SCHEMA.into(), touches, time: None, header: None, planned: Vec::new(), contacts }
    }

    /// Reads what an earlier run has left.
    pub(in crate::cli) fn read(path: &Path) -> Result<LiveState, Failure> {
        let (file, bytes) = read_bytes(path)?;
        let wrong = |why: String| Failure::Input(format!("--resume {file}: {why}"));
        let state: LiveState = serde_json::from_slice(&bytes)
            .map_err(|error| wrong(format!("no state of palpate live --save: {}", visible(&error.to_string()))))?;
        if state.schema != STATE_SCHEMA {
            return Err(wrong(format!("its schema is {:?}, and {STATE_SCHEMA} is needed", visible(&state.schema))));
        }
        match checked(&state.contacts) {
            // there may have been no touch yet
            Ok(()) | Err(ContactError::Empty) => Ok(state),
            Err(error) => Err(wrong(error.to_string())),
        }
    }

    /// Writes it, whole or not at all.
    pub(in crate::cli) fn write(&self, path: &Path) -> Result<(), Failure> {
        Ok(write_atomically(path, &mut |out| Ok(serde_json::to_writer(out, self)?))?)
    }
}

/// Whether touches can be; a normal of zeros is one that is not known.
pub(in crate::cli) fn checked(contacts: &Contacts) -> Result<(), ContactError> {
    with_known_normals(contacts).check()
}

/// The contacts with some normal where none is known: that is written as zero, which is no fault here.
fn with_known_normals(contacts: &Contacts) -> Contacts {
    let mut known = contacts.clone();
    if let Orientation::Normals { nx, ny, nz } = &mut known.orientation {
        let zero = |((nx, ny), nz): ((&f64, &f64), &mut f64)| {
            if *nx == 0.0 && *ny == 0.0 && *nz == 0.0 {
                *nz = 1.0;
            }
        };
        nx.iter().zip(ny.iter()).zip(nz.iter_mut()).for_each(zero);
    }
    known
}
