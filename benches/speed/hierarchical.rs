//! Adaptive fits over hierarchical splines: `cargo bench --bench hierarchical [-- WORD]`.
//!
//! ```text
//! table      1e4 .. 1e7 contacts of one smooth surface with 0, 10 and 1,000 bumps: time, memory, unknowns, error, factor's share
//! false      cells split where the surface is in the span of the base grid
//! coverage   how often height and R +- 1.96 u hold the truth, near bumps and far from them
//! orders     nonzeros and seconds of the factor by minimum degree and by nested dissection; `orders FOLDER` writes the matrices there
//! gradients  the same fit by the factor and by conjugate gradients: time, memory of the factors, difference, also of uncertainties
//! stream     N contacts with 1,000 bumps that come in pieces and are never in memory at once: time, memory, the bits of the fit in memory
//! evaluate   nanoseconds a point with two derivatives, beside the tensor spline with the cells of the finest level
//! ```
//!
//! Every row of the table is a process of its own, which says its peak memory. Contacts are made before the clock starts.

use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

use palpate_fitting::observation::RoughnessOrder;
use palpate_geometry::contact::Contacts;
use palpate_geometry::curvature::Derivatives;
use palpate_geometry::surface::{HeightField, Surface};
use palpate_hierarchical::adaptive::tiles::fit_spooled;
use palpate_hierarchical::adaptive::{AdaptiveFit, AdaptiveOptions, fit_adaptive};
use palpate_hierarchical::equations::MeetingPattern;
use palpate_hierarchical::factor::{EliminationOrder, SparseCholesky};
use palpate_hierarchical::field::HierarchicalField;
use palpate_hierarchical::mesh::{CellId, Mesh};
use palpate_hierarchical::space::HierarchicalSpace;
use palpate_numeric::bspline::Knots;
use palpate_numeric::draws::Lcg;

type Fault = Box<dyn std::error::Error>;

/// Standard deviation of a height.
const NOISE: f64 = 0.002;

fn main() -> Result<(), Fault> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["--one", contacts, features] => one(contacts.parse()?, features.parse()?),
        ["table", most] => table(most.parse()?),
        ["false"] => false_splits(),
        ["coverage"] => coverage(),
        ["evaluate"] => evaluate(),
        ["orders"] => orders(None),
        ["orders", folder] => orders(Some(Path::new(folder))),
        ["gradients"] => gradients(),
        ["stream"] => stream(10_000_000, true),
        ["stream", contacts] => stream(contacts.parse()?, false),
        [] | ["table"] => table(10_000_000),
        _ => Err("table [MOST], false, coverage, evaluate, orders [FOLDER], gradients, stream [CONTACTS]".into()),
    }
}

/// A smooth surface over [-1, 1]^2 with bumps and dimples of 3 to 10 standard deviations at random places.
struct Scene {
    features: Vec<[f64; 3]>,
    radius: f64,
    /// Features by the squares of a grid, so that a height asks only those nearby.
    grid: Vec<Vec<u32>>,
}

const GRID: usize = 64;

impl Scene {
    fn new(count: usize, seed: u64) -> Scene {
        let mut draw = Lcg::new(seed);
        let radius = if count > 100 { 0.01 } else { 0.02 };
        let mut features: Vec<[f64; 3]> = Vec::new();
        while features.len() < count {
            let [x, y] = [0, 1].map(|_| 1.9 * draw.uniform() - 0.95);
            let apart = |f: &[f64; 3]| (f[0] - x).hypot(f[1] - y) > 3.0 * radius;
            if features.iter().all(apart) {
                let sign = if draw.uniform() < 0.5 { -1.0 } else { 1.0 };
                features.push([x, y, sign * NOISE * (3.0 + 7.0 * draw.uniform())]);
            }
        }
        let mut grid = vec![Vec::new(); GRID * GRID];
        let square = |t: f64| (((t + 1.0) * 0.5 * GRID as f64) as usize).min(GRID - 1);
        for (k, [x, y, _]) in features.iter().enumerate() {
            let reach = 6.0 * radius;
            for i in square(x - reach)..=square(x + reach) {
                (square(y - reach)..=square(y + reach)).for_each(|j| grid[i * GRID + j].push(k as u32));
            }
        }
        Scene { features, radius, grid }
    }

