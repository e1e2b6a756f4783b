//! The C++17 example is compiled, linked with both libraries and run, and so is C, where a compiler is there.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A compiler that answers.
fn compiler(names: [&str; 3]) -> Option<&str> {
    let answers =
        |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success());
    names.into_iter().find(answers)
}

/// Where this build put its libraries: beside this test, or above it.
fn library(name: &str) -> Option<PathBuf> {
    let deps = std::env::current_exe().unwrap().parent().unwrap().to_path_buf();
    [deps.join(name), deps.parent().unwrap().join(name)].into_iter().find(|path| path.exists())
}

fn ran(command: &mut Command) -> Output {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

#[test]
fn the_example_in_cpp_is_built_and_says_what_it_felt() {
    let Some(compiler) = compiler(["c++", "g++", "clang++"]).filter(|_| cfg!(target_os = "linux")) else {
        println!("not checked: no C++ compiler, or no Linux, whose linker this test speaks to");
        return;
    };
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = tempfile::tempdir().unwrap();
    let mut tried = 0;
    for name in ["libpalpate_capi.so", "libpalpate_capi.a"] {
        let Some(library) = library(name) else {
            println!("not checked: {name} is not built beside this test");
            continue;
        };
        tried += 1;
        let program = folder.path().join(name.replace('.', "_"));
        let mut line = Command::new(compiler);
        line.args(["-std=c++17", "-Wall", "-Wextra", "-Werror", "-I"]).arg(here.join("include"));
        line.arg(here.join("examples/robot.cpp")).arg(&library).args(["-pthread", "-ldl", "-lm", "-o"]).arg(&program);
        ran(&mut line);
        let text = ran(Command::new(&program).env("LD_LIBRARY_PATH", library.parent().unwrap())).stdout;
        let text = String::from_utf8(text).unwrap();
        for words in ["ridge, a cylinder: radius 2", "height field: ridge", "of the last 30", "refused (2): x of touch"]
        {
            assert!(text.contains(words), "{words}: {text}");
        }
    }
    assert!(tried > 0, "neither library was found");
}

/// The header is C, too.
#[test]
fn the_header_is_c() {
    let Some(compiler) = compiler(["cc", "gcc", "clang"]) else {
        println!("not checked: no C compiler");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("a.c");
    std::fs::write(&source, "#include <palpate.h>\nint main(void) { return palpate_version()[0] == 0; }\n").unwrap();
    let mut line = Command::new(compiler);
    line.args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-I"]);
    ran(line.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("include")).arg(source));
}

/// CMake finds the package where it was installed.
#[test]
fn cmake_finds_the_package() {
    let there = |name: &str| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success());
    let (Some(_), true, Some(library)) = (
        compiler(["c++", "g++", "clang++"]),
        there("cmake") && cfg!(target_os = "linux"),
        library("libpalpate_capi.so"),
    ) else {
        println!("not checked: no CMake, no C++ compiler, or no Linux");
        return;
    };
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = tempfile::tempdir().unwrap();
    let (prefix, build) = (folder.path().join("prefix"), folder.path().join("build"));
    ran(Command::new(here.join("install.sh")).arg(&prefix).arg("--from").arg(library.parent().unwrap()));
    let mut line = Command::new("cmake");
    line.arg("-S").arg(here.join("examples")).arg("-B").arg(&build);
    ran(line.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display())));
    ran(Command::new("cmake").arg("--build").arg(&build));
    let text = String::from_utf8(ran(&mut Command::new(build.join("robot"))).stdout).unwrap();
    assert!(text.contains("ridge, a cylinder"), "{text}");
}
