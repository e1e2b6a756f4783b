//! `palpate live`: a line after each touch, which agrees with `palpate fit` of the same touches; what is no touch; a robot that
//! stops, starts anew or goes away; a state that is taken up again; a scene that plays the robot.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, Output, Stdio};

use assert_cmd::Command;
use serde_json::Value;

fn palpate(here: &Path, line: &str, input: &[u8]) -> Output {
    let mut command = Command::cargo_bin("palpate").unwrap();
    command.current_dir(here).args(line.split_whitespace()).write_stdin(input).output().unwrap()
}

/// The lines of an output that are answers, and what stands on standard error.
fn answers(here: &Path, line: &str, input: &str) -> (Vec<Value>, String) {
    let output = palpate(here, line, input.as_bytes());
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{line}: {errors}");
    let text = String::from_utf8(output.stdout).unwrap();
    let lines = text.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    (lines.filter(|line| line.get("answer").is_some()).collect(), errors)
}

fn touch(k: usize) -> String {
    // a bar of radius 9 along y, in an order that fills the patch; the errors are a fixed pattern
    let (x, y) = ((k as f64 * 0.754_877_666).fract() * 8.0 - 4.0, (k as f64 * 0.569_840_291).fract() * 8.0 - 4.0);
    let z = (81.0 - x * x).sqrt() + 0.01 * (k as f64 * 2.3).sin();
    format!("{x},{y},{z},{},0,{}\n", x / 9.0 + 0.01 * (k as f64 * 1.7).sin(), (81.0 - x * x).sqrt() / 9.0)
}

/// A table of touches.
fn table(touches: std::ops::Range<usize>) -> String {
    "x,y,z,nx,ny,nz\n".to_string() + &touches.map(touch).collect::<String>()
}

/// The radius of an answer, and that of another with half of its interval.
fn radii(own: &Value, batch: &Value) -> Option<[f64; 3]> {
    let interval: Vec<f64> = batch["radius_interval"].as_array()?.iter().filter_map(Value::as_f64).collect();
    let [lo, hi] = interval[..] else { return None };
    Some([own["radius"].as_f64()?, batch["radius"].as_f64()?, 0.5 * (hi - lo)])
}

/// Every answer that is called fresh is the one of `palpate fit`, to its digits; one that touches have moved is near it.
#[test]
fn an_answer_is_that_of_the_batch() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let (lines, _) = answers(here, "live - --json", &table(0..26));
    let last = lines.last().unwrap();
    assert_eq!((&last["touch"], &last["answer"], &last["contacts"]), (&26.into(), &"fresh".into(), &26.into()));
    let (mut moved, mut compared) = (0, 0);
    for line in &lines {
        let of = line["contacts"].as_u64().unwrap() as usize;
        match line["answer"].as_str().unwrap() {
            "fresh" => assert_eq!(line["touch"], line["contacts"]),
            "moved" => {
                moved += 1;
                assert!(line["touch"] == line["contacts"] && line["made_at"].as_u64() < line["touch"].as_u64());
            }
            "none" => {
                assert!(line["why"].is_string() && line["shape"].is_null());
                continue;
            }
            other => panic!("{other}"),
        }
        std::fs::write(here.join("t.csv"), table(0..of)).unwrap();
        let fit: Value = serde_json::from_slice(&palpate(here, "fit t.csv --json", b"").stdout).unwrap();
        if line["answer"] == "fresh" {
            assert_eq!(line["shape"], fit["shape"], "{of} touches");
            assert_eq!(line["kind"], fit["fit"]["chosen"]["hypothesis"]);
        } else if let Some([own, batch, u]) = radii(&line["shape"], &fit["shape"]) {
            assert!((own - batch).abs() < 0.75 * u, "{of} touches: {own} for {batch} +- {u}");
            compared += 1;
        }
    }
    assert!(compared > 4, "{compared} answers that were moved have a radius");
    assert!(moved > 4, "{moved} answers were moved");
    let radius = last["shape"]["radius"].as_f64().unwrap();
    assert!((radius - 9.0).abs() < 0.3, "{radius}");
    assert!(last["next"]["at"].is_array() && last["next"]["z"].is_number());
}