    fn height(&self, x: f64, y: f64) -> f64 {
        let square = |t: f64| (((t + 1.0) * 0.5 * GRID as f64) as usize).min(GRID - 1);
        let near = self.grid[square(x) * GRID + square(y)].iter().map(|k| self.features[*k as usize]);
        let bumps: f64 =
            near.map(|[u, v, h]| h * (-((x - u).powi(2) + (y - v).powi(2)) / self.radius.powi(2)).exp()).sum();
        0.3 * (1.5 * x).sin() * (1.2 * y + 0.3).cos() + bumps
    }

    fn touched(&self, count: usize, seed: u64) -> Contacts {
        self.touched_by(count, &mut Lcg::new(seed))
    }

    fn touched_by(&self, count: usize, draw: &mut Lcg) -> Contacts {
        let mut columns = [0, 1, 2].map(|_| Vec::with_capacity(count));
        for _ in 0..count {
            let [x, y] = [0, 1].map(|_| 2.0 * draw.uniform() - 1.0);
            let z = self.height(x, y) + NOISE * draw.normal();
            [x, y, z].into_iter().zip(&mut columns).for_each(|(v, column)| column.push(v));
        }
        let [x, y, z] = columns;
        Contacts::from_positions(x, y, z)
    }

    /// R of the true surface, by differences.
    fn curvedness(&self, x: f64, y: f64) -> Option<f64> {
        let step = 1e-4;
        let z = |i: f64, j: f64| self.height(x + i * step, y + j * step);
        let middle = z(0.0, 0.0);
        let second = |a: f64, b: f64| (a - 2.0 * middle + b) / (step * step);
        let mixed = (z(1.0, 1.0) - z(1.0, -1.0) - z(-1.0, 1.0) + z(-1.0, -1.0)) / (4.0 * step * step);
        let slope = |a: f64, b: f64| (a - b) / (2.0 * step);
        let (along, across) = (slope(z(1.0, 0.0), z(-1.0, 0.0)), slope(z(0.0, 1.0), z(0.0, -1.0)));
        let bent = [second(z(1.0, 0.0), z(-1.0, 0.0)), second(z(0.0, 1.0), z(0.0, -1.0))];
        Some(Derivatives::of_height(along, across, bent[0], mixed, bent[1]).principal()?.curvedness())
    }

    /// Features of which more than half stands in the fit.
    fn found(&self, fit: &AdaptiveFit) -> usize {
        let stands = |f: &&[f64; 3]| (fit.at(f[0], f[1]).z - self.height(f[0], f[1])).abs() < 0.5 * f[2].abs();
        self.features.iter().filter(stands).count()
    }
}

/// Peak memory of this process so far, megabytes.
fn peak() -> Result<f64, Fault> {
    let text = std::fs::read_to_string("/proc/self/status")?;
    let line = text.lines().find(|line| line.starts_with("VmHWM")).ok_or("no peak memory")?;
    let kilobytes: f64 = line.split_whitespace().nth(1).ok_or("no peak memory")?.parse()?;
    Ok(kilobytes / 1024.0)
}

/// Root mean square of the error over random places.
fn error(scene: &Scene, fit: &AdaptiveFit) -> f64 {
    let mut draw = Lcg::new(99);
    let places = 20_000;
    let square = |_| {
        let [x, y] = [0, 1].map(|_| 2.0 * draw.uniform() - 1.0);
        (fit.at(x, y).z - scene.height(x, y)).powi(2)
    };
    ((0..places).map(square).sum::<f64>() / f64::from(places)).sqrt()
}

