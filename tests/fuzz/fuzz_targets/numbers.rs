//! A mutator for texts of numbers: one number out, another in, the rest left valid. Bytes changed at random break a
//! table or a document long before they make a strange one; a quarter of the mutations still are of that kind.

/// What stands in for a number: ends of ranges, neighbours of them, and what is no number.
const NUMBERS: &[&str] = &[
    "0",
    "-0",
    "1",
    "2",
    "3",
    "5",
    "9",
    "10",
    "-1",
    "0.5",
    "1e-9",
    "-1e9",
    "1e154",
    "1e308",
    "1e309",
    "5e-324",
    "nan",
    "inf",
    "4294967296",
    "18446744073709551616",
    "",
    "[1]",
    "1,1",
];

/// The text with one of its numbers replaced, in place; its new length.
pub fn mutate(data: &mut [u8], size: usize, max_size: usize, seed: u32) -> usize {
    let spans = spans(&data[..size]);
    if seed.is_multiple_of(4) || spans.is_empty() {
        return libfuzzer_sys::fuzzer_mutate(data, size, max_size);
    }
    let [pick, word] = [seed >> 2, seed >> 17].map(|v| v as usize);
    let (start, end) = spans[pick % spans.len()];
    let number = NUMBERS[word % NUMBERS.len()].as_bytes();
    let grown = size - (end - start) + number.len();
    if grown > max_size {
        return size;
    }
    data.copy_within(end..size, start + number.len());
    data[start..start + number.len()].copy_from_slice(number);
    grown
}

/// Where numbers stand, and empty lists, which have room for one.
fn spans(text: &[u8]) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < text.len() {
        let start = at;
        while at < text.len() && (text[at].is_ascii_digit() || (at > start && b".eE-+".contains(&text[at]))) {
            at += 1;
        }
        if at > start {
            found.push((start, at));
        } else {
            if text[at..].starts_with(b"[]") {
                found.push((at + 1, at + 1));
            }
            at += 1;
        }
    }
    found
}
