//! Lineages of very many founders, and names that cannot be shown: read in bounded time, refused in one short message.

use furrow_lineage::Lineage;

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
    let loops = |k: usize| founder(&format!("F{k}"), &format!("F{}", (k + 1) % 20_000), "larger");
    let mut many: Vec<String> = (0..20_000).map(loops).collect();
    let circle = lineage(&many);
    many[0] = founder("F0", "F1999x", "larger");
    let alone: Vec<String> = (0..20_000).map(|k| format!("(name: \"F{k}\")")).collect();
    let long = "x".repeat(100_000);
    for (text, expected) in [
        (circle, "F8 <- F9 <- … (19990 more) <- F0; one founder"),
        (
            lineage(&many),
            "my.ron:2: founder \"F0\": mother = \"F1999x\": must be a founder of this file: F0, F1, F2, F3, F4, F5, F6, F7, F8, F9, … (19990 more); did you mean F1999?",
        ),
        (
            lineage(&alone),
            "my.ron:3: founders F0, F1, F2, F3, F4, F5, F6, F7, F8, F9, … (19990 more) have no mother; exactly one founder may have none",
        ),
        (lineage(&[format!("(name: \"{long}\", cue: \"{long}\")")]), "must be none, since the file has no cues"),
    ] {
        let said = complaint(&text);
        assert!(said.contains(expected), "{said}");
    }
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