fn one(contacts: usize, features: usize) -> Result<(), Fault> {
    let scene = Scene::new(features, 7);
    let touched = scene.touched(contacts, 8);
    let before = peak()?;
    let begun = Instant::now();
    let fit = fit_adaptive(&touched, &AdaptiveOptions { uncertainty: false, ..AdaptiveOptions::default() })?;
    let seconds = begun.elapsed().as_secs_f64();
    let report = fit.report();
    let work = &report.work;
    let last = report.rounds.last().ok_or("no round")?;
    println!(
        "| {contacts} | {features} | {seconds:.2} | {:.0} | {:.0} | {} | {} | {} | {:.3} | {:.3} | {:.4} | {} | {:.2} {:.2} {:.2} {:.2} | {} |",
        before,
        peak()?,
        last.unknowns,
        last.cells,
        report.rounds.len(),
        fit.height_noise() / NOISE,
        report.rms / NOISE,
        error(&scene, &fit) / NOISE,
        scene.found(&fit),
        work.sorting.as_secs_f64(),
        work.passes.as_secs_f64(),
        work.assembly.as_secs_f64(),
        work.factorisation.as_secs_f64(),
        report.outliers.len(),
    );
    println!("seconds {seconds}");
    Ok(())
}

fn table(most: usize) -> Result<(), Fault> {
    println!(
        "| contacts | features | seconds | MB of contacts | MB at most | unknowns | cells | rounds | sigma found/true | rms/sigma | error/sigma | found | \
         sort, passes, assembly, factor s | left out |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
    );
    for features in [0, 10, 1000] {
        let mut points = Vec::new();
        for contacts in [10_000, 100_000, 1_000_000, 10_000_000].into_iter().filter(|n| *n <= most) {
            let said = Command::new(std::env::current_exe()?)
                .args(["--one", &contacts.to_string(), &features.to_string()])
                .output()?;
            let text = String::from_utf8(said.stdout)?;
            let Some((row, seconds)) = text.split_once("seconds ") else {
                return Err(format!("no answer: {}", String::from_utf8_lossy(&said.stderr)).into());
            };
            print!("{row}");
            points.push([(contacts as f64).ln(), seconds.trim().parse::<f64>()?.ln()]);
        }
        println!("growth exponent with {features} features: {:.2}", slope(&points));
    }
    Ok(())
}

/// Slope of the straight line through the points.
fn slope(points: &[[f64; 2]]) -> f64 {
    let n = points.len() as f64;
    let [mx, my] = [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / n);
    let sum = |f: &dyn Fn(&[f64; 2]) -> f64| points.iter().map(f).sum::<f64>();
    sum(&|p| (p[0] - mx) * (p[1] - my)) / sum(&|p| (p[0] - mx).powi(2))
}

/// A cubic surface: whatever is split is split by chance.
fn false_splits() -> Result<(), Fault> {
    println!("| contacts | base segments | fits | cells | split by chance |\n|---|---|---|---|---|");
    for (contacts, segments, fits) in [(20_000, 8, 200), (200_000, 32, 40), (1_000_000, 64, 10), (100_000, 64, 40)] {
        let (mut cells, mut split) = (0, 0);
        for seed in 0..fits {
            let mut draw = Lcg::new(1000 + seed);
            let mut columns = [0, 1, 2].map(|_| Vec::with_capacity(contacts));
            for _ in 0..contacts {
                let [x, y] = [0, 1].map(|_| 2.0 * draw.uniform() - 1.0);
                let z = 0.3 * x.powi(3) - 0.2 * x * y * y + 0.1 * y + NOISE * draw.normal();
                [x, y, z].into_iter().zip(&mut columns).for_each(|(v, column)| column.push(v));
            }
            let [x, y, z] = columns;
            let options = AdaptiveOptions { base_segments: segments, uncertainty: false, ..AdaptiveOptions::default() };
            let fit = fit_adaptive(&Contacts::from_positions(x, y, z), &options)?;
            cells += fit.report().rounds[0].cells;
            split += fit.report().rounds.iter().map(|round| round.split).sum::<usize>();
        }
        println!(
            "| {contacts} | {segments} | {fits} | {cells} | {split} ({:.3} %) |",
            100.0 * split as f64 / cells as f64
        );
    }
    Ok(())
}

/// Intervals that held the truth.
#[derive(Clone, Copy, Default)]
struct Held {
    heights: usize,
    curvedness: usize,
    places: usize,
}

