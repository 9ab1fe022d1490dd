//! Folds, pitchforks and ends of branches do not depend on the mesh or on the length of the steps.

use furrow_cell::settings::{Settings, presets};
use furrow_cell::{Cell, Numerics};
use furrow_mechanics::equilibria::{Branch, BranchEnd, BranchOptions, asymmetric, primary};
use rayon::prelude::*;

/// Relative tolerance of ξ_s.
const TOLERANCE: f64 = 1e-4;

/// An event or an end of a branch, and its ξ_s.
type Found = (String, f64);

/// SplitMix64, from 0 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn cell(preset: &str, r0: f64, epsilon: f64, cue: Option<&str>) -> Cell {
    let mut cell = Settings::preset(preset).unwrap().cell;
    (cell.r0, cell.epsilon) = (r0, epsilon);
    if let Some(cue) = cue {
        cell.cue = cue.parse().unwrap();
    }
    cell
}

/// R0 1 to 6, ε 0.5 to 0.97; a twelfth with a symmetric cue, a twelfth with one beside the middle.
fn random_cell(index: u64) -> Cell {
    let mut random = Random(index);
    let preset = presets().nth((3.0 * random.next()) as usize).unwrap();
    let mut rounded = |from: f64, width: f64| ((from + width * random.next()) * 1e3).round() / 1e3;
    let (r0, epsilon) = (rounded(1.0, 5.0), rounded(0.5, 0.47));
    let cue = match random.next() {
        0.0..0.08 => Some("kappa:band,u0=0.5,omega=0.1,amplitude=0.2"),
        0.08..0.16 => Some("kappa:band,u0=0.465,omega=0.0577,amplitude=0.1"),
        _ => None,
    };
    cell(preset, r0, epsilon, cue)
}

fn listed(name: &str, branch: &Branch, out: &mut Vec<Found>) {
    for event in &branch.events {
        let which = match (event.pitchfork(), event.fold()) {
            (Some(pitchfork), _) => pitchfork.criticality().to_string(),
            (_, Some(fold)) => if fold.maximum { "maximum" } else { "minimum" }.to_owned(),
            _ => unreachable!("there are no others"),
        };
        out.push((format!("{name} {} {which}", event.kind()), event.point().xi_s));
    }
    out.push((format!("{name} {}", branch.ended.name()), branch.points.last().unwrap().xi_s));
}

fn found(cell: &Cell, intervals: usize, max_step: f64) -> Vec<Found> {
    let numerics = Numerics { intervals, ..Numerics::default() };
    let options = BranchOptions { xi: [0.0, 60.0], points: 2000, ..BranchOptions::default() }.with_max_step(max_step);
    let branch = primary::follow(cell, &numerics, &options, |_| true).unwrap();
    let mut out = Vec::new();
    listed("primary", &branch, &mut out);
    if let Some(pitchfork) = branch.pitchforks().next() {
        listed("asymmetric", &asymmetric::follow(pitchfork, cell, &options).branch, &mut out);
    }
    out
}

/// Says how events differ, if they do.
fn difference(cell: &Cell, settings: &[(usize, f64)]) -> Option<String> {
    let all: Vec<Vec<Found>> = settings.iter().map(|(intervals, step)| found(cell, *intervals, *step)).collect();
    let near = |a: &Found, b: &Found| a.0 == b.0 && (a.1 - b.1).abs() <= TOLERANCE * (1.0 + b.1.abs());
    let same = |a: &[Found], b: &[Found]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| near(a, b));
    let agree = all[1..].iter().all(|other| same(&all[0], other));
    let lines = settings.iter().zip(&all).map(|(settings, found)| format!("\n  {settings:?} {found:?}"));
    (!agree).then(|| format!("R0 = {}, ε = {}, {}: {}", cell.r0, cell.epsilon, cell.cue, lines.collect::<String>()))
}

/// Branches with a turning point at the pitchfork that the asymmetric one comes back to, with two folds in one step, or with events
/// next to pinch-off.
#[test]
fn events_do_not_depend_on_the_length_of_the_steps() {
    let known = [
        ("sulston1983", 3.449, 0.947),
        ("sulston1983", 3.158, 0.512),
        ("gao2026-thresholds", 5.697, 0.61),
        ("sulston1983", 3.993, 0.508),
        ("gao2026-thresholds", 4.544, 0.846),
        ("gao2026-thresholds", 5.029, 0.713),
        ("gao2026", 2.758, 0.894),
        ("gao2026-thresholds", 1.357, 0.507),
        ("sulston1983", 5.68, 0.536),
        ("gao2026-thresholds", 4.513, 0.78),
    ];
    for (preset, r0, epsilon) in known {
        assert_eq!(difference(&cell(preset, r0, epsilon, None), &[(48, 1.0), (48, 0.4)]), None);
    }
    for index in 1..6 {
        assert_eq!(difference(&random_cell(index), &[(48, 1.0), (96, 0.4)]), None);
    }
}

#[test]
fn an_asymmetric_branch_ends_at_a_pitchfork_and_in_no_fold() {
    let cell = cell("sulston1983", 3.449, 0.947, None);
    let options = BranchOptions { xi: [0.0, 60.0], ..BranchOptions::default() }.with_max_step(1.0);
    let branch = primary::follow(&cell, &Numerics::default(), &options, |_| true).unwrap();
    let branch = asymmetric::follow(branch.pitchforks().next().unwrap(), &cell, &options).branch;
    let folds: Vec<f64> = branch.folds().map(|fold| fold.point.xi_s).collect();
    assert!(folds.len() == 1 && (folds[0] - 36.893902).abs() < 1e-5, "{folds:?}");
    assert_eq!(branch.ended, BranchEnd::Rejoined);
    assert!((branch.points.last().unwrap().xi_s - 36.538117).abs() < 1e-4);
}

/// The first 150 branches, or others: `FURROW_BRANCHES=0-500`.
#[test]
#[ignore = "takes minutes"]
fn events_of_random_branches_depend_on_neither_mesh_nor_steps() {
    let part = std::env::var("FURROW_BRANCHES").unwrap_or("0-150".into());
    let (from, to) = part.split_once('-').unwrap();
    let indices = from.parse::<u64>().unwrap()..to.parse().unwrap();
    let settings = [(48, 1.0), (96, 1.0), (48, 0.4), (96, 0.4)];
    let differ: Vec<String> = indices
        .into_par_iter()
        .filter_map(|index| difference(&random_cell(index), &settings).map(|how| format!("{index}: {how}")))
        .collect();
    assert!(differ.is_empty(), "{} differ:\n{}", differ.len(), differ.join("\n"));
}
