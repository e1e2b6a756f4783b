//! The words: the first output of four things that a newcomer feels, what explains it, and what the shell wants.

use std::path::Path;

use serde_json::Value;

use super::command_line::{output, told};

const BAR: &str = "name = \"a bar\"\nseed = 4\n[surface]\nkind = \"cylinder\"\nradius = 25.0\naxis_deg = 30.0\n[sweep]\n\
    fingers = [-6.0, -3.0, 0.0, 3.0, 6.0]\nfrom = -6.0\nto = 6.0\nstations = 12\n[effects.position_noise]\nsigma = 0.05\n\
    [effects.normal_noise]\nsigma_deg = 3.0\n";

/// Text without its line breaks, which stand wherever a line is full.
fn flowing(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A folder with contacts of a bar, a groove and a plate.
fn bench() -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    let groove = BAR.replace("radius = 25.0", "radius = 40.0\nconcave = true");
    let plate = BAR.replace("kind = \"cylinder\"\nradius = 25.0\naxis_deg = 30.0", "kind = \"plane\"");
    for (name, scene) in [("bar", BAR.to_string()), ("groove", groove), ("plate", plate)] {
        std::fs::write(directory.path().join(format!("{name}.toml")), scene).unwrap();
        told(directory.path(), &format!("simulate {name}.toml -o {name}.csv"));
    }
    directory
}

#[test]
fn a_newcomer_is_told_the_shape_its_bounds_and_what_to_do() {
    let directory = bench();
    let here = directory.path();
    let bar = flowing(&told(here, "fit bar.csv --unit mm"));
    for words in [
        "ridge: like the outside of a pipe",
        "% sure to lie between",
        " mm ",
        "per mm; 0.707/radius",
        "the way along the ridge",
        "the axis goes through x = ",
    ] {
        assert!(bar.contains(words), "{words}: {bar}");
    }
    assert!(!bar.contains("cholesky") && !bar.contains("rank"), "{bar}");
    let groove = told(here, "fit groove.csv");
    // its places allow a cone, too, which has an axis of its own
    assert!(groove.contains("rut: like the inside of a pipe") && groove.contains("axis       "), "{groove}");
    let named = told(here, "fit groove.csv --degree 2");
    assert!(named.contains("the way along the rut"), "{named}");
    let plate = flowing(&told(here, "fit plate.csv"));
    assert!(
        plate.contains("plane: flat, as far as these contacts can tell") && plate.contains("would look as flat"),
        "{plate}"
    );
    // one number says how sure it is, and the bound of R has its level
    assert_eq!(plate.matches(" %").count(), 2, "{plate}");
    assert!(plate.contains("95 % sure; per unit of length"), "{plate}");
    assert!(told(here, "fit bar.csv --verbose").contains("support"));
}

/// A hill that levels out has a cap in the middle and bends the other way at its foot: an answer, though no one class describes it.
#[test]
fn several_shapes_side_by_side_are_an_answer() {
    let directory = bench();
    let here = directory.path();
    let hill = BAR
        .replace(
            "kind = \"cylinder\"\nradius = 25.0\naxis_deg = 30.0",
            "kind = \"gaussian\"\nheight = 3.0\nwidth = 5.0",
        )
        .replace("sigma = 0.05", "sigma = 0.005")
        .replace("sigma_deg = 3.0", "sigma_deg = 0.3");
    std::fs::write(here.join("hill.toml"), hill).unwrap();
    told(here, "simulate hill.toml -o hill.csv");
    let words = told(here, "fit hill.csv");
    assert!(words.contains("several side by side: ") && words.contains(" % of the patch, "), "{words}");
    for wrong in ["NO RESULT", "touch more", "axis ", "any direction"] {
        assert!(!words.contains(wrong), "{wrong}: {words}");
    }
    assert!(words.contains("noise      measured points scatter by about"), "{words}");
    told(here, "fit hill.csv --out out --pictures svg --quiet");
    let (title, page) = (title_of(&here.join("out")), read(&here.join("out/report.html")));
    assert!(title.ends_with(" side by side") && !title.contains("undefined"), "{title}");
    assert!(page.contains(">several<") && !page.contains("Axis, degrees"), "{title}");
    let document: Value = serde_json::from_str(&told(here, "fit hill.csv --json")).unwrap();
    let by_area = document["shape"]["class_by_area"].as_object().unwrap();
    let shares: Vec<f64> = by_area.values().map(|share| share.as_f64().unwrap()).collect();
    assert!(document["shape"]["class"].is_null() && shares.len() > 1, "{by_area:?}");
    assert!(shares.iter().all(|share| *share >= 0.1) && shares.iter().sum::<f64>() <= 1.0 + 1e-12, "{by_area:?}");
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}

