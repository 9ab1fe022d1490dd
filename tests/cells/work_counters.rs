//! The work of each kind of division: steps and factorisations, which do not depend on the machine and its load.
//!
//! After an intended change, `UPDATE_CASES=1 cargo test --test cells work_counters` writes the new numbers to `work_counters.txt`.

use crate::common::cases::check_cases;
use crate::common::shapes::{at, solve, whole};
use furrow_cell::{Cell, Cue, Numerics, Parameter};
use furrow_mechanics::division::{DivisionInput, DivisionOptions, divide_with};
use furrow_mechanics::equilibria::curves;

/// One division of each kind.
fn kinds() -> [(&'static str, f64, Cue); 5] {
    [
        ("symmetric, R0 = 2.5", 2.5, Cue::none()),
        ("asymmetric, R0 = 2.0", 2.0, Cue::none()),
        ("failed, R0 = 1.6", 1.6, Cue::none()),
        ("cued, R0 = 5.4", 5.4, Cue::published()),
        ("two furrows, R0 = 5.4", 5.4, Cue::none()),
    ]
}

/// The tables in `work_counters.txt`.
#[test]
fn work_of_each_kind_of_division() {
    check_cases("cells/work_counters.txt", |case| match case {
        "work" => work(),
        _ => intervals(),
    });
}

/// Changing R0 by one to a hundred thousand units in the last place leaves every count below as it is, but moves single
/// Newton iterations; other implementations of sin and exp may do the same. Those are therefore given to the nearest
/// multiple of 50, a tenth or so of a division's.
fn work() -> String {
    let row = |(kind, r0, cue): (&str, f64, Cue)| {
        let d = solve(Cell::gao2026_thresholds(r0).with_cue(cue));
        let outcome = format!("{:?}", d.outcome());
        let furrow_bvp::Work { steps, rejected, iterations, factorisations, remeshings } = d.work;
        let newton = (iterations + 25) / 50 * 50;
        format!("{kind:24} {outcome:11} {steps:6} {rejected:8} {factorisations:14} {remeshings:10} {newton:7}\n")
    };
    let head = "division                 outcome      steps rejected factorisations remeshings newton~\n";
    head.to_owned() + &kinds().map(row).concat()
}

/// The cost of a factorisation or an iteration grows with the intervals of the mesh: those of all steps but the first, noisy one.
fn intervals() -> String {
    let row = |(kind, r0, cue): (&str, f64, Cue)| {
        let mut intervals = Vec::new();
        let input = DivisionInput::new(Cell::gao2026_thresholds(r0).with_cue(cue));
        let (division, _) =
            divide_with(&input, DivisionOptions::observed_by(&mut |frame| intervals.push(frame.shape.intervals())))
                .unwrap();
        assert_eq!(intervals.len(), division.work.steps + 1, "the start and all steps");
        let steps = &intervals[2..];
        let (least, most) = (steps.iter().min().unwrap(), steps.iter().max().unwrap());
        let mean = steps.iter().sum::<usize>() as f64 / steps.len() as f64;
        format!("{kind:24} {least:5} {mean:4.1} {most:4}\n")
    };
    "division                 least mean most\n".to_owned() + &kinds().map(row).concat()
}

/// Branches in ξ_s, and curves of singular points, an iteration of which is a factorisation. Roundings move single steps,
/// so that these counts are held below a tenth more than was seen (in brackets).
#[test]
fn work_of_branches_and_curves() {
    let numerics = Numerics::default();
    let within = |kind: &str, seen: [usize; 2], allowed: [usize; 2]| {
        println!("{kind}: {} points, {} iterations", seen[0], seen[1]);
        assert!(seen[0] <= allowed[0] && seen[1] <= allowed[1], "{kind}: {seen:?} above {allowed:?}");
    };
    // (35, 150), (61, 225)
    for (r0, epsilon, allowed) in [(2.0, 0.87, [39, 165]), (2.22, 0.64, [67, 248])] {
        let branch = whole(&at(r0, epsilon));
        within("branch", [branch.points.len(), branch.work.iterations], allowed);
    }
    // (86 to 104, 120), (95 to 113, 117), (162 to 210, 222), (210 to 244, 247): the corrections of a step are near rounding here.
    for (range, pitchforks, folds) in [([1.5, 5.4], [115, 132], [125, 130]), ([5.4, 1.5], [231, 244], [268, 272])] {
        let curve = curves::pitchfork_curve(&Cell::gao2026_thresholds(2.0), &numerics, Parameter::R0, range).unwrap();
        within("pitchforks", [curve.points.len(), curve.iterations], pitchforks);
        let curve = curves::boundary_and_folds(&Cell::gao2026_thresholds(2.0), &numerics, Parameter::R0, range, None)
            .unwrap()
            .folds
            .remove(0);
        within("folds", [curve.points.len(), curve.iterations], folds);
    }
}
