//! NPZ files of any type and memory order, as other programs write them: what the readers are tried on.

use std::io::{Seek, Write};

use ndarray::{Array, Dimension};
use zip::ZipWriter;
use zip::result::ZipResult;
use zip::write::SimpleFileOptions;

/// A number that NumPy has a type for.
pub(crate) trait Number: Copy {
    /// NumPy's name of the type.
    const DESCR: &str;
    /// Little endian.
    fn bytes(self) -> Vec<u8>;
}

macro_rules! number {
    ($type:ty, $descr:literal) => {
        impl Number for $type {
            const DESCR: &str = $descr;
            fn bytes(self) -> Vec<u8> {
                self.to_le_bytes().to_vec()
            }
        }
    };
}

number!(f64, "<f8");
number!(f32, "<f4");
number!(i32, "<i4");

impl Number for bool {
    const DESCR: &str = "|b1";
    fn bytes(self) -> Vec<u8> {
        vec![u8::from(self)]
    }
}

/// Deflated arrays of the types above, each in the order in which it lies in memory.
pub(crate) struct NpzWriter<W: Write + Seek>(ZipWriter<W>);

impl<W: Write + Seek> NpzWriter<W> {
    pub(crate) fn new(out: W) -> NpzWriter<W> {
        NpzWriter(ZipWriter::new(out))
    }

    pub(crate) fn add_array<T: Number, D: Dimension>(&mut self, name: &str, array: &Array<T, D>) -> ZipResult<()> {
        let order = if array.is_standard_layout() { "False" } else { "True" };
        let sizes: String = array.shape().iter().map(|n| format!("{n}, ")).collect();
        let text = format!("{{'descr': '{}', 'fortran_order': {order}, 'shape': ({sizes}), }}\n", T::DESCR);
        self.0.start_file(format!("{name}.npy"), SimpleFileOptions::default())?;
        self.0.write_all(b"\x93NUMPY\x01\x00")?;
        self.0.write_all(&(text.len() as u16).to_le_bytes())?;
        self.0.write_all(text.as_bytes())?;
        for value in array.as_slice_memory_order().unwrap() {
            self.0.write_all(&value.bytes())?;
        }
        Ok(())
    }

    pub(crate) fn finish(self) -> ZipResult<W> {
        self.0.finish()
    }
}