impl Held {
    fn look(&mut self, scene: &Scene, fit: &AdaptiveFit, [x, y]: [f64; 2]) -> Result<(), Fault> {
        let sds = fit.point_sds([x, y]).ok_or("no uncertainty")?;
        let height = fit.height_sd(x, y).ok_or("no uncertainty")?;
        let curvedness = fit.at(x, y).derivatives().principal().ok_or("no tangent plane")?.curvedness();
        let off = curvedness - scene.curvedness(x, y).ok_or("no tangent plane")?;
        self.places += 1;
        self.heights += usize::from((fit.at(x, y).z - scene.height(x, y)).abs() <= 1.96 * height);
        self.curvedness += usize::from(off.abs() <= 1.96 * sds.curvedness.unwrap_or(0.0));
        Ok(())
    }

    fn shares(&self) -> String {
        let share = |held: usize| 100.0 * held as f64 / self.places as f64;
        format!("{:.1} %, {:.1} %", share(self.heights), share(self.curvedness))
    }
}

/// Places near a feature lie within two radii of one.
fn coverage() -> Result<(), Fault> {
    println!(
        "| one halving more | contacts | features | z, R held far | z, R held near | places far, near | seconds for the inverse |\n|---|---|---|---|---|---|---|"
    );
    let cases = [(50_000, 10, 20), (500_000, 10, 6), (2_000_000, 1000, 1)];
    for (last_halving, (contacts, features, scenes)) in
        [false, true].into_iter().flat_map(|k| cases.map(|case| (k, case)))
    {
        let mut held = [Held::default(); 2];
        let mut seconds = 0.0;
        for k in 0..scenes {
            let scene = Scene::new(features, 70 + k);
            let options = AdaptiveOptions { last_halving, ..AdaptiveOptions::default() };
            let fit = fit_adaptive(&scene.touched(contacts, 170 + k), &options)?;
            seconds += fit.report().work.inverse.as_secs_f64();
            let mut draw = Lcg::new(270 + k);
            let mut places: Vec<[f64; 2]> = (0..2000).map(|_| [0, 1].map(|_| 2.0 * draw.uniform() - 1.0)).collect();
            for f in &scene.features {
                places.extend((0..2000 / features).map(|_| {
                    let (r, t) = (2.0 * scene.radius * draw.uniform().sqrt(), std::f64::consts::TAU * draw.uniform());
                    [f[0] + r * t.cos(), f[1] + r * t.sin()].map(|v| v.clamp(-1.0, 1.0))
                }));
            }
            for [x, y] in places {
                let near = scene.features.iter().any(|f| (f[0] - x).hypot(f[1] - y) < 2.0 * scene.radius);
                held[usize::from(near)].look(&scene, &fit, [x, y])?;
            }
        }
        let [far, near] = held;
        println!(
            "| {last_halving} | {contacts} | {features} | {} | {} | {}, {} | {:.2} |",
            far.shares(),
            near.shares(),
            far.places,
            near.places,
            seconds / scenes as f64
        );
    }
    Ok(())
}

/// One level, and six levels about a spot, against tensor splines.
fn evaluate() -> Result<(), Fault> {
    let mut draw = Lcg::new(5);
    let places: Vec<[f64; 2]> = (0..1_000_000).map(|_| [0, 1].map(|_| 2.0 * draw.uniform() - 1.0)).collect();
    println!("| surface | cells | ns a point |\n|---|---|---|");
    let timed = |name: &str, cells: usize, surface: &dyn Fn(f64, f64) -> f64| {
        let best = (0..5).map(|_| {
            let begun = Instant::now();
            std::hint::black_box(places.iter().map(|[x, y]| surface(*x, *y)).sum::<f64>());
            begun.elapsed().as_secs_f64()
        });
        println!("| {name} | {cells} | {:.0} |", 1e9 * best.fold(f64::INFINITY, f64::min) / places.len() as f64);
    };
    for segments in [64, 512] {
        let knots = || Knots::uniform(3, segments, -1.0, 1.0);
        let count = (segments + 3) * (segments + 3);
        let tensor = HeightField::new([knots()?, knots()?], vec![0.5; count])?;
        timed("tensor spline", segments * segments, &|x, y| tensor.jet([x, y]).derivatives.uu[2]);
    }
    for levels in [0, 6] {
        let mut mesh = Mesh::new([Knots::uniform(3, 64, -1.0, 1.0)?, Knots::uniform(3, 64, -1.0, 1.0)?])?;
        (0..levels).try_for_each(|level| mesh.refine(CellId { level, place: [20 << level, 33 << level] }))?;
        let space = Arc::new(HierarchicalSpace::new(mesh));
        let (cells, ones) = (space.leaves().len(), vec![0.5; space.unknowns()]);
        let field = HierarchicalField::new(space, ones)?;
        timed(&format!("hierarchical, {levels} levels more"), cells, &|x, y| field.jet([x, y]).derivatives.uu[2]);
    }
    Ok(())
}

