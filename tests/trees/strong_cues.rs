//! Critical radii end branches only where divisions rest, whatever the cue.

use furrow_cell::{Cell, Cue, Numerics};
use furrow_lineage::batch::{Memo, Quantisation, SchedulerOptions, critical_radii, solve};
use furrow_lineage::{EndRule, Fate, Grower, Lineage, TerminalReason, Thresholds, Tree, TreeSettings};
use furrow_mechanics::critical::CriticalRadii;
use furrow_mechanics::division::divide;
use rand_mt::Mt64;
use rayon::prelude::*;

use super::random_trees::{between, one_of};

/// A strong cue of one term that tells the poles apart.
fn strong_cue(random: &mut Mt64) -> String {
    let fields = ["kappa", "activity", "xi_s", "xi_b", "eta_b", "eta_s", "viscosity", "friction", "tension"];
    let (field, profile) = (one_of(random, &fields), one_of(random, &["band", "step", "gradient"]));
    let amplitude = between(random, 0.4, 0.95) * if random.next_u64() & 1 == 0 { 1.0 } else { -1.0 };
    let width = match random.next_u64() & 1 {
        0 => format!("{:.4}", between(random, 0.03, 0.3)),
        _ => format!("{:.4}Lh", between(random, 0.2, 1.5)),
    };
    let place = match profile {
        "gradient" => String::new(),
        _ => format!("u0={:.5},omega={width},", between(random, 0.0, 1.0)),
    };
    format!("{field}:{profile},{place}amplitude={amplitude:.5}")
}

/// Which cells divide, in trees with and without critical radii, from one memo.
pub fn dividing(cue: &Cue, settings: &TreeSettings, most: usize) -> [Vec<(String, bool)>; 2] {
    let text = r#"(name: "one", cues: {"strong": "kappa:u0=0.4,omega=0.1,amplitude=0.2"}, founders: [(name: "S", cue: "strong")])"#;
    let mut lineage = Lineage::parse(text, "one.ron").unwrap();
    lineage.limits.max_cells = most;
    let lineage = lineage.with_cues_replaced("strong", cue);
    let memo = Memo::new(Quantisation::DEFAULT);
    let radii = Thresholds::new(CriticalRadii::new(&settings.numerics));
    [EndRule::Thresholds(&radii), EndRule::Dynamics].map(|ends| {
        let options = SchedulerOptions { threads: 1, ..SchedulerOptions::default() };
        let grower = Grower { lineage: &lineage, settings: settings.clone(), ends, memo: &memo, options };
        let (tree, _): (Tree, _) = grower.grow(divide).unwrap();
        tree.cells()
            .map(|id| tree.cell(id))
            .map(|cell| (cell.name.clone(), matches!(cell.fate, Fate::Divides(_))))
            .collect()
    })
}

/// Asserts that trees with and without critical radii have the same cells, for three cues that were hard and `count` random ones.
fn assert_radii_agree_with_divisions(count: usize) {
    let mut random = Mt64::new(20261123);
    let named = [
        "xi_s:band,u0=0.960127,omega=1.183Lh,amplitude=0.945228",
        "activity:gradient,amplitude=0.85",
        "xi_s:band,u0=0.5231,omega=0.03072,amplitude=0.4602",
    ];
    let random = std::iter::repeat_with(|| strong_cue(&mut random)).take(count);
    let cues: Vec<String> = named.into_iter().map(str::to_owned).chain(random).collect();
    let differs = |(number, cue): (usize, &String)| {
        let cell = if number % 2 == 0 { Cell::new(2.1) } else { Cell::gao2026_thresholds(2.1) };
        let [ahead, all] = dividing(&cue.parse().unwrap(), &TreeSettings { cell, ..TreeSettings::default() }, 24);
        let first = ahead.iter().zip(&all).find(|(a, b)| a != b)?;
        Some(format!("{number} {cue}: {} and {} cells, {first:?}", ahead.len(), all.len()))
    };
    let differ: Vec<String> = cues.par_iter().enumerate().filter_map(differs).collect();
    assert!(differ.is_empty(), "{differ:#?}");
}

#[test]
fn no_radius_ends_a_branch_that_divides() {
    assert_radii_agree_with_divisions(30);
}

#[test]
#[ignore = "takes minutes of every core"]
fn no_radius_ends_a_branch_that_divides_under_400_cues() {
    assert_radii_agree_with_divisions(397);
}

/// Without axial symmetry, cells below the critical radius of bent states rest.
#[test]
fn trees_without_the_axis_end_as_their_divisions_do() {
    let numerics = Numerics { modes: 2, elements: 32, ..Numerics::default() };
    let settings = TreeSettings { cell: Cell::new(1.7), numerics, ..TreeSettings::default() };
    let lineage = Lineage::parse(r#"(name: "one", founders: [(name: "S")])"#, "one.ron").unwrap();
    let memo = Memo::new(Quantisation::DEFAULT);
    let radii = Thresholds::new(critical_radii(&numerics, None));
    let grown = [EndRule::Thresholds(&radii), EndRule::Dynamics].map(|ends| {
        let options = SchedulerOptions { threads: 2, ..SchedulerOptions::default() };
        let grower = Grower { lineage: &lineage, settings: settings.clone(), ends, memo: &memo, options };
        let (tree, _) = grower.grow(solve).unwrap();
        let of = |id| (tree.cell(id).name.clone(), tree.cell(id).r0, matches!(tree.cell(id).fate, Fate::Divides(_)));
        let below = tree.cells().filter(|id| {
            let reason = tree.cell(*id).fate.terminal_reason();
            reason.is_some_and(
                |reason| matches!(reason, TerminalReason::BelowBentBoundary { r0_c } if (1.4..1.45).contains(r0_c)),
            )
        });
        (tree.cells().map(of).collect::<Vec<_>>(), below.count())
    });
    let [(ahead, below), (all, none)] = grown;
    assert_eq!(ahead, all);
    // Equal halves of 1.35, which rest.
    assert!(ahead.len() == 3 && below == 2 && none == 0, "{ahead:?}");
}
