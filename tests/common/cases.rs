//! Cases in text files: input lines, marked with `> `, followed by the expected output. `[..]` matches any text; `[=name]` matches any
//! text the first time, and the same text later in the file.

use std::collections::HashMap;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use super::command::CACHE;

/// Runs every case of a file in `tests` and compares the output with the expected one.
///
/// With `UPDATE_CASES=1` it rewrites the cases that differ instead. Read the difference before you commit it.
pub fn check_cases(file: &str, mut run: impl FnMut(&str) -> String) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(file);
    let text = std::fs::read_to_string(&path).unwrap();
    let (mut checked, mut names) = (Vec::new(), HashMap::new());
    for case in text.trim_end().split("\n\n") {
        let head: Vec<&str> = case.lines().take_while(|line| line.starts_with(['>', '#'])).collect();
        let input: Vec<&str> = head.iter().filter_map(|line| line.strip_prefix("> ")).collect();
        let found = format!("{}\n{}", head.join("\n"), run(&input.join("\n")));
        let found = found.trim_end().to_owned();
        checked.push(if is_like(&found, case, &mut names) { case.to_owned() } else { found });
    }
    if std::env::var_os("UPDATE_CASES").is_some() {
        std::fs::write(&path, checked.join("\n\n") + "\n").unwrap();
        return;
    }
    for (found, expected) in checked.iter().zip(text.trim_end().split("\n\n")) {
        assert!(found == expected, "in {file}:\n{found}\n\nand expected, where {names:?}:\n{expected}");
    }
}

/// Runs the cases of a file one after another in a new folder, each as a shell script that can call `furrow`. `$ROOT` is the package's
/// folder. ` => ` is followed by the parts of the JSON answer to compare: see [`picked`].
pub fn check_session(file: &str) {
    let folder = tempfile::tempdir().unwrap();
    let programs = Path::new(env!("CARGO_BIN_EXE_furrow")).parent().unwrap();
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").unwrap());
    check_cases(file, |case| {
        let (script, places) = case.split_once(" => ").unwrap_or((case, ""));
        let mut shell = Command::new("sh");
        shell.args(["-c", script]).current_dir(&folder).env("PATH", &path).env("XDG_CACHE_HOME", CACHE);
        let output = shell.env("ROOT", env!("CARGO_MANIFEST_DIR")).output().unwrap();
        let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        let out = match serde_json::from_str(&out) {
            Ok(answer) if !places.is_empty() => {
                places.split(' ').map(|place| picked(&answer, place) + "\n").collect::<String>()
            }
            _ => out,
        };
        let code = if output.status.success() { String::new() } else { format!("{}\n", output.status) };
        let lines = [&out, &err, &code].into_iter().flat_map(|text| text.lines());
        // A slow machine prints its progress every half minute.
        let is_progress = |line: &str| {
            let seconds = line.strip_prefix("furrow: ").and_then(|rest| rest.split_once(" s: "));
            seconds.is_some_and(|(seconds, _)| seconds.bytes().all(|byte| byte.is_ascii_digit()))
        };
        lines.filter(|line| !line.trim().is_empty() && !is_progress(line)).collect::<Vec<_>>().join("\n")
    });
}

/// The part of a document at a path. Its steps are separated by `/`: a key or an index; `last`; `*`, every entry; `#`, the number of
/// entries; `key=value`, the entry of a list with this value. A path that ends in `<` or `>` and a number gives `true` if all numbers
/// there are below or above it.
fn picked(value: &Value, place: &str) -> String {
    if let Some(at) = place.find(['<', '>']) {
        let (is_below, limit) = (&place[at..=at] == "<", place[at + 1..].parse::<f64>().unwrap());
        let numbers = picked(value, &place[..at]);
        let mut each =
            numbers.split(' ').map(|number| number.parse::<f64>().unwrap_or_else(|_| panic!("{place}: {numbers:?}")));
        return each.all(|number| if is_below { number < limit } else { number > limit }).to_string();
    }
    let (step, rest) = place.split_once('/').unwrap_or((place, ""));
    let list = || value.as_array().unwrap();
    match (step, step.split_once('=')) {
        ("", _) => value.as_str().map_or_else(|| value.to_string(), str::to_owned),
        ("#", _) => value.as_object().map_or_else(|| list().len(), |map| map.len()).to_string(),
        ("*", _) => list().iter().map(|entry| picked(entry, rest)).collect::<Vec<_>>().join(" "),
        ("last", _) => picked(list().last().unwrap(), rest),
        (_, Some((key, wanted))) => picked(list().iter().find(|entry| entry[key] == wanted).unwrap(), rest),
        _ => picked(step.parse::<usize>().map_or_else(|_| &value[step], |index| &value[index]), rest),
    }
}

/// Whether a text matches a pattern. Adds the texts that its names matched to `names`.
fn is_like(found: &str, pattern: &str, names: &mut HashMap<String, String>) -> bool {
    // The texts between the wildcards, and the wildcards.
    let (mut texts, mut wildcards) = (vec![String::new()], Vec::new());
    for (k, piece) in pattern.split('[').enumerate() {
        let between = texts.last_mut().unwrap();
        match piece.split_once(']').filter(|(mark, _)| k > 0 && (*mark == ".." || mark.starts_with('='))) {
            Some((mark, text)) if names.contains_key(mark) => between.push_str(&format!("{}{text}", names[mark])),
            Some((mark, text)) => {
                wildcards.push(mark);
                texts.push(text.to_owned());
            }
            None => between.push_str(&format!("{}{piece}", if k > 0 { "[" } else { "" })),
        }
    }
    let Some(mut rest) = found.strip_prefix(&texts[0]) else { return false };
    for (k, mark) in wildcards.iter().enumerate() {
        let text = &texts[k + 1];
        let last = k + 1 == wildcards.len();
        let place =
            if last { rest.strip_suffix(text.as_str()).map(|stem| stem.len()) } else { rest.find(text.as_str()) };
        let Some(place) = place else { return false };
        if *mark != ".." {
            names.insert((*mark).to_owned(), rest[..place].to_owned());
        }
        rest = &rest[place + text.len()..];
    }
    rest.is_empty()
}
