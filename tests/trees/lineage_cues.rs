//! Who carries which cue in a lineage: founders' cues and rules, rules of the file, their complaints, and the table's column.

use crate::common::stand_in::fake;
use furrow::batch::{Memo, Quantisation, SchedulerOptions};
use furrow::cell::Cue;
use furrow::io::{FounderRow, founder_rows};
use furrow::lineage::{Grower, Lineage, Tree, TreeSettings};
use furrow::report::{founders_table, html};

const CUES: &str = "cues: {\"polar\": kappa(u0: 0.4, omega: 0.1, amplitude: 0.2), \
                    \"pull\": tension(profile: gradient, amplitude: 0.3)}";

/// A lineage with two cues, further fields of the file and the given founders.
fn text(fields: &str, founders: &str) -> String {
    format!("Lineage(name: \"x\", {CUES}, limits: (max_depth: 4),{fields} founders: [\n{founders}\n])")
}

fn lineage(fields: &str, founders: &str) -> Lineage {
    Lineage::parse(&text(fields, founders), "my.ron").unwrap()
}

/// Grown with the stand-in for the solver: symmetric without a cue above R0 = 2.25, χ = 0.2 with any.
fn grow(lineage: &Lineage) -> Tree {
    let (memo, settings) = (Memo::new(Quantisation::DEFAULT), TreeSettings::default());
    let options = SchedulerOptions { threads: 1, ..SchedulerOptions::default() };
    Grower { lineage, settings, ends: &|_| None, memo: &memo, options }.grow(fake).unwrap().0
}

/// Names of the cells that carry a cue, in breadth-first order.
fn carriers(tree: &Tree, cue: &str) -> Vec<String> {
    let cue = tree.lineage.cue(cue).unwrap();
    tree.cells().map(|id| tree.cell(id)).filter(|cell| cell.cue == cue).map(|cell| cell.name.clone()).collect()
}

fn complaint(fields: &str, founders: &str) -> String {
    Lineage::parse(&text(fields, founders), "my.ron").unwrap_err().to_string()
}

