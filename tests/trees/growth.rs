//! Growth, rounds and files of a tree, with a stand-in for the division solver.

use crate::common::stand_in::{self, division, fake, grown};
use furrow_cell::Cell;
use furrow_formats::{founder_rows, newick};
use furrow_formats::{tree_from_json, tree_to_json};
use furrow_lineage::batch::Summary;
use furrow_lineage::{Lineage, TerminalReason, Tree, TreeSettings};
use furrow_mechanics::division::{Division, DivisionError, DivisionInput, Outcome};

fn grow_with(
    lineage: &Lineage,
    threads: usize,
    ends: &dyn Fn(&Cell) -> Option<TerminalReason>,
    solve: impl Fn(&DivisionInput) -> Result<Division, DivisionError> + Sync,
) -> (Tree, Summary) {
    stand_in::grow(lineage, &TreeSettings::default(), threads, ends, solve)
}

fn grow(lineage: &Lineage) -> Tree {
    grown(lineage, &|_| None, fake)
}

/// A lineage of one founder with an R0.
fn alone(r0: f64) -> Lineage {
    Lineage::parse(&format!("Lineage(name: \"x\", founders: [(name: \"Q\", r0: {r0})])"), "x.ron").unwrap()
}

fn limited(max_depth: u32, max_cells: usize) -> Lineage {
    let text = format!(
        "Lineage(name: \"x\", limits: (max_depth: {max_depth}, max_cells: {max_cells}), founders: [(name: \"Q\")])"
    );
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
        match mother.name.as_str() {
            "P0" => assert_eq!((a.name.as_str(), p.name.as_str()), ("AB", "P1")),
            "EMS" => assert_eq!((a.name.as_str(), p.name.as_str()), ("MS", "E")),
            "AB" => assert_eq!((a.name.as_str(), p.name.as_str()), ("ABa", "ABp")),
            "ABa" => assert_eq!((a.name.as_str(), p.name.as_str()), ("ABal", "ABar")),
            _ => {}
        }
        assert_eq!(a.generation, mother.generation + 1);
    }
    let carries: Vec<&str> =
        tree.cells().map(|n| tree.cell(n)).filter(|c| !c.cue.is_none()).map(|c| c.name.as_str()).collect();
    assert_eq!(carries, ["P0", "P1", "P2", "P3"]);
}

#[test]
fn rounds_of_a_known_tree() {
    // Radii 4, 3.17, 2.52: symmetric; 2.0: χ = 0.88, its daughters 0.78 and 1.96; the larger divides once more.
    let tree = grow(&alone(4.0));
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
    let one = grow_with(&lineage, 1, &|_| None, fake);
    for threads in [2, 8] {
        let many = grow_with(&lineage, threads, &|_| None, fake);
        assert_eq!(tree_to_json(&one.0).unwrap(), tree_to_json(&many.0).unwrap());
        assert_eq!(one.1.solved, many.1.solved);
    }
    // Equal cells are solved once: the symmetric rounds of AB cost one division each.
    assert!(one.1.solved < one.0.len() / 3, "{} of {}", one.1.solved, one.0.len());
    assert_eq!(one.1.solved + one.1.memo_hits, one.0.len());
}

#[test]
fn json_round_trip_is_exact() {
    let tree = grow(&Lineage::c_elegans().unwrap());
    let text = tree_to_json(&tree).unwrap();
    let back = tree_from_json(&text).unwrap();
    assert_eq!(tree_to_json(&back).unwrap(), text);
    assert_eq!(back.settings, tree.settings);
}

#[test]
fn newick_names_lengths_and_order() {
    let text = "Lineage(name: \"x\", founders: [(name: \"Q_1\", r0: 2.0)], limits: (max_depth: 1))";
    let tree = grow(&Lineage::parse(text, "x.ron").unwrap());
    // Asymmetric with χ = -0.88; the daughters meet the limit, so that they have no division time.
    assert_eq!(newick(&tree), "('Q_1a','Q_1p')'Q_1':1.5;\n");
}

