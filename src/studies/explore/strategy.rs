//! The strategies by their names.

/// How the next touches are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Strategy {
    /// Ever finer lattices: the place farthest from all touches so far.
    Lattice,
    /// Places at random.
    Random,
    /// Along the two principal directions at the middle of the patch, as the paper's second sweep.
    SecondSweep,
    /// Where the height of the surface is least certain.
    Variance,
    /// Where a touch lets the uncertainties of S and R fall most: those of the recognition, or of the model that was named.
    #[default]
    Shape,
    /// Where a richer model of the surface differs most.
    ProbeModel,
}

impl Strategy {
    /// Every strategy with its word.
    pub const WORDS: [(&'static str, Strategy); 6] = [
        ("lattice", Strategy::Lattice),
        ("random", Strategy::Random),
        ("second-sweep", Strategy::SecondSweep),
        ("variance", Strategy::Variance),
        ("shape", Strategy::Shape),
        ("probe-model", Strategy::ProbeModel),
    ];

    /// The word for it on the command line and in JSON.
    pub fn name(self) -> &'static str {
        Strategy::WORDS.iter().find(|(_, strategy)| *strategy == self).map_or("", |(word, _)| word)
    }
}