#[test]
fn people_read_one_line_a_touch() {
    let folder = tempfile::tempdir().unwrap();
    let output = palpate(folder.path(), "live - --refresh 0", table(0..12).as_bytes());
    let (text, errors) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert_eq!(text.lines().count(), 12, "{text}");
    assert!(text.starts_with("1  no answer: 1 contact"), "{text}");
    let last = text.lines().last().unwrap();
    assert!(last.starts_with("12  ridge") && last.contains("radius") && last.contains("next"), "{last}");
    assert_eq!(errors.lines().count(), 1);
    assert!(errors.contains("12 touches, 0 lines left out; 12 looks"), "{errors}");
    assert!(palpate(folder.path(), "live - --quiet", b"x,y,z\n1,2,3\n").stderr.is_empty());
}

/// What is no touch is said with its line, and nothing else is lost.
#[test]
fn what_is_no_touch_is_left_out_and_said() {
    let folder = tempfile::tempdir().unwrap();
    let good: Vec<String> = (0..10).map(touch).collect();
    let mut lines = vec!["x,y,z,nx,ny,nz,time\n".to_string()];
    lines.extend(good.iter().enumerate().map(|(k, row)| format!("{},{k}\n", row.trim())));
    lines.insert(3, "1,2\n".into());
    lines.insert(5, "\n".into());
    lines.insert(7, "1,2,3,0,0,x,4\n".into());
    lines.insert(9, "# a remark\n".into());
    lines.push("1,2,3,0,0,1,inf,4,5\n".into());
    let (found, errors) = answers(folder.path(), "live - --json --refresh 0", &lines.concat());
    let (clean, _) = answers(folder.path(), "live - --json --refresh 0", &table(0..10));
    assert_eq!(found.last().unwrap()["shape"], clean.last().unwrap()["shape"]);
    assert_eq!(found.len(), 10);
    let said: Vec<&str> = errors.lines().collect();
    assert_eq!(said.len(), 3, "{errors}");
    for (line, number) in said.iter().zip([4, 8, 16]) {
        assert!(line.contains(&format!("line {number}: ")) && line.contains("no touch, left out"), "{line}");
    }
}

#[test]
fn a_sensor_that_starts_anew_and_touches_out_of_order_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let row = |k: usize, time: f64| format!("{},{time}\n", touch(k).trim());
    let header = "x,y,z,nx,ny,nz,t\n";
    let mut text = header.to_string();
    (0..5).for_each(|k| text += &row(k, k as f64));
    text += &row(5, 2.5);
    text += &row(6, 6.0);
    text += header;
    (7..12).for_each(|k| text += &row(k, 0.1 * k as f64));
    let (found, errors) = answers(folder.path(), "live - --json --refresh 0", &text);
    let (clean, _) = answers(folder.path(), "live - --json --refresh 0", &table(0..12));
    assert_eq!(found.last().unwrap()["shape"], clean.last().unwrap()["shape"]);
    let said: Vec<&str> = errors.lines().collect();
    assert_eq!(said.len(), 2, "{errors}");
    assert!(said[0].contains("line 7: a touch of time 2.5 comes after one of 4; it counts all the same"), "{errors}");
    assert!(said[1].contains("line 9: names of columns again"), "{errors}");
}

/// JSON lines, as messages of robots are written down, are the touches of the table.
#[test]
fn json_lines_are_touches() {
    let folder = tempfile::tempdir().unwrap();
    let message = |k: usize| {
        let values: Vec<f64> = touch(k).trim().split(',').map(|v| v.parse().unwrap()).collect();
        let [x, y, z] = [values[0], values[1], values[2]];
        serde_json::json!({"stamp": k, "pose": {"position": {"x": x, "y": y, "z": z}}, "normal": &values[3..]})
            .to_string()
    };
    let text = (0..12).map(|k| message(k) + "\n").collect::<String>();
    let (found, errors) = answers(folder.path(), "live - --json", &text);
    let (clean, _) = answers(folder.path(), "live - --json", &table(0..12));
    assert!(errors.is_empty(), "{errors}");
    assert_eq!(found.last().unwrap()["shape"], clean.last().unwrap()["shape"]);
}

