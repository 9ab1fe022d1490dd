//! Rules that set parameters of cells by generation, size and mother.

use crate::common::stand_in::{fake, grown};
use furrow_cell::{Cell, Parameter};
use furrow_formats::{tree_from_json, tree_to_json};
use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions};
use furrow_lineage::{EndRule, Grower, Lineage, TerminalReason, Thresholds, Tree, TreeSettings};
use furrow_mechanics::critical::CriticalRadii;
use furrow_mechanics::division::{DivisionInput, Outcome, divide};
use serde_json::Value;

fn lineage(fields: &str, founders: &str) -> Lineage {
    let text = format!("Lineage(name: \"x\", limits: (max_depth: 7),{fields} founders: [\n{founders}\n])");
    Lineage::parse(&text, "my.ron").unwrap()
}

const FALLING: &str = "physics_rules: [(parameter: \"xi_s\", factor: 0.97, per: generation)],";

/// A tree by the mechanics, with its ends from critical radii or from divisions.
fn grow(lineage: &Lineage, r0: f64, by_radii: bool) -> Tree {
    let memo = Memo::new(Quantisation::DEFAULT);
    let settings = TreeSettings { cell: Cell::new(r0), ..TreeSettings::default() };
    let rule = Thresholds::new(CriticalRadii::new(&settings.numerics));
    let ends = if by_radii { EndRule::Thresholds(&rule) } else { EndRule::Dynamics };
    Grower { lineage, settings, ends, memo: &memo, options: SchedulerOptions::default() }.grow(divide).unwrap().0
}

/// Name, parameters and outcome of a cell, and χ where it divides.
type Seen = (String, Cell, Option<Outcome>, Option<f64>);

fn cells(tree: &Tree) -> Vec<Seen> {
    let cell = |id| {
        let cell = tree.cell(id);
        (cell.name.clone(), tree.parameters(id), cell.fate.outcome(), cell.fate.chi())
    };
    tree.cells().map(cell).collect()
}

/// ξ_s falls by 3 % a generation: generation k has 25·0.97^k, in the tree, in tree.json and in the solver's input. Each cell
/// divides as a single cell with its parameters.
#[test]
fn activity_falls_by_generation() {
    let lineage = lineage(FALLING, "(name: \"Q\", r0: 3.0)");
    let tree = grow(&lineage, 3.0, true);
    // ½³ of the volume of 3 is 1.5, below every critical radius.
    assert!(tree.len() > 10 && tree.cells().any(|id| tree.cell(id).generation == 3));
    let text = tree_to_json(&tree).unwrap();
    let document: Value = serde_json::from_str(&text).unwrap();
    let expected = [25.0, 25.0 * 0.97, 25.0 * 0.97 * 0.97, 25.0 * 0.97 * 0.97 * 0.97];
    for (id, record) in tree.cells().zip(document["cells"].as_array().unwrap()) {
        let cell = tree.cell(id);
        let k = cell.generation as usize;
        let xi_s = tree.parameters(id).xi_s;
        if let Some(expected) = expected.get(k) {
            assert!((xi_s / expected - 1.0).abs() < 1e-15, "{}: {xi_s}", cell.name);
        }
        assert_eq!(record["physics"]["xi_s"].as_f64(), Some(xi_s));
        let Some(division) = cell.fate.division() else { continue };
        let r0 = Quantisation::DEFAULT.apply(cell.r0);
        let alone = divide(&DivisionInput::new(Cell { xi_s, ..Cell::new(r0) })).unwrap();
        assert_eq!((cell.fate.chi(), division.t_end), (alone.chi(), alone.t_end), "{}", cell.name);
    }
    assert_eq!(tree_to_json(&tree_from_json(&text).unwrap()).unwrap(), text);
}

/// Branches end where cells with their own parameters come to rest, and at other cells than without rules.
#[test]
fn ends_by_critical_radii_are_those_of_the_divisions() {
    for (rules, is_longer) in [
        (FALLING, Some(false)),
        ("physics_rules: [(parameter: \"xi_s\", factor: 1.1, per: generation)],", Some(true)),
        ("physics_rules: [(parameter: \"epsilon\", value: 0.80, below_r0: 2.2)],", Some(true)),
        (
            "physics_rules: [(parameter: \"epsilon\", add: -0.15, per: mother_chi), (parameter: \"xi_s\", value: 22, above_r0: 1.9)],",
            None,
        ),
        ("physics_rules: [(parameter: \"xi_s\", value: 14, add: 5, per: r0)],", None),
        ("physics_rules: [(parameter: \"tension\", from_mother: true, add: 0.2, from_generation: 1)],", None),
    ] {
        let ruled = lineage(rules, "(name: \"Q\", r0: 2.8)");
        let [by_radii, by_divisions] = [true, false].map(|by_radii| grow(&ruled, 2.8, by_radii));
        assert_eq!(cells(&by_radii), cells(&by_divisions), "{rules}");
        let plain = grow(&lineage("", "(name: \"Q\", r0: 2.8)"), 2.8, true);
        assert_ne!(cells(&by_radii), cells(&plain), "{rules}");
        let longer = is_longer.unwrap_or(by_radii.len() > plain.len());
        assert!(longer == (by_radii.len() > plain.len()), "{rules}: {} and {}", by_radii.len(), plain.len());
    }
    // Where many cells share the parameters, radii do end branches.
    let tree = grow(&lineage(FALLING, "(name: \"Q\", r0: 2.8)"), 2.8, true);
    let mut reasons = tree.cells().filter_map(|id| tree.cell(id).fate.terminal_reason());
    assert!(reasons.any(|reason| matches!(reason, TerminalReason::BelowPitchfork { .. })));
}

