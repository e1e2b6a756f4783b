//! One exploration, look by look: errors, uncertainties, and what was recognised.

use palpate::FitOptions;
use palpate_studies::explore::{ExploreOptions, Look, Strategy, explore};

use crate::contacts::{BUDGET, options};
use crate::objects::object;

pub(crate) fn print(seed: u64, noise: u64, model: Option<&FitOptions>) {
    for (word, strategy) in Strategy::WORDS {
        println!("\nobject {seed}, noise {noise}, {word}");
        println!("contacts  error S   u(S)     noise    model    error R/R  u(R)/R   support  kind");
        let options = ExploreOptions { model: model.cloned(), ..options(strategy, noise, BUDGET) };
        let mut watch = |look: &Look| {
            if let (Some(s), Some(r), [Some(ts), Some(tr)]) = (look.shape_index, look.curvedness, look.truth) {
                println!(
                    "{:>8} {:>8.4} {:>8.4} {:>8.4} {:>8.4}  {:>8.4}  {:>8.4}  {:>6.2}  {}",
                    look.contacts,
                    s.mean - ts,
                    s.u,
                    s.u_noise,
                    s.u_model,
                    r.mean / tr - 1.0,
                    r.u / r.mean,
                    look.support,
                    look.kind.as_deref().unwrap_or("-")
                );
            }
            true
        };
        if let Err(error) = explore(&object(seed), &options, &mut watch) {
            println!("{error}");
        }
    }
}