/// The first words of the picture of S and R in a folder.
fn title_of(folder: &Path) -> String {
    let picture = read(&folder.join("shape.svg"));
    let (_, rest) = picture.split_once("<text").and_then(|(_, rest)| rest.split_once('>')).unwrap();
    rest.split_once('<').unwrap().0.to_string()
}

/// What a plane leaves of S and R is rounding: neither is drawn as if it were a shape, and the title says what the words say.
#[test]
fn pictures_of_a_plane_are_flat() {
    let directory = bench();
    let here = directory.path();
    let words = told(here, "fit plate.csv --out out --pictures svg");
    let below =
        words.lines().find_map(|line| line.split_once("below ")).unwrap().1.split(' ').next().unwrap().to_string();
    assert_eq!(title_of(&here.join("out")), format!("plate.csv: plane, R below {below}"));
    let (picture, page) = (read(&here.join("out/shape.svg")), read(&here.join("out/report.html")));
    assert!(picture.contains("S is undefined: the patch is flat") && !picture.contains("u(S)"));
    assert!(!picture.contains("e-1") && page.contains(&format!(">below {below}<")) && !page.contains(">undefined<"));
}

/// The axis is where the thing lies, whichever of its curvatures is the larger one.
#[test]
fn a_groove_has_the_axis_of_the_bar_that_would_lie_in_it() {
    let directory = bench();
    let shape = |line: &str| -> Value {
        let document: Value = serde_json::from_str(&told(directory.path(), line)).unwrap();
        document["shape"].clone()
    };
    for line in ["fit bar.csv --json", "fit bar.csv --degree 2 --json", "fit groove.csv --degree 2 --json"] {
        let axis = shape(line)["axis_deg"].as_f64().unwrap();
        assert!((axis - 30.0).abs() < 5.0, "{line}: {axis}");
    }
    // the places of a narrow groove allow a cone, too, whose axis leans out of the plane of x and y
    let groove = shape("fit groove.csv --json");
    let along = |k: usize| groove["axis"][k].as_f64();
    let of_cone = along(0).zip(along(1)).map(|(x, y)| (y / x).atan().to_degrees());
    let axis = groove["axis_deg"].as_f64().or(of_cone).unwrap();
    assert!((axis - 30.0).abs() < 5.0, "{axis}");
    let named: Value = serde_json::from_str(&told(directory.path(), "fit groove.csv --degree 2 --json")).unwrap();
    let direction = named["shape"]["direction_deg"].as_f64().unwrap();
    assert!((direction - 120.0).abs() < 5.0, "{direction}");
}

#[test]
fn three_contacts_are_no_result_and_a_slip_of_the_pen_is_understood() {
    let directory = bench();
    let here = directory.path();
    let bar = std::fs::read_to_string(here.join("bar.csv")).unwrap();
    std::fs::write(here.join("few.csv"), bar.lines().take(4).map(|line| format!("{line}\n")).collect::<String>())
        .unwrap();
    let few = told(here, "fit few.csv");
    assert!(few.contains("NO RESULT") && few.contains("touch more places") && !few.contains("flat"), "{few}");
    let (_, wrong, code) = output(here, "fit bar.cvs");
    assert!(wrong.contains("did you mean bar.csv?") && code == Some(2), "{wrong}");
}

