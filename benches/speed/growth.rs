//! How cost grows, how long a frame and a touch take: `cargo bench --bench growth`.
//!
//! ```text
//! contacts 1e5 .. 1e7 under 64 x 64 segments        unknowns 35^2 .. 515^2 with 38 contacts each (512 segments: 1e7)
//! ```
//!
//! Contacts are made and taken in a million at a time, none is kept. Times are of palpate alone, the best of
//! the repetitions that fit; exponents are slopes of straight lines through the logarithms. Peak memory is that of a
//! process of its own for every row (`growth --one SEGMENTS CONTACTS`).

#[path = "../workloads/mod.rs"]
#[allow(dead_code, reason = "other benches use the rest")]
mod workloads;

use std::process::Command;
use std::time::{Duration, Instant};

use palpate::plans::{ImagePlan, SlopePlan, TouchStream};
use workloads::{Fault, image, image_knots, paper_points, pool, scattered_from, square_knots};

/// Contacts taken in at once. Every piece costs each cell it touches a microsecond, however few its contacts.
const PIECE: usize = 1_000_000;

fn main() -> Result<(), Fault> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    if let [flag, segments, contacts] = &arguments[..]
        && flag == "--one"
    {
        return one(segments.parse()?, contacts.parse()?);
    }
    println!("64 x 64 segments, one thread");
    table(&[(64, 100_000), (64, 300_000), (64, 1_000_000), (64, 3_000_000), (64, 10_000_000)], |row| row.contacts)?;
    println!("\ncontacts in proportion to unknowns, one thread");
    table(&[(32, 46_000), (64, 170_000), (128, 650_000), (256, 2_540_000), (512, 10_000_000)], |row| row.unknowns)?;
    frames()?;
    touches()
}

/// One measured fit.
struct Row {
    contacts: f64,
    unknowns: f64,
    adding: f64,
    solving: f64,
    megabytes: f64,
}

fn table(sizes: &[(usize, usize)], against: impl Fn(&Row) -> f64) -> Result<(), Fault> {
    println!("| segments | contacts | taking in | ns a contact | solving | peak memory |\n|---|---|---|---|---|---|");
    let mut rows = Vec::new();
    for &(segments, contacts) in sizes {
        let said = Command::new(std::env::current_exe()?)
            .args(["--one", &segments.to_string(), &contacts.to_string()])
            .output()?;
        let text = String::from_utf8(said.stdout)?;
        let numbers: Vec<f64> = text.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
        let [adding, solving, megabytes] = numbers[..] else {
            return Err(format!("no answer: {text}{}", String::from_utf8_lossy(&said.stderr)).into());
        };
        println!(
            "| {segments} | {contacts} | {:.1} ms | {:.1} | {:.1} ms | {megabytes:.0} MB |",
            1e3 * adding,
            1e9 * adding / contacts as f64,
            1e3 * solving
        );
        let unknowns = ((segments + 3) * (segments + 3)) as f64;
        rows.push(Row { contacts: contacts as f64, unknowns, adding, solving, megabytes });
    }
    let exponent = |value: &dyn Fn(&Row) -> f64| {
        let points: Vec<[f64; 2]> = rows.iter().map(|row| [against(row).ln(), value(row).ln()]).collect();
        slope(&points)
    };
    println!(
        "exponents: taking in {:.2}, solving {:.2}, memory {:.2}",
        exponent(&|row| row.adding),
        exponent(&|row| row.solving),
        exponent(&|row| row.megabytes)
    );
    Ok(())
}

fn slope(points: &[[f64; 2]]) -> f64 {
    let n = points.len() as f64;
    let [mx, my] = [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / n);
    let (xy, xx) =
        points.iter().fold((0.0, 0.0), |(xy, xx), p| (xy + (p[0] - mx) * (p[1] - my), xx + (p[0] - mx) * (p[0] - mx)));
    xy / xx
}

/// Prints seconds of taking in, seconds of solving, peak megabytes.
fn one(segments: usize, contacts: usize) -> Result<(), Fault> {
    let mut plan = SlopePlan::new(square_knots(3, segments, 0.0, 1.0)?, [1.0; 3])?;
    let (mut adding, mut solving) = (Duration::MAX, Duration::MAX);
    let repetitions = if contacts > 2_000_000 { 1 } else { 3 };
    for _ in 0..repetitions {
        plan.clear();
        let (took, solved) = pool(1)?.install(|| -> Result<_, Fault> {
            let mut took = Duration::ZERO;
            for first in (0..contacts).step_by(PIECE) {
                let piece = scattered_from(first, PIECE.min(contacts - first));
                let start = Instant::now();
                plan.add(&piece.view())?;
                took += start.elapsed();
            }
            let start = Instant::now();
            plan.solve()?;
            Ok((took, start.elapsed()))
        })?;
        (adding, solving) = (adding.min(took), solving.min(solved));
    }
    println!("{} {} {}", adding.as_secs_f64(), solving.as_secs_f64(), peak_megabytes());
    Ok(())
}

fn peak_megabytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|l| l.starts_with("VmHWM:")).unwrap_or_default();
    line.split_whitespace().nth(1).and_then(|v| v.parse::<f64>().ok()).unwrap_or(f64::NAN) / 1024.0
}

/// 640 x 480 frames through one plan.
fn frames() -> Result<(), Fault> {
    let ([x, y], [z, zx, zy]) = image();
    let mut plan = ImagePlan::new(image_knots()?, &x, &y, [1.0; 3])?;
    let mut times = quantiles(200, || {
        plan.fit_frame(&z, &zx, &zy)?;
        Ok(())
    })?;
    times.sort_unstable();
    let median = times[times.len() / 2].as_secs_f64();
    println!("\n640 x 480 stream: median {:.2} ms, {:.0} frames a second", 1e3 * median, 1.0 / median);
    Ok(())
}

/// A touch taken in and the shape with its uncertainty given out, one patch after another of 40 touches.
fn touches() -> Result<(), Fault> {
    let (columns, points) = (workloads::paper(false), paper_points());
    let knots = square_knots(2, 1, -4.5, 4.5)?;
    let mut stream = TouchStream::new(knots, [0.02, 0.05, 0.05], [&points, &points])?;
    let [x, y, z, zx, zy] = &columns.0;
    let touch = |stream: &mut TouchStream, r: usize| stream.push([x[r], y[r]], z[r], [zx[r], zy[r]]);
    (0..36).try_for_each(|r| touch(&mut stream, r))?;
    let mut r = 0;
    let mut times = quantiles(100_000, || {
        r = (r + 1) % 36;
        touch(&mut stream, r)?;
        std::hint::black_box(stream.shape()?);
        Ok(())
    })?;
    times.sort_unstable();
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize].as_secs_f64() * 1e6;
    println!(
        "push and shape, S and R on 8 x 8 with uncertainties: median {:.1} us, p99 {:.1} us, p99.9 {:.1} us",
        at(0.5),
        at(0.99),
        at(0.999)
    );
    Ok(())
}

fn quantiles(count: usize, mut run: impl FnMut() -> Result<(), Fault>) -> Result<Vec<Duration>, Fault> {
    (0..count)
        .map(|_| {
            let start = Instant::now();
            run()?;
            Ok(start.elapsed())
        })
        .collect()
}