/// A shell goes by the mother's χ, or by her own shell; founders and the first cell are no exception but where there is no mother.
#[test]
fn a_shell_is_set_by_the_mothers() {
    let chi = "physics_rules: [(parameter: \"epsilon\", value: 0.9, add: -0.1, per: mother_chi)],";
    let tree = grown(&lineage(chi, "(name: \"Q\", r0: 3.0)"), &|_| None, fake);
    let mut seen = [0; 2];
    for id in tree.cells() {
        let epsilon = tree.parameters(id).epsilon;
        let mother = tree.mother(id).map(|mother| tree.cell(mother).fate.outcome().unwrap());
        // The stand-in's divisions are equal or have χ = 0.88. Without a mother the cell keeps its own parameters.
        let expected = match mother {
            None => 0.87,
            Some(Outcome::Symmetric) => 0.9,
            Some(_) => 0.9 - 0.1 * 0.88,
        };
        assert_eq!(epsilon, expected, "{}", tree.cell(id).name);
        seen[usize::from(mother == Some(Outcome::Asymmetric))] += 1;
    }
    assert!(seen[0] > 1 && seen[1] > 1);

    let own = "physics_rules: [(parameter: \"epsilon\", from_mother: true, factor: 0.5)],";
    let founders = "(name: \"Q\", r0: 5.0, physics: (epsilon: 0.8)),
        (name: \"A\", mother: \"Q\", daughter: larger),
        (name: \"B\", mother: \"Q\", daughter: smaller, physics_rules: [(parameter: \"epsilon\", value: 0.6, to_generation: 0),
            (parameter: \"epsilon\", from_mother: true, add: -0.01)])";
    let tree = grown(&lineage(own, founders), &|_| None, fake);
    for id in tree.cells() {
        let cell = tree.cell(id);
        let k = cell.generation;
        let expected = match tree.founder_name(id) {
            "B" => (1..k).fold(0.6, |epsilon, _| epsilon - 0.01),
            _ => 0.8 * 0.5f64.powi(k as i32),
        };
        assert!((tree.parameters(id).epsilon - expected).abs() < 1e-15, "{}", cell.name);
    }
}

/// Of each parameter the first rule that applies counts; rules also set numbers of the cue.
#[test]
fn the_first_rule_of_a_parameter_counts() {
    let rules = "cues: {\"pull\": \"tension:gradient,amplitude=0.4\"}, physics_rules: [
        (parameter: \"cue.amplitude\", factor: 0.5, per: generation), (parameter: \"kappa\", value: 2, from_generation: 2),
        (parameter: \"kappa\", add: 0.5), (parameter: \"w\", factor: 2, above_r0: 3)],";
    let tree = grown(&lineage(rules, "(name: \"Q\", r0: 3.5, cue: \"pull\")"), &|_| None, fake);
    let base = Cell::new(1.0);
    for id in tree.cells() {
        let (cell, own) = (tree.cell(id), tree.parameters(id));
        assert_eq!(own.cue.terms()[0].amplitude, 0.4 * 0.5f64.powi(cell.generation as i32));
        assert_eq!(own.material.kappa, if cell.generation >= 2 { 2.0 } else { base.material.kappa + 0.5 });
        assert_eq!(own.shell.w, base.shell.w * if cell.r0 > 3.0 { 2.0 } else { 1.0 });
        assert_eq!(Parameter::P0.get(&own), Parameter::P0.get(&base));
    }
    assert!(tree.len() > 10);
}

/// Rules set numbers of a regulator, in the units of the file. Each cell has its own, in the tree and in tree.json.
#[test]
fn rules_set_numbers_of_a_regulator() {
    let rules = "units: (length_um: 2, time_min: 5), cues: {\"carried\": \"regulator:none,turnover=0.05/s,diffusion=0.02um2/s,activity=0.3\"}, physics_rules: [
        (parameter: \"regulator.turnover\", factor: 0.5, per: generation), (parameter: \"regulator.activity\", value: 0.2, above_r0: 3),
        (parameter: \"regulator.kappa\", value: 1)],";
    let tree = grown(&lineage(rules, "(name: \"Q\", r0: 3.5, cue: \"carried\")"), &|_| None, fake);
    for id in tree.cells() {
        let cell = tree.cell(id);
        let turnover = 15.0 * 0.5f64.powi(cell.generation as i32);
        let activity = if cell.r0 > 3.0 { 0.2 } else { 0.3 };
        let expected = format!("regulator:none,turnover={turnover},diffusion=1.5,activity={activity}");
        assert_eq!(tree.parameters(id).cue.to_string(), expected);
    }
    assert!(tree.len() > 10);
    let text = tree_to_json(&tree).unwrap();
    assert_eq!(tree_to_json(&tree_from_json(&text).unwrap()).unwrap(), text);
}

/// A rule that gives an invalid value ends the branch, and the cell has the reason.
#[test]
fn a_value_that_is_not_allowed_leaves_a_cell_undecided() {
    let rules = "physics_rules: [(parameter: \"epsilon\", add: 0.1, per: generation)],";
    let tree = grown(&lineage(rules, "(name: \"Q\", r0: 5.0)"), &|_| None, fake);
    assert_eq!(tree.len(), 7);
    for id in tree.cells().filter(|id| tree.cell(*id).generation == 2) {
        let Some(TerminalReason::Undecided { why }) = tree.cell(id).fate.terminal_reason() else { panic!() };
        assert_eq!(why, "physics_rules[0]: epsilon = 1.07: must be above 0 and below 1");
    }
}
