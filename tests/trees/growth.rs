//! Growth, rounds and files of a tree, with a simulated division solver.

use crate::common::stand_in::{self, division, fake, grown};
use furrow_cell::Cell;
use furrow_formats::{founder_rows, newick, tree_from_json, tree_to_json};
use furrow_lineage::batch::Summary;
use furrow_lineage::{CellId, Lineage, TerminalReason, Tree, TreeSettings};
use furrow_mechanics::division::{Division, DivisionError, DivisionInput, Outcome};

fn grow_with(
    lineage: &Lineage,
    threads: usize,
    solve: impl Fn(&DivisionInput) -> Result<Division, DivisionError> + Sync,
) -> (Tree, Summary) {
    stand_in::grow(lineage, &TreeSettings::default(), threads, &|_| None, solve)
}

/// Names of the cells that ended for a reason.
fn ended(tree: &Tree, reason: impl Fn(&TerminalReason) -> bool) -> Vec<&str> {
    let cells = tree.cells().map(|id| tree.cell(id));
    cells.filter(|cell| cell.fate.terminal_reason().is_some_and(&reason)).map(|cell| cell.name.as_str()).collect()
}

fn grow(lineage: &Lineage) -> Tree {
    grown(lineage, &|_| None, fake)
}

/// A lineage of one founder, with an R0 or limits.
fn alone(founder: &str, limits: &str) -> Lineage {
    let text = format!("Lineage(name: \"x\", limits: ({limits}), founders: [(name: \"Q\", {founder})])");
    Lineage::parse(&text, "x.ron").unwrap()
}

#[test]
fn founders_take_their_places() {
    let tree = grow(&Lineage::c_elegans().unwrap());
    for node in tree.cells() {
        let Some([a, p]) = tree.daughters(node) else { continue };
        let (mother, a, p) = (tree.cell(node), tree.cell(a), tree.cell(p));
        // Volumes are handed down to rounding, equal halves to the last bit.
        assert!(
            (a.volume_fraction + p.volume_fraction - mother.volume_fraction).abs() <= 1e-15 * mother.volume_fraction
        );
        if mother.fate.outcome() == Some(Outcome::Symmetric) {
            assert_eq!(a.r0.to_bits(), p.r0.to_bits());
        }
        // The cue makes the posterior daughter the smaller: the germline's.
        let named = [("P0", "AB", "P1"), ("EMS", "MS", "E"), ("AB", "ABa", "ABp"), ("ABa", "ABal", "ABar")];
        if let Some((_, first, second)) = named.iter().find(|(name, ..)| *name == mother.name) {
            assert_eq!((a.name.as_str(), p.name.as_str()), (*first, *second));
        }
        assert_eq!(a.generation, mother.generation + 1);
    }
    let carries = tree.cells().map(|n| tree.cell(n)).filter(|c| !c.cue.is_none()).map(|c| c.name.as_str());
    assert_eq!(carries.collect::<Vec<_>>(), ["P0", "P1", "P2", "P3"]);
}

#[test]
fn rounds_of_a_known_tree() {
    // Radii 4, 3.17, 2.52: symmetric; 2.0: χ = 0.88, its daughters 0.78 and 1.96; the larger divides once more.
    let tree = grow(&alone("r0: 4.0", ""));
    let rows = founder_rows(&tree);
    let rounds = rows[0].rounds.unwrap();
    assert_eq!((rounds.symmetric, rounds.full_doublings, rounds.min), (3, 4, 4));
    // 8 cells of R0 = 2 each leave a chain: small daughters at 4, 5, ..., until the large one has R0 < 1.7.
    let chain = ((1.7f64 / 2.0).powi(3).ln() / 0.94f64.ln()).ceil() as u32;
    assert_eq!(rounds.max, 3 + chain);
    assert_eq!(rounds.terminal, 8 * (chain + 1));
    let sum: u32 = (1..=chain).sum::<u32>() + chain;
    assert!((rounds.mean - (3.0 + f64::from(sum) / f64::from(chain + 1))).abs() < 1e-12);
    assert!(tree.cells().all(|n| tree.daughters(n).is_some()
        || tree.cell(n).fate.terminal_reason() == Some(&TerminalReason::AtRest { growth_rate: Some(-0.25) })));
}

