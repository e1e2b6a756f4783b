use super::*;
use crate::primitives::placed::*;
use palpate_numeric::draws::Lcg;
use palpate_numeric::vector::*;

fn gaussian(g: &mut Lcg) -> f64 {
    (-2.0 * (1.0 - g.uniform()).ln()).sqrt() * (6.283185307179586 * g.uniform()).cos()
}
fn direction(g: &mut Lcg) -> [f64; 3] {
    loop {
        let v = [gaussian(g), gaussian(g), gaussian(g)];
        let l = norm(v);
        if l > 0.1 {
            return v.map(|x| x / l);
        }
    }
}

#[test]
#[ignore]
fn study() {
    let count: usize = std::env::var("COUNT").ok().and_then(|c| c.parse().ok()).unwrap_or(40);
    let mut pooled = [[0.0f64; 4]; 10];
    for kind in [PartKind::Ellipsoid, PartKind::Sphere, PartKind::Cylinder, PartKind::Cone, PartKind::Torus] {
        for turn in [360.0f64, 160.0, 90.0] {
            for (n, normals) in [(8, true), (20, false), (20, true), (60, false), (60, true), (300, false)] {
                if let Ok(only) = std::env::var("ONLY") {
                    if only != n.to_string() {
                        continue;
                    }
                }
                for noise in [0.002f64, 0.02, 0.05] {
                    let (mut right, mut inside, mut answered, mut several, mut none, mut wrongsure, mut wide) =
                        (0, 0, 0, 0, 0, 0, 0.0);
                    let mut time = 0.0;
                    for rep in 0..count {
                        let mut g = Lcg::new(
                            (rep as u64) * 7919
                                + n as u64 * 31
                                + (turn as u64) * 17
                                + (noise * 1e5) as u64
                                + kind as u64 * 1013
                                + normals as u64,
                        );
                        for _ in 0..10 {
                            g.uniform();
                        }
                        let axis = direction(&mut g);
                        let size = 1.0;
                        let second = match kind {
                            PartKind::Cone => 0.15 + 0.6 * g.uniform(),
                            PartKind::Ellipsoid => 0.5 + 0.4 * g.uniform(), PartKind::Torus => 0.2 + 0.5 * g.uniform(),
                            _ => 0.0,
                        };
                        let base = Primitive {
                            kind,
                            origin: [5.0 * g.uniform(), 3.0, -2.0],
                            axes: axes_along(axis),
                            sizes: [size, second, if kind == PartKind::Ellipsoid { 0.5 + 0.45 * g.uniform() } else { 0.0 }],
                            side: 1.0,
                        };
                        let (mut p, mut nn) = (vec![], vec![]);
                        for _ in 0..n {
                            let (a, b) = ((g.uniform() - 0.5) * turn.to_radians(), g.uniform() - 0.5);
                            let own = match kind {
                                PartKind::Sphere | PartKind::Ellipsoid => { let h = (turn / 360.0).max(0.3) * 2.0 * b;
                                    let h = h.clamp(-1.0, 1.0);
                                    let r = (1.0 - h * h).sqrt();
                                    [r * a.cos(), r * a.sin(), h]
                                }
                                PartKind::Cylinder => [a.cos(), a.sin(), 3.0 * b],
                                PartKind::Cone => {
                                    let h = 1.5 * b;
                                    let r = 1.0 + h * second.tan();
                                    [r * a.cos(), r * a.sin(), h]
                                }
                                _ => {
                                    let t = b * 6.2831853 * (turn / 360.0).max(0.5);
                                    let r = 1.0 + second * t.cos();
                                    [r * a.cos(), r * a.sin(), second * t.sin()]
                                }
                            };
                            let own = if kind == PartKind::Ellipsoid { [own[0] * base.sizes[0], own[1] * base.sizes[1], own[2] * base.sizes[2]] } else { own };
 let at = along(base.origin, 1.0, base.out(own));
                            let (d, normal) = base.nearest(at);
                            assert!(d.abs() < 1e-9);
                            let e = noise * gaussian(&mut g);
                            p.push(along(at, e, normal));
                            let [t1, t2, _] = axes_along(normal);
                            nn.push(unit(along(
                                along(normal, 2.0 * noise * gaussian(&mut g), t1),
                                2.0 * noise * gaussian(&mut g),
                                t2,
                            )));
                        }
                        if !normals {
                            nn.clear();
                        }
                        let t = std::time::Instant::now();
                        let sample = Sample::new(&p, &nn, [0.0, 0.0]).unwrap();
                        let verdict = infer(&sample, &Tuning::default());
                        time += t.elapsed().as_secs_f64();
                        match verdict {
                            Verdict::One(post) => {
                                answered += 1;
                                let k = post.kind();
                                let w = post.weight_of(k);
                                let tenth = ((w * 10.0) as usize).min(9);
                                let ok = k == kind;
                                pooled[tenth][0] += 1.0;
                                pooled[tenth][1] += w;
                                pooled[tenth][2] += ok as u8 as f64;
                                if ok {
                                    right += 1;
                                    let dr = draws(&post, &Tuning::default(), 1);
                                    let truth = match kind {
                                        PartKind::Cone | PartKind::Torus => second,
                                        _ => size,
                                    };
                                    let r: Vec<(f64, f64)> = dr
                                        .iter()
                                        .filter(|d| d.primitive.kind == k)
                                        .map(|d| {
                                            (
                                                match kind {
                                                    PartKind::Cone => d.primitive.sizes[1].abs(),
                                                    PartKind::Torus => d.primitive.sizes[1] * sample.frame.scale,
                                                    PartKind::Ellipsoid => d.primitive.sizes.iter().copied().fold(0.0, f64::max) * sample.frame.scale,
 _ => d.primitive.sizes[0] * sample.frame.scale,
                                                },
                                                1.0,
                                            )
                                        })
                                        .collect();
                                    let s = spread(&r, 0.95).unwrap();
                                    inside += (s.interval[0] <= truth && truth <= s.interval[1]) as usize;
                                    wide += s.sd / truth;
                                } else if w > 0.95 {
                                    wrongsure += 1;
                                    if std::env::var("SAY").is_ok() {
                                        let f = |k: PartKind| {
                                            (
                                                post.members_of(k).len(),
                                                post.best_of(k).map(|b| (b.log_evidence, b.sd, b.departure)),
                                            )
                                        };
                                        println!("    {:?} {:?} true {:?}", k, f(k), f(kind));
                                    }
                                }
                            }
                            Verdict::Several(_) => several += 1,
                            Verdict::None => none += 1,
                        }
                    }
                    println!(
                        "{kind:?} turn {turn} n {n} normals {normals} noise {noise}: right {right}/{answered} inside {:.0}% u {:.3} several {several} none {none} wrong&sure {wrongsure} {:.1} ms",
                        100.0 * inside as f64 / (right as f64).max(1.0),
                        wide / (right as f64).max(1.0),
                        time / count as f64 * 1e3
                    );
                }
            }
        }
    }
    for t in pooled {
        println!("claims {} forecast {:.3} right {:.3}", t[0], t[1] / t[0].max(1.0), t[2] / t[0].max(1.0));
    }
}
use super::posterior::{draws, spread};
