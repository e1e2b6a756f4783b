//! ChaCha with 8 rounds, sixteen blocks at a time, one block a lane.
//!
//! ```text
//! state = constants (4) | key (8) | block number (2) | stream (2)         32-bit words
//! quarter round: a += b; d = (d ^ a) <<< 16;  c += d; b = (b ^ c) <<< 12;  a += b; d = (d ^ a) <<< 8;  c += d; b = (b ^ c) <<< 7
//! ```
//!
//! The words are those of `rand_chacha::ChaCha8Rng` with the same key, stream and position, which the tests hold.
//! Plain arrays: compilers make one register of sixteen lanes, and the dispatcher decides how wide it is.
//! D. J. Bernstein, *ChaCha, a variant of Salsa20*, 2008.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::lanes::Lanes;
use super::{Level, dispatch};

/// Blocks made at once: one 512-bit register of 32-bit words.
pub const BLOCKS: usize = 16;
/// 64-bit words in a block.
pub const WORDS: usize = 8;

type Row = [u32; BLOCKS];

#[inline(always)]
fn step(a: &mut Row, b: &Row, d: &mut Row, turn: u32) {
    for l in 0..BLOCKS {
        a[l] = a[l].wrapping_add(b[l]);
    }
    for l in 0..BLOCKS {
        d[l] = (d[l] ^ a[l]).rotate_left(turn);
    }
}

macro_rules! quarter {
    ($x:ident, $a:literal, $b:literal, $c:literal, $d:literal) => {{
        let [mut a, mut b, mut c, mut d] = [$x[$a], $x[$b], $x[$c], $x[$d]];
        step(&mut a, &b, &mut d, 16);
        step(&mut c, &d, &mut b, 12);
        step(&mut a, &b, &mut d, 8);
        step(&mut c, &d, &mut b, 7);
        [$x[$a], $x[$b], $x[$c], $x[$d]] = [a, b, c, d];
    }};
}

#[inline(always)]
fn generic<V: Lanes>(key: &[u32; 8], stream: u64, first_block: u64, out: &mut [[u64; BLOCKS]; WORDS]) {
    let mut x: [Row; 16] = [[0; BLOCKS]; 16];
    for (row, constant) in x.iter_mut().zip([0x6170_7865, 0x3320_646e, 0x7962_2d32, 0x6b20_6574_u32]) {
        *row = [constant; BLOCKS];
    }
    for (row, word) in x[4..12].iter_mut().zip(key) {
        *row = [*word; BLOCKS];
    }
    for l in 0..BLOCKS {
        let block = first_block.wrapping_add(l as u64);
        x[12][l] = block as u32;
        x[13][l] = (block >> 32) as u32;
    }
    x[14] = [stream as u32; BLOCKS];
    x[15] = [(stream >> 32) as u32; BLOCKS];
    let counters = [x[12], x[13]];
    for _ in 0..4 {
        quarter!(x, 0, 4, 8, 12);
        quarter!(x, 1, 5, 9, 13);
        quarter!(x, 2, 6, 10, 14);
        quarter!(x, 3, 7, 11, 15);
        quarter!(x, 0, 5, 10, 15);
        quarter!(x, 1, 6, 11, 12);
        quarter!(x, 2, 7, 8, 13);
        quarter!(x, 3, 4, 9, 14);
    }
    let start = |k: usize, l: usize| match k {
        0 => 0x6170_7865,
        1 => 0x3320_646e,
        2 => 0x7962_2d32,
        3 => 0x6b20_6574,
        4..12 => key[k - 4],
        12 => counters[0][l],
        13 => counters[1][l],
        14 => stream as u32,
        _ => (stream >> 32) as u32,
    };
    for (j, words) in out.iter_mut().enumerate() {
        for l in 0..BLOCKS {
            let low = x[2 * j][l].wrapping_add(start(2 * j, l));
            let high = x[2 * j + 1][l].wrapping_add(start(2 * j + 1, l));
            words[l] = u64::from(low) | u64::from(high) << 32;
        }
    }
}

/// Blocks `first_block ..` of a stream: `out[j][l]` is the j-th 64-bit word of block `first_block + l`.
pub fn chacha8(level: Level, key: &[u32; 8], stream: u64, first_block: u64, out: &mut [[u64; BLOCKS]; WORDS]) {
    dispatch!(level, generic [](key: &[u32; 8], stream: u64, first_block: u64, out: &mut [[u64; BLOCKS]; WORDS]));
}

/// The safe twin: `rand_chacha`, one block after the other.
pub fn chacha8_twin(key: &[u32; 8], stream: u64, first_block: u64, out: &mut [[u64; BLOCKS]; WORDS]) {
    let mut bytes = [0; 32];
    for (four, word) in bytes.chunks_exact_mut(4).zip(key) {
        four.copy_from_slice(&word.to_le_bytes());
    }
    let mut generator = ChaCha8Rng::from_seed(bytes);
    generator.set_stream(stream);
    generator.set_word_pos(u128::from(first_block) * 16);
    for l in 0..BLOCKS {
        for words in out.iter_mut() {
            words[l] = generator.next_u64();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_words_as_rand_chacha() {
        let key = [1, 2, 3, 0x8000_0000, 5, 6, 7, u32::MAX];
        for (stream, block) in [(0, 0), (7, 1), (u64::MAX, 3), (1 << 40, u64::from(u32::MAX) - 5)] {
            let mut expected = [[0; BLOCKS]; WORDS];
            chacha8_twin(&key, stream, block, &mut expected);
            for level in Level::available() {
                let mut words = [[0; BLOCKS]; WORDS];
                chacha8(level, &key, stream, block, &mut words);
                assert_eq!(words, expected, "{} stream {stream} block {block}", level.name());
                println!("{:<18} {:<9} the same words", "chacha8", level.name());
            }
        }
    }
}
