//! The examples below each command's help. The test below reads every one of them as the command line does.

pub(super) const ALL: &str = "\
Examples:
  palpate run                  # a first answer, from a built-in scene
  palpate fit contacts.csv     # your own contacts: columns x,y,z, maybe normals
  palpate explain S            # what a word of the answer means
  palpate fit --help           # every option of a command";

pub(super) const RUN: &str = "\
Examples:
  palpate run                              # a round bar, beside its truth
  palpate run paper-cylinder               # the paper's, by its own spline
  palpate run around-torus --out out       # another scene; pictures into out
  palpate run my.toml --surface parametric # your own scene: palpate help scene";

pub(super) const SIMULATE: &str = "\
Examples:
  palpate simulate paper-cylinder -o contacts.csv
  palpate simulate my.toml -o contacts.npz";

pub(super) const FIT: &str = "\
Examples:
  palpate fit contacts.csv                 # palpate chooses the model
  palpate fit scan.ply --unit mm --out out # pictures and tables into out
  palpate fit contacts.csv --degree 2 --save surface.json  # exactly this model
  palpate fit log.csv --columns x=px,y=py,z=pz  # columns of other names
  palpate fit a.csv b.csv --table out.csv  # a row of each file
  simulator | palpate fit - --json | jq .shape.R.interval";

pub(super) const STUDY: &str = "\
Examples:
  palpate study paper-table2               # 10,000 replicates
  palpate study my.toml --tolerance 2      # until the ends have two digits
  palpate study my.toml --sweep effects.position_noise.sigma=0.01:0.1:log3";

pub(super) const FRONTIER: &str = "\
Examples:
  palpate frontier bar --out out           # five rows, and the one to take
  palpate frontier contacts.csv            # the same of measured contacts
  palpate frontier my.toml --error-s 0.01  # the cheapest as accurate
  palpate frontier my.toml --budget 50us   # the most accurate as quick";

pub(super) const MERGE: &str = "\
Examples:
  palpate study my.toml --replicates 1e6 --range 0:500000 --part a
  palpate study my.toml --replicates 1e6 --range 500000:1000000 --part b
  palpate merge a b --json";

pub(super) const EXPLORE: &str = "\
Examples:
  palpate explore paper-cylinder --contacts 60
  palpate explore my.toml --u-s 0.01 --u-r 0.02 --out out";

pub(super) const LIVE: &str = "\
Examples:
  robot | palpate live - --until-radius 0.5 # a line after each touch
  palpate live touches.csv --json          # a JSON object a line
  palpate live bar --until-radius 1        # a scene plays the robot
  palpate live - --window 200 --save state.json";

pub(super) const PARTS: &str = "\
Examples:
  palpate parts parts-mug                  # a built-in body, beside its truth
  palpate parts scan.ply --out out         # picture, table, report
  palpate parts scan.ply --points s.csv    # no parts: S and R at every point";

pub(super) const EXPLAIN: &str = "\
Examples:
  palpate explain
  palpate explain S";

pub(super) const SCENES: &str = "\
Examples:
  palpate scenes
  palpate scenes bar > my.toml             # a scene to change";

pub(super) const SHOW: &str = "\
Examples:
  palpate show surface.json
  palpate show surface.json --at p.csv     # height, normal, k1, k2, S, R there
  palpate show surface.json --save a.step  # for CAD; .ply and others as a mesh";

pub(super) const DIFF: &str = "\
Examples:
  palpate diff before.json after.json
  palpate diff surface.json part.step --out out";

pub(super) const COMPLETIONS: &str = "\
Examples:
  source <(palpate completions bash)
  palpate completions zsh > ~/.zfunc/_palpate
  palpate completions fish > ~/.config/fish/completions/palpate.fish";

#[cfg(test)]
mod tests {
    use clap::{CommandFactory, Parser};

    use crate::cli::Line;

    #[test]
    fn every_example_is_a_command_line() {
        let command = Line::command();
        let verbs = command.get_subcommands().chain([&command]);
        let texts = verbs.filter_map(|verb| verb.get_after_help().map(ToString::to_string));
        let mut seen = 0;
        for text in texts {
            for line in text.lines().filter_map(|line| line.find("palpate ").map(|at| &line[at..])) {
                // up to a remark, a pipe or a file for the output
                let words = line.split_whitespace().take_while(|word| !["#", "|", ">"].contains(word));
                let words: Vec<&str> = words.map(|word| word.trim_end_matches(')')).collect();
                if let Err(error) = Line::try_parse_from(&words) {
                    assert!(!error.use_stderr(), "{line}: {error}");
                }
                seen += 1;
            }
        }
        assert!(seen > 20, "{seen} examples");
    }

    /// An example that is wrapped is no command line.
    #[test]
    fn every_example_fits_a_narrow_terminal() {
        let wide = include_str!("examples.rs").lines().filter(|line| line.starts_with("  palpate"));
        let wide: Vec<&str> = wide.map(|line| line.trim_end_matches("\";")).filter(|line| line.len() > 80).collect();
        assert!(wide.is_empty(), "{wide:?}");
    }
}
