//! Bifurcations of cycles.

use furrow_bvp::continuation::Advance;
use furrow_bvp::{
    Continuation, ContinuationSettings, Gauss, Metric, Number, PeriodicOrbit, Solution, VectorField, locate, mesh,
};
use furrow_spectra::cycles::{self, CycleBranch, CyclePoint, CycleWatch};
use furrow_spectra::floquet::{CycleBifurcation, Multipliers};
use furrow_spectra::hopf::{Equilibria, EquilibriumBranch, HopfPoint, HopfWatch};

mod brusselator;
mod canard;
mod circuit;
mod conservative;
mod duffing;
mod integrated;
mod lorenz;

/// A metric in which c and T have no weight.
fn metric(components: usize, parameter: f64) -> Metric {
    let mut scalars = vec![0.0; components + 2];
    scalars[components + 1] = parameter;
    Metric { components: vec![1.0; components], scalars }
}

/// All Hopf points in a range.
fn hopf_points<V: VectorField>(branch: &mut EquilibriumBranch<V>, range: [f64; 2]) -> Vec<HopfPoint> {
    let (mut watch, mut all) = (HopfWatch::start(branch).unwrap(), Vec::new());
    let ended = branch.follow(range, 300, |branch, advance| {
        all.extend(watch.look(branch, advance).unwrap());
        true
    });
    ended.unwrap();
    all
}

/// A point is of a kind, at a parameter and a period, and its error is as small as it says.
fn check(point: &CyclePoint, kind: CycleBifurcation, [parameter, period]: [f64; 2], digits: f64) {
    let what = format!("{kind:?} at {parameter}: {point:?}");
    assert_eq!(point.bifurcation, kind, "{what}");
    assert!((point.parameter() - parameter).abs() < digits && (point.period() - period).abs() < digits, "{what}");
    assert!(point.error < digits, "{what}");
}

/// All points in a range.
fn watched<V: VectorField + Clone>(
    branch: &mut CycleBranch<V>,
    range: [f64; 2],
    limit: usize,
    mut visit: impl FnMut(&mut CycleBranch<V>, Advance, &Multipliers, &[CyclePoint]) -> bool,
) -> Vec<CyclePoint> {
    let (mut watch, mut all) = (CycleWatch::start(branch).unwrap(), Vec::new());
    branch
        .follow(range, limit, |branch, advance| {
            let found = watch.look(branch, advance).unwrap();
            let goes_on = visit(branch, advance, &watch.multipliers, &found);
            all.extend(found);
            goes_on
        })
        .unwrap();
    all
}
