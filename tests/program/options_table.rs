//! Lines on which every option of their command must matter, and what is typed after each option.

/// A line, and the options that matter on another line or with another value: option, line in its place (or none), value.
#[derive(Clone, Copy)]
pub(crate) struct Context {
    pub(crate) line: &'static str,
    pub(crate) rows: &'static [(&'static str, &'static str, &'static str)],
}

/// What is typed after an option where a context says nothing else. An option that is not here fails the test.
pub(crate) const VALUES: &[(&str, &str)] = &[
    ("--surface", "parametric"),
    ("--adaptive", ""),
    ("--closed", "u"),
    ("--degree", "3"),
    ("--segments", "2"),
    ("--domain", "-9,9,-9,9"),
    ("--weights", "position"),
    ("--sigma", "0.1,4"),
    ("--sigma-xy", "0.5"),
    ("--method", "qr"),
    ("--smooth", "0.1"),
    ("--robust", "huber"),
    ("--grid", "5x6"),
    ("--inset", "0.2"),
    ("--frame", "auto"),
    ("--verbose", ""),
    ("--unit", "mm"),
    ("--pictures", "png"),
    ("--json", ""),
    ("--out", "D"),
    ("--quiet", ""),
    ("--save", "f.json"),
    ("--bare", ""),
    ("--table", "t.csv"),
    ("--skip-invalid", ""),
    ("--near", "0,0,0,5"),
    ("--box", "-5,5,-5,5,-50,50"),
    ("--flip-normals", ""),
    ("--ignore-normals", ""),
    ("--normals", "estimate"),
    ("--viewpoint", "0,0,-90"),
    ("--intrinsics", "500,500,20,20"),
    ("--columns", "x=y,y=x,z=z"),
    ("--memory", "0"),
    ("--tune", "least_contacts=4"),
    ("--tolerance", "2"),
    ("--points", "q.csv"),
    ("--library", "known"),
    ("--seed", "77"),
    ("--output", "c.csv"),
    ("--explain", ""),
    ("--replicates", "30"),
    ("--level", "0.7"),
    ("--rule", "adaptive --tolerance 1"),
    ("--budget", "0.2"),
    ("--range", "0:10 --part r.part"),
    ("--part", "r.part"),
    ("--records", "r.csv"),
    ("--checkpoint", "k"),
    ("--quantity", "k1"),
    ("--quantile", "0.2"),
    ("--path", "whole"),
    ("--attribution", "0"),
    ("--coverage", ""),
    ("--sweep", "surface.radius=20,30"),
    ("--error-s", "0.1"),
    ("--error-r", "0.1"),
    ("--beside", "peers.json"),
    ("--emit", "e.toml"),
    ("--keep-stations", ""),
    ("--seconds", "0.4"),
    ("--all", ""),
    ("--stages", ""),
    ("--count", ""),
    ("--orders", ""),
    ("--strategy", "random"),
    ("--contacts", "36"),
    ("--u-s", "0.2 --u-r 0.2"),
    ("--u-r", "0.2 --u-s 0.2"),
    ("--per-round", "2"),
    ("--lines", ""),
    ("--reach", "-3,3,-3,3"),
    ("--at", "at.csv"),
    ("--until-radius", "9"),
    ("--window", "12"),
    ("--refresh", "0.5"),
    ("--resume", "live.state"),
];

