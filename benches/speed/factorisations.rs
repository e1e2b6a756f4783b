//! Our factorisations against faer's on the same matrices: `cargo bench --bench factorisations [-- ratio]`
//!
//! ```text
//! Cholesky   (E'E) c = E'b    ours by patch, dense or band        faer: sparse LL' under AMD, simplicial and supernodal
//! QR         min |E c - b|    ours of the rows, front by front    faer: sparse QR under COLAMD
//!            both to 400 unknowns                                 faer: dense, too; the fastest way of faer's counts
//! ```
//!
//! E holds three rows a contact, eight contacts an unknown, scattered over the unit square. Symbolic work and memory are
//! prepared outside the timer where a library lets one prepare them; factor and solution are timed, on one thread. The
//! ways take turns, and a ratio is the median over the rounds. Solutions that differ end the bench with an error.
//! A ratio above one says that the hand-written code no longer earns its place.

#[path = "../workloads/mod.rs"]
#[allow(dead_code, reason = "other benches use the rest")]
mod workloads;

use std::hint::black_box;
use std::time::Instant;

use criterion::{BenchmarkId, Criterion};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::solvers::{Solve, SolveLstsq};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::solvers::{Qr, SymbolicQr};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Conj, Mat, MatMut, Par, Side};
use palpate_fitting::observation::{ScatteredSites, to_csr};
use palpate_numeric::linalg::{RowWeights, SiteWeights, Sites, StencilMatrix, Targets, assemble, normal_rhs};
use palpate_numeric::solve::{Cholesky, TriangularFactor};
use workloads::{Fault, scattered, square_knots};

/// Degree and segments a side: 9, 81, 400, 1089 and 4489 unknowns.
const SIZES: [(usize, usize); 5] = [(2, 1), (3, 6), (3, 17), (3, 30), (3, 64)];
/// Contacts an unknown.
const CONTACTS: usize = 8;
/// Beyond this many unknowns nobody would use dense factors.
const DENSE: usize = 400;
/// Largest difference of two solutions over the largest coefficient; the normal matrices' condition is below 1e6.
const AGREEMENT: f64 = 1e-9;

/// One way from the prepared problem to its solution.
type Way<'a> = (&'static str, Box<dyn FnMut() -> Result<Vec<f64>, Fault> + 'a>);

struct Problem {
    sites: ScatteredSites,
    row_weights: RowWeights,
    targets: Targets,
    matrix: StencilMatrix,
    right: Vec<f64>,
}

impl Problem {
    fn new(degree: usize, segments: usize) -> Result<Problem, Fault> {
        let knots = square_knots(degree, segments, 0.0, 1.0)?;
        let unknowns = (degree + segments).pow(2);
        let [x, y, z, zx, zy] = scattered(CONTACTS * unknowns).0;
        let sites = ScatteredSites::new(knots, x.into_iter().zip(y).map(|(x, y)| [x, y]).collect());
        let row_weights = RowWeights::Uniform(SiteWeights { z: 1.0, a: 0.1, b: 0.0, d: 0.1 });
        let targets: Targets = (0..z.len()).map(|k| [z[k], 0.1 * zx[k], 0.1 * zy[k]]).collect();
        let mut matrix = StencilMatrix::zeros(sites.shape());
        assemble(&sites, &row_weights, &mut matrix);
        let mut right = vec![0.0; unknowns];
        normal_rhs(&sites, &row_weights, &targets, &mut right);
        Ok(Problem { sites, row_weights, targets, matrix, right })
    }

    fn unknowns(&self) -> usize {
        self.matrix.order()
    }

    /// Lower triangle of the normal matrix.
    fn lower(&self) -> Result<SparseColMat<usize, f64>, Fault> {
        let mut entries = Vec::new();
        self.matrix.for_each_lower(|row, column, position| {
            entries.push(Triplet::new(row.max(column), row.min(column), self.matrix.values()[position]));
        });
        SparseColMat::try_new_from_triplets(self.unknowns(), self.unknowns(), &entries).map_err(words)
    }

