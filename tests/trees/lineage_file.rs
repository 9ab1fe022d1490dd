//! The lineage file: the built-in one against the published counts, and the text of every complaint.

use crate::common::tables;
use furrow::lineage::{C_ELEGANS, Lineage};

fn complaint(text: &str) -> String {
    Lineage::parse(text, "my.ron").unwrap_err().to_string()
}

/// A lineage of the given founders.
fn with(founders: &str) -> String {
    format!(
        "Lineage(name: \"x\", cues: {{\"polar\": kappa(u0: 0.4, omega: 0.1, amplitude: 0.2)}}, founders: [\n{founders}\n])"
    )
}

#[test]
fn built_in_founders() {
    let lineage = Lineage::c_elegans().unwrap();
    let names: Vec<&str> = lineage.founders.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(names, ["P0", "AB", "P1", "EMS", "MS", "E", "P2", "C", "P3", "D", "P4"]);
    let cued: Vec<&str> = lineage.founders.iter().filter(|f| f.cue.is_some()).map(|f| f.name.as_str()).collect();
    assert_eq!(cued, ["P0", "P1", "P2", "P3"]);
}

/// Every count of the built-in file is the one in the table derived from Sulston et al. 1983.
#[test]
fn sulston_counts_match_the_table() {
    let lineage = Lineage::c_elegans().unwrap();
    let rows = tables::reference("founder_table.csv");
    assert_eq!(rows.len(), lineage.founders.len());
    for row in rows {
        let name = row.text("founder");
        let s = lineage.founders.iter().find(|f| f.name == name).unwrap().observed.unwrap();
        assert_eq!(f64::from(s.min.unwrap()), row.number("min_rounds"), "{name}");
        assert_eq!(s.mean.unwrap(), row.number("mean_rounds"), "{name}");
        assert_eq!(f64::from(s.max.unwrap()), row.number("max_rounds"), "{name}");
        assert_eq!(f64::from(s.full_doublings.unwrap()), row.number("last_full_doubling_round"), "{name}");
        assert_eq!(f64::from(s.terminal.unwrap()), row.number("terminal"), "{name}");
        assert_eq!(f64::from(s.deaths.unwrap()), row.number("deaths"), "{name}");
    }
}

#[test]
fn malformed_ron_names_line_and_column() {
    assert_eq!(
        complaint("Lineage(\n  name: \"x\",\n  founders: [(name \"P0\")],\n)"),
        "my.ron:3:20: founders[0]: expected a colon, found \"P0\""
    );
    assert_eq!(
        complaint("Lineage(name: \"x\", founders: [(name: \"P0\", radius: 3)])"),
        "my.ron:1:44: founders[0]: unknown field \"radius\": must be one of name, mother, daughter, cue, inherit, cue_rules, r0, physics, letters, observed, sulston"
    );
}

#[test]
fn unknown_mother() {
    assert_eq!(
        complaint(&with("(name: \"P0\"),\n(name: \"AB\", mother: \"P9\", daughter: larger)")),
        "my.ron:3: founder \"AB\": mother = \"P9\": must be a founder of this file: P0, AB"
    );
}

#[test]
fn unknown_cue() {
    assert_eq!(
        complaint(&with("(name: \"P0\", cue: \"bipolar\")")),
        "my.ron:2: founder \"P0\": cue = \"bipolar\": must be one of none, polar; did you mean polar?"
    );
}

#[test]
fn cycle() {
    assert_eq!(
        complaint(&with(
            "(name: \"Z\"),\n(name: \"A\", mother: \"B\", daughter: larger),\n(name: \"B\", mother: \"A\", daughter: larger)"
        )),
        "my.ron:3: the founders' mothers form a cycle: A <- B <- A; one founder must have no mother, and all others descend from it"
    );
    assert_eq!(
        complaint(&with("(name: \"A\", mother: \"A\", daughter: larger)")),
        "my.ron:2: the founders' mothers form a cycle: A <- A; one founder must have no mother, and all others descend from it"
    );
}

#[test]
fn two_first_cells() {
    assert_eq!(
        complaint(&with("(name: \"A\"),\n(name: \"B\")")),
        "my.ron:3: founders A, B have no mother; exactly one founder may have none"
    );
}

#[test]
fn duplicate_founder_and_daughter() {
    assert_eq!(
        complaint(&with("(name: \"A\"),\n(name: \"A\")")),
        "my.ron:3: founders[1].name = \"A\": must be unique in the file: it is the name of a founder at my.ron:2 already"
    );
    assert_eq!(
        complaint(&with(
            "(name: \"A\"),\n(name: \"B\", mother: \"A\", daughter: larger),\n(name: \"C\", mother: \"A\", daughter: larger)"
        )),
        "my.ron:4: founder \"C\": daughter = larger: must be the other one: \"B\" is already the larger daughter"
    );
    assert_eq!(
        complaint(&with("(name: \"A\"),\n(name: \"B\", mother: \"A\", daughter: larger)")),
        "my.ron:3: founder \"B\" is a daughter of \"A\", whose smaller daughter is not in the list; list both or neither"
    );
}

#[test]
fn numbers_out_of_range() {
    assert_eq!(
        complaint(&with("(name: \"A\", r0: -1.5)")),
        "my.ron:2: founder \"A\": r0 = -1.5: must be a finite number above 0"
    );
    assert_eq!(
        complaint(&with("(name: \"A\", r0: NaN)")),
        "my.ron:2: founder \"A\": r0 = NaN: must be a finite number above 0"
    );
    let text =
        "Lineage(name: \"x\", cues: {\"c\": kappa(u0: 1.4, omega: 0.1, amplitude: 0.1)}, founders: [(name: \"A\")])";
    assert_eq!(complaint(text), "my.ron: cues[\"c\"].kappa.u0 = 1.4: must be from 0 to 1");
    let text = "Lineage(name: \"x\", limits: (max_depth: 0), founders: [(name: \"A\")])";
    assert_eq!(complaint(text), "my.ron: limits.max_depth = 0: must be from 1 to 100000");
}

/// Two cells of one name would make the tree's files ambiguous.
#[test]
fn founder_named_like_a_descendant() {
    assert_eq!(
        complaint(&with(
            "(name: \"A\"),\n(name: \"B\", mother: \"A\", daughter: larger),\n(name: \"Bap\", mother: \"A\", daughter: smaller)"
        )),
        "my.ron:4: founder \"Bap\": name = \"Bap\": must be a name that no descendant of \"B\" may be given by the naming rule"
    );
}

/// What is written into tree.json is the lineage that was read.
#[test]
fn lineage_survives_json() {
    let lineage = Lineage::parse(C_ELEGANS, "c_elegans.ron").unwrap();
    let json = serde_json::to_string(&lineage).unwrap();
    assert_eq!(serde_json::from_str::<Lineage>(&json).unwrap(), lineage);
}