#[test]
fn same_tree_at_any_thread_count() {
    let lineage = Lineage::c_elegans().unwrap();
    let one = grow_with(&lineage, 1, fake);
    for threads in [2, 8] {
        let many = grow_with(&lineage, threads, fake);
        assert_eq!(tree_to_json(&one.0).unwrap(), tree_to_json(&many.0).unwrap());
        assert_eq!(one.1.solved, many.1.solved);
    }
    // Equal cells are solved once: the symmetric rounds of AB cost one division each.
    assert!(one.1.solved < one.0.len() / 3, "{} of {}", one.1.solved, one.0.len());
    assert_eq!(one.1.solved + one.1.memo_hits, one.0.len());
}

#[test]
fn newick_names_lengths_and_order() {
    let text = "Lineage(name: \"x\", founders: [(name: \"Q_1\", r0: 2.0)], limits: (max_depth: 1))";
    // Asymmetric with χ = -0.88; the daughters meet the limit, so that they have no division time.
    let tree = grow(&Lineage::parse(text, "x.ron").unwrap());
    assert_eq!(newick(&tree), "('Q_1a','Q_1p')'Q_1':1.5;\n");
}

/// Cells of a founder double before they divide, so that equal halves keep its size; a given radius is that at division.
#[test]
fn cells_of_a_founder_grow_before_they_divide() {
    let text = r#"(name: "x", limits: (max_depth: 3), founders: [
        (name: "S", r0: 4.0, growth: 3), (name: "Q", mother: "S", daughter: larger, growth: 2), (name: "G", mother: "S", daughter: smaller, r0: 2.5),
    ])"#;
    let lineage = Lineage::parse(text, "x.ron").unwrap();
    let halves = |input: &DivisionInput| Ok(division(input.cell.r0, Outcome::Symmetric, 0.0));
    let tree = grow_with(&lineage, 1, halves).0;
    let r0 = |name: &str| tree.cells().map(|id| tree.cell(id)).find(|cell| cell.name == name).unwrap().r0;
    for (name, expected) in [("S", 4.0), ("Q", 4.0), ("Qa", 4.0), ("Qap", 4.0), ("G", 2.5), ("Ga", 2.5 * 0.5f64.cbrt())]
    {
        assert!((r0(name) - expected).abs() < 1e-12, "{name}: {}", r0(name));
    }
    let refusal =
        Lineage::parse("(name: \"x\", founders: [(name: \"S\", growth: 0)])", "x.ron").unwrap_err().to_string();
    assert!(refusal.contains("growth = 0: must be a number from 0.01 to 100"), "{refusal}");
}

#[test]
fn founders_stop_after_their_rounds_and_named_cells_die() {
    let text = r#"(name: "x", limits: (max_depth: 5), dies: ["Qaa*a", "nobody"], founders: [
        (name: "S", r0: 4.0), (name: "Q", mother: "S", daughter: larger), (name: "G", mother: "S", daughter: smaller, most_rounds: 1),
    ])"#;
    let lineage = Lineage::parse(text, "x.ron").unwrap();
    let halves = |input: &DivisionInput| Ok(division(input.cell.r0, Outcome::Symmetric, 0.0));
    let tree = grow_with(&lineage, 2, halves).0;
    assert_eq!(ended(&tree, |reason| *reason == TerminalReason::MostRounds { most_rounds: 1 }), ["Ga", "Gp"]);
    // Qaaaa and Qaapa are daughters of cells that divide; the daughters of Qaaa, which dies, are not born.
    assert_eq!(ended(&tree, |reason| *reason == TerminalReason::Dies), ["Qaaa", "Qaapa"]);
    assert_eq!(ended(&tree, |reason| *reason == TerminalReason::MaxDepth { max_depth: 5 }).len(), 13);
    // None of them has failed to divide: no division was computed.
    let stopped = tree.cells().map(|id| tree.cell(id)).filter(|cell| cell.fate.terminal_reason().is_some());
    assert!(stopped.into_iter().all(|cell| cell.fate.outcome().is_none()));
}

