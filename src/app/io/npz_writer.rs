//! An NPZ on its way out: arrays of float64 in row-major order, each a `.npy` of version 1 inside a zip.

use std::io::{BufWriter, Result, Seek, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::npy::float64_header;

/// Writes array after array; [`NpzWriter::finish`] completes the file.
pub(crate) struct NpzWriter<W: Write + Seek> {
    zip: ZipWriter<W>,
    options: SimpleFileOptions,
}

impl<W: Write + Seek> NpzWriter<W> {
    /// Arrays as they are, like `np.savez`.
    pub(crate) fn stored(out: W) -> NpzWriter<W> {
        NpzWriter::by(out, CompressionMethod::Stored)
    }

    /// Arrays deflated, like `np.savez_compressed`.
    pub(crate) fn compressed(out: W) -> NpzWriter<W> {
        NpzWriter::by(out, CompressionMethod::Deflated)
    }

    fn by(out: W, method: CompressionMethod) -> NpzWriter<W> {
        NpzWriter { zip: ZipWriter::new(out), options: SimpleFileOptions::default().compression_method(method) }
    }

    /// `values` in row-major order of `shape`.
    pub(crate) fn add(&mut self, name: &str, shape: &[usize], values: impl IntoIterator<Item = f64>) -> Result<()> {
        self.zip.start_file(format!("{name}.npy"), self.options)?;
        let mut out = BufWriter::new(&mut self.zip);
        out.write_all(&float64_header(shape))?;
        for value in values {
            out.write_all(&value.to_le_bytes())?;
        }
        out.flush()
    }

    /// Writes the zip's directory and returns what was written to.
    pub(crate) fn finish(self) -> Result<W> {
        let mut out = self.zip.finish()?;
        out.flush()?;
        Ok(out)
    }
}
