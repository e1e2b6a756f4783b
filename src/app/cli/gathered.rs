//! Files of one run on their way into the output directory.

use std::sync::{Arc, Mutex};

use crate::io::Together;

/// Files on their way into the output directory; clones share them.
#[derive(Clone, Debug, Default)]
pub(super) struct Gathered {
    /// What is still to be published.
    pub(super) files: Arc<Mutex<Option<Together>>>,
    /// Names of the files that stand there.
    pub(super) written: Arc<Mutex<Vec<String>>>,
}
