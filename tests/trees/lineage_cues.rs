//! Cues in a lineage: of founders, by rules, and in the table's column.

use crate::common::stand_in::{fake, grown};
use furrow_cell::cue::Quantity;
use furrow_cell::{Cell, Cue};
use furrow_formats::{FounderRow, founder_rows};
use furrow_lineage::{Lineage, Tree};
use furrow_mechanics::polarity::resolved;
use furrow_report::{founders_table, html};

const CUES: &str = "cues: {\"polar\": \"kappa:u0=0.4,omega=0.1,amplitude=0.2\", \
                    \"pull\": \"tension:gradient,amplitude=0.3\"}";

/// A lineage with two cues, further fields of the file and the given founders.
fn lineage(fields: &str, founders: &str) -> Lineage {
    let text = format!("Lineage(name: \"x\", {CUES}, limits: (max_depth: 4),{fields} founders: [\n{founders}\n])");
    Lineage::parse(&text, "my.ron").unwrap()
}

/// Grown with the simulated solver: symmetric without a cue above R0 = 2.25, χ = 0.2 with any.
fn grow(lineage: &Lineage) -> Tree {
    grown(lineage, &|_| None, fake)
}

/// Names of the cells that carry a cue, in breadth-first order.
fn carriers(tree: &Tree, cue: &str) -> Vec<String> {
    let cue = tree.lineage.cue(cue).unwrap();
    tree.cells().map(|id| tree.cell(id)).filter(|cell| cell.cue == cue).map(|cell| cell.name.clone()).collect()
}

#[test]
fn a_founders_cue_is_inherited_unless_it_is_not() {
    let inherited = grow(&lineage("", "(name: \"Q\", r0: 5.0, cue: \"polar\")"));
    assert_eq!(carriers(&inherited, "polar").len(), inherited.len());
    let alone = grow(&lineage("", "(name: \"Q\", r0: 5.0, cue: \"polar\", inherit: false)"));
    assert_eq!(carriers(&alone, "polar"), ["Q"]);
    assert!(alone.len() > 20);
    // Up to the next founder, which has its own cue or no cue.
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

/// Rules of the file count generations from the first cell and apply to founders without rules; the word none
/// of a founder is a saying.
#[test]
fn rules_of_the_file_hold_where_founders_say_nothing() {
    let founders = "(name: \"Q\", r0: 5.0),
        (name: \"A\", mother: \"Q\", daughter: larger, cue: \"none\"),
        (name: \"B\", mother: \"Q\", daughter: smaller)";
    let tree = grow(&lineage(" cue_rules: [(cue: \"pull\", from_generation: 1, to_generation: 2)],", founders));
    assert_eq!(carriers(&tree, "pull"), ["B", "Ba", "Bp"]);
    assert_eq!(tree.cell(tree.first()).cue, Cue::none());
    // A founder's own rules replace the file's, even if they do not apply.
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

/// A cue given to a lineage without cues goes to the first cell and to the smaller daughters below it, as in the built-in lineage.
#[test]
fn a_cue_for_a_lineage_without_cues_goes_along_the_smaller_daughters() {
    let founders = "(name: \"Q\", r0: 5.0), (name: \"A\", mother: \"Q\", daughter: larger, cue: \"none\"),
        (name: \"B\", mother: \"Q\", daughter: smaller)";
    let given: Cue = "friction:gradient,amplitude=0.2".parse().unwrap();
    let plain = lineage("", founders);
    assert!(plain.is_without_cues());
    let tree = grow(&plain.clone().with_cues_replaced("slow", &given));
    let carriers = carriers(&tree, "slow");
    assert!(
        carriers.contains(&"Ba".to_owned()) && carriers.iter().all(|name| name.starts_with(['Q', 'B'])),
        "{carriers:?}"
    );
    assert_eq!(plain.clone().with_cues_replaced("none", &Cue::none()), plain);
    let worm = Lineage::c_elegans().unwrap();
    assert!(!worm.is_without_cues());
    let again = worm.clone().with_cues_replaced("none", &Cue::none()).with_cues_replaced("germline", &Cue::published());
    for (founder, other) in worm.founders.iter().zip(&again.founders).filter(|(founder, _)| founder.name != "P4") {
        let cue = |cue: &Option<String>| cue.clone().filter(|name| name != "none");
        assert_eq!(cue(&founder.cue), cue(&other.cue), "{}", founder.name);
    }
}

/// Each founder can have constants of PAR polarity of its own. L_h is as long as the file's units say, unless the cue says so.
#[test]
fn founders_have_constants_of_polarity_of_their_own() {
    let text = r#"Lineage(name: "x", units: (length_um: 2.5), cues: {"usual": "kappa:par_band,amplitude=0.3",
        "weak": "kappa:par_band,k_pa=1.9,amplitude=0.3", "long": "kappa:par_band,length_um=3.2,amplitude=0.3"}, founders: [
        (name: "Q", r0: 5.0, cue: "usual"), (name: "A", mother: "Q", daughter: larger, cue: "weak"),
        (name: "B", mother: "Q", daughter: smaller, cue: "long")])"#;
    let lineage = Lineage::parse(text, "my.ron").unwrap();
    let place = |name: &str| {
        let cell = Cell::new(5.0).with_cue(lineage.cue(name).unwrap().clone());
        let resolved = resolved(&cell).unwrap();
        resolved.cue.terms()[0].quantity(Quantity::U0).unwrap()
    };
    let expected = |cue: &str| {
        let cell = Cell::new(5.0).with_cue(cue.parse().unwrap());
        resolved(&cell).unwrap().cue.terms()[0].quantity(Quantity::U0).unwrap()
    };
    assert_eq!(place("usual"), expected("kappa:par_band,length_um=2.5,amplitude=0.3"));
    assert_eq!(place("weak"), expected("kappa:par_band,k_pa=1.9,length_um=2.5,amplitude=0.3"));
    assert_eq!(place("long"), expected("kappa:par_band,length_um=3.2,amplitude=0.3"));
    assert!((place("usual") - place("long")).abs() > 1e-3 && (place("usual") - place("weak")).abs() > 1e-2);
}

/// The table names every founder's cue, counts the cells below that carry one, and explains the names.
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
    assert!(html(&tree, &rows, None).contains("none, pull +2"));
}
