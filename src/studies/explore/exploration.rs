//! The loop: sweep, recognise, plan, touch, until a goal or the budget ends it.
//!
//! ```text
//! contacts = first sweep
//! repeat   S, R, u(S), u(R) = what `palpate fit` answers: recognised, or by the model that was named
//!          stop at the goal, at the budget, or where the goal is out of reach
//!          contacts += touches chosen by the strategy
//! ```

use palpate_fitting::fit::FitOptions;
use palpate_geometry::contact::Contacts;
use palpate_inference::recognition::RecognitionOptions;
use palpate_world::scene::{Truth, World};

use super::ExploreError;
use super::acquisition::Situation;
use super::answer::Answer;
use super::planner::TouchPlanner;
use super::simulated_sensor::Hand;
use super::status::{Look, Stopped};
use super::stopping::Goal;
use super::strategy::Strategy;

/// What an exploration is to do.
#[derive(Clone, Debug, PartialEq)]
pub struct ExploreOptions {
    /// How touches are chosen.
    pub strategy: Strategy,
    /// Most contacts, those of the first sweep among them.
    pub contacts: usize,
    /// The model that answers; `None`: the contacts are recognised.
    pub model: Option<FitOptions>,
    /// How contacts are recognised where no model is named; its level is `level`.
    pub recognition: RecognitionOptions,
    /// Where to stop.
    pub goal: Option<Goal>,
    /// Touches between two looks.
    pub per_round: usize,
    /// Whether whole lines of fingers are planned in place of single touches (`variance` and `shape`).
    pub lines: bool,
    /// Seed of the world's noise and of random choices.
    pub seed: u64,
    /// Where touches may be made, `[x0, x1, y0, y1]`; the rectangle of the first sweep where nothing is said.
    pub reach: Option<[f64; 4]>,
    /// Level of the intervals.
    pub level: f64,
}

/// All that came of it.
#[derive(Clone, Debug)]
pub struct Exploration {
    /// Every look, the first after the first sweep.
    pub looks: Vec<Look>,
    /// Why it ended.
    pub stopped: Stopped,
    /// All contacts.
    pub contacts: Contacts,
    /// The truth behind them.
    pub truth: Truth,
    /// Where the scene's own sweeps touched.
    pub swept: Vec<[f64; 2]>,
}

impl Exploration {
    /// What an exploration had come to when it was left after these looks, the first of which followed the first sweep:
    /// their contacts are felt again, with the same noise.
    ///
    /// # Errors
    /// A world that cannot be explored.
    pub fn after(world: &World, options: &ExploreOptions, looks: Vec<Look>) -> Result<Exploration, ExploreError> {
        let mut hand = Hand::new(world, options.seed, options.reach)?;
        let swept = hand.sites()?;
        // what the first look names are the places of the sweep
        hand.touches = looks.iter().skip(1).flat_map(|look| look.touched.iter().copied()).collect();
        let (contacts, truth) = hand.feel()?;
        Ok(Exploration { looks, stopped: Stopped::Asked, contacts, truth, swept })
    }
}

/// Explores a simulated world; `seen` is told every look, and says whether to go on.
///
/// # Errors
/// A world that cannot be explored, a budget that the first sweep spends, no candidate inside reach.
pub fn explore(
    world: &World,
    options: &ExploreOptions,
    mut seen: impl FnMut(&Look) -> bool,
) -> Result<Exploration, ExploreError> {
    check(options)?;
    let mut hand = Hand::new(world, options.seed, options.reach)?;
    if hand.swept >= options.contacts {
        return Err(ExploreError::Budget { first: hand.swept, budget: options.contacts });
    }
    let swept = hand.sites()?;
    let mut looks: Vec<Look> = Vec::new();
    let mut touched = swept.clone();
    let mut direction = None;
    // places without normals are touched from above
    let up = options.recognition.up.unwrap_or([0.0, 0.0, 1.0]);
    let recognition = options.recognition.clone().with_level(options.level).with_up(up);
    loop {
        let (contacts, truth) = hand.feel()?;
        let touches = if options.strategy == Strategy::Shape { hand.candidates.as_slice() } else { &[] };
        let answer = Answer::new(&contacts, (options.model.as_ref(), &recognition), touches);
        check_planner(options, &answer)?;
        let mut look = Look::new(contacts.len(), touched, &answer, &truth);
        let direction = *direction.get_or_insert_with(|| answer.principal_direction());
        let units = options.goal.zip(look.curvedness).map(|(goal, r)| [goal.u_s, goal.u_r * r.mean]);
        let (hand_now, seed) = (&hand, options.seed);
        let situation =
            Situation { hand: hand_now, swept: &swept, contacts: &contacts, answer: &answer, direction, units, seed };
        let left = options.contacts - hand.swept - hand.touches.len();
        if options.goal.is_some() {
            look.richer_p = answer.richer_p(&contacts);
            look.departure = answer.departure(&contacts);
            let shares = situation.attainable(left);
            look.attainable = look.noises().zip(shares).map(|(now, share)| [0, 1].map(|q| now[q] * share[q]));
        }
        let goes_on = seen(&look);
        looks.push(look);
        let ended = options.goal.and_then(|goal| goal.ends(&looks));
        let ended = ended.or((left == 0).then_some(Stopped::Budget)).or((!goes_on).then_some(Stopped::Asked));
        let next = match ended {
            None => situation.next(options.strategy, options.per_round.min(left), options.lines)?,
            Some(_) => Vec::new(),
        };
        if next.is_empty() {
            return Ok(Exploration { looks, stopped: ended.unwrap_or(Stopped::Places), contacts, truth, swept });
        }
        hand.touches.extend(&next);
        touched = next;
    }
}

fn check(options: &ExploreOptions) -> Result<(), ExploreError> {
    let fault = |option, value: String, expected| Err(ExploreError::Option { option, value, expected });
    if options.per_round == 0 {
        return fault("per_round", "0".into(), "at least one touch a round");
    }
    if let Some(goal) = options.goal {
        for (option, value) in [("u_s", goal.u_s), ("u_r", goal.u_r)] {
            if !(value > 0.0 && value.is_finite()) {
                return fault(option, value.to_string(), "a positive number, such as 0.01");
            }
        }
    }
    Ok(())
}

/// A named model must be one that touches can be planned by, where the strategy plans.
fn check_planner(options: &ExploreOptions, answer: &Answer) -> Result<(), ExploreError> {
    match (answer, options.strategy) {
        (Answer::Fitted(fit), Strategy::Shape | Strategy::Variance) => TouchPlanner::new(fit).map(|_| ()),
        _ => Ok(()),
    }
}
