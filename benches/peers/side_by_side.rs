//! One workload of the side-by-side comparison, timed as the peers time theirs: from arrays in memory to the answer.
//!
//! `side_by_side WORKLOAD INPUT OUTPUT REPETITIONS THREADS` prints `BASE megabytes` with the input read, `T seconds` per
//! repetition and `RSS megabytes` at the peak, and writes the answer for the driver (`benches/peers/compare.py`) to check. Input files are those of the peers.

use std::hint::black_box;
use std::io::Read;
use std::time::Instant;

use palpate::fit::{Objective, SlopeWeights};
use palpate::montecarlo::FixedSites;
use palpate::plans::{ImagePlan, SlopeColumns, SlopePlan};
use palpate::spline::CurvatureGrid;
use palpate::spline::Knots;
use palpate::{Contacts, FitOptions, fit_contacts};
use palpate_numeric::bspline::linspace;

type Outcome = Result<(), Box<dyn std::error::Error + Send + Sync>>;

fn main() -> Outcome {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let [workload, input, output, repetitions, threads] = &arguments[..] else {
        println!("side_by_side WORKLOAD INPUT OUTPUT REPETITIONS THREADS (see benches/peers/README.md)");
        return Ok(());
    };
    let numbers = read(input)?;
    println!("BASE {:.1}", peak_megabytes());
    let repetitions: usize = repetitions.parse()?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.parse()?).build()?;
    let answer = pool.install(|| match workload.as_str() {
        "w1" => paper_fit(&numbers, repetitions),
        "w2" => scattered_fit(&numbers, repetitions, 64),
        "w2l" => scattered_fit(&numbers, repetitions, 128),
        "w2_certified" => certified_fit(&numbers, repetitions, 64),
        "w2l_certified" => certified_fit(&numbers, repetitions, 128),
        "w3_cold" => image_fit(&numbers, repetitions, true),
        "w3_reused" => image_fit(&numbers, repetitions, false),
        "w4" => noise_study(&numbers, repetitions),
        "w5" => curvature_map(&numbers, repetitions),
        other => Err(format!("no workload {other}").into()),
    })?;
    std::fs::write(output, answer.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>())?;
    println!("RSS {:.1}", peak_megabytes());
    Ok(())
}

/// By pieces, so that the peak is the numbers' own.
fn read(path: &str) -> Result<Vec<f64>, std::io::Error> {
    let file = std::fs::File::open(path)?;
    let mut numbers = Vec::with_capacity(file.metadata()?.len() as usize / 8);
    let mut input = std::io::BufReader::with_capacity(1 << 16, file);
    let mut word = [0; 8];
    while numbers.len() < numbers.capacity() {
        input.read_exact(&mut word)?;
        numbers.push(f64::from_le_bytes(word));
    }
    Ok(numbers)
}

fn peak_megabytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|l| l.starts_with("VmHWM:")).unwrap_or_default();
    line.split_whitespace().nth(1).and_then(|v| v.parse::<f64>().ok()).unwrap_or(f64::NAN) / 1024.0
}

/// Times `run` after one warm-up; `inner` runs make one repetition.
fn time(repetitions: usize, inner: usize, mut run: impl FnMut() -> Outcome) -> Outcome {
    for k in 0..=repetitions {
        let start = Instant::now();
        for _ in 0..inner {
            run()?;
        }
        if k > 0 {
            println!("T {:.9}", start.elapsed().as_secs_f64() / inner as f64);
        }
    }
    Ok(())
}

fn columns(numbers: &[f64]) -> SlopeColumns<'_> {
    let n = numbers.len() / 5;
    let column = |k: usize| &numbers[k * n..(k + 1) * n];
    SlopeColumns { x: column(0), y: column(1), z: column(2), zx: column(3), zy: column(4) }
}

type Answer = Result<Vec<f64>, Box<dyn std::error::Error + Send + Sync>>;

fn paper_fit(numbers: &[f64], repetitions: usize) -> Answer {
    let knots = [Knots::uniform(2, 1, -4.5, 4.5)?, Knots::uniform(2, 1, -4.5, 4.5)?];
    let points = linspace(-3.5, 3.5, 8);
    let mut plan = SlopePlan::new(knots.clone(), [1.0, 2.0, 2.0])?;
    let mut grid = CurvatureGrid::new(&knots, &points, &points);
    let (mut s, mut r) = ([0.0; 64], [0.0; 64]);
    let mut coefficients = [0.0; 9];
    let mut numbers = numbers.to_vec();
    let mut k = 0;
    time(repetitions, 20_000, || {
        // as the C++ peer: a datum that changes keeps the compiler from lifting the fit out of the loop
        numbers[72 + k % 36] += 1e-18;
        k += 1;
        coefficients.copy_from_slice(plan.fit(&columns(&numbers))?);
        grid.maps(&coefficients, &mut s, &mut r);
        black_box((&coefficients, &s, &r));
        Ok(())
    })?;
    Ok(coefficients.into_iter().chain(s).chain(r).collect())
}

