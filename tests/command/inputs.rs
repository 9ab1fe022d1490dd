//! Any input file is read in bounded time and memory, and an invalid one gives one error message.

use std::path::Path;
use std::process::Command;

use furrow_lineage::Lineage;

use crate::common::command::{HERE, answer, json, refusal};

fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

fn lineage(founders: &[String]) -> String {
    format!("Lineage(name: \"x\", founders: [\n{}\n])", founders.join(",\n"))
}

fn founder(name: &str, mother: &str, daughter: &str) -> String {
    format!("(name: \"{name}\", mother: \"{mother}\", daughter: {daughter})")
}

fn complaint(text: &str) -> String {
    let said = Lineage::parse(text, "my.ron").unwrap_err().to_string();
    assert!(said.len() < 700, "{} bytes: {}...", said.len(), &said[..200]);
    said
}

/// A hundred thousand founders, in a wide tree and in a deep one. Pair by pair they would take minutes; the bound on the
/// work is held by a test beside the check of names.
#[test]
fn many_founders_are_read() {
    let which = |k: usize| if k % 2 == 1 { "larger" } else { "smaller" };
    let mut wide = vec!["(name: \"F0\")".to_owned()];
    wide.extend((1..=100_000).map(|k| founder(&format!("F{k}"), &format!("F{}", (k - 1) / 2), which(k))));
    assert_eq!(Lineage::parse(&lineage(&wide), "wide").unwrap().founders.len(), 100_001);
    let mut deep = vec!["(name: \"M0\")".to_owned()];
    for k in 1..=40_000 {
        let mother = format!("M{}", k - 1);
        deep.extend([founder(&format!("M{k}"), &mother, "larger"), founder(&format!("S{k}"), &mother, "smaller")]);
    }
    assert_eq!(Lineage::parse(&lineage(&deep), "deep").unwrap().founders.len(), 80_001);
}

/// Messages about very many founders name a few of them.
#[test]
fn messages_about_many_founders_are_short() {
    let mut many: Vec<String> =
        (0..20_000).map(|k| founder(&format!("F{k}"), &format!("F{}", (k + 1) % 20_000), "larger")).collect();
    assert!(
        complaint(&lineage(&many)).contains("F8 <- F9 <- … (19990 more) <- F0; one founder"),
        "{}",
        complaint(&lineage(&many))
    );
    many[0] = founder("F0", "F1999x", "larger");
    assert_eq!(
        complaint(&lineage(&many)),
        "my.ron:2: founder \"F0\": mother = \"F1999x\": must be a founder of this file: F0, F1, F2, F3, F4, F5, F6, F7, F8, F9, … (19990 more); did you mean F1999?"
    );
    let alone: Vec<String> = (0..20_000).map(|k| format!("(name: \"F{k}\")")).collect();
    assert_eq!(
        complaint(&lineage(&alone)),
        "my.ron:3: founders F0, F1, F2, F3, F4, F5, F6, F7, F8, F9, … (19990 more) have no mother; exactly one founder may have none"
    );
    let long = "x".repeat(100_000);
    let said = complaint(&lineage(&[format!("(name: \"{long}\", cue: \"{long}\")")]));
    assert!(said.contains("must be none, since the file has no cues"), "{said}");
}

/// Some editors begin a file with a byte order mark.
#[test]
fn a_byte_order_mark_is_passed_over() {
    let text = "\u{feff}Lineage(name: \"x\", founders: [(name: \"A\")])";
    assert_eq!(Lineage::parse(text, "x").unwrap(), Lineage::parse(&text[3..], "x").unwrap());
    let folder = tempfile::tempdir().unwrap();
    let config = write(folder.path(), "c.ron", "\u{feff}Config(physics: (epsilon: 0.8))");
    answer(HERE, &["steady", "--r0", "2", "--xi", "1", "--config", &config]);
    let targets = write(folder.path(), "t.ron", "\u{feff}Targets(unknowns: [], thresholds: [])");
    assert!(refusal(HERE, &["calibrate", &targets]).contains("unknowns = []: must be at least one parameter"));
}

/// Names land in drawings and pages, which are XML.
#[test]
fn characters_that_xml_cannot_hold_are_refused() {
    for c in ["\u{1}", "\u{7f}", "\u{85}", "\u{fffe}", "\u{ffff}"] {
        for (text, field) in [
            (format!("Lineage(name: \"x{c}\", founders: [(name: \"A\")])"), "name = "),
            (format!("Lineage(name: \"x\", citation: \"y{c}\", founders: [(name: \"A\")])"), "citation = "),
            (format!("Lineage(name: \"x\", cues: {{\"c{c}\": none}}, founders: [(name: \"A\")])"), "cues = "),
            (format!("Lineage(name: \"x\", founders: [(name: \"A{c}\")])"), "name = "),
        ] {
            let said = complaint(&text);
            assert!(said.contains(field) && said.contains("control characters"), "{said}");
            assert!(!said.contains(c), "what cannot be shown is shown escaped: {said}");
        }
    }
}

/// Pipes are read like files, and one that never ends is left at the limit.
#[cfg(unix)]
#[test]
fn pipes_are_read_and_endless_ones_are_left() {
    let text = "Lineage(name: \"x\", limits: (max_depth: 1), founders: [(name: \"A\", r0: 1.0)])";
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let writer = {
        let pipe = pipe.clone();
        std::thread::spawn(move || std::fs::write(pipe, text).unwrap())
    };
    assert_eq!(Lineage::read(&pipe).unwrap(), Lineage::parse(text, "x").unwrap());
    writer.join().unwrap();
    assert_eq!(
        refusal(HERE, &["tree", "/dev/zero"]),
        "furrow: error: /dev/zero: cannot be read: it is longer than 64 MB, the most that is read of a file\n"
    );
    // Tables of volumes may be far longer than other files: the first bytes show whether they are text.
    let said = refusal(HERE, &["compare", "volumes", "/dev/zero"]);
    assert_eq!(said, "furrow: error: /dev/zero:1:1: this is no text: it has a byte 0\n");
    // As long as it says, with nothing in it: its length alone is looked at.
    let long = folder.path().join("long.ron");
    std::fs::File::create(&long).unwrap().set_len(100 << 20).unwrap();
    assert_eq!(
        refusal(HERE, &["tree", long.to_str().unwrap()]),
        format!(
            "furrow: error: {}: cannot be read: it has 100 MB, which is longer than 64 MB, the most that is read of a file\n",
            long.display()
        )
    );
}

/// Quoted file contents have no control characters.
#[test]
fn messages_have_no_control_characters() {
    let folder = tempfile::tempdir().unwrap();
    for (command, text) in [
        ("tree", "Lineage(name: \"x\", founders: [(name: \u{1b}[2J)])"),
        ("sweep", "Sweep(kind: division, axes: [\u{7}])"),
        ("calibrate", "Targets(unknowns: [], thresholds: [\0])"),
    ] {
        let path = write(folder.path(), "x.ron", text);
        let out = folder.path().join("out");
        let mut arguments = vec![command, &path];
        if command == "sweep" {
            arguments.extend(["--out", out.to_str().unwrap()]);
        }
        let said = refusal(HERE, &arguments);
        assert!(said.starts_with(&format!("furrow: error: {path}:1:")), "{said:?}");
        assert!(!said.trim_end().contains(char::is_control), "{said:?}");
    }
}

#[test]
fn an_activity_that_is_no_normal_number_is_as_good_as_none() {
    let [tiny, zero] = ["1e-308", "0"].map(|xi| json(HERE, &["steady", "--r0", "2", "--xi", xi]));
    assert_eq!(tiny["L"], zero["L"]);
}