/// The wrong file is told what it is, and what takes it.
#[test]
fn the_wrong_file_is_told_which_command_takes_it() {
    let directory = bench();
    let here = directory.path();
    std::fs::create_dir(here.join("scans")).unwrap();
    let line: String = (0..20).map(|k| format!("{k},{},{k}\n", 2 * k)).collect();
    std::fs::write(here.join("line.csv"), format!("x,y,z\n{line}")).unwrap();
    for (line, words) in [
        ("fit scans", &["scans/*.csv"][..]),
        ("fit bar.toml", &["bar.toml: this looks like TOML", "palpate run"]),
        ("study bar.csv", &["bar.csv: line 1", "a scene is a TOML file", "palpate fit bar.csv"]),
        ("run groove", &["there is no such file, but there is groove.toml"]),
        ("explain qwxyz", &["is explained; palpate explain lists all words"]),
        ("fit line.csv", &["line.csv: the contacts lie on one line", "beside the line"]),
    ] {
        let (_, err, code) = output(here, line);
        assert!(code == Some(2) && words.iter().all(|words| err.contains(words)), "{line}: {err}");
        assert!(!err.contains("e0") && err.lines().count() == 1, "{line}: {err}");
    }
}

/// A table without heights, as by a slip in the name of their column, is no plane of height 0.
#[test]
fn contacts_without_heights_are_told_from_their_directions() {
    let directory = bench();
    let here = directory.path();
    let bar = std::fs::read_to_string(here.join("bar.csv")).unwrap();
    std::fs::write(here.join("slip.csv"), bar.replacen("x,y,z,", "x,y,zz,", 1)).unwrap();
    let slip = told(here, "fit slip.csv");
    assert!(slip.contains("ridge") && slip.contains("no heights (a column z)") && slip.contains("zz"), "{slip}");
    let (_, err, code) = output(here, "parts slip.csv");
    assert!(err.contains("no column z") && code == Some(2), "{err}");
    // heights of weight zero change nothing, and other weights are said
    let weighed = |weight: &dyn Fn(usize) -> &'static str, spoil: bool| -> String {
        let row = |(k, line): (usize, &str)| match (k, weight(k)) {
            (0, _) => format!("{line},wz\n"),
            (_, "0") if spoil => {
                let mut fields: Vec<&str> = line.split(',').collect();
                fields[2] = "1000";
                format!("{},0\n", fields.join(","))
            }
            (_, weight) => format!("{line},{weight}\n"),
        };
        bar.lines().enumerate().map(row).collect()
    };
    let some = |k: usize| if k % 7 == 3 { "0" } else { "1" };
    std::fs::write(here.join("zero.csv"), weighed(&some, true)).unwrap();
    let zero = told(here, "fit zero.csv");
    assert!(zero.contains("ridge") && zero.contains("9 heights of weight 0 (wz) are left out"), "{zero}");
    std::fs::write(here.join("half.csv"), weighed(&|k| if k % 2 == 0 { "0.5" } else { "1" }, false)).unwrap();
    assert!(flowing(&told(here, "fit half.csv")).contains("count only for a model that is named"));
}

#[test]
fn no_line_for_people_is_wider_than_a_terminal() {
    let directory = bench();
    let here = directory.path();
    told(here, "fit bar.csv --save a.json --quiet");
    for line in [
        "study paper-table2 --replicates 2000 --attribution 0",
        "run --verbose",
        "run paper-cylinder --verbose",
        "explore paper-table2 --contacts 40",
        "fit --help",
        "run -h",
        "--help",
        "explain found as",
        "explain",
        "help scene",
        "diff a.json a.json",
    ] {
        let text = told(here, line);
        let wide = text.lines().filter(|line| line.chars().count() > 80).collect::<Vec<_>>();
        assert!(wide.is_empty(), "{line}: {wide:?}");
    }
}

/// Short help is one screen of what is used most, long help has everything.
#[test]
fn short_help_is_short() {
    let here = Path::new(".");
    for verb in ["run", "fit"] {
        let [short, long] = ["-h", "--help"].map(|flag| told(here, &format!("{verb} {flag}")));
        assert!(2 * short.lines().count() < long.lines().count(), "{short}");
        assert!(long.contains("--robust") && !short.contains("--robust") && short.contains("--degree"), "{short}");
    }
}

