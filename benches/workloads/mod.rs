//! Inputs of the five workloads, made here so that a bench needs no file: the surfaces of `peers/inputs.py`, other noise.
//!
//! ```text
//! W1  36 contacts of a cylinder, radius 6.6, axis at 30 degrees       W4  their noise-free data
//! W2  z = 0.3 sin 6x cos 5y + 0.1 xy on [0, 1]^2, 200,000 contacts, 64 x 64 segments   (W2L: 1,000,000, 128 x 128)
//! W3  the same on 640 x 480 pixels                                    W5  its coefficients, 64 x 64 segments
//! ```

use palpate::plans::SlopeColumns;
use palpate::spline::Knots;
use palpate_numeric::bspline::linspace;
use palpate_numeric::draws::EffectDraws;

/// Any error of a bench.
pub(crate) type Fault = Box<dyn std::error::Error + Send + Sync>;

/// Columns x, y, z, zx, zy of one length.
#[derive(Clone, Debug, Default)]
pub(crate) struct Columns(pub [Vec<f64>; 5]);

impl Columns {
    /// The view that a plan takes.
    pub(crate) fn view(&self) -> SlopeColumns<'_> {
        let [x, y, z, zx, zy] = &self.0;
        SlopeColumns { x, y, z, zx, zy }
    }
}

/// `(z, zx, zy)` of the wave.
fn wave(x: f64, y: f64) -> [f64; 3] {
    let ([sx, cx], [sy, cy]) = ([(6.0 * x).sin(), (6.0 * x).cos()], [(5.0 * y).sin(), (5.0 * y).cos()]);
    [0.3 * sx * cy + 0.1 * x * y, 1.8 * cx * cy + 0.1 * y, -1.5 * sx * sy + 0.1 * x]
}

/// `(z, zx, zy)` of the cylinder, apex at z = 0.
fn cylinder(x: f64, y: f64) -> [f64; 3] {
    let (sin, cos) = 30.0_f64.to_radians().sin_cos();
    let u = -x * sin + y * cos;
    let depth = (6.6 * 6.6 - u * u).sqrt();
    [depth - 6.6, u / depth * sin, -u / depth * cos]
}

fn noisy(exact: [f64; 3], sd: [f64; 3], draws: &EffectDraws, contact: u64) -> [f64; 3] {
    let mut drawn = [0.0; 4];
    draws.gaussians(contact, 0, 4, &mut drawn);
    [0, 1, 2].map(|k| exact[k] + sd[k] * drawn[k])
}

fn columns(rows: impl Iterator<Item = [f64; 5]>) -> Columns {
    let mut made = Columns::default();
    for row in rows {
        made.0.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
    }
    made
}

/// W1, or with `exact` W4: three fingers at six stations, each touched twice, sites off by 0.1.
pub(crate) fn paper(exact: bool) -> Columns {
    let draws = EffectDraws::new(2026, "paper");
    let sd = if exact { [0.0; 3] } else { [0.02, 0.05, 0.05] };
    columns((0..36).map(|r| {
        let mut off = [0.0; 2];
        draws.gaussians(1000 + r, 0, 2, &mut off);
        let station = (r % 12 / 2) as f64;
        let (x, y) = ((r / 12) as f64 * 4.0 - 4.0 + 0.1 * off[0], station * 1.6 - 4.0 + 0.1 * off[1]);
        let [z, zx, zy] = noisy(cylinder(x, y), sd, &draws, r);
        [x, y, z, zx, zy]
    }))
}

/// W2 and W2L: contacts anywhere on the unit square.
pub(crate) fn scattered(count: usize) -> Columns {
    scattered_from(0, count)
}

/// Contacts `first ..` of an endless row of them.
pub(crate) fn scattered_from(first: usize, count: usize) -> Columns {
    let (sites, noise) = (EffectDraws::new(2026, "sites"), EffectDraws::new(2026, "noise"));
    columns((first as u64..(first + count) as u64).map(|r| {
        let mut at = [0.0; 2];
        sites.uniforms(r, 0, 2, &mut at);
        let [z, zx, zy] = noisy(wave(at[0], at[1]), [1e-3, 1e-2, 1e-2], &noise, r);
        [at[0], at[1], z, zx, zy]
    }))
}

/// W3: pixel centres in [0, 1] x [0, 0.75], and the images of heights and slopes, row-major [x, y].
pub(crate) fn image() -> ([Vec<f64>; 2], [Vec<f64>; 3]) {
    let centres = |n: usize, side: f64| (0..n).map(|i| side * (i as f64 + 0.5) / n as f64).collect::<Vec<f64>>();
    let axes = [centres(640, 1.0), centres(480, 0.75)];
    let noise = EffectDraws::new(2026, "pixels");
    let mut images: [Vec<f64>; 3] = Default::default();
    for (i, x) in axes[0].iter().enumerate() {
        for (j, y) in axes[1].iter().enumerate() {
            let drawn = noisy(wave(*x, *y), [1e-3, 1e-2, 1e-2], &noise, (i * 480 + j) as u64);
            images.iter_mut().zip(drawn).for_each(|(image, value)| image.push(value));
        }
    }
    (axes, images)
}

/// W5: heights at the Greville abscissae, 67 x 67.
pub(crate) fn bicubic(knots: &[Knots; 2]) -> Vec<f64> {
    let [x, y] = knots.each_ref().map(Knots::greville);
    x.iter().flat_map(|x| y.iter().map(|y| wave(*x, *y)[0])).collect()
}

/// Equal knots on both axes.
pub(crate) fn square_knots(degree: usize, segments: usize, lo: f64, hi: f64) -> Result<[Knots; 2], Fault> {
    let knots = Knots::uniform(degree, segments, lo, hi)?;
    Ok([knots.clone(), knots])
}

/// The knots of W1 and W4.
pub(crate) fn paper_knots() -> Result<[Knots; 2], Fault> {
    square_knots(2, 1, -4.5, 4.5)
}

/// The knots of W3.
pub(crate) fn image_knots() -> Result<[Knots; 2], Fault> {
    Ok([Knots::uniform(3, 80, 0.0, 1.0)?, Knots::uniform(3, 60, 0.0, 0.75)?])
}

/// The shape grid of W1 and W4 along one axis.
pub(crate) fn paper_points() -> Vec<f64> {
    linspace(-3.5, 3.5, 8)
}

/// A pool of so many threads.
pub(crate) fn pool(threads: usize) -> Result<rayon::ThreadPool, Fault> {
    Ok(rayon::ThreadPoolBuilder::new().num_threads(threads).build()?)
}