/// Contacts of a piece, and of a tile at most.
const PIECE: usize = 1_000_000;
const TILE: usize = 1_000_000;

/// Contacts drawn piece by piece.
fn stream(contacts: usize, compared: bool) -> Result<(), Fault> {
    let scene = Scene::new(1000, 7);
    let options = AdaptiveOptions { uncertainty: false, ..AdaptiveOptions::default() };
    let mut draw = Lcg::new(8);
    let pieces =
        (0..contacts.div_ceil(PIECE)).map(|k| Ok(scene.touched_by(PIECE.min(contacts - k * PIECE), &mut draw)));
    let folder = std::env::temp_dir().join(format!("palpate-stream-{}", std::process::id()));
    let begun = Instant::now();
    let fit = fit_spooled(pieces, &options, &folder, TILE)?;
    let (seconds, memory) = (begun.elapsed().as_secs_f64(), peak()?);
    println!(
        "| contacts | MB of contacts | seconds, drawing included | MB at most | unknowns | sigma found/true | error/sigma | found |\n|---|---|---|---|---|---|---|---|"
    );
    println!(
        "| {contacts} | {:.0} | {seconds:.1} | {memory:.0} | {} | {:.3} | {:.4} | {} |",
        24e-6 * contacts as f64,
        fit.unknowns(),
        fit.height_noise() / NOISE,
        error(&scene, &fit) / NOISE,
        scene.found(&fit),
    );
    if compared {
        let whole = fit_adaptive(&scene.touched(contacts, 8), &options)?;
        let bits = |fit: &AdaptiveFit| fit.field().coefficients().iter().map(|c| c.to_bits()).collect::<Vec<u64>>();
        println!("the bits of the fit in memory: {}", bits(&fit) == bits(&whole));
    }
    Ok(())
}

/// Matrices of fits, and of tensor grids.
fn orders(folder: Option<&Path>) -> Result<(), Fault> {
    println!(
        "| matrix | unknowns | entries of A | order | numbers in the factor | products | plan s | factor s | solve ms |\n|---|---|---|---|---|---|---|---|---|"
    );
    for segments in [64, 256] {
        let knots = || Knots::uniform(3, segments, -1.0, 1.0);
        order_of(&format!("grid-{segments}"), &HierarchicalSpace::new(Mesh::new([knots()?, knots()?])?), folder)?;
    }
    for (contacts, features) in [(1_000_000, 10), (1_000_000, 1000), (10_000_000, 1000)] {
        let options = AdaptiveOptions { uncertainty: false, ..AdaptiveOptions::default() };
        let fit = fit_adaptive(&Scene::new(features, 7).touched(contacts, 8), &options)?;
        order_of(&format!("fit-{contacts}-{features}"), fit.field().space(), folder)?;
    }
    Ok(())
}