    /// The rows E.
    fn rows(&self) -> Result<SparseColMat<usize, f64>, Fault> {
        let csr = to_csr(&self.sites, &self.row_weights);
        let entries: Vec<_> =
            csr.triplet_iter().map(|(row, column, value)| Triplet::new(row, column, *value)).collect();
        SparseColMat::try_new_from_triplets(csr.nrows(), csr.ncols(), &entries).map_err(words)
    }

    fn cholesky_ways(&self) -> Result<Vec<Way<'_>>, Fault> {
        let mut ours = Cholesky::plan(self.matrix.shape())?;
        let mut ways: Vec<Way> = vec![(
            "ours",
            Box::new(move || {
                let mut v = self.right.clone();
                ours.factor_and_solve(&self.matrix, &mut v)?;
                Ok(v)
            }),
        )];
        let kinds = [
            ("faer simplicial", SupernodalThreshold::FORCE_SIMPLICIAL),
            ("faer supernodal", SupernodalThreshold::FORCE_SUPERNODAL),
        ];
        for (name, threshold) in kinds {
            let mut faers = FaerCholesky::plan(self.lower()?, threshold)?;
            ways.push((name, Box::new(move || faers.factor_and_solve(&self.right))));
        }
        if self.unknowns() <= DENSE {
            let dense = self.lower()?.to_dense();
            ways.push((
                "faer dense",
                Box::new(move || {
                    let mut v = Mat::from_fn(self.unknowns(), 1, |i, _| self.right[i]);
                    dense.llt(Side::Lower).map_err(words)?.solve_in_place(v.as_mut());
                    Ok(v.col_as_slice(0).to_vec())
                }),
            ));
        }
        Ok(ways)
    }

    fn qr_ways(&self) -> Result<Vec<Way<'_>>, Fault> {
        let norms_squared = self.matrix.diagonal();
        let ours = move || -> Result<Vec<f64>, Fault> {
            let factor = TriangularFactor::of_rows(&self.sites, &self.row_weights, &self.targets, &norms_squared)?;
            Ok(factor.coefficients())
        };
        let (rows, unknowns) = (self.rows()?, self.unknowns());
        let right = Mat::from_fn(rows.nrows(), 1, |i, _| self.targets[i / 3][i % 3]);
        let mut ways: Vec<Way> = vec![("ours", Box::new(ours))];
        if unknowns <= DENSE {
            let (dense, right) = (rows.to_dense(), right.clone());
            let way = move || Ok(dense.qr().solve_lstsq(&right).col_as_slice(0).to_vec());
            ways.push(("faer dense", Box::new(way)));
        }
        let symbolic = SymbolicQr::try_new(rows.symbolic()).map_err(words)?;
        let way = move || {
            let factor = Qr::try_new_with_symbolic(symbolic.clone(), rows.as_ref()).map_err(words)?;
            let mut v = right.clone();
            factor.solve_lstsq_in_place(v.as_mut());
            Ok(v.col_as_slice(0)[..unknowns].to_vec())
        };
        ways.push(("faer sparse", Box::new(way)));
        Ok(ways)
    }
}

/// faer's sparse LL' with its symbolic part and its memory at hand.
struct FaerCholesky {
    lower: SparseColMat<usize, f64>,
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    memory: MemBuffer,
}

impl FaerCholesky {
    fn plan(lower: SparseColMat<usize, f64>, threshold: SupernodalThreshold) -> Result<FaerCholesky, Fault> {
        let parameters = CholeskySymbolicParams { supernodal_flop_ratio_threshold: threshold, ..Default::default() };
        let symbolic = factorize_symbolic_cholesky(lower.symbolic(), Side::Lower, SymmetricOrdering::Amd, parameters)
            .map_err(words)?;
        let factor = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let memory = MemBuffer::new(factor.or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq)));
        let values = vec![0.0; symbolic.len_val()];
        Ok(FaerCholesky { lower, symbolic, values, memory })
    }

    fn factor_and_solve(&mut self, right: &[f64]) -> Result<Vec<f64>, Fault> {
        self.symbolic
            .factorize_numeric_llt(
                &mut self.values,
                self.lower.as_ref(),
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .map_err(words)?;
        let mut v = right.to_vec();
        let unknowns = v.len();
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut v, unknowns, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
        Ok(v)
    }
}