#[test]
fn limits_end_a_tree_that_does_not() {
    let forever = |input: &DivisionInput| Ok(division(input.cell.r0, Outcome::Symmetric, 0.0));
    let grown = |lineage: &Lineage, threads| grow_with(lineage, threads, &|_| None, forever).0;
    let tree = grown(&limited(5, 1_000_000), 2);
    assert_eq!(tree.len(), 63);
    let leaf = tree.cells().next_back().unwrap();
    assert_eq!(tree.cell(leaf).fate.terminal_reason(), Some(&TerminalReason::MaxDepth { max_depth: 5 }));
    assert_eq!(tree.cell(leaf).fate.outcome(), None);
    let one = grown(&limited(60, 101), 1);
    assert_eq!(one.len(), 101);
    assert_eq!(tree_to_json(&one).unwrap(), tree_to_json(&grown(&limited(60, 101), 4)).unwrap());
    assert!(
        one.cells().any(|n| one.cell(n).fate.terminal_reason() == Some(&TerminalReason::MaxCells { max_cells: 101 }))
    );
}

#[test]
fn boundary_ends_branches_without_solving() {
    let ends =
        |cell: &Cell| (cell.cue.is_none() && cell.r0 < 1.7).then_some(TerminalReason::BelowPitchfork { r0_c: 1.7 });
    let solve = |input: &DivisionInput| {
        assert!(input.cell.r0 >= 1.7);
        fake(input)
    };
    let (tree, _) = grow_with(&alone(4.0), 2, &ends, solve);
    for node in tree.cells().filter(|n| tree.daughters(*n).is_none()) {
        assert_eq!(tree.cell(node).fate.terminal_reason(), Some(&TerminalReason::BelowPitchfork { r0_c: 1.7 }));
        assert_eq!(tree.cell(node).fate.outcome(), Some(Outcome::Arrested));
    }
}

/// The four granddaughters of one size that cannot be solved end their branches, and say why; the rest of the tree stands,
/// at any number of threads, and its file can be read back.
#[test]
fn cells_that_cannot_be_computed_are_undecided() {
    let solve = |input: &DivisionInput| match input.cell.r0 < 4.0 {
        true => Err(DivisionError::Undecided { r0: input.cell.r0, epsilon: input.cell.epsilon, t_max: 2000.0 }),
        false => fake(input),
    };
    for threads in [1, 4] {
        let (tree, _) = grow_with(&alone(6.0), threads, &|_| None, solve);
        let undecided: Vec<(&str, String)> = tree
            .cells()
            .map(|id| tree.cell(id))
            .filter_map(|cell| match cell.fate.terminal_reason() {
                Some(TerminalReason::Undecided { why }) => Some((cell.name.as_str(), why.clone())),
                _ => None,
            })
            .collect();
        assert_eq!(undecided.iter().map(|(name, _)| *name).collect::<Vec<_>>(), ["Qaa", "Qap", "Qpa", "Qpp"]);
        assert!(
            undecided.iter().all(|(_, why)| why.ends_with("within t = 2000; raise t_max, or try more mesh intervals")),
            "{undecided:?}"
        );
        assert_eq!(tree.len(), 7);
        let outcomes: Vec<Option<Outcome>> = tree.cells().map(|id| tree.cell(id).fate.outcome()).collect();
        assert_eq!(outcomes[3..], [None; 4]);
        let read = tree_from_json(&tree_to_json(&tree).unwrap()).unwrap();
        assert_eq!(tree_to_json(&read).unwrap(), tree_to_json(&tree).unwrap());
    }
}

/// Where nothing tells the poles apart the smaller daughter is on either side, by the seed and the cell's name; its size is
/// that of the one division solved.
#[test]
fn sides_of_uncued_divisions_are_drawn_for_each_cell() {
    let unequal = |input: &DivisionInput| Ok(division(input.cell.r0, Outcome::Asymmetric, 0.3));
    let lineage = limited(8, 1_000_000);
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
    let lineage = limited(3000, 1_000_000);
    let (tree, _) = grow_with(&lineage, 1, &|_| None, shrinking);
    assert!(tree.len() > 2000, "{}", tree.len());
    assert_eq!(tree_from_json(&tree_to_json(&tree).unwrap()).unwrap().len(), tree.len());
    assert!(newick(&tree).len() > tree.len());
}

#[test]
fn drawing_and_report() {
    let tree = grow(&Lineage::c_elegans().unwrap());
    let drawing = furrow_report::svg(&tree);
    let report = furrow_report::html(&tree, &founder_rows(&tree));
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