/// Roughness of the space, and every diagonal entry doubled: the pattern of its normal equations.
fn order_of(name: &str, space: &HierarchicalSpace, folder: Option<&Path>) -> Result<(), Fault> {
    let pattern = MeetingPattern::of(space);
    let mut values = vec![0.0; pattern.rows().len()];
    pattern.roughness(space, RoughnessOrder::Second).iter().for_each(|level| level.add_to(1.0, &mut values));
    pattern.starts()[1..].iter().for_each(|end| values[end - 1] *= 2.0);
    if let Some(folder) = folder {
        let mut text = format!("{} {}\n", pattern.order(), values.len());
        for column in 0..pattern.order() {
            for at in pattern.starts()[column]..pattern.starts()[column + 1] {
                text.push_str(&format!("{} {column} {:e}\n", pattern.rows()[at], values[at]));
            }
        }
        std::fs::write(folder.join(format!("{name}.txt")), text)?;
    }
    let places = space.places();
    let orders = [
        ("minimum degree", EliminationOrder::MinimumDegree),
        ("dissection", EliminationOrder::NestedDissection(&places)),
    ];
    for (order, by) in orders {
        let begun = Instant::now();
        let mut factor = SparseCholesky::plan(pattern.starts(), pattern.rows(), by)?;
        let planned = begun.elapsed().as_secs_f64();
        let mut best = [f64::INFINITY; 2];
        for _ in 0..5 {
            let begun = Instant::now();
            factor.factor(&values)?;
            let factored = begun.elapsed().as_secs_f64();
            let mut v = vec![1.0; pattern.order()];
            factor.solve(&mut v);
            best = [best[0].min(factored), best[1].min(begun.elapsed().as_secs_f64() - factored)];
        }
        println!(
            "| {name} | {} | {} | {order} | {} | {:.2e} | {planned:.3} | {:.3} | {:.1} |",
            pattern.order(),
            values.len(),
            factor.factor_entries(),
            factor.multiply_adds(),
            best[0],
            1e3 * best[1],
        );
    }
    Ok(())
}

/// The factor of the whole, and conjugate gradients where it would have more than a tenth of a million numbers.
/// How far standard uncertainties of one fit are off those of another, root mean square shares of z and of R.
fn sds_apart(fit: &AdaptiveFit, whole: &AdaptiveFit) -> String {
    let mut draw = Lcg::new(98);
    let mut squares = [0.0; 2];
    let mut places = 0.0;
    for _ in 0..20_000 {
        let at = [0, 1].map(|_| 2.0 * draw.uniform() - 1.0);
        let Some((one, other)) = fit.point_sds(at).zip(whole.point_sds(at)) else { continue };
        let Some((r, r_of_other)) = one.curvedness.zip(other.curvedness) else { continue };
        let ratios = [one.position / other.position, r / r_of_other];
        squares.iter_mut().zip(ratios).for_each(|(sum, ratio)| *sum += (ratio - 1.0).powi(2));
        places += 1.0;
    }
    let [z, r] = squares.map(|sum: f64| 100.0 * (sum / places).sqrt());
    format!("{z:.2} %, {r:.2} %")
}

fn gradients() -> Result<(), Fault> {
    println!(
        "| contacts | features | by | seconds | of them factors and solutions | unknowns | numbers in factors | backward error | \
         off the other, sigma | uncertainties off, told | of z, of R off the other |\n|---|---|---|---|---|---|---|---|---|---|---|"
    );
    for (contacts, features) in [(100_000, 1000), (1_000_000, 1000)] {
        let touched = Scene::new(features, 7).touched(contacts, 8);
        let mut fits: Vec<AdaptiveFit> = Vec::new();
        for (by, most_factor_entries) in [("factor", usize::MAX), ("gradients", 100_000)] {
            let options = AdaptiveOptions { most_factor_entries, ..AdaptiveOptions::default() };
            let begun = Instant::now();
            let fit = fit_adaptive(&touched, &options)?;
            let seconds = begun.elapsed().as_secs_f64();
            let report = fit.report();
            let mut draw = Lcg::new(99);
            let off = fits.first().map(|whole: &AdaptiveFit| {
                let square = |_| {
                    let [x, y] = [0, 1].map(|_| 2.0 * draw.uniform() - 1.0);
                    (fit.at(x, y).z - whole.at(x, y).z).powi(2)
                };
                ((0..20_000).map(square).sum::<f64>() / 20_000.0).sqrt() / NOISE
            });
            println!(
                "| {contacts} | {features} | {by} | {seconds:.1} | {:.1} | {} | {} | {:.1e} | {} | {} | {} |",
                (report.work.factorisation + report.work.inverse).as_secs_f64(),
                fit.unknowns(),
                report.factor_entries,
                report.backward_error.unwrap_or(f64::NAN),
                off.map_or(String::new(), |off| format!("{off:.4}")),
                report.draws_error.map_or(String::new(), |share| format!("{:.2} %", 100.0 * share)),
                fits.first().map_or(String::new(), |whole| sds_apart(&fit, whole)),
            );
            fits.push(fit);
        }
    }
    Ok(())
}
