//! Whatever a path names and whatever it holds is read in bounded time and memory, and refused in one message.

use std::path::Path;
use std::process::{Command, Output};

use furrow::lineage::Lineage;

use crate::common::command::{HERE, furrow, refusal};

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

/// A name that stands twice is told with both of its places.
#[test]
fn names_that_stand_twice() {
    assert_eq!(
        complaint("Lineage(name: \"x\", founders: [\n(name: \"A\"),\n\n(name: \"A\"),\n])"),
        "my.ron:4: founders[1].name = \"A\": must be unique in the file: it is the name of a founder at my.ron:2 already"
    );
    assert_eq!(
        complaint("Lineage(name: \"x\", cues: {\"c\": none,\n\"c\": none}, founders: [(name: \"A\")])"),
        "my.ron:2:10: cues[\"c\"]: the cue \"c\" stands twice"
    );
}

#[test]
fn malformed_ron_names_field_what_stands_there_and_what_is_expected() {
    for (text, expected) in [
        (
            "Lineage(name: \"x\", founders: [(name: \"A\", r0: \"big\")])",
            "founders[0].r0: expected a length: a number of L_h, as in 5.4, or of µm, as in \"17um\", found the string \"big\"",
        ),
        (
            "Lineage(name: \"x\", founders: [(name: \"A\", r0: 1,5)])",
            "1:49: founders[0]: expected the name of a field, found 5",
        ),
        (
            "Lineage(name: \"x\", founders: [(name: \"A\"",
            "1:41: founders[0].name: expected a comma or the closing bracket, found the end of the file",
        ),
        (
            "Lineage(name: \"x\", founders: [(name: A)])",
            "1:38: founders[0].name: expected text in double quotes, found A",
        ),
        ("Lineage(name: \"x\", founders: (name: \"A\"))", "1:30: founders: expected a list in brackets [ ], found ("),
        (
            "Lineage(name: \"x\", limits: (max_depth: 2.5), founders: [])",
            "1:41: limits.max_depth: expected a whole number, found 2.5",
        ),
        (
            "Lineage(name: \"x\", limits: (max_depth: -1), founders: [])",
            "1:41: limits.max_depth: the whole number is negative or too large",
        ),
        (
            "Lineage(name: \"x\", naming: (a, p), founders: [])",
            "1:29: naming: expected a character in single quotes, found a",
        ),
        (
            "Lineage(name: \"x\", founders: [(name: \"A\", inherit: yes)])",
            "1:52: founders[0].inherit: expected true or false, found yes",
        ),
        ("Lineage(name: \"x\", founders: [(mother: \"A\")])", "founders[0]: the field \"name\" is missing"),
        ("Lineage(name: \"x\", foundrs: [])", "did you mean founders?"),
        (
            "Lineage(name: \"x\", founders: [(name: \"A\", mother: \"B\", daughter: large)])",
            "founders[0].daughter: unknown name \"large\": must be one of larger, smaller; did you mean larger?",
        ),
        (
            "Lineage(name: \"x\", cues: {\"c\": kappa(u0: 0.5, amplitude: 1)}, founders: [])",
            "cues[\"c\"]: kappa.omega = (not given)",
        ),
        (
            "Lineage(name: \"x\", cues: {\"c\": kappa(u0: left, amplitude: 1)}, founders: [])",
            "cues[\"c\"].u0: expected a number, found left",
        ),
        ("Lineage(name: \"x\", founders: []) (", "1:34: expected the end of the file, found ("),
    ] {
        let said = complaint(text);
        assert!(said.starts_with("my.ron:1:") && said.contains(expected), "{text}: {said}");
    }
}

/// A file of another kind is called that.
#[test]
fn other_files_are_no_lineages() {
    let said = refusal(HERE, &["tree", concat!(env!("CARGO_MANIFEST_DIR"), "/README.md")]);
    assert!(
        said.ends_with("README.md: is not a lineage file: it begins with \"# furrow\", and a lineage file is RON that begins with Lineage(\n"),
        "{said}"
    );
    let folder = tempfile::tempdir().unwrap();
    let config = write(folder.path(), "c.ron", "// mine\nConfig(physics: (epsilon: 0.8))");
    assert!(refusal(HERE, &["tree", &config]).contains("is not a lineage file: it begins with \"Config(physics"));
    assert!(
        refusal(HERE, &["calibrate", &config]).contains("is not a file of targets: it begins with \"Config(physics")
    );
    let empty = write(folder.path(), "e.ron", " /* nothing */ \n");
    assert!(
        refusal(HERE, &["steady", "--r0", "2", "--config", &empty]).contains("is not a configuration: it is empty")
    );
    assert_eq!(
        refusal(HERE, &["tree", folder.path().to_str().unwrap()]),
        format!("furrow: error: {}: cannot be read: it is a folder, not a file\n", folder.path().display())
    );
}

