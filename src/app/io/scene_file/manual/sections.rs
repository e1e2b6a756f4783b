//! The rest of a scene: its name, the sweep, the fit, the study.

use super::Default::{Required, Value, Words};
use super::Range::{Any, NotNegative, Other};
use super::{Entry, Range, keys};

const COUNT: Range = Other("a whole number, 1 or above", "0");
const NUMBERS: Range = Other("a list of numbers", "1.0");

pub(super) const SCENE: &[Entry] = &[Entry {
    table: "",
    kind: None,
    about: "At the top of the file, before any [section].",
    keys: keys! {
        "name" = "\"my scene\"", Value("\"\""), Other("text in quotes", "1"), "printed with the results";
        "seed" = "1", Value("1997"), Other("a whole number, 0 or above", "-1"),
            "where the random draws start: the same seed gives the same numbers";
    },
}];

pub(super) const SWEEP: &[Entry] = &[Entry {
    table: "sweep",
    kind: None,
    about: "How the fingers move: side by side, each stopping at every station.",
    keys: keys! {
        "fingers" = "[-4.0, 0.0, 4.0]", Required, NUMBERS, "offset of each finger across the sweep, units of length";
        "path" = "\"down\"", Value("\"down\""), Range::Words(&["down", "around", "scan"]),
            "down onto the surface from above, around a cylinder or torus, or a scan of solids without fingers";
        "at" = "[-4.0, 0.0, 4.0]", Words("from, to and stations"), NUMBERS,
            "the stations one by one, in place of from, to and stations, units of length";
        "from" = "-4.0", Required, Any, "first station, units of length (around: degrees, 0 on top)";
        "to" = "4.0", Required, Any, "last station";
        "stations" = "9", Required, COUNT, "how many, evenly spaced, both ends included";
        "repeats" = "2", Value("1"), COUNT, "touches at each station, each with fresh errors";
        "angle_deg" = "45.0", Value("0.0"), Any, "turns the sweep about its centre, degrees; 0 slides along y";
        "tip_radius" = "0.5", Value("0.0"), NotNegative, "radius of the round fingertips, units of length; 0 is a point";
        "centre" = "[1.0, 0.0]", Value("[0.0, 0.0]"), Other("two numbers", "1.0"), "where fingers and stations are counted from, units of length";
        "unreachable" = "\"skip\"", Value("\"error\""), Range::Words(&["error", "skip"]),
            "whether a station beside the surface is an error or is left out";
        "spacing" = "0.5", Words("a scan needs one"), Other("a number above 0", "\"wide\""), "of a scan: from point to point, units of length";
        "eye" = "[50.0, 40.0, 45.0]", Words("every side is seen"), Other("three numbers", "1.0"), "of a scan: where the scanner stands, units of length";
        "second" = "{ angle_deg = 90.0 }", Words("one sweep"), Other("a table [sweep.second] with the keys above", "1"),
            "a second sweep; what it leaves out is as in the first";
    },
}];

pub(super) const FIT: &[Entry] = &[
    Entry {
        table: "fit",
        kind: None,
        about: "How the contacts are fitted; the words are those of the command line. Every key may be left out.",
        keys: keys! {
            "surface" = "\"height\"", Value("\"height\""), Range::Words(&["height", "parametric", "auto"]),
                "heights over x and y, or a surface in space that may stand upright and close";
            "closed" = "\"u\"", Words("open"), Range::Words(&["u", "v", "u,v"]), "directions in which a surface in space closes";
            "degree" = "3", Value("2"), Other("1 to 9, or a pair", "10"), "degree of the pieces along x and y";
            "segments" = "[2, 2]", Value("1"), Other("a whole number, 1 or above, or a pair", "0"), "pieces along x and y";
            "grid" = "[4, 4]", Value("8"), Other("a whole number, 1 or above, or a pair", "0"), "points at which S and R are taken";
            "domain" = "[-5.0, 5.0, -5.0, 5.0]", Words("all contacts"), Other("[x0, x1, y0, y1] in order", "[1.0, 0.0, 0.0, 1.0]"),
                "range of x and y that the surface covers, units of length";
            "weights" = "\"position\"", Value("\"tangent\""), Other("auto, tangent, position, equal, or [WZ, WX, WY]", "\"heavy\""),
                "how much heights and slopes count; not together with sigma";
            "sigma" = "[0.02, 3.0]", Words("weights"), Other("auto, or [Z, DEG], both above 0", "[0.0, 1.0]"),
                "noise of heights (units of length) and of normals (degrees)";
            "sigma_xy" = "0.3", Value("0.0"), NotNegative, "known noise of the contacts in x and in y, units of length";
            "inset" = "0.1", Value("0.0"), Other("0 to below 0.5", "0.5"), "margin of the grid that is left out, a fraction of each side";
            "smooth" = "\"auto\"", Value("\"none\""), Other("none, auto, or lambda, 0 or above", "-1.0"), "how much bending costs";
            "method" = "\"qr\"", Value("\"auto\""), Range::Words(&["auto", "cholesky", "qr", "kronecker", "pcg"]), "how the equations are solved";
            "robust" = "\"huber\"", Value("\"none\""), Range::Words(&["none", "huber", "tukey"]), "how contacts that do not belong are treated";
            "frame" = "\"auto\"", Words("keep where that is possible"), Range::Words(&["keep", "auto"]),
                "axes of the input, or axes turned so that z points out of the patch";
            "level" = "0.99", Value("0.95"), Other("above 0, below 1", "1.0"), "how often the bounds of S and R hold the truth";
        },
    },
    Entry {
        table: "study",
        kind: None,
        about: "How often `palpate study` repeats the scene.",
        keys: keys! {
            "replicates" = "2000", Words("10000, or as many as --tolerance needs"), COUNT, "repetitions";
            "level" = "0.9", Value("0.95"), Other("above 0, below 1", "1.0"), "how often the bounds of S and R hold a replicate";
        },
    },
];
