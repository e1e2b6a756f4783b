use super::*;
use crate::primitives::placed::PartKind;
#[test]
#[ignore]
fn scratch() {
    for file in std::env::var("FILES").unwrap().split_whitespace() {
        let text = std::fs::read_to_string(file).unwrap();
        let mut p = vec![];
        let mut n = vec![];
        for line in text.lines() {
            let v: Vec<f64> =
                line.split(|c: char| c == ',' || c.is_whitespace()).filter_map(|t| t.parse().ok()).collect();
            if v.len() >= 3 {
                p.push([v[0], v[1], v[2]]);
            }
            if v.len() >= 6 {
                n.push([v[3], v[4], v[5]]);
            }
        }
        let t = std::time::Instant::now();
        let sample = Sample::new(&p, &n, [1e-5, 1e-5]).unwrap();
        let verdict = infer(&sample, &Tuning::default());
        let show = |post: &BodyPosterior| {
            let kind = post.kind();
            for k in PartKind::EXACT {
                let best = post.best_of(k);
                println!(
                    "   {:?} w {:.4} members {}/{} sd {:?} dep {:?} rms {:?} ev {:?}",
                    k,
                    post.weight_of(k),
                    post.members_of(k).len(),
                    p.len(),
                    best.map(|b| b.sd),
                    best.and_then(|b| b.departure),
                    best.map(|b| b.departure_rms),
                    best.map(|b| b.log_evidence)
                );
            }
            let b = post.likeliest(kind).unwrap();
            let dr = super::posterior::draws(post, &Tuning::default(), 1);
            let r: Vec<(f64, f64)> = dr
                .iter()
                .filter(|d| d.primitive.kind == kind)
                .map(|d| (d.primitive.sizes[0] * sample.frame.scale, 1.0))
                .collect();
            let a: Vec<(f64, f64)> = dr
                .iter()
                .filter(|d| d.primitive.kind == kind)
                .map(|d| {
                    (
                        d.primitive.sizes[1]
                            * if b.kind == crate::primitives::placed::PartKind::Torus {
                                sample.frame.scale
                            } else {
                                57.29578
                            },
                        1.0,
                    )
                })
                .collect();
            println!(
                "   -> {:?} c {:?} sizes {:?} {:?}",
                b.kind,
                sample.frame.to_input(b.origin),
                super::posterior::spread(&r, 0.95),
                super::posterior::spread(&a, 0.95)
            );
        };
        println!("{file} n {} scale {} {:.0} ms", p.len(), sample.frame.scale, t.elapsed().as_secs_f64() * 1e3);
        match &verdict {
            Verdict::One(post) => show(post),
            Verdict::Several(t) => {
                for t in t {
                    println!(
                        "  SEVERAL {:?} {} size {}",
                        t.primitive.kind,
                        t.contacts,
                        t.primitive.sizes[0] * sample.frame.scale
                    );
                }
            }
            Verdict::None => println!("  NONE"),
        }
    }
}
