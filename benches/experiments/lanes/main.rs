//! `lanes own|pulp SET STRIDE ROWS CALLS`: the Gram matrix of rows by palpate's lanes or by pulp's, its bits and its nanoseconds.
//! `lanes faer`: the bits of a QR factor and of eigenvalues by faer, which takes the widest set of pulp that is compiled.
#![allow(dead_code, unused_imports, reason = "the folder of the lanes is taken in whole, and one kernel of it is asked")]

mod gram_rows;
#[path = "../../../src/numeric/simd/mod.rs"]
mod simd;

use std::time::Instant;

use faer::Mat;
use simd::Isa;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match &words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["faer"] => of_faer(),
        [which, set, numbers @ ..] => {
            let [stride, rows, calls] = [0, 1, 2].map(|k: usize| numbers[k].parse().expect("a number"));
            of_kernel(which, set, [stride, rows, calls]);
        }
        _ => eprintln!("lanes own|pulp SET STRIDE ROWS CALLS, lanes faer"),
    }
}

fn of_kernel(which: &str, set: &str, [stride, count, calls]: [usize; 3]) {
    let rows: Vec<f64> = (0..stride * count).map(|r| (r as f64 * 78.233).sin()).collect();
    let mut out = vec![0.5; stride * stride];
    let isa = Isa::available().into_iter().find(|isa| isa.name() == set).expect("a set of this machine");
    let began = Instant::now();
    for _ in 0..calls {
        match which {
            "own" => simd::gram_rows(isa, stride, &rows, &mut out),
            _ => gram_rows::gram_rows(set, stride, &rows, &mut out),
        }
    }
    let each = began.elapsed().as_nanos() / calls.max(1) as u128;
    let lower = (0..stride).flat_map(|i| (0..=i).map(move |j| i * stride + j));
    println!("bits {:016x} ns {each}", hash(lower.map(|k| out[k])));
}

fn of_faer() {
    let matrix = Mat::from_fn(60, 40, |i, j| ((i * 40 + j) as f64 * 78.233).sin());
    let factor = matrix.qr().thin_R().to_owned();
    let values = (matrix.transpose() * &matrix).self_adjoint_eigenvalues(faer::Side::Lower).unwrap_or_default();
    let factor = (0..40).flat_map(|j| (0..=j).map(move |i| (i, j))).map(|(i, j)| factor[(i, j)]);
    println!("qr {:016x} eigenvalues {:016x}", hash(factor), hash(values.into_iter()));
}

fn hash(numbers: impl Iterator<Item = f64>) -> u64 {
    numbers.fold(0, |hash: u64, number| hash.wrapping_mul(0x100_0000_01b3) ^ number.to_bits())
}
