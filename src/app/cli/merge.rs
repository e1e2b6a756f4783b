//! `palpate merge PART...`: parts made with `palpate study --range`, joined to the bits of one run.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;

use crate::io::StudyFile;
use crate::report::StudyDocument;
use palpate_studies::montecarlo::{Stopped, StudyError, StudyState};

use super::failure::Failure;
use super::options::{OutputFlags, PictureFlags};
use super::provenance::provenance;
use super::study::{PageExtras, part, source_of, tell};
use super::study_plan::{Plan, StudyArgs};
use super::until::Until;

/// Arguments of `palpate merge`.
#[derive(Args)]
pub(super) struct MergeArgs {
    /// Parts, in any order
    #[arg(required = true)]
    parts: Vec<PathBuf>,
    #[command(flatten)]
    pictures: PictureFlags,
    #[command(flatten)]
    output: OutputFlags,
}

pub(super) fn merge(args: &MergeArgs) -> Result<(), Failure> {
    args.output.prepare(&args.parts.iter().map(PathBuf::as_path).collect::<Vec<_>>(), &[])?;
    let (plan, document, whole) = join(&args.parts, || args.output.spinner("shares of the effects"))?;
    let provenance = provenance(&plan.name, None, Some(plan.study.seed()));
    let told = PageExtras { provenance, asked: plan.identity.replicates, pictures: &args.pictures };
    tell(&args.output, &plan, &document, &whole, &told)
}

/// The study that the parts make; `wait` gives what shall last as long as the shares of the effects are computed.
pub(super) fn join<W>(
    parts: &[PathBuf],
    wait: impl Fn() -> W,
) -> Result<(Arc<Plan>, StudyDocument, StudyState), Failure> {
    let mut order: Vec<(u64, usize)> = Vec::new();
    // the files are read twice, one at a time: a hundred parts need the memory of two
    let mut first: Option<StudyFile> = None;
    for (k, path) in parts.iter().enumerate() {
        let file = part(path)?;
        if file.state.to != file.range[1] {
            let [a, b] = file.range;
            return Err(Failure::Input(format!(
                "{}: a part that is not finished: it holds replicates {a} to {} of {a}:{b}",
                path.display(),
                file.state.to
            )));
        }
        if let Some(first) = &first {
            first.identity.check(&file.identity).map_err(|e| {
                Failure::Input(format!("{} is no part of the study of {}: {e}", path.display(), parts[0].display()))
            })?;
        }
        order.push((file.state.from, k));
        first.get_or_insert(file);
    }
    let Some(first) = first else { return Err(Failure::Input("there are no parts to join".into())) };
    order.sort_unstable();
    let Some(study_args) = StudyArgs::parse_back(&first.arguments) else {
        return Err(Failure::Input(format!("{}: its arguments cannot be read back", parts[0].display())));
    };
    let plan = Arc::new(Plan::new(&study_args, &source_of(&first, &study_args))?);
    plan.identity
        .check(&first.identity)
        .map_err(|e| Failure::Input(format!("{}: a part of another study: {e}", parts[0].display())))?;
    let total = first.identity.replicates;
    drop(first);
    let wrong = |e: StudyError| Failure::Input(e.to_string());
    let mut whole = None;
    let (mut at, mut seconds) = (0, 0.0);
    for (_, k) in order {
        let file = part(&parts[k])?;
        let (from, to) = (file.state.from, file.state.to);
        if from < at {
            return Err(wrong(StudyError::Overlap { from, to: at.min(to) }));
        }
        if from > at {
            return Err(wrong(StudyError::Gap { from: at, to: from, total }));
        }
        (at, seconds) = (to, seconds + file.seconds);
        match &mut whole {
            None => whole = Some(file.state),
            Some(whole) => whole
                .merge(&file.state)
                .map_err(|_| Failure::Input(format!("{}: its tallies are of another kind", parts[k].display())))?,
        }
    }
    let Some(whole) = whole.filter(|_| at == total) else {
        return Err(wrong(StudyError::Gap { from: at, to: total, total }));
    };
    let waiting = wait();
    let document = plan.document(&whole, Stopped::Replicates, seconds, Until::interrupted());
    drop(waiting);
    Ok((plan, document, whole))
}
