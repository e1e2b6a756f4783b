//! What whoever asks a tile must know of it, so that the cells that it needs are sent and no others.

use std::ops::Range;

use super::packed::{Packer, Unpacker, damaged};
use crate::error::HierarchyError;

/// What whoever asks must know of a tile.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TileExtent {
    pub(super) roots: Range<usize>,
    /// Codes of the first and the last contact that it has; none without contacts.
    pub(super) codes: Option<[u64; 2]>,
    pub(super) kind: u64,
    pub(super) total: usize,
}

impl TileExtent {
    /// As bytes.
    pub fn pack(&self) -> Vec<u8> {
        let mut packer = Packer::default();
        let sizes = [self.roots.start, self.roots.end, self.total].map(|k| k as u64);
        packer.words(&[sizes[0], sizes[1], sizes[2], self.kind]);
        packer.words(self.codes.as_ref().map_or(&[], |codes| &codes[..]));
        packer.bytes
    }

    /// From bytes.
    ///
    /// # Errors
    /// [`HierarchyError::Parts`].
    pub fn unpack(bytes: &[u8]) -> Result<TileExtent, HierarchyError> {
        let mut reader = Unpacker::new(bytes);
        let (sizes, codes) = (reader.words()?, reader.words()?);
        reader.end()?;
        let [from, to, total, kind] = sizes[..] else { return Err(damaged()) };
        let codes = <[u64; 2]>::try_from(codes).ok();
        Ok(TileExtent { roots: from as usize..to as usize, codes, kind, total: total as usize })
    }
}