const fn on(line: &'static str, rows: &'static [(&'static str, &'static str, &'static str)]) -> Context {
    Context { line, rows }
}

pub(crate) const FIT: &[Context] = &[
    on("fit bar.csv", &[("--skip-invalid", "fit holes.csv", "")]),
    on(
        "fit bar.csv --degree 2",
        &[
            ("--skip-invalid", "fit holes.csv --degree 2", ""),
            ("--degree", "fit bar.csv --surface height", "3"),
            ("--method", "fit bar.csv --degree 2 --verbose", "qr"),
            ("--frame", "fit lean.csv --degree 2", "keep"),
        ],
    ),
    on("fit bare.csv", &[("--skip-invalid", "fit holes.csv", "")]),
    on(
        "fit bare.csv --degree 2",
        &[
            ("--skip-invalid", "fit holes.csv --degree 2", ""),
            ("--degree", "fit bare.csv --surface height", "3"),
            ("--method", "fit bare.csv --degree 2 --verbose", "qr"),
            ("--frame", "fit lean.csv --degree 2", "keep"),
        ],
    ),
    on(
        "fit bar.csv --surface parametric",
        &[("--skip-invalid", "fit holes.csv --surface parametric", ""), ("--degree", "", "2")],
    ),
    on(
        "fit bare.csv --adaptive",
        &[("--skip-invalid", "fit holes.csv --adaptive", ""), ("--degree", "", "4"), ("--columns", "", "x=x,y=z,z=y")],
    ),
    on(
        "fit bar.csv bare.csv --json",
        &[
            ("--skip-invalid", "fit bar.csv holes.csv --json", ""),
            ("--quiet", "fit bar.csv bare.csv", ""),
            ("--json", "fit bar.csv bare.csv", ""),
        ],
    ),
];

pub(crate) const GRIDS_AND_RUNS: &[Context] = &[
    on("fit grid.npz", &[("--skip-invalid", "fit holes.npz", "")]),
    on(
        "fit grid.npz --degree 2",
        &[
            ("--skip-invalid", "fit holes.npz --degree 2", ""),
            ("--degree", "fit grid.npz --surface height", "3"),
            ("--method", "fit grid.npz --degree 2 --verbose", "qr"),
        ],
    ),
    on(
        "run bar.toml",
        &[
            ("--surface", "", "parametric"),
            ("--method", "run bar.toml --verbose", "qr"),
            ("--frame", "run lean.toml", "auto"),
        ],
    ),
    on("simulate bar.toml -o x.csv", &[("--output", "simulate bar.toml --out E", "x.csv")]),
    on("show s.json", &[]),
    on("show s.json --at at.csv", &[("--at", "show s.json", "at.csv")]),
    on("diff s.json t.json", &[]),
    on("merge p0 p1", &[]),
    on("scenes", &[]),
    on("explain R", &[]),
    on("explain", &[]),
    on("completions bash", &[]),
    on("man", &[]),
    on("help fit", &[]),
];

pub(crate) const PARTS: &[Context] = &[
    on("parts box.csv", &[("--skip-invalid", "parts boxholes.csv", "")]),
    on("parts boxbare.csv", &[("--skip-invalid", "parts boxholes.csv", "")]),
    on("parts grid.npz", &[("--skip-invalid", "parts holes.npz", "")]),
    on("parts box.toml", &[]),
];

pub(crate) const LIVES: &[Context] = &[
    on(
        "live mixed.csv --refresh 9",
        &[
            ("--refresh", "live mixed.csv", "0.5"),
            ("--viewpoint", "live bare.csv --refresh 9", "0,0,-90"),
            ("--until-radius", "live mixed.csv", "9"),
            ("--u-s", "live mixed.csv", "9 --u-r 9"),
            ("--u-r", "live mixed.csv", "9 --u-s 9"),
        ],
    ),
    on(
        "live tiny.toml --contacts 14 --refresh 9",
        &[
            ("--contacts", "live tiny.toml --refresh 9", "14"),
            ("--viewpoint", "live bare.csv --refresh 9", "0,0,-90"),
            ("--refresh", "live mixed.csv", "0.5"),
            ("--until-radius", "live mixed.csv", "9"),
            ("--u-s", "live mixed.csv", "9 --u-r 9"),
            ("--u-r", "live mixed.csv", "9 --u-s 9"),
        ],
    ),
];

pub(crate) const STUDIES: &[Context] = &[
    on(
        "study tiny.toml --replicates 4 --attribution 0 --json",
        &[
            ("--replicates", "study tiny.toml --attribution 0 --json", "20"),
            ("--attribution", "study tiny.toml --replicates 4 --json", "9"),
            ("--surface", "", "parametric --closed u"),
            ("--budget", "study tiny.toml --replicates 300000 --attribution 0", "0.1"),
            ("--tolerance", "", "1"),
            ("--json", "study tiny.toml --replicates 4 --attribution 0", ""),
            ("--quiet", "study tiny.toml --replicates 4 --attribution 0", ""),
        ],
    ),
    on(
        "study fixed.toml --replicates 2 --coverage --json",
        &[
            ("--tolerance", "", "1"),
            ("--coverage", "study fixed.toml --replicates 2 --json", ""),
            ("--surface", "", "parametric --closed u"),
            ("--json", "study fixed.toml --replicates 2 --coverage", ""),
            ("--quiet", "study fixed.toml --replicates 2 --coverage", ""),
        ],
    ),
    on(
        "study tiny.toml --replicates 4 --sweep surface.radius=20,30 --json",
        &[
            ("--replicates", "study tiny.toml --sweep surface.radius=20,30 --json", "20"),
            ("--tolerance", "", "1"),
            ("--sweep", "study tiny.toml --replicates 4 --json", "surface.radius=20,30"),
            ("--surface", "", "parametric --closed u"),
            ("--budget", "study tiny.toml --replicates 9000 --sweep surface.radius=20:30:lin30", "0.1"),
            ("--quiet", "study tiny.toml --replicates 4 --sweep surface.radius=20,30", ""),
            ("--json", "study tiny.toml --replicates 4 --sweep surface.radius=20,30", ""),
        ],
    ),
];

pub(crate) const EXPLORATIONS: &[Context] = &[
    on("explore bar.toml --contacts 33", &[("--contacts", "explore bar.toml", "33")]),
    on(
        "explore bar.toml --contacts 33 --sigma 0.05,3 --json",
        &[
            ("--contacts", "explore bar.toml --sigma 0.05,3 --json", "33"),
            ("--sigma", "explore bar.toml --contacts 33 --json", "0.1,4"),
            ("--frame", "explore lean.toml --contacts 33 --sigma 0.05,3 --json", "auto"),
            ("--quiet", "explore bar.toml --contacts 33 --sigma 0.05,3", ""),
            ("--json", "explore bar.toml --contacts 33 --sigma 0.05,3", ""),
        ],
    ),
    on("frontier bar.csv --seconds 0.05", &[]),
    on("frontier --orders", &[("--orders", "frontier bar.csv", "")]),
];

/// Pairs that may stay without a word, and why. One that does matter is taken out of the list.
pub(crate) const SILENT: &[(&str, &str, &str)] = &[
    ("scenes paper-plane", "--quiet", "what is printed is the scene itself"),
    ("simulate bar.toml -o -", "--quiet", "what is printed are the contacts themselves"),
];

/// Pairs that another test tries, because they take seconds or because no two runs are alike.
pub(crate) const ELSEWHERE: &[(&str, &str)] = &[
    ("frontier bar.csv --seconds 0.05", "--budget"),
    ("frontier bar.csv --seconds 0.05", "--seconds"),
    ("frontier bar.csv --seconds 0.05", "--json"),
    ("frontier bar.csv --seconds 0.05", "--out"),
    ("frontier bar.csv --seconds 0.05", "--quiet"),
    ("frontier bar.csv --seconds 0.05", "--all"),
    ("frontier bar.csv --seconds 0.05", "--beside"),
    // two thousand replicates are what the option takes less of
    ("study fixed.toml --replicates 2 --coverage --json", "--replicates"),
    ("frontier --orders", "--json"),
    ("frontier --orders", "--quiet"),
];