/// A neuroblast: the cue goes to the larger daughter at each division, and her sisters divide once.
#[test]
fn a_cue_passes_to_the_larger_daughter_alone() {
    let text = |more: &str| {
        format!(
            r#"(name: "x", limits: (max_depth: 4), cues: {{"basal": "tension:gradient,amplitude=0.3"}},
                founders: [(name: "N", r0: 4.0, cue: "basal"{more})])"#
        )
    };
    let passes = ", cue_passes_to: larger, rounds_without_cue: 1";
    let lineage = Lineage::parse(&text(passes), "x.ron").unwrap();
    let unequal_with_cue = |input: &DivisionInput| {
        let outcome = if input.cell.cue.is_none() { (Outcome::Symmetric, 0.0) } else { (Outcome::Asymmetric, 0.5) };
        Ok(division(input.cell.r0, outcome.0, outcome.1))
    };
    let tree = grow_with(&lineage, 2, unequal_with_cue).0;
    assert_eq!(tree_to_json(&tree).unwrap(), tree_to_json(&grow_with(&lineage, 1, unequal_with_cue).0).unwrap());
    let carrying: Vec<_> = tree.cells().filter(|id| tree.cue_name(*id) == "basal").collect();
    assert_eq!(carrying.len(), 5, "one in each generation");
    for id in tree.cells() {
        assert_eq!(tree.cue_name(id) == "none", tree.cell(id).cue.is_none());
        let heirs = tree.daughters(id).map(|pair| pair.map(|daughter| carrying.contains(&daughter)));
        let larger = tree.daughters(id).map(|[a, p]| tree.cell(a).r0 > tree.cell(p).r0);
        if let (Some(heirs), Some(is_anterior_larger), true) = (heirs, larger, carrying.contains(&id)) {
            assert_eq!(heirs, [is_anterior_larger, !is_anterior_larger], "{}", tree.cell(id).name);
        }
    }
    // Sisters of the first three neuroblasts divide once within four generations.
    assert_eq!(ended(&tree, |reason| *reason == TerminalReason::MostRounds { most_rounds: 1 }).len(), 4);
    for (more, expected) in [
        (", inherit: false, cue_passes_to: larger", "cue_passes_to = larger: must be left out where"),
        (", rounds_without_cue: 1", "rounds_without_cue = 1: must be left out without cue_passes_to"),
    ] {
        let refused = Lineage::parse(&text(more), "x.ron").unwrap_err().to_string();
        assert!(refused.contains(expected), "{refused}");
    }
}

#[test]
fn limits_end_a_tree_that_does_not() {
    let grown = |limits: &str, threads| {
        grow_with(&alone("", limits), threads, |input| Ok(division(input.cell.r0, Outcome::Symmetric, 0.0))).0
    };
    let tree = grown("max_depth: 5", 2);
    assert_eq!(tree.len(), 63);
    assert_eq!(ended(&tree, |reason| *reason == TerminalReason::MaxDepth { max_depth: 5 }).len(), 32);
    assert_eq!(tree.cell(tree.cells().next_back().unwrap()).fate.outcome(), None);
    let limits = "max_depth: 60, max_cells: 101";
    let one = grown(limits, 1);
    assert_eq!(one.len(), 101);
    assert_eq!(tree_to_json(&one).unwrap(), tree_to_json(&grown(limits, 4)).unwrap());
    assert!(!ended(&one, |reason| *reason == TerminalReason::MaxCells { max_cells: 101 }).is_empty());
}

