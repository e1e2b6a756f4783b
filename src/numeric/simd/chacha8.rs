//! ChaCha with 8 rounds, sixteen blocks at a time, one block in each lane.
//!
//! ```text
//! state = constants (4) | key (8) | block number (2) | stream (2)         32-bit words
//! quarter round: a += b; d = (d ^ a) <<< 16;  c += d; b = (b ^ c) <<< 12;  a += b; d = (d ^ a) <<< 8;  c += d; b = (b ^ c) <<< 7
//! ```
//!
//! The words are those of `rand_chacha::ChaCha8Rng` with the same key, stream and position, as the test shows.
//! Rows of words go through intrinsics because compilers make good code of the rounds from plain arrays, but interleave the
//! halves by gathers, which took three quarters of the time.
//! D. J. Bernstein, *ChaCha, a variant of Salsa20*, 2008.

use super::lanes::{Lanes, Words};
use super::{Isa, dispatch};

/// Blocks made at once: one 512-bit register of 32-bit words.
pub const BLOCKS: usize = 16;
/// 64-bit words in a block.
pub const WORDS: usize = 8;

const CONSTANTS: [u32; 4] = [0x6170_7865, 0x3320_646e, 0x7962_2d32, 0x6b20_6574];

macro_rules! quarter {
    ($x:ident, $a:literal, $b:literal, $c:literal, $d:literal) => {{
        let [mut a, mut b, mut c, mut d] = [$x[$a], $x[$b], $x[$c], $x[$d]];
        a = a.plus(b);
        d = d.xor(a).rotate_left::<16, 16>();
        c = c.plus(d);
        b = b.xor(c).rotate_left::<12, 20>();
        a = a.plus(b);
        d = d.xor(a).rotate_left::<8, 24>();
        c = c.plus(d);
        b = b.xor(c).rotate_left::<7, 25>();
        [$x[$a], $x[$b], $x[$c], $x[$d]] = [a, b, c, d];
    }};
}

/// The starting state of the blocks `first ..`, one block in each lane, in the order that [`Words::store_pairs`] reverses.
#[inline(always)]
fn start<W: Words>(key: &[u32; 8], stream: u64, first: u64) -> [W; 16] {
    let mut x = [W::splat(0); 16];
    for k in 0..4 {
        x[k] = W::splat(CONSTANTS[k]);
        x[4 + k] = W::splat(key[k]);
        x[8 + k] = W::splat(key[4 + k]);
    }
    let order = W::order();
    [x[12], x[13]] = if first as u32 <= u32::MAX - W::N as u32 {
        [W::splat(first as u32).plus(W::load(order)), W::splat((first >> 32) as u32)]
    } else {
        let mut halves = [[0; BLOCKS]; 2];
        for l in 0..W::N {
            let block = first.wrapping_add(u64::from(order[l]));
            (halves[0][l], halves[1][l]) = (block as u32, (block >> 32) as u32);
        }
        [W::load(&halves[0]), W::load(&halves[1])]
    };
    [x[14], x[15]] = [W::splat(stream as u32), W::splat((stream >> 32) as u32)];
    x
}

#[inline(always)]
fn blocks<W: Words>(key: &[u32; 8], stream: u64, first: u64, from: usize, out: &mut [[u64; BLOCKS]; WORDS]) {
    let start = start::<W>(key, stream, first.wrapping_add(from as u64));
    let mut x = start;
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
    for (j, words) in out.iter_mut().enumerate() {
        let (low, high) = (x[2 * j].plus(start[2 * j]), x[2 * j + 1].plus(start[2 * j + 1]));
        W::store_pairs(low, high, &mut words[from..]);
    }
}

#[inline(always)]
fn generic<V: Lanes>(key: &[u32; 8], stream: u64, first_block: u64, out: &mut [[u64; BLOCKS]; WORDS]) {
    for from in (0..BLOCKS).step_by(V::Words::N) {
        blocks::<V::Words>(key, stream, first_block, from, out);
    }
}

/// Blocks `first_block ..` of a stream: `out[j][l]` is the j-th 64-bit word of block `first_block + l`.
pub fn chacha8(isa: Isa, key: &[u32; 8], stream: u64, first_block: u64, out: &mut [[u64; BLOCKS]; WORDS]) {
    dispatch!(isa, generic [](key: &[u32; 8], stream: u64, first_block: u64, out: &mut [[u64; BLOCKS]; WORDS]));
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    use super::*;

    /// The safe twin: `rand_chacha`, one block after the other.
    fn chacha8_twin(key: &[u32; 8], stream: u64, first_block: u64, out: &mut [[u64; BLOCKS]; WORDS]) {
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

    #[test]
    fn the_same_words_as_rand_chacha() {
        let key = [1, 2, 3, 0x8000_0000, 5, 6, 7, u32::MAX];
        for (stream, block) in [(0, 0), (7, 1), (u64::MAX, 3), (1 << 40, u64::from(u32::MAX) - 5)] {
            let mut expected = [[0; BLOCKS]; WORDS];
            chacha8_twin(&key, stream, block, &mut expected);
            for isa in Isa::available() {
                let mut words = [[0; BLOCKS]; WORDS];
                chacha8(isa, &key, stream, block, &mut words);
                assert_eq!(words, expected, "{} stream {stream} block {block}", isa.name());
                println!("{:<18} {:<9} the same words", "chacha8", isa.name());
            }
        }
    }
}
