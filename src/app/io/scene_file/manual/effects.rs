//! `[effects.NAME]`: the errors that are simulated. Only what stands in the scene is.

use super::Default::{Required, Value, Words};
use super::Range::{Any, NotNegative, Other, Positive, Probability};
use super::{Entry, Key, Range, keys};

/// Laws that errors may follow.
const LAWS: Range = Range::Words(&["normal", "uniform", "laplace", "triangular", "student_t"]);

/// Keys of every effect that draws normal errors.
pub(super) const SHARED: &[Key] = keys! {
    "distribution" = "\"laplace\"", Value("\"normal\""), LAWS, "law of its errors, their standard deviation unchanged; student_t takes dof beside it (above 2; left out: 5)";
};

const THREE: Range = Other("a number, or three", "[1.0, 2.0]");

const fn effect(table: &'static str, about: &'static str, keys: &'static [Key]) -> Entry {
    Entry { table, kind: None, about, keys }
}

pub(super) const EFFECTS: &[Entry] = &[
    effect(
        "effects.tip_radius_error",
        "The robot believes its round fingertips larger or smaller than they are.",
        keys! {
            "error" = "0.1", Required, Any, "believed less true radius, units of length";
        },
    ),
    effect(
        "effects.indentation",
        "Soft tips sink in before they are read (Hertz contact).",
        keys! {
            "modulus" = "100.0", Required, Positive, "contact modulus, force per length squared";
            "threshold" = "0.5", Required, NotNegative, "force at which a reading is taken";
            "overshoot" = "0.1", Value("0.0"), NotNegative, "force by which it is exceeded at most";
        },
    ),
    effect(
        "effects.friction",
        "Friction tilts the felt force, and with it the normal.",
        keys! {
            "mu" = "0.2", Required, NotNegative, "coefficient of friction, no unit";
            "sigma" = "0.02", Value("0.0"), NotNegative, "its standard deviation from contact to contact";
        },
    ),
    effect(
        "effects.force_noise",
        "The force sensor that tells the normal is noisy, biased, drifts and has steps.",
        keys! {
            "sigma" = "0.02", Value("0.0"), NotNegative, "standard deviation per axis, units of force";
            "bias" = "[0.0, 0.01, 0.0]", Value("0.0"), THREE, "constant error, for all axes or for x, y, z, units of force";
            "drift" = "0.001", Value("0.0"), NotNegative, "standard deviation of its wandering from contact to contact, units of force";
            "quantum" = "0.01", Value("0.0"), NotNegative, "step of its converter, units of force";
            "load" = "1.0", Value("1.0"), Positive, "force of a contact, where indentation sets none";
        },
    ),
    effect(
        "effects.position_noise",
        "Positions are off by chance.",
        keys! {
            "sigma" = "0.02", Required, THREE, "standard deviation, for all axes or for x, y, z, units of length";
            "covariance" = "[[4e-4, 0.0, 0.0], [0.0, 4e-4, 0.0], [0.0, 0.0, 1e-4]]", Words("sigma"),
                Other("three rows of three numbers, in place of sigma", "[1.0, 2.0]"), "covariance of x, y, z, units of length squared";
        },
    ),
    effect(
        "effects.normal_noise",
        "Normals are off by chance.",
        keys! {
            "sigma_deg" = "3.0", Required, NotNegative, "standard deviation per tangent axis, degrees";
        },
    ),
    effect(
        "effects.slope_gain",
        "All slopes are measured too steep, or too flat, by one factor.",
        keys! {
            "relative" = "0.3", Required, Any, "by how much, relative to the slope: 0.3 is 30 % too steep, -0.2 is 20 % too flat";
        },
    ),
    effect(
        "effects.encoder",
        "Joint encoders of the arm have steps and noise.",
        keys! {
            "resolution_deg" = "0.05", Value("0.0"), NotNegative, "step of every encoder, degrees";
            "sigma_deg" = "0.01", Value("0.0"), NotNegative, "standard deviation of every joint angle, degrees";
            "base" = "[-30.0, 0.0, 0.0]", Words("three joints beside the patch"), Other("three numbers; needs links", "1.0"),
                "where the arm stands, units of length";
            "links" = "[{ a = 20.0, alpha_deg = 90.0, d = 10.0, theta_deg = 0.0 }, { a = 20.0 }, { a = 15.0 }]",
                Words("three joints beside the patch"), Other("a list of tables; needs base", "[1.0]"),
                "Denavit-Hartenberg links: lengths a and d, angles alpha_deg and theta_deg; what is left out is 0";
        },
    ),
    effect(
        "effects.misalignment",
        "The robot's frame is not where it believes.",
        keys! {
            "rotation_deg" = "[0.0, 1.0, 0.0]", Value("[0.0, 0.0, 0.0]"), Other("three numbers", "1.0"),
                "angles about x, y, z in this order, degrees";
            "translation" = "[0.1, 0.0, 0.0]", Value("[0.0, 0.0, 0.0]"), Other("three numbers", "1.0"), "shift, units of length";
        },
    ),
    effect(
        "effects.latency",
        "The position that is read with a normal is an older one.",
        keys! {
            "distance" = "0.1", Value("0.0"), Any, "how far back on its path the finger was, units of length";
            "jitter" = "0.02", Value("0.0"), NotNegative, "how much that varies either way, units of length";
        },
    ),
    effect(
        "effects.finger_noise",
        "Errors that change slowly along the path of a finger.",
        keys! {
            "sigma" = "0.05", Value("0.0"), THREE, "standard deviation of the position, for all axes or for x, y, z, units of length";
            "sigma_deg" = "1.0", Value("0.0"), NotNegative, "standard deviation of the normal per tangent axis, degrees";
            "length" = "3.0", Required, Positive, "distance over which errors fade by a factor e, units of length";
        },
    ),
    effect(
        "effects.slip",
        "Now and then a finger slips and the reading is gross.",
        keys! {
            "probability" = "0.05", Required, Probability, "how often";
            "size" = "1.0", Required, NotNegative, "how far, units of length";
        },
    ),
    effect(
        "effects.dropout",
        "Readings that never arrive.",
        keys! {
            "probability" = "0.1", Required, Probability, "how often";
        },
    ),
    effect(
        "effects.row_noise",
        "Errors of the heights and slopes that the fit sees; x and y stay exact.",
        keys! {
            "sigma_z" = "0.02", Value("0.0"), NotNegative, "standard deviation of z, units of length";
            "sigma_slope" = "0.01", Value("0.0"), NotNegative, "standard deviation of each slope, no unit";
        },
    ),
];
