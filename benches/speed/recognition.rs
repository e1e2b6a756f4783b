//! What an answer of no named model costs, under criterion: `cargo bench --bench recognition`.
//!
//! | id | workload |
//! |---|---|
//! | `recognition/ball36`, `bar36`, `egg36` | 36 contacts with normals over a part of a ball, a bar, an egg, from contacts in memory to the answer |
//! | `recognition/places36` | 36 places of the ball without normals |
//! | `recognition/ball400`, `ball6000`, `ball1000000` | more contacts of the ball with normals |
//! | `touch_more/ball36` | one touch after these, by which the answer is moved and not made anew |
//!
//! One thread each, but for `ball1000000_2t`. Errors are 0.2 % of the radius and half a degree; every input is the same in every run.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BatchSize, Criterion, Throughput};
use palpate::Contacts;
use palpate::recognition::{Recognition, RecognitionError, RecognitionOptions, SequentialPosterior};
use palpate_numeric::draws::Lcg;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Sd of a place over the radius, and of a normal in radians.
const ERRORS: [f64; 2] = [0.002, 0.01];

fn gaussian(generator: &mut Lcg) -> f64 {
    (-2.0 * (1.0 - generator.uniform()).ln()).sqrt() * (std::f64::consts::TAU * generator.uniform()).cos()
}

/// Places and unit normals of an ellipsoid of these half axes, within 40 degrees of its third.
fn cap(half_axes: [f64; 3], count: usize) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let mut generator = Lcg::new(20_260_401);
    let one = |_| {
        let angle = std::f64::consts::TAU * generator.uniform();
        let sin = 0.64 * generator.uniform().sqrt();
        let direction = [sin * angle.cos(), sin * angle.sin(), (1.0 - sin * sin).sqrt()];
        let error = 1.0 + ERRORS[0] * gaussian(&mut generator);
        let place = [0, 1, 2].map(|k| error * half_axes[k] * direction[k]);
        let normal = [0, 1, 2].map(|k| direction[k] / half_axes[k]);
        let length = normal.iter().map(|v| v * v).sum::<f64>().sqrt();
        let mut tilted = || ERRORS[1] * gaussian(&mut generator);
        let normal = normal.map(|v| v / length + tilted());
        let length = normal.iter().map(|v| v * v).sum::<f64>().sqrt();
        (place, normal.map(|v| v / length))
    };
    (0..count).map(one).unzip()
}

/// The same of a bar along x, whose contacts reach as far along it as across.
fn bar(radius: f64, count: usize) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let (places, normals) = cap([radius; 3], count);
    let across = |v: [f64; 3]| v[1].hypot(v[2]);
    let place = |(p, n): (&[f64; 3], &[f64; 3])| {
        let rise = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt() / across(*p);
        ([p[0], p[1] * rise, p[2] * rise], [0.0, n[1] / across(*n), n[2] / across(*n)])
    };
    places.iter().zip(&normals).map(place).unzip()
}

fn contacts((places, normals): &(Vec<[f64; 3]>, Vec<[f64; 3]>)) -> Contacts {
    Contacts::from_points(places).with_normal_vectors(normals)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut criterion = Criterion::default().configure_from_args();
    let one = ThreadPoolBuilder::new().num_threads(1).build()?;
    recognition(&mut criterion, &one)?;
    touch_more(&mut criterion, &one)?;
    let two = ThreadPoolBuilder::new().num_threads(2).build()?;
    let many = contacts(&cap([25.0; 3], 1_000_000));
    let mut group = criterion.benchmark_group("recognition");
    group.sample_size(10).measurement_time(Duration::from_secs(20));
    group.bench_function("ball1000000_2t", |b| b.iter(|| two.install(|| recognised(black_box(&many)).is_ok())));
    group.finish();
    criterion.final_summary();
    Ok(())
}

fn recognised(contacts: &Contacts) -> Result<Recognition, RecognitionError> {
    Recognition::of(contacts, &RecognitionOptions::default())
}

fn recognition(criterion: &mut Criterion, one: &ThreadPool) -> Result<(), RecognitionError> {
    let ball = [25.0; 3];
    let cases = [
        ("ball36", contacts(&cap(ball, 36))),
        ("bar36", contacts(&bar(25.0, 36))),
        ("egg36", contacts(&cap([40.0, 28.0, 25.0], 36))),
        ("places36", Contacts::from_points(&cap(ball, 36).0)),
        ("ball400", contacts(&cap(ball, 400))),
        ("ball6000", contacts(&cap(ball, 6000))),
        ("ball1000000", contacts(&cap(ball, 1_000_000))),
    ];
    let mut group = criterion.benchmark_group("recognition");
    group.sample_size(10);
    for (name, contacts) in &cases {
        recognised(contacts)?;
        group.throughput(Throughput::Elements(contacts.len() as u64));
        group.bench_function(*name, |b| b.iter(|| one.install(|| recognised(black_box(contacts)).is_ok())));
    }
    group.finish();
    Ok(())
}

fn touch_more(criterion: &mut Criterion, one: &ThreadPool) -> Result<(), RecognitionError> {
    let (places, normals) = cap([25.0; 3], 37);
    let first = contacts(&(places[..36].to_vec(), normals[..36].to_vec()));
    let found = recognised(&first)?;
    let posterior = SequentialPosterior::after(&found);
    let mut group = criterion.benchmark_group("touch_more");
    group.bench_function("ball36", |b| {
        let begin = || (found.clone(), posterior.clone());
        let touch = |(mut found, mut posterior): (Recognition, SequentialPosterior)| {
            one.install(|| posterior.update(&mut found, black_box(places[36]), Some(normals[36])).is_moved())
        };
        b.iter_batched(begin, touch, BatchSize::SmallInput);
    });
    group.finish();
    Ok(())
}