#[test]
fn boundary_ends_branches_without_solving() {
    let below = TerminalReason::BelowPitchfork { r0_c: 1.7 };
    let ends = |cell: &Cell| (cell.cue.is_none() && cell.r0 < 1.7).then(|| below.clone());
    let solve = |input: &DivisionInput| {
        assert!(input.cell.r0 >= 1.7);
        fake(input)
    };
    let tree = grown(&alone("r0: 4.0", ""), &ends, solve);
    for node in tree.cells().filter(|n| tree.daughters(*n).is_none()) {
        let fate = &tree.cell(node).fate;
        assert_eq!((fate.terminal_reason(), fate.outcome()), (Some(&below), Some(Outcome::Arrested)));
    }
}

/// The four granddaughters of one size that cannot be solved end their branches, and say why; the rest of the tree is complete,
/// at any number of threads, and its file can be read back.
#[test]
fn cells_that_cannot_be_computed_are_undecided() {
    let solve = |input: &DivisionInput| match input.cell.r0 < 4.0 {
        true => Err(DivisionError::Undecided { r0: input.cell.r0, epsilon: input.cell.epsilon, t_max: 2000.0 }),
        false => fake(input),
    };
    for threads in [1, 4] {
        let (tree, _) = grow_with(&alone("r0: 6.0", ""), threads, solve);
        let advice = "within t = 2000; raise t_max, or try more mesh intervals";
        let undecided = |reason: &_| matches!(reason, TerminalReason::Undecided { why } if why.ends_with(advice));
        assert_eq!(ended(&tree, undecided), ["Qaa", "Qap", "Qpa", "Qpp"]);
        assert_eq!(tree.len(), 7);
        assert!(tree.cells().skip(3).all(|id| tree.cell(id).fate.outcome().is_none()));
        let read = tree_from_json(&tree_to_json(&tree).unwrap()).unwrap();
        assert_eq!(tree_to_json(&read).unwrap(), tree_to_json(&tree).unwrap());
    }
}

/// Where nothing tells the poles apart the smaller daughter is on either side, by the seed and the cell's name; its size is
/// the seed of the one division solved.
#[test]
fn sides_of_uncued_divisions_are_drawn_for_each_cell() {
    let unequal = |input: &DivisionInput| Ok(division(input.cell.r0, Outcome::Asymmetric, 0.3));
    let lineage = alone("", "max_depth: 8");
    let sides = |seed: u64| -> Vec<bool> {
        let settings = TreeSettings { seed, ..TreeSettings::default() };
        let (tree, _) = stand_in::grow(&lineage, &settings, 2, &|_| None, unequal);
        let dividing = tree.cells().filter_map(|id| tree.daughters(id).map(|pair| (id, pair)));
        dividing
            .map(|(id, [anterior, posterior])| {
                let smaller_posterior = tree.cell(posterior).r0 < tree.cell(anterior).r0;
                let division = tree.cell(id).fate.division().unwrap();
                assert_eq!(division.chi(), Some(0.3));
                assert_eq!(division.chi_signed(), Some(if smaller_posterior { 0.3 } else { -0.3 }));
                smaller_posterior
            })
            .collect()
    };
    let (one, again, other) = (sides(1), sides(1), sides(2));
    assert_eq!(one, again);
    assert_ne!(one, other);
    let share = one.iter().filter(|posterior| **posterior).count() as f64 / one.len() as f64;
    assert!(one.len() == 255 && (0.35..0.65).contains(&share), "{share} of {}", one.len());
}

/// Nothing recurses over generations.
#[test]
fn deep_chain() {
    let shrinking = |input: &DivisionInput| {
        Ok(match input.cell.r0 < 5.0 {
            true => division(input.cell.r0, Outcome::Arrested, 0.0),
            false => division(input.cell.r0, Outcome::Asymmetric, 0.9999),
        })
    };
    let (tree, _) = grow_with(&alone("", "max_depth: 3000, max_cells: 1000000"), 1, shrinking);
    assert!(tree.len() > 2000, "{}", tree.len());
    assert_eq!(tree_from_json(&tree_to_json(&tree).unwrap()).unwrap().len(), tree.len());
    assert!(newick(&tree).len() > tree.len());
}