/// The last so many touches count: a surface that was another one long ago is forgotten.
#[test]
fn a_window_forgets() {
    let folder = tempfile::tempdir().unwrap();
    let flat: String = (0..30).map(|k| format!("{},{},-50,0,0,1\n", k % 6, k / 6)).collect();
    let text = format!("x,y,z,nx,ny,nz\n{flat}{}", (0..14).map(touch).collect::<String>());
    let (found, _) = answers(folder.path(), "live - --json --window 14 --refresh 1", &text);
    let (clean, _) = answers(folder.path(), "live - --json", &table(0..14));
    let (last, own) = (found.last().unwrap(), clean.last().unwrap());
    assert_eq!((&last["shape"], &last["contacts"], &last["touch"]), (&own["shape"], &14.into(), &44.into()));
}

/// Of a file of something else five lines are told, not a million; one touch, and the next fault is told again.
#[test]
fn lines_that_are_no_touch_are_told_a_few_times_in_a_row() {
    let folder = tempfile::tempdir().unwrap();
    let other: String = (0..1000).map(|k| format!("{k},2\n")).collect();
    let output = palpate(folder.path(), "live -", format!("time,force\n{other}").as_bytes());
    let errors = String::from_utf8(output.stderr).unwrap();
    assert!(errors.lines().count() == 6 && errors.contains("nothing more is said"), "{errors}");
    assert!(errors.contains("1001 lines left out"), "{errors}");
    let faults = "a,b\n".repeat(7);
    let (found, errors) = answers(folder.path(), "live - --json", &format!("{}{faults}{}a,b\n", table(0..9), touch(9)));
    let told = errors.lines().filter(|line| line.contains("no touch")).count();
    assert_eq!((&found.last().unwrap()["touch"], told), (&10.into(), 6), "{errors}");
}

/// What several things are stays as it was told until the touches have grown by the whole of --refresh: a look at them takes longest.
#[test]
fn several_things_are_looked_at_as_often_as_one() {
    let touch = |k: usize| {
        let at = |by: f64| (k as f64 * by).fract() * 20.0 - 10.0;
        let side = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let (mut place, mut normal) = ([at(0.754_877_666), at(0.569_840_291), at(0.438_579)], [0.0; 3]);
        (place[k % 3], normal[k % 3]) = (side * (10.0 + 0.03 * (k as f64 * 2.3).sin()), side);
        let line: Vec<String> = place.iter().chain(&normal).map(f64::to_string).collect();
        line.join(",") + "\n"
    };
    let text = format!("x,y,z,nx,ny,nz\n{}", (0..90).map(touch).collect::<String>());
    let folder = tempfile::tempdir().unwrap();
    let output = palpate(folder.path(), "live - --json", text.as_bytes());
    let text = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let (last, told) = (lines.last().unwrap(), lines.iter().rfind(|line| line.get("answer").is_some()).unwrap());
    assert!(told["why"].as_str().is_some_and(|why| why.contains("several things")), "{told}");
    // a quarter more each, and once at the end
    let of_many = lines.iter().filter(|line| line["touch"].as_u64() > Some(50) && line["touch"] == line["made_at"]);
    assert!(of_many.count() <= 4 && last["touches"] == 90, "{last}");
}

/// A run that was cut in two answers as one run, whether its second half has names of its own or none.
#[test]
fn a_state_is_taken_up_again() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let (whole, _) = answers(here, "live - --json", &table(0..20));
    answers(here, "live - --json --save s.json", &table(0..11));
    let rows: String = (11..20).map(touch).collect();
    for second in [table(11..20), rows] {
        let (found, errors) = answers(here, "live - --json --resume s.json", &second);
        assert!(errors.is_empty(), "{errors}");
        assert_eq!(found.last().unwrap()["shape"], whole.last().unwrap()["shape"]);
        assert_eq!(found[0]["touch"], 12);
    }
    for (name, text) in [("a", "{}"), ("b", "x,y,z\n"), ("c", "{\"schema\":\"palpate.live.state/1\"}")] {
        std::fs::write(here.join(name), text).unwrap();
        let output = palpate(here, &format!("live - --resume {name}"), b"");
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && message.contains("--resume"), "{message}");
    }
    let mut state: Value = serde_json::from_slice(&std::fs::read(here.join("s.json")).unwrap()).unwrap();
    state["contacts"]["y"].as_array_mut().unwrap().pop();
    std::fs::write(here.join("d"), state.to_string()).unwrap();
    assert_eq!(palpate(here, "live - --resume d", b"").status.code(), Some(2));
}

