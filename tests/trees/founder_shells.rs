//! Shells of founders: the profile of a table for some of the lineage, in place of the run's.

use std::sync::Mutex;

use crate::common::stand_in::{fake, grow};
use furrow_cell::{Cell, ShellChoice, ShellProfile};
use furrow_formats::{tree_from_json, tree_to_json};
use furrow_lineage::{Lineage, TreeSettings};
use furrow_mechanics::division::DivisionInput;

/// r = b sin t √(1 + k cos t), z = a cos t.
fn egg(k: f64) -> ShellProfile {
    let row = |i: usize| {
        let (sin, cos) = (i as f64 * std::f64::consts::PI / 24.0).sin_cos();
        format!("{},{}\n", 1.505 * cos, if i.is_multiple_of(24) { 0.0 } else { sin * (1.0 + k * cos).sqrt() })
    };
    let text = format!("z,r\n{}", (0..=24).map(row).collect::<String>());
    ShellProfile::from_table(text.as_bytes(), "egg", "egg.csv").unwrap()
}

const FOUNDERS: &str = r#"Lineage(name: "x", limits: (max_depth: 4), founders: [
    (name: "Q", r0: 4, growth: 2),
    (name: "A", mother: "Q", daughter: larger),
    (name: "B", mother: "Q", daughter: smaller, physics: (aspect: 1.2)),
    (name: "C", mother: "B", daughter: larger, shell_profile: "ellipsoid"),
    (name: "D", mother: "B", daughter: smaller, physics_rules: [(parameter: "aspect", from_mother: true, factor: 1.1)]),
])"#;

/// Q and D have the same table and B another one.
fn lineage() -> Lineage {
    let mut lineage = Lineage::parse(FOUNDERS, "x.ron").unwrap();
    for (founder, k) in [(0, 0.2), (2, 0.3), (4, 0.2)] {
        lineage.founders[founder].shell_profile = Some(ShellChoice::Profile(Box::new(egg(k))));
    }
    lineage
}

#[test]
fn a_founders_shell_is_that_of_its_descendants_up_to_the_next_founder() {
    let settings = TreeSettings { cell: Cell::new(4.0).with_shell_profile(egg(-0.1)), ..TreeSettings::default() };
    let seen = Mutex::new(Vec::new());
    let solve = |input: &DivisionInput| {
        seen.lock().unwrap().push(input.cell.clone());
        fake(input)
    };
    let tree = grow(&lineage(), &settings, 1, &|_| None, solve).0;
    let run = &settings.cell;
    let mut founders = [0; 5];
    for id in tree.cells() {
        let (place, cell) = (tree.cell(id), tree.parameters(id));
        founders[place.founder] += 1;
        let expected = match place.founder {
            0 => (Some(egg(0.2)), egg(0.2).aspect()),
            // Not its mother's, but the run's.
            1 => (Some(egg(-0.1)), run.shell.aspect),
            2 => (Some(egg(0.3)), 1.2),
            3 => (None, run.shell.aspect),
            // The factor of its rule is taken once for each division from B.
            _ => (Some(egg(0.2)), 1.2 * 1.1f64.powi(place.generation as i32 - 1)),
        };
        assert_eq!(cell.shell_profile.as_deref(), expected.0.as_ref(), "{}", place.name);
        assert!((cell.shell.aspect / expected.1 - 1.0).abs() < 1e-12, "{}: {}", place.name, cell.shell.aspect);
        if place.fate.division().is_some() {
            let same = |input: &Cell| (&input.shell_profile, input.shell) == (&cell.shell_profile, cell.shell);
            assert!(seen.lock().unwrap().iter().any(same), "{}", place.name);
        }
    }
    assert!(founders.iter().skip(3).all(|cells| *cells > 1), "{founders:?}");
    let again = tree_from_json(&tree_to_json(&tree).unwrap()).unwrap();
    assert!(tree.cells().all(|id| again.parameters(id) == tree.parameters(id)));
}

#[test]
fn a_file_with_a_base_gives_its_founders_shells() {
    let text = r#"(base: "c_elegans", founders: [(name: "P1", shell_profile: "ellipsoid"), (name: "E", cue: "none")])"#;
    let lineage = Lineage::parse(text, "mine.ron").unwrap();
    let shell = |name: &str| lineage.founders[lineage.founder_named(name).unwrap()].shell_profile.clone();
    assert_eq!((shell("P1"), shell("E")), (Some(ShellChoice::Ellipsoid), None));
}
