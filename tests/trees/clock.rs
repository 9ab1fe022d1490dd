//! The clock of a lineage: births and divisions in minutes, in trees and in their files.

use std::fs;

use crate::common::stand_in::{fake, grown};
use furrow_formats::exchange::{BranchLengths, Exported, Format, check_tree, export};
use furrow_formats::{founder_rows, newick, tree_from_json, tree_to_json};
use furrow_lineage::clock::{Alive, alive, last_divisions};
use furrow_lineage::{CellId, CellTimes, Lineage, Origin, Tree};
use furrow_report::founders_table;

/// Q with the daughters A and B, and further fields of the file and of A.
fn lineage(fields: &str, of_a: &str) -> Lineage {
    parsed(fields, of_a).unwrap()
}

fn parsed(fields: &str, of_a: &str) -> Result<Lineage, furrow_input::InputError> {
    Lineage::parse(
        &format!(
            "Lineage(name: \"x\", limits: (max_depth: 4), {fields} cues: {{\"polar\": \"kappa:u0=0.4,omega=0.1,amplitude=0.2\"}},
             founders: [(name: \"Q\", r0: 5.0, cue: \"polar\", inherit: false),
                        (name: \"A\", mother: \"Q\", daughter: larger, {of_a}),
                        (name: \"B\", mother: \"Q\", daughter: smaller)])"
        ),
        "my.ron",
    )
}

fn grow(fields: &str, of_a: &str) -> Tree {
    grown(&lineage(fields, of_a), &|_| None, fake)
}

/// A cell's times and volume by name.
fn of(tree: &Tree, name: &str) -> (CellTimes, f64) {
    let id = tree.cells().find(|id| tree.cell(*id).name == name).unwrap();
    (tree.times().unwrap()[id.index()], tree.cell(id).volume_fraction)
}

/// The lifetime of a cell that divides.
fn lifetime(tree: &Tree, name: &str) -> f64 {
    let (times, _) = of(tree, name);
    times.division_min.unwrap() - times.birth_min
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{a} {b}");
}

#[test]
fn cells_live_by_their_volume_and_daughters_are_born_when_their_mother_divides() {
    let tree = grow("clock: (lifetime_min: 24, exponent: 0.28),", "");
    let times = tree.times().unwrap();
    assert!(tree.len() > 20);
    for id in tree.cells() {
        let CellTimes { birth_min, division_min, .. } = times[id.index()];
        assert_eq!(division_min.is_some(), tree.daughters(id).is_some());
        if let Some(division) = division_min {
            close(division - birth_min, 24.0 / tree.cell(id).volume_fraction.powf(0.28));
        }
        match tree.mother(id) {
            None => assert_eq!(birth_min, 0.0),
            Some(mother) => assert_eq!(Some(birth_min), times[mother.index()].division_min),
        }
    }
    close(lifetime(&tree, "Q"), 24.0);
    // The smaller sister lives longer.
    assert!(lifetime(&tree, "B") > lifetime(&tree, "A"));
}

#[test]
fn a_founder_has_a_law_of_its_own_and_inherits_the_rest() {
    let file = "clock: (lifetime_min: 24, exponent: 0.28),";
    let law = |name: &str, of_a: &str, lifetime_min: f64, at: f64, exponent: f64| {
        let tree = grow(file, of_a);
        let (_, volume) = of(&tree, name);
        close(lifetime(&tree, name), lifetime_min * (volume / at).powf(-exponent));
    };
    for name in ["A", "Aa", "Aap"] {
        law(name, "clock: (exponent: 1.0)", 24.0, 1.0, 1.0);
        law(name, "clock: (lifetime_min: 30)", 30.0, 1.0, 0.28);
        law(name, "clock: (lifetime_min: 30, at_volume: 0.1, exponent: -0.5)", 30.0, 0.1, -0.5);
    }
    for name in ["Q", "B", "Ba"] {
        law(name, "clock: (lifetime_min: 30, exponent: 1.0)", 24.0, 1.0, 0.28);
    }
    // At its own volume a cell has the given lifetime.
    let tree = grow("clock: (lifetime_min: 24, at_volume: 0.25),", "");
    close(lifetime(&tree, "A"), 24.0);
}

#[test]
fn measured_lifetimes_go_before_the_law_and_pinch_off_is_added_to_the_law_alone() {
    let clock = "clock: (lifetime_min: 24, tau_min: 4.0, lifetimes: {\"A\": 31.5}),";
    let tree = grow(clock, "");
    close(lifetime(&tree, "A"), 31.5);
    let t_end = tree.cell(tree.first()).fate.t_end().unwrap();
    assert!(t_end > 1.0);
    close(lifetime(&tree, "Q"), 24.0 + 4.0 * t_end);

    let folder = tempfile::tempdir().unwrap();
    let text = |table: &str| {
        fs::write(folder.path().join("lifetimes.csv"), table).unwrap();
        let file = folder.path().join("my.ron");
        let lineage = "Lineage(name: \"x\", clock: (lifetime_min: 24, lifetimes: \"lifetimes.csv\"), founders: [(name: \"Q\", r0: 5.0)])";
        fs::write(&file, lineage).unwrap();
        Lineage::read(&file)
    };
    let read = text("# measured, by hand\ncell,n,lifetime_min\nQ,8,20.5\nQap,8,33\n").unwrap();
    assert_eq!(
        read.clock.unwrap().lifetimes.unwrap().into_iter().collect::<Vec<_>>(),
        [("Q".to_owned(), 20.5), ("Qap".to_owned(), 33.0)]
    );
    for (table, expected) in [
        ("cell,minutes\nQ,3\n", "lifetimes.csv:1:1: no column is called lifetime_min"),
        ("cell,lifetime_min\nQ,3\nQa,-3\n", "lifetimes.csv:3:1: lifetime_min = \"-3\": must be a number above 0"),
        ("cell,lifetime_min\nQ,3\nQ,3\n", "lifetimes.csv:3:1: the cell \"Q\" is given twice"),
        ("cell,lifetime_min\nQx,3\n", "clock.lifetimes = \"Qx\": must be a founder of this file"),
    ] {
        let said = text(table).unwrap_err().to_string();
        assert!(said.contains(expected), "{said}");
    }
}

#[test]
fn the_origin_is_minute_0_where_it_takes_place() {
    let (plain, of_division) = (
        grow("clock: (lifetime_min: 24, exponent: 0.28),", ""),
        grow("clock: (lifetime_min: 24, exponent: 0.28, origin: division(\"A\")),", ""),
    );
    let (a, _) = of(&plain, "A");
    assert_eq!(of(&of_division, "A").0.division_min, Some(0.0));
    for id in plain.cells() {
        let [before, after] = [&plain, &of_division].map(|tree| tree.times().unwrap()[id.index()]);
        close(after.birth_min, before.birth_min - a.division_min.unwrap());
    }
    assert_eq!(of_division.time_origin(), Some(Origin::Division("A".to_owned())));
    let of_birth = grow("clock: (lifetime_min: 24, origin: birth(\"B\")),", "");
    assert_eq!(of(&of_birth, "B").0.birth_min, 0.0);
    // A cell that is never born.
    let none = grow("clock: (lifetime_min: 24, origin: division(\"Aaaaaaaaa\")),", "");
    assert_eq!(none.time_origin(), Some(Origin::Birth("Q".to_owned())));
    assert_eq!(of(&none, "Q").0.birth_min, 0.0);
}

#[test]
fn clocks_that_are_wrong_are_refused_with_their_place() {
    for (fields, of_a, expected) in [
        ("clock: (lifetime_min: 0),", "", "clock.lifetime_min = 0: must be a number of minutes"),
        ("clock: (lifetime_min: 24, exponent: 9),", "", "clock.exponent = 9: must be a number from -5 to 5"),
        ("clock: (lifetime_min: 24, at_volume: -1),", "", "clock.at_volume = -1: must be a fraction"),
        ("clock: (lifetime_min: 24, tau_min: 0),", "", "clock.tau_min = 0: must be a number of minutes"),
        ("clock: (lifetime_min: 24, origin: birth(\"Ax\")),", "", "clock.origin = \"Ax\": must be a founder"),
        // Its daughters are founders.
        ("clock: (lifetime_min: 24, origin: birth(\"Qa\")),", "", "clock.origin = \"Qa\": must be a founder"),
        (
            "clock: (lifetime_min: 24, lifetimes: {\"A\": -3}),",
            "",
            "clock.lifetimes[\"A\"] = -3: must be a number of minutes",
        ),
        ("clock: (lifetime_min: 24, lifetimes: {\"A\": 3, \"A\": 4}),", "", "the cell \"A\" is given twice"),
        ("clock: (exponent: 0.3),", "", "lifetime_min"),
        (
            "",
            "clock: (exponent: 0.3)",
            "my.ron:3: founder \"A\": clock = (given): must be left out where the file has no clock",
        ),
        ("clock: (lifetime_min: 24),", "clock: (lifetime_min: -1)", "founder \"A\": clock.lifetime_min = -1"),
        (
            "clock: (lifetime_min: 24),",
            "clock: (at_volume: 0.1)",
            "founder \"A\": clock.at_volume = (alone): must be given with",
        ),
    ] {
        let said = parsed(fields, of_a).unwrap_err().to_string();
        assert!(said.contains(expected), "{said}\n{expected}");
    }
}

#[test]
fn a_base_gives_its_clock_unless_the_file_has_one() {
    let worm = Lineage::c_elegans().unwrap();
    let e = worm.founder_named("E").unwrap();
    assert!(worm.clock.is_some() && worm.founders[e].clock.is_some());
    let parse = |fields: &str| Lineage::parse(&format!("(base: \"c_elegans\", {fields})"), "mine.ron").unwrap();
    let same = parse("name: \"mine\"");
    assert_eq!((&same.clock, same.lifetime_law(e)), (&worm.clock, worm.lifetime_law(e)));
    let own = parse("clock: (lifetime_min: 24, exponent: 0.28)");
    assert!(own.founders.iter().all(|founder| founder.clock.is_none()));
    assert_eq!(own.lifetime_law(e).unwrap().lifetime(0.5), 24.0 * 0.5_f64.powf(-0.28));
    let one = parse("founders: [(name: \"E\", clock: (exponent: 0.5))]");
    assert_eq!(one.lifetime_law(e).unwrap().exponent, 0.5);
}

/// The clock changes neither cells nor divisions, and a file without one has no word of it.
#[test]
fn without_a_clock_every_file_is_as_before() {
    let (with, without) = (grow("clock: (lifetime_min: 24, exponent: 0.28),", ""), grow("", ""));
    assert!(with.cells().all(|id| with.cell(id) == without.cell(id)) && with.len() == without.len());
    assert!(without.times().is_none() && without.time_origin().is_none());
    assert_eq!(newick(&with), newick(&without));
    let text = tree_to_json(&without).unwrap();
    assert!(!text.contains("clock") && !text.contains("_min"), "{text}");
    for format in Format::ALL {
        let Exported::File(text) = export(&without, format, BranchLengths::Time, &[]) else { continue };
        assert!(!text.contains("_min"), "{format:?}");
    }
    let refused = check_tree(&without, Format::Newick, BranchLengths::Minutes).unwrap_err().to_string();
    assert!(refused.contains("must be time, generation or none: the tree's lineage has no clock"), "{refused}");
}

#[test]
fn a_tree_file_keeps_times_and_refuses_others() {
    let tree = grow("clock: (lifetime_min: 24, exponent: 0.28, origin: division(\"Q\")),", "");
    let text = tree_to_json(&tree).unwrap();
    let read = tree_from_json(&text).unwrap();
    assert_eq!((read.times(), tree_to_json(&read).unwrap()), (tree.times(), text.clone()));
    let first = "\"birth_min\":-24.0,\"division_min\":0.0}";
    assert_eq!(text.matches(first).count(), 1);
    for (with, expected) in [
        (
            "\"birth_min\":-23.0,\"division_min\":0.0}",
            "cells[0] \"Q\": birth_min = -23.0: must be -24.0 by the lineage's clock",
        ),
        ("\"division_min\":1.0}", "division_min = 1.0: must be 0.0 by"),
    ] {
        let said = tree_from_json(&text.replace(first, with)).unwrap_err().to_string();
        assert!(said.contains(expected), "{said}");
    }
    // Files of older versions lack it.
    assert!(tree_from_json(&text.replace(first, "\"t_max\":1}")).is_ok());
}

fn exported(tree: &Tree, format: Format, lengths: BranchLengths) -> String {
    let Exported::File(text) = export(tree, format, lengths, &[]) else { panic!("{format:?} is one file") };
    text
}

#[test]
fn exports_have_minutes() {
    let tree = grow("clock: (lifetime_min: 24, exponent: 0.28),", "");
    let text = exported(&tree, Format::Newick, BranchLengths::Minutes);
    assert!(text.ends_with(")Q:24;\n"), "{text}");
    let b = lifetime(&tree, "B");
    assert!(text.contains(&format!("B:{b})")), "{text}");
    let nhx = exported(&tree, Format::Nhx, BranchLengths::None);
    assert!(nhx.contains("birth_min=0:division_min=24]") && nhx.contains("birth_min=24:"), "{nhx}");
    let csv = exported(&tree, Format::Csv, BranchLengths::Time);
    assert!(csv.lines().next().unwrap().ends_with(",birth_min,division_min,lifetime_extrapolated"));
    assert!(csv.lines().nth(1).unwrap().ends_with(",,0,24,"), "{csv}");
    let graph = exported(&tree, Format::GraphMl, BranchLengths::Minutes);
    assert!(graph.contains(&format!("target=\"B\"><data key=\"length\">{b}</data>")));
    assert!(graph.contains("<data key=\"division_min\">24</data>"));
}

/// In the table, in tree.json and in exports: those more than half a division smaller than the smallest cell of the fit.
#[test]
fn minutes_beyond_the_sizes_of_the_clock_are_marked() {
    let volumes = |range: &str| grow(&format!("clock: (lifetime_min: 24, exponent: 0.28, volumes: {range}),"), "");
    let beyond = |tree: &Tree| {
        let times = tree.times().unwrap();
        tree.cells().filter(|id| times[id.index()].lifetime_extrapolated).collect::<Vec<_>>()
    };
    assert!(beyond(&volumes("(1e-9, 1)")).is_empty());
    let tree = volumes("(0.8, 1)");
    let marked = beyond(&tree);
    assert!(!marked.is_empty() && marked.len() < tree.len());
    let small = |id: &&CellId| tree.daughter_count(**id) > 0 && tree.cell(**id).volume_fraction < 0.8 / 2_f64.sqrt();
    assert_eq!(marked.len(), tree.cells().collect::<Vec<_>>().iter().filter(small).count());
    let text = tree_to_json(&tree).unwrap();
    assert_eq!(text.matches("\"lifetime_extrapolated\":true").count(), marked.len());
    assert_eq!(tree_to_json(&tree_from_json(&text).unwrap()).unwrap(), text);
    let csv = exported(&tree, Format::Csv, BranchLengths::Time);
    assert_eq!(csv.lines().filter(|line| line.ends_with(",1")).count(), marked.len());
    let table = founders_table(&tree, &founder_rows(&tree));
    assert!(table.contains("* extrapolated: the clock was fitted to cells of other sizes"), "{table}");
    let wrong = "Lineage(name: \"x\", clock: (lifetime_min: 24, volumes: (0.3, 0.1)), founders: [(name: \"Q\")])";
    let said = Lineage::parse(wrong, "x.ron").unwrap_err().to_string();
    assert!(said.contains("clock.volumes = (0.3, 0.1): must be the smallest and the largest volume"), "{said}");
}

/// A row for each minute, each after the one before; by generation one row a cell as without a clock.
#[test]
fn time_points_of_lineagetree_are_minutes() {
    let tree = grow("clock: (lifetime_min: 24, exponent: 0.28, origin: division(\"A\")),", "");
    let text = exported(&tree, Format::LineageTree, BranchLengths::Time);
    let rows: Vec<Vec<f64>> =
        text.lines().map(|line| line.split(',').map(|number| number.parse().unwrap()).collect()).collect();
    let times = tree.times().unwrap();
    let begin = times[0].birth_min;
    let last = times.iter().filter_map(|cell| cell.division_min).fold(0.0, f64::max) - begin;
    for (k, row) in rows.iter().enumerate() {
        let &[id, time, cell, _, _, pred, _] = row.as_slice() else { panic!("{row:?}") };
        assert_eq!(id as usize, k);
        if pred < 0.0 {
            assert_eq!((k, time), (0, 0.0));
            continue;
        }
        let before = &rows[pred as usize];
        assert_eq!(time, before[1] + 1.0);
        let of_mother = tree.mother(tree.cells().nth(cell as usize).unwrap()).map(|mother| mother.index() as f64);
        assert!(before[2] == cell || Some(before[2]) == of_mother);
    }
    for id in tree.cells() {
        let CellTimes { birth_min, division_min, .. } = times[id.index()];
        let own: Vec<f64> = rows.iter().filter(|row| row[2] as usize == id.index()).map(|row| row[1]).collect();
        let end = division_min.map_or(last, |division| division - begin);
        assert!((own[0] - (birth_min - begin)).abs() < 1.0 && (own[own.len() - 1] + 1.0 - end).abs() < 1.0);
    }
    let by_generation = exported(&tree, Format::LineageTree, BranchLengths::Generation);
    assert_eq!(by_generation, exported(&grow("", ""), Format::LineageTree, BranchLengths::Time));
    assert!(Format::LineageTree.check_lengths(BranchLengths::Time).is_err());
    assert!(Format::Csv.check_lengths(BranchLengths::Minutes).is_err());
}

#[test]
fn cells_alive_and_last_divisions_are_those_of_the_times() {
    let tree = grow("clock: (lifetime_min: 24, exponent: 0.28, origin: division(\"Q\")),", "");
    let times = tree.times().unwrap();
    let counts = alive(&times);
    assert!(counts.len() > 50 && counts.len() <= 102, "{}", counts.len());
    for Alive { min, cells } in &counts {
        let there =
            |cell: &&CellTimes| cell.birth_min <= *min && cell.division_min.is_none_or(|division| division > *min);
        assert_eq!(*cells, times.iter().filter(there).count(), "{min}");
    }
    let ends = tree.cells().filter(|id| tree.daughters(*id).is_none()).count();
    assert_eq!((counts[0], counts[counts.len() - 1].cells), (Alive { min: -24.0, cells: 1 }, ends));
    let last = last_divisions(&tree, &times);
    let of_all = times.iter().filter_map(|cell| cell.division_min).reduce(f64::max);
    assert_eq!(last[0], of_all);
    for (k, name) in ["Q", "A", "B"].into_iter().enumerate() {
        let below = tree.cells().filter(|id| name == "Q" || tree.cell(*id).name.starts_with(name));
        assert_eq!(last[k], below.filter_map(|id| times[id.index()].division_min).reduce(f64::max), "{name}");
        assert_eq!(founder_rows(&tree)[k].last_division_min, last[k]);
    }
}
