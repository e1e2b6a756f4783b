//! Numbers one behind another as bytes, little-endian, each list behind its length: what goes into files and to other machines.

use crate::error::HierarchyError;
use crate::mesh::{CellId, MAX_LEVEL};

/// Bytes that are being written.
#[derive(Debug, Default)]
pub(super) struct Packer {
    pub bytes: Vec<u8>,
}

impl Packer {
    pub(super) fn word(&mut self, word: u64) {
        self.bytes.extend(word.to_le_bytes());
    }

    pub(super) fn real(&mut self, real: f64) {
        self.word(real.to_bits());
    }

    pub(super) fn reals(&mut self, reals: &[f64]) {
        self.word(reals.len() as u64);
        reals.iter().for_each(|real| self.real(*real));
    }

    pub(super) fn words(&mut self, words: &[u64]) {
        self.word(words.len() as u64);
        words.iter().for_each(|word| self.word(*word));
    }

    pub(super) fn numbers(&mut self, numbers: &[u32]) {
        self.word(numbers.len() as u64);
        numbers.iter().for_each(|number| self.bytes.extend(number.to_le_bytes()));
    }

    pub(super) fn cells(&mut self, cells: &[CellId]) {
        let flat: Vec<u32> = cells.iter().flat_map(|cell| [cell.level.into(), cell.place[0], cell.place[1]]).collect();
        self.numbers(&flat);
    }
}

/// Bytes that are being read.
#[derive(Debug)]
pub(super) struct Unpacker<'a> {
    bytes: &'a [u8],
}

/// Why bytes are none of ours.
pub(super) fn damaged() -> HierarchyError {
    HierarchyError::Parts { what: "bytes that are none of these, or of another version".into() }
}

impl<'a> Unpacker<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Unpacker<'a> {
        Unpacker { bytes }
    }

    fn chunk(&mut self, count: usize, size: usize) -> Result<&'a [u8], HierarchyError> {
        let len = count.checked_mul(size).ok_or_else(damaged)?;
        let (chunk, rest) = self.bytes.split_at_checked(len).ok_or_else(damaged)?;
        self.bytes = rest;
        Ok(chunk)
    }

    pub(super) fn word(&mut self) -> Result<u64, HierarchyError> {
        let (word, rest) = self.bytes.split_first_chunk().ok_or_else(damaged)?;
        self.bytes = rest;
        Ok(u64::from_le_bytes(*word))
    }

    pub(super) fn size(&mut self) -> Result<usize, HierarchyError> {
        usize::try_from(self.word()?).map_err(|_| damaged())
    }

    pub(super) fn real(&mut self) -> Result<f64, HierarchyError> {
        self.word().map(f64::from_bits)
    }

    pub(super) fn reals(&mut self) -> Result<Vec<f64>, HierarchyError> {
        let count = self.size()?;
        let (chunks, _) = self.chunk(count, 8)?.as_chunks();
        Ok(chunks.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect())
    }

    pub(super) fn words(&mut self) -> Result<Vec<u64>, HierarchyError> {
        let count = self.size()?;
        let (chunks, _) = self.chunk(count, 8)?.as_chunks();
        Ok(chunks.iter().map(|chunk| u64::from_le_bytes(*chunk)).collect())
    }

    pub(super) fn numbers(&mut self) -> Result<Vec<u32>, HierarchyError> {
        let count = self.size()?;
        let (chunks, _) = self.chunk(count, 4)?.as_chunks();
        Ok(chunks.iter().map(|chunk| u32::from_le_bytes(*chunk)).collect())
    }

    pub(super) fn cells(&mut self) -> Result<Vec<CellId>, HierarchyError> {
        let flat = self.numbers()?;
        let (cells, rest) = flat.as_chunks();
        let sound = |[level, _, _]: &[u32; 3]| *level as usize <= MAX_LEVEL;
        if !rest.is_empty() || !cells.iter().all(sound) {
            return Err(damaged());
        }
        Ok(cells.iter().map(|[level, i, j]| CellId { level: *level as u8, place: [*i, *j] }).collect())
    }

    /// Nothing may be left.
    pub(super) fn end(self) -> Result<(), HierarchyError> {
        if self.bytes.is_empty() { Ok(()) } else { Err(damaged()) }
    }
}