#[test]
fn drawing_and_report() {
    let tree = grow(&Lineage::c_elegans().unwrap());
    let drawing = furrow_report::svg(&tree, furrow_report::TimeAxis::Generations);
    let report = furrow_report::html(&tree, &founder_rows(&tree), None);
    // One disc with a title a cell.
    assert_eq!(drawing.matches("<title>").count(), tree.len());
    assert!(report.contains("<h1>Caenorhabditis elegans, grown from mechanics</h1>") && report.contains("</svg>"));
    // Self-contained: the name space is the only address in it.
    let addresses = report.matches("http:").count() + report.matches("https:").count();
    assert_eq!(addresses, report.matches("http://www.w3.org/2000/svg").count());
    let table = furrow_report::founders_table(&tree, &founder_rows(&tree));
    assert!(
        table.contains(
            "AB        4.555  none      symmetric    0.000 |   5   6.25   7    5   4    64 |   8   9.05  11    8   487"
        ),
        "{table}"
    );
}

#[test]
fn with_a_clock_a_drawing_has_cells_at_their_births() {
    use furrow_report::TimeAxis;
    let mut lineage = Lineage::c_elegans().unwrap();
    lineage.clock = None;
    lineage.founders.iter_mut().for_each(|founder| founder.clock = None);
    let tree = grow(&lineage);
    assert_eq!(furrow_report::svg(&tree, TimeAxis::Minutes), furrow_report::svg(&tree, TimeAxis::Generations));
    assert!(!furrow_report::html(&tree, &founder_rows(&tree), None).contains("<h2>Cells over time</h2>"));
    let text = r#"(base: "c_elegans", clock: (lifetime_min: 15, exponent: 0.3, origin: division("ABa")))"#;
    let tree = grow(&Lineage::parse(text, "own.ron").unwrap());
    let drawing = furrow_report::svg(&tree, TimeAxis::Minutes);
    let times = tree.times().unwrap();
    let number = |text: &str| text.split(['"', ' ']).next().unwrap().parse::<f64>().unwrap();
    let place = |name: &str| {
        let cell = drawing.split("<g>").find(|part| part.starts_with(&format!("<title>{name}:"))).unwrap();
        [number(cell.split("born at ").nth(1).unwrap()), number(cell.split("cy=\"").nth(1).unwrap())]
    };
    // However short its life, the first cell is drawn as wide as it is. A ring is drawn along its middle.
    let radius = |name: &str| {
        let cell = drawing.split(&format!("<title>{name}:")).nth(1).and_then(|cell| cell.split("/>").next()).unwrap();
        let width = cell.split("stroke-width=\"").nth(1).map_or(0.0, number);
        number(cell.split(" r=\"").nth(1).unwrap()) + 0.5 * width
    };
    let r0 = |name: &str| tree.cell(tree.cells().find(|id| tree.cell(*id).name == name).unwrap()).r0;
    let [first_cell, second, third] = ["P0", "AB", "EMS"].map(|name| radius(name) / r0(name));
    assert!((first_cell / second - 1.0).abs() < 0.01 && (first_cell / third - 1.0).abs() < 0.01);
    let birth = |id: &CellId| times[id.index()].birth_min;
    let latest = tree.cells().max_by(|a, b| birth(a).total_cmp(&birth(b))).unwrap();
    let [[first, top], [last, bottom]] = [place("P0"), place(&tree.cell(latest).name)];
    assert!(last > first + 100.0 && bottom > top + 300.0);
    for id in tree.cells().take(40) {
        let name = &tree.cell(id).name;
        let [born, down] = place(name);
        assert!((birth(&id) - born).abs() < 0.051, "{name}");
        let expected = top + (born - first) / (last - first) * (bottom - top);
        assert!((down - expected).abs() < 1.0, "{name} {down} {expected}");
    }
    for words in ["minute 0 is the division of ABa", "cells alive", "AB: last division, ", "E: last division, "] {
        assert!(drawing.contains(words), "{words}");
    }
    assert!(!drawing.contains(">P1: last division"));
    assert!(furrow_report::html(&tree, &founder_rows(&tree), None).contains("<h2>Cells over time</h2>"));
}