/// Some editors begin a file with a byte order mark.
#[test]
fn a_byte_order_mark_is_passed_over() {
    let text = "\u{feff}Lineage(name: \"x\", founders: [(name: \"A\")])";
    assert_eq!(Lineage::parse(text, "x").unwrap(), Lineage::parse(&text[3..], "x").unwrap());
    let folder = tempfile::tempdir().unwrap();
    let config = write(folder.path(), "c.ron", "\u{feff}Config(physics: (epsilon: 0.8))");
    assert!(furrow(HERE, &["steady", "--r0", "2", "--xi", "1", "--config", &config]).status.success());
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

#[test]
fn a_cue_of_a_lineage_without_cues() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "l.ron", "Lineage(name: \"x\", founders: [(name: \"A\")])");
    assert_eq!(
        refusal(HERE, &["divide", "--r0", "2", "--cue", "polar", "--lineage", &file]),
        "furrow: error: --cue: cue = \"polar\": must be none or terms FIELD:PROFILE,key=value,.. joined by +\n"
    );
    let said = complaint("Lineage(name: \"x\", founders: [(name: \"A\", cue: \"polar\")])");
    assert_eq!(said, "my.ron:1: founder \"A\": cue = \"polar\": must be none, since the file has no cues");
}

#[test]
fn settings_in_the_wrong_section_and_numbers_that_are_none() {
    for (setting, complaint) in [
        ("physics.intervals=96", "key = \"physics.intervals\": must be numerics.intervals or intervals alone"),
        ("numerics.eps=0.8", "key = \"numerics.eps\": must be physics.eps or eps alone"),
        ("numerics.xi_b=1", "key = \"numerics.xi_b\": must be physics.xi_b or xi_b alone"),
    ] {
        let said = refusal(HERE, &["steady", "--r0", "2", "--set", setting]);
        assert_eq!(said, format!("furrow: error: --set: {complaint}\n"));
    }
    let misspelt = refusal(HERE, &["steady", "--r0", "2", "--set", "numerics.intervls=96"]);
    assert!(misspelt.ends_with("; did you mean intervals?\n"), "{misspelt}");
    for option in ["--epsilon", "--max-step", "--xi-max"] {
        let said = refusal(HERE, &["branch", "--r0=2", &format!("{option}=absent")]);
        assert!(said.contains("'absent'") && said.contains(": must be a number, as 0.87 or 1e-3\n"), "{said}");
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

/// Tables of volumes may be far longer than other files; what is no text is told by its first bytes.
#[cfg(unix)]
#[test]
fn an_endless_table_is_left() {
    assert_eq!(
        refusal(HERE, &["compare", "volumes", "/dev/zero"]),
        "furrow: error: /dev/zero:1:1: this is no text: it has a byte 0\n"
    );
}

/// What stands in a file is quoted without the characters that a terminal would obey.
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

/// More values than there is memory for are refused before one of them is made.
#[test]
fn a_sweep_of_too_many_values_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let axes: Vec<String> = ["r0", "epsilon", "xi_s", "aspect", "p0", "w", "kappa", "eta_b"]
        .iter()
        .map(|name| format!("(parameter: \"{name}\", sample: (from: 0.5, to: 0.9, count: 10000000))"))
        .collect();
    let path = write(folder.path(), "many.ron", &format!("Sweep(kind: division, axes: [{}])", axes.join(",")));
    let said = refusal(HERE, &["sweep", &path, "--out", folder.path().join("out").to_str().unwrap()]);
    assert!(said.ends_with("must be axes of 20000000 values at most, all together\n"), "{said}");
}

/// Numbers at the ends of what a number can be.
#[test]
fn numbers_beyond_all_sizes() {
    for size in ["1e308", "1e-308", "1e7", "1e-7"] {
        for command in ["divide", "pitchfork", "tree", "explore"] {
            let said = refusal(HERE, &[command, "--r0", size]);
            assert!(said.contains("must be a finite number above 0, from 1e-6 to 1e6"), "{said}");
        }
    }
    // An activity that is no normal number is as good as none.
    let output = furrow(HERE, &["steady", "--r0", "2", "--xi", "1e-308", "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let zero = furrow(HERE, &["steady", "--r0", "2", "--xi", "0", "--json"]);
    let length = |output: &Output| serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()["L"].as_f64();
    assert_eq!(length(&output), length(&zero));
}
