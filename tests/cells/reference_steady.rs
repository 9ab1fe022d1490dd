//! Stationary shapes compared with independent reference values.

use crate::common::tables;
use furrow_bvp::newton::{Newton, NewtonScratch};
use furrow_bvp::{Gauss, System};
use furrow_cell::{Cell, Numerics};
use furrow_mechanics::cortex::{Cortex, Domain, observables};
use furrow_mechanics::equilibria::{passive, stationary};

#[test]
fn passive_shapes_exist_for_every_confinement() {
    for r0 in [0.3, 1.0, 2.0, 5.4, 12.0] {
        for k in 0..=13 {
            let epsilon = 0.3 + 0.05 * k as f64;
            let cell = Cell { epsilon, ..Cell::gao2026_thresholds(r0) };
            let (y, report) =
                passive(&cell, &Numerics::default()).unwrap_or_else(|e| panic!("R0 = {r0}, epsilon = {epsilon}: {e}"));
            let volume = 2.0 * observables::volume_until(&Gauss::new(4).unwrap(), &y, 0.5);
            assert!((volume / cell.volume() - 1.0).abs() < 1e-10, "{volume} {cell:?} {report:?}");
        }
    }
}

#[test]
fn passive_shapes_match_the_reference() {
    let rows = tables::reference("passive.csv");
    assert!(rows.len() >= 2);
    for row in rows {
        let (r0, epsilon) = (row.number("R0"), row.number("eps"));
        let numerics = Numerics::default();
        let (y, _) = passive(&Cell { epsilon, ..Cell::gao2026_thresholds(r0) }, &numerics).unwrap();
        let gauss = Gauss::new(numerics.stages).unwrap();
        assert!((y.scalars[0] - row.number("L")).abs() < 2e-6, "{row:?}");
        assert!((y.scalars[1] - row.number("p")).abs() < 2e-6, "{row:?}");
        let elongation = observables::elongation(&y, Domain::Half, r0);
        assert!((elongation - row.number("H_over_R0")).abs() < 1e-6, "{row:?}");
        let radius = observables::equator_radius(&gauss, &y) / r0;
        assert!((radius - row.number("r_eq_over_R0")).abs() < 1e-6, "{row:?}");
    }
}

/// At R0 = 2, ε = 0.87 the symmetric branch passes ξ_s = 20.7468 with H = 2.736436 and p = 0.56647.
#[test]
fn an_active_symmetric_shape_matches_the_reference() {
    let numerics = Numerics::default();
    let (mut y, _) = passive(&Cell::gao2026_thresholds(2.0), &numerics).unwrap();
    let mut system = System::new(Cortex::dimensions_for(&Cell::new(2.0), 0), numerics.stages);
    let mut scratch = NewtonScratch::default();
    for xi_s in [5.0, 10.0, 15.0, 18.0, 20.7468] {
        let mut cortex = Cortex::new(&Cell { xi_s, ..Cell::gao2026_thresholds(2.0) }, Domain::Half, &[]);
        Newton::default().solve(&mut system, &mut scratch, &mut cortex, &mut y, &[], false).unwrap();
    }
    assert!((observables::elongation(&y, Domain::Half, 2.0) - 2.736436).abs() < 2e-6);
    assert!((y.scalars[0] / 2.0 - 3.5787).abs() < 1e-4);
    assert!((y.scalars[1] - 0.56647).abs() < 2e-4);
}

/// φ at the equator and at the poles of a cell at rest whose regulator has no source: independent values,
/// converged to 1e-6 and given to 1e-5.
#[test]
fn a_regulator_at_rest_matches_the_reference() {
    let cue: furrow_cell::Cue = "regulator:none,turnover=10,diffusion=1,activity=0.3".parse().unwrap();
    let cell = Cell::gao2026_thresholds(1.65).with_cue(cue);
    let shape = stationary(&cell, &Numerics::default()).unwrap();
    for (u, expected) in [(0.5, -0.11849), (0.0, 0.15592), (1.0, 0.15592)] {
        let phi = shape.regulator_at(u).unwrap();
        assert!((phi - expected).abs() < 1e-5, "{u}: {phi}");
    }
    assert_eq!(stationary(&Cell::gao2026_thresholds(1.65), &Numerics::default()).unwrap().regulator_at(0.5), None);
}