fn scattered_fit(numbers: &[f64], repetitions: usize, segments: usize) -> Answer {
    let knots = [Knots::uniform(3, segments, 0.0, 1.0)?, Knots::uniform(3, segments, 0.0, 1.0)?];
    let mut answer = Vec::new();
    let contacts = columns(numbers);
    time(repetitions, 1, || {
        // the plan is inside the timer, as everything is in the peer's
        let mut plan = SlopePlan::new(knots.clone(), [1.0; 3])?;
        answer = plan.fit(&contacts)?.to_vec();
        Ok(())
    })?;
    Ok(answer)
}

/// The public way: frame, refinement, shape on 100 x 100 points with uncertainty and plane test, certificate.
fn certified_fit(numbers: &[f64], repetitions: usize, segments: usize) -> Answer {
    let SlopeColumns { x, y, z, zx, zy } = columns(numbers);
    let contacts = Contacts::from_positions(x.to_vec(), y.to_vec(), z.to_vec()).with_slopes(zx.to_vec(), zy.to_vec());
    let options = FitOptions::default()
        .with_degree(3)
        .with_segments(segments, segments)
        .with_domain([0.0, 1.0, 0.0, 1.0])
        .with_objective(Objective::Slopes(SlopeWeights::Explicit([1.0; 3])))
        .with_grid(100, 100);
    let mut answer = Vec::new();
    time(repetitions, 1, || {
        let start = Instant::now();
        let fit = fit_contacts(&contacts, &options)?;
        let fitted = start.elapsed();
        let shape = fit.shape();
        let described = start.elapsed();
        let certificate = fit.certificate();
        println!("fit {fitted:.1?}  shape {:.1?}  certificate {:.1?}", described - fitted, start.elapsed() - described);
        black_box((shape, certificate));
        answer = fit.input_surface()?.coefficients().iter().copied().collect();
        Ok(())
    })?;
    Ok(answer)
}

fn image_fit(numbers: &[f64], repetitions: usize, cold: bool) -> Answer {
    let knots = [Knots::uniform(3, 80, 0.0, 1.0)?, Knots::uniform(3, 60, 0.0, 0.75)?];
    let (x, rest) = numbers.split_at(640);
    let (y, images) = rest.split_at(480);
    let (z, rest) = images.split_at(640 * 480);
    let (zx, zy) = rest.split_at(640 * 480);
    let mut plan = ImagePlan::new(knots.clone(), x, y, [1.0; 3])?;
    let mut answer = Vec::new();
    time(repetitions, 1, || {
        if cold {
            plan = ImagePlan::new(knots.clone(), x, y, [1.0; 3])?;
        }
        answer.clear();
        answer.extend_from_slice(plan.fit_frame(z, zx, zy)?);
        Ok(())
    })?;
    Ok(answer)
}

fn noise_study(numbers: &[f64], repetitions: usize) -> Answer {
    let knots = [Knots::uniform(2, 1, -4.5, 4.5)?, Knots::uniform(2, 1, -4.5, 4.5)?];
    let points = linspace(-3.5, 3.5, 8);
    let mut answer = Vec::new();
    let (mut s, mut r) = (vec![0.0; 100_000], vec![0.0; 100_000]);
    time(repetitions, 1, || {
        let sites =
            FixedSites::new(&knots, &columns(numbers), [1.0, 2.0, 2.0], [0.02, 0.05, 0.05], [&points, &points])?;
        sites.replicates(2026, 0, &mut s, &mut r);
        answer = summary(&mut s).into_iter().chain(summary(&mut r)).collect();
        Ok(())
    })?;
    Ok(answer)
}

/// Mean and the 2.5 and 97.5 percentiles, linearly interpolated as NumPy does.
fn summary(values: &mut [f64]) -> [f64; 3] {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let mut percentile = |p: f64| {
        let position = p * (values.len() - 1) as f64;
        let (at, fraction) = (position as usize, position.fract());
        let (_, low, above) = values.select_nth_unstable_by(at, f64::total_cmp);
        let next = above.iter().copied().fold(f64::INFINITY, f64::min);
        *low + fraction * (next - *low)
    };
    [mean, percentile(0.025), percentile(0.975)]
}

fn curvature_map(numbers: &[f64], repetitions: usize) -> Answer {
    let knots = [Knots::uniform(3, 64, 0.0, 1.0)?, Knots::uniform(3, 64, 0.0, 1.0)?];
    let points = linspace(0.0, 1.0, 1000);
    let (mut s, mut r) = (vec![0.0; 1_000_000], vec![0.0; 1_000_000]);
    time(repetitions, 1, || {
        CurvatureGrid::new(&knots, &points, &points).maps(numbers, &mut s, &mut r);
        Ok(())
    })?;
    Ok(s.into_iter().chain(r).collect())
}