/// The scene's own sweeps come first, then the places that the answers propose, until the goal.
#[test]
fn a_scene_plays_the_robot() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let scene = "[surface]\nkind = \"sphere\"\nradius = 12.0\n[sweep]\nfingers = [-4.0, 0.0, 4.0]\nfrom = -4.0\nto = 4.0\n\
        stations = 3\n[effects.position_noise]\nsigma = 0.1\n[effects.normal_noise]\nsigma_deg = 4.0\n";
    std::fs::write(here.join("ball.toml"), scene).unwrap();
    let output = palpate(here, "live ball.toml --until-radius 0.6 --json --save s.json", b"");
    let text = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let (end, answers_seen) = lines.split_last().unwrap();
    assert_eq!((&end["stopped"], &end["touches"]), (&"goal".into(), &answers_seen.len().into()));
    assert!(answers_seen.len() > 9);
    for line in &answers_seen[answers_seen.len() - 2..] {
        let [lo, hi] = [0, 1].map(|k| line["shape"]["radius_interval"][k].as_f64().unwrap());
        assert!(line["answer"] == "fresh" && (hi - lo) / 2.0 <= 0.6, "{line}");
    }
    // the touch was made where the line before had proposed it
    let state: Value = serde_json::from_slice(&std::fs::read(here.join("s.json")).unwrap()).unwrap();
    assert_eq!(state["planned"][0], answers_seen[8]["next"]["at"]);
    let more = answers_seen.len() + 2;
    let (found, _) = answers(here, &format!("live ball.toml --contacts {more} --json --resume s.json"), "");
    let numbers: Vec<&Value> = found.iter().map(|line| &line["touch"]).collect();
    assert_eq!((numbers[0], numbers[1]), (&(more - 1).into(), &more.into()));
    assert_eq!(found.last().unwrap()["answer"], "fresh");
    let refused = palpate(here, "live bar --resume s.json", b"");
    assert_eq!(refused.status.code(), Some(2));
}

fn started(here: &Path, line: &str) -> Child {
    let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("palpate"));
    let piped = command.current_dir(here).args(line.split_whitespace()).stdin(Stdio::piped());
    piped.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// A robot that goes on writing after its reader has gone, and one that is interrupted: what was touched is kept.
#[test]
fn a_reader_that_goes_and_an_interrupt_keep_the_touches() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let touches = |name: &str| -> u64 {
        let state: Value = serde_json::from_slice(&std::fs::read(here.join(name)).unwrap()).unwrap();
        state["touches"].as_u64().unwrap()
    };
    let mut gone = started(here, "live - --refresh 9 --save gone.json");
    let mut input = gone.stdin.take().unwrap();
    let mut output = BufReader::new(gone.stdout.take().unwrap());
    input.write_all(table(0..3).as_bytes()).unwrap();
    output.read_line(&mut String::new()).unwrap();
    drop(output);
    // enough that a line meets the closed pipe; the program may end before all are written
    let _ = input.write_all((3..60).map(touch).collect::<String>().as_bytes());
    drop(input);
    let mut message = String::new();
    gone.stderr.take().unwrap().read_to_string(&mut message).unwrap();
    assert!(gone.wait().unwrap().success() && message.is_empty(), "{message}");
    assert!(touches("gone.json") >= 1);
    if cfg!(unix) {
        let mut asked = started(here, "live - --save asked.json");
        let mut input = asked.stdin.take().unwrap();
        let mut output = BufReader::new(asked.stdout.take().unwrap());
        input.write_all(table(0..5).as_bytes()).unwrap();
        (0..5).for_each(|_| assert!(output.read_line(&mut String::new()).unwrap() > 0));
        let id = asked.id().to_string();
        assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        assert_eq!(asked.wait().unwrap().code(), Some(130));
        assert_eq!(touches("asked.json"), 5);
    }
}

#[test]
fn options_of_the_other_kind_of_input_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for line in
        ["live - --contacts 9", "live - --seed 3", "live bar --columns x=px", "live - --window 2", "live no.csv"]
    {
        let output = palpate(folder.path(), line, b"x,y,z\n");
        assert_eq!(output.status.code(), Some(2), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    }
}