fn words(error: impl std::fmt::Debug) -> Fault {
    format!("{error:?}").into()
}

/// Largest difference over the largest coefficient.
fn gap(a: &[f64], b: &[f64]) -> f64 {
    let largest = a.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    a.iter().zip(b).fold(0.0_f64, |m, (x, y)| m.max((x - y).abs())) / largest
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Seconds of one call, over as many calls as take a millisecond.
fn seconds(way: &mut Way, calls: usize) -> Result<f64, Fault> {
    let start = Instant::now();
    for _ in 0..calls {
        black_box(way.1()?);
    }
    Ok(start.elapsed().as_secs_f64() / calls as f64)
}

/// Prints one line: every way's median time, and the median ratio of ours to faer's fastest.
fn compare(what: &str, unknowns: usize, mut ways: Vec<Way>) -> Result<(), Fault> {
    const ROUNDS: usize = 15;
    let ours = ways[0].1()?;
    let mut calls = Vec::new();
    for way in &mut ways {
        let found = gap(&ours, &way.1()?);
        if found.is_nan() || found > AGREEMENT {
            return Err(format!("{what}, {unknowns} unknowns: {} differs by {found:e}", way.0).into());
        }
        calls.push((1e-3 / seconds(way, 1)?.max(1e-9)).ceil() as usize);
    }
    let count = ways.len();
    let mut times = vec![Vec::new(); count];
    for round in 0..ROUNDS {
        // another way first in every round
        for k in (0..count).map(|k| (k + round) % count) {
            times[k].push(seconds(&mut ways[k], calls[k])?);
        }
    }
    let medians: Vec<f64> = times.iter().map(|t| median(t.clone())).collect();
    let fastest = (1..ways.len()).min_by(|a, b| medians[*a].total_cmp(&medians[*b])).unwrap_or(0);
    let ratio = median((0..ROUNDS).map(|r| times[0][r] / times[fastest][r]).collect());
    print!("{what:<9} {unknowns:>5} unknowns   ours / {:<16} {ratio:>6.2}  ", ways[fastest].0);
    ways.iter().zip(&medians).for_each(|((name, _), t)| print!("   {name} {:.1} us", t * 1e6));
    println!();
    Ok(())
}

fn ratios() -> Result<(), Fault> {
    for (degree, segments) in SIZES {
        let problem = Problem::new(degree, segments)?;
        compare("Cholesky", problem.unknowns(), problem.cholesky_ways()?)?;
        compare("QR", problem.unknowns(), problem.qr_ways()?)?;
    }
    Ok(())
}

/// The same under criterion, ids `cholesky/ours/81`, `qr/faer sparse/81`.
fn timed(criterion: &mut Criterion) -> Result<(), Fault> {
    for (degree, segments) in SIZES {
        let problem = Problem::new(degree, segments)?;
        for (group, ways) in [("cholesky", problem.cholesky_ways()?), ("qr", problem.qr_ways()?)] {
            let mut group = criterion.benchmark_group(group);
            group.sample_size(20);
            for (name, mut way) in ways {
                group.bench_function(BenchmarkId::new(name, problem.unknowns()), |b| b.iter(&mut way));
            }
            group.finish();
        }
    }
    Ok(())
}

fn main() -> Result<(), Fault> {
    faer::set_global_parallelism(Par::Seq);
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let argued = |word: &str| std::env::args().any(|argument| argument.contains(word));
    // a criterion filter, or nothing: the ratios first
    if argued("ratio") || !std::env::args().skip(1).any(|argument| argument.contains('/')) {
        ratios()?;
    }
    if argued("ratio") {
        return Ok(());
    }
    let mut criterion = Criterion::default().configure_from_args();
    timed(&mut criterion)?;
    criterion.final_summary();
    Ok(())
}
