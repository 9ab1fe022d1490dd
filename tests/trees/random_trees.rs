//! Trees of random cells, confinements, activities and cues: every tree is complete, and predicted ends agree with the
//! dynamics.

use crate::common::stand_in::grow;
use furrow_cell::{Cell, Numerics};
use furrow_lineage::{Lineage, TerminalReason, Thresholds, Tree, TreeSettings};
use furrow_mechanics::critical::CriticalRadii;
use furrow_mechanics::division::divide;
use rand_mt::Mt64;

/// Uniform in [from, to).
pub fn between(random: &mut Mt64, from: f64, to: f64) -> f64 {
    from + (to - from) * (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

pub fn one_of<'a>(random: &mut Mt64, list: &[&'a str]) -> &'a str {
    list[(random.next_u64() % list.len() as u64) as usize]
}

/// A cue of one term, of any field and profile.
fn cue(random: &mut Mt64) -> String {
    let fields = ["kappa", "activity", "xi_s", "xi_b", "eta_b", "eta_s", "viscosity", "friction", "tension"];
    let (field, profile) = (one_of(random, &fields), one_of(random, &["band", "step", "gradient"]));
    let amplitude = between(random, 0.05, 0.3) * if random.next_u64() & 1 == 0 { 1.0 } else { -1.0 };
    let place = match profile {
        "gradient" => String::new(),
        _ => format!("u0={},omega={},", between(random, 0.3, 0.7), between(random, 0.04, 0.15)),
    };
    format!("{field}:{profile},{place}amplitude={amplitude}")
}

#[test]
fn every_tree_is_whole_and_equals_that_of_all_its_divisions() {
    let mut random = Mt64::new(20261121);
    let (mut cells, mut slow) = (0, 0);
    for number in 0..6 {
        let cell = Cell {
            epsilon: between(&mut random, 0.8, 0.9),
            xi_s: between(&mut random, 20.0, 30.0),
            ..Cell::gao2026_thresholds(between(&mut random, 4.0, 7.0))
        };
        let cue = cue(&mut random);
        let lineage = Lineage::c_elegans().unwrap().with_cues_replaced("random", &cue.parse().unwrap());
        // The two trees are compared with each other, so a coarse mesh suffices.
        let numerics = Numerics { intervals: 32, ..Numerics::default() };
        let settings = TreeSettings { cell, numerics, seed: number, ..TreeSettings::default() };
        let rule = Thresholds::new(CriticalRadii::new(&settings.numerics));
        let [ahead, all] = [&(|cell: &Cell| rule.of(cell)) as &dyn Fn(&Cell) -> Option<TerminalReason>, &|_| None]
            .map(|ends| grow(&lineage, &settings, 2, ends, divide).0);
        let fates = |tree: &Tree| -> Vec<_> {
            tree.cells().map(|id| tree.cell(id)).map(|c| (c.name.clone(), c.r0.to_bits(), c.fate.outcome())).collect()
        };
        assert_eq!(fates(&ahead), fates(&all), "{:?}, {cue}", settings.cell);
        assert!(fates(&all).iter().all(|(.., outcome)| outcome.is_some()), "{:?}, {cue}", settings.cell);
        let waited = |id| all.cell(id).fate.division().is_some_and(|d| d.slow_growth_rate.is_some());
        cells += all.len();
        slow += all.cells().filter(|id| waited(*id)).count();
    }
    println!("{cells} cells, {slow} of them slow");
    assert!(cells > 600, "{cells}");
}