/// Whoever asked for files is told which there are, and which to open first; nobody is told to do what was done.
#[test]
fn files_that_were_written_are_said() {
    let directory = bench();
    let here = directory.path();
    let text = told(here, "fit bar.csv --out o").replace("\n           ", " ");
    let last = text.lines().last().unwrap();
    assert!(
        last.starts_with("wrote      open o/report.html first; beside it fit.json") && last.contains("shape.svg"),
        "{text}"
    );
    assert!(!text.contains("--out") && text.contains("--verbose"), "{text}");
    assert!(
        !told(here, "fit bar.csv --out o --json").contains("wrote") && told(here, "fit bar.csv --out o -q").is_empty()
    );
    assert!(told(here, "simulate bar -o b.csv").contains("b.csv"));
    assert!(told(here, "explore paper-table2 --contacts 40 --out e").contains("open e/report.html first"));
}

/// What has next to no probability is not named beside the best.
#[test]
fn improbable_kinds_are_not_named() {
    let directory = bench();
    let text =
        told(directory.path(), "run paper-cylinder --surface height") + &told(directory.path(), "fit groove.csv");
    assert!(!text.contains("less than 1 %"), "{text}");
}

#[test]
fn units_are_kept_with_a_saved_surface() {
    let directory = bench();
    told(directory.path(), "fit bar.csv --unit mm --save bar.json");
    assert!(told(directory.path(), "show bar.json").contains("per mm"));
    assert!(told(directory.path(), "show bar.json --unit inch").contains("per inch"));
    assert!(output(directory.path(), "fit bar.csv --unit <b>").1.contains("such as mm"));
}

#[test]
fn every_label_of_the_first_output_is_explained() {
    let directory = bench();
    let here = directory.path();
    told(here, "fit bar.csv --save a.json --quiet");
    let lines = [
        "fit bar.csv --out o",
        "run paper-fig6-r8-degree3",
        "study paper-table2 --replicates 500",
        "diff a.json a.json",
    ];
    let text: String = lines.iter().map(|line| told(here, line)).collect();
    let labels = text.lines().filter(|line| !line.starts_with(' ')).filter_map(|line| line.split("  ").next());
    // rows of tables are named by what stands in the scene or the file
    let rows = ["", "A", "B", "height", "normal", "sum", "tip_radius_error", "encoder", "force_noise"];
    for label in labels.map(str::trim).filter(|label| !rows.contains(label)) {
        let word = label.split(',').next().unwrap().split(" mean").next().unwrap();
        let (out, err, code) = output(here, &format!("explain {word}"));
        assert!(code == Some(0) && out.len() > 100, "{label}: {err}");
    }
    // the page and the program count the same kinds
    assert!(
        text.contains("of 8 kinds of surface") && flowing(&told(here, "explain found as")).contains("these are eight"),
        "{text}"
    );
    let (_, err, code) = output(here, "explain curvednes");
    assert!(err.contains("did you mean \"curvedness\"?") && code == Some(2), "{err}");
    let document: Value = serde_json::from_str(&told(here, "explain S --json")).unwrap();
    assert_eq!((&document["schema"], &document["entries"][0]["word"]), (&"palpate.explain/1".into(), &"S".into()));
}

#[test]
fn help_knows_scenes_and_commands_and_shells_get_their_completions() {
    let here = Path::new(".");
    let manual = told(here, "help scene");
    assert!(
        ["[sweep]", "kind = \"torus\"", "[effects.encoder]", "replicates"].iter().all(|part| manual.contains(part))
    );
    assert!(told(here, "help scene encoder").contains("resolution_deg"));
    assert!(told(here, "help fit").contains("--degree") && told(here, "help").contains("Examples:"));
    let (_, err, code) = output(here, "help torus");
    assert!(err.contains("palpate help scene torus") && code == Some(2), "{err}");
    for shell in ["bash", "zsh", "fish"] {
        assert!(told(here, &format!("completions {shell}")).contains("palpate"));
    }
    // the page names no other page, since all commands stand on it
    let page = told(here, "man");
    assert!(page.contains(".TH palpate") && page.contains("palpate fit") && !page.contains("fit(1)"), "{page}");
}

/// Nothing is coloured where nobody looks.
#[test]
fn a_pipe_gets_plain_text() {
    for line in ["run", "help", "help fit", "explain S"] {
        assert!(!told(Path::new("."), line).contains('\u{1b}'), "{line}");
    }
}