#[test]
fn a_founders_cue_is_inherited_unless_it_is_not() {
    let inherited = grow(&lineage("", "(name: \"Q\", r0: 5.0, cue: \"polar\")"));
    assert_eq!(carriers(&inherited, "polar").len(), inherited.len());
    let alone = grow(&lineage("", "(name: \"Q\", r0: 5.0, cue: \"polar\", inherit: false)"));
    assert_eq!(carriers(&alone, "polar"), ["Q"]);
    assert!(alone.len() > 20);
    // Up to the next founder, which has its own or none.
    let founders = "(name: \"Q\", r0: 5.0, cue: \"polar\"),
        (name: \"A\", mother: \"Q\", daughter: larger, cue: \"pull\", inherit: false),
        (name: \"B\", mother: \"Q\", daughter: smaller)";
    let tree = grow(&lineage("", founders));
    assert_eq!((carriers(&tree, "polar"), carriers(&tree, "pull")), (vec!["Q".to_owned()], vec!["A".to_owned()]));
}

/// Rounds are counted from the founder; the first rule that applies is the one.
#[test]
fn founders_rules_give_cues_by_round_and_radius() {
    let rules =
        "cue_rules: [(cue: \"pull\", from_generation: 1, to_generation: 1), (cue: \"polar\", to_generation: 2)]";
    let tree = grow(&lineage("", &format!("(name: \"Q\", r0: 5.0, {rules})")));
    assert_eq!(carriers(&tree, "pull"), ["Qa", "Qp"]);
    assert_eq!(carriers(&tree, "polar"), ["Q", "Qaa", "Qap", "Qpa", "Qpp"]);

    // 5 divides into 3.68 and 4.22 with the cue, these into 2.92 and 3.35 without.
    let rules = "cue_rules: [(cue: \"polar\", above_r0: 4.0), (cue: \"pull\", below_r0: 3.0)]";
    let tree = grow(&lineage("", &format!("(name: \"Q\", r0: 5.0, {rules})")));
    for id in tree.cells() {
        let cell = tree.cell(id);
        let expected = match cell.r0 {
            r0 if r0 > 4.0 => "polar",
            r0 if r0 < 3.0 => "pull",
            _ => "none",
        };
        assert_eq!(cell.cue, tree.lineage.cue(expected).unwrap(), "{} R0 = {}", cell.name, cell.r0);
    }
    for cue in ["polar", "pull", "none"] {
        assert!(!carriers(&tree, cue).is_empty(), "{cue}");
    }
}

/// Rules of the file count generations from the first cell and hold where a founder says nothing of its own; the word none
/// of a founder is a saying.
#[test]
fn rules_of_the_file_hold_where_founders_say_nothing() {
    let founders = "(name: \"Q\", r0: 5.0),
        (name: \"A\", mother: \"Q\", daughter: larger, cue: \"none\"),
        (name: \"B\", mother: \"Q\", daughter: smaller)";
    let tree = grow(&lineage(" cue_rules: [(cue: \"pull\", from_generation: 1, to_generation: 2)],", founders));
    assert_eq!(carriers(&tree, "pull"), ["B", "Ba", "Bp"]);
    assert_eq!(tree.cell(tree.first()).cue, Cue::none());
    // A founder's own rules shut the file's out, even where none of them applies.
    let own = "(name: \"Q\", r0: 5.0, cue_rules: [(cue: \"polar\", from_generation: 2)])";
    let tree = grow(&lineage(" cue_rules: [(cue: \"pull\")],", own));
    assert!(carriers(&tree, "pull").is_empty());
    assert_eq!(carriers(&tree, "none"), ["Q", "Qa", "Qp"]);
}

/// A cue given in place of all others goes where these went, rules included.
#[test]
fn a_cue_in_the_place_of_others_follows_their_rules() {
    let founders = "(name: \"Q\", r0: 5.0, cue_rules: [(cue: \"none\", to_generation: 0), (cue: \"polar\")])";
    let lineage = lineage(" cue_rules: [(cue: \"pull\")],", founders);
    let given: Cue = "friction:gradient,amplitude=0.2".parse().unwrap();
    let tree = grow(&lineage.clone().with_cues_replaced("slow", &given));
    assert!(tree.cells().all(|id| tree.cell(id).cue == if id == tree.first() { Cue::none() } else { given.clone() }));
    let tree = grow(&lineage.with_cues_replaced("none", &Cue::none()));
    assert!(tree.cells().all(|id| tree.cell(id).cue.is_none()));
}

#[test]
fn trees_with_rules_survive_their_file() {
    let founders =
        "(name: \"Q\", r0: 5.0, cue_rules: [(cue: \"polar\", above_r0: 4.0), (cue: \"pull\", below_r0: 3.0)])";
    let tree = grow(&lineage(" cue_rules: [(cue: \"pull\", to_generation: 3)],", founders));
    let text = tree.to_json().unwrap();
    let back = Tree::from_json(&text).unwrap();
    assert_eq!(back.to_json().unwrap(), text);
    assert_eq!(back.lineage, tree.lineage);
    let of = |tree: &Tree| tree.cells().map(|id| tree.cell(id).cue.clone()).collect::<Vec<Cue>>();
    assert_eq!(of(&back), of(&tree));
}

#[test]
fn complaints_about_rules_name_them() {
    let of_founder = |fields: &str| complaint("", &format!("(name: \"Q\", {fields})"));
    for (fields, expected) in [
        (
            "cue: \"polar\", cue_rules: [(cue: \"pull\")]",
            "my.ron:2: founder \"Q\": cue = \"polar\": must be left out where cue_rules are given",
        ),
        (
            "cue_rules: [(cue: \"polar\"), (cue: \"polr\")]",
            "my.ron:2: founder \"Q\": cue_rules[1].cue = \"polr\": must be one of none, polar, pull; did you mean polar?",
        ),
        (
            "cue_rules: [(cue: \"polar\", from_generation: 3, to_generation: 2)]",
            "my.ron:2: founder \"Q\": cue_rules[0].to_generation = 2: must be from_generation = 3 or later",
        ),
        (
            "cue_rules: [(cue: \"polar\", below_r0: -1)]",
            "my.ron:2: founder \"Q\": cue_rules[0].below_r0 = -1: must be a finite number above 0",
        ),
        (
            "cue_rules: [(cue: \"polar\", above_r0: inf)]",
            "my.ron:2: founder \"Q\": cue_rules[0].above_r0 = inf: must be a finite number above 0",
        ),
        (
            "cue_rules: [(cue: \"polar\", below_r0: 2, above_r0: 3)]",
            "my.ron:2: founder \"Q\": cue_rules[0].above_r0 = 3: must be less than below_r0 = 2",
        ),
    ] {
        assert_eq!(of_founder(fields), expected);
    }
    let unknown = of_founder("cue_rules: [(cue: \"polar\", until: 3)]");
    let expected = "founders[0].cue_rules[0]: unknown field \"until\": must be one of cue, from_generation,";
    assert!(unknown.starts_with("my.ron:2:") && unknown.contains(expected), "{unknown}");
    let missing = of_founder("cue_rules: [(below_r0: 3)]");
    let expected = "founders[0].cue_rules[0]: the field \"cue\" is missing";
    assert!(missing.starts_with("my.ron:2:") && missing.ends_with(expected), "{missing}");
}

#[test]
fn complaints_about_rules_of_the_file_name_them() {
    for (fields, expected) in [
        (
            " cue_rules: [(cue: \"bipolar\")],",
            "my.ron: cue_rules[0].cue = \"bipolar\": must be one of none, polar, pull; did you mean polar?",
        ),
        (
            " cue_rules: [(cue: \"none\"), (cue: \"pull\", to_generation: 1, from_generation: 4)],",
            "my.ron: cue_rules[1].to_generation = 1: must be from_generation = 4 or later",
        ),
        (
            " cue_rules: [(cue: \"none\", below_r0: NaN)],",
            "my.ron: cue_rules[0].below_r0 = NaN: must be a finite number above 0",
        ),
    ] {
        assert_eq!(complaint(fields, "(name: \"Q\")"), expected);
    }
}

/// The table names every founder's cue, counts the cells below that carry one, and says what the names mean.
#[test]
fn the_founders_table_has_a_column_of_cues() {
    let founders = "(name: \"Q\", r0: 5.0, cue: \"polar\"),
        (name: \"A\", mother: \"Q\", daughter: larger, cue_rules: [(cue: \"pull\", from_generation: 1, to_generation: 1)]),
        (name: \"B\", mother: \"Q\", daughter: smaller)";
    let tree = grow(&lineage("", founders));
    let rows = founder_rows(&tree);
    let below =
        |row: &FounderRow| row.cued_descendants.iter().map(|(name, n)| format!("{name} {n}")).collect::<String>();
    let seen: Vec<(&str, &str, String)> =
        rows.iter().map(|row| (row.name.as_str(), row.cue.as_str(), below(row))).collect();
    let of = |name: &'static str, cue: &'static str, below: &str| (name, cue, below.to_owned());
    assert_eq!(seen, [of("Q", "polar", ""), of("A", "none", "pull 2"), of("B", "none", "")]);
    let table = founders_table(&tree, &rows);
    let column = |line: &str| line.split_whitespace().skip(2).take(3).collect::<Vec<_>>().join(" ");
    let lines: Vec<String> = table.lines().skip(5).take(3).map(column).collect();
    assert!(table.contains("founder      R0  cue            division         χ |"), "{table}");
    assert_eq!(lines, ["polar asymmetric 0.200", "none, pull +2", "none symmetric 0.000"], "{table}");
    for line in ["cue polar: kappa:band,u0=0.4,omega=0.1,amplitude=0.2\n", "cue pull: tension:gradient,amplitude=0.3\n"]
    {
        assert!(table.contains(line), "{table}");
    }
    assert!(html(&tree, &rows).contains("none, pull +2"));
}
