//! Regulators that the flow carries: divisions compared with independent reference runs, thresholds with growth rates and divisions.

use crate::common::shapes::{check_threshold, first};
use crate::common::tables;
use furrow_cell::{Cell, Numerics, Parameter};
use furrow_mechanics::cortex::{Cortex, Domain};
use furrow_mechanics::critical::{BoundaryKind, critical_radius};
use furrow_mechanics::division::{DivisionInput, Outcome, divide};
use furrow_mechanics::equilibria::{StationaryError, StepBudget, primary, stationary};
use furrow_mechanics::stability::{Parity, Stability};

fn cued(r0: f64, cue: &str) -> Cell {
    Cell::gao2026_thresholds(r0).with_cue(cue.parse().unwrap_or_else(|e| panic!("{cue}: {e}")))
}

/// Without a source the flow alone gathers the regulator.
const SELF_ORGANISED: &str = "regulator:none,turnover=10,diffusion=1,activity=0.3";
/// Made off the equator.
const SOURCED: &str = "regulator:band,u0=0.45,omega=0.15,amplitude=0.5,turnover=10,diffusion=1,kappa=0.4";

#[test]
fn divisions_with_a_regulator_match_the_reference() {
    let rows = tables::reference("division_regulator.csv");
    assert_eq!(rows.len(), 5);
    for row in rows {
        let cell = cued(row.number("R0"), row.text("cue"));
        let sourced = cell.cue.regulator().unwrap().source.is_some();
        let division = divide(&DivisionInput::new(cell)).unwrap();
        let phi = division.phi.unwrap();
        println!("{row:?}: {:?} {:?} {} {phi}", division.chi_signed(), division.u_furrow(), division.t_end);
        assert!((phi - row.number("phi")).abs() < 0.01, "{phi} {row:?}");
        if row.text("outcome") == "failed" {
            assert_eq!(division.outcome(), Outcome::Arrested);
            continue;
        }
        let (chi, u) = (division.chi_signed().unwrap(), division.u_furrow().unwrap());
        let expected = row.number("chi_signed");
        // Without a source the noise chooses the side.
        let off = if sourced { chi - expected } else { chi.abs() - expected.abs() };
        assert!(off.abs() < 0.003, "{chi} {row:?}");
        assert!((u - row.number("u_furrow")).abs() < 0.003, "{u} {row:?}");
        assert!((division.t_end / row.number("t_end") - 1.0).abs() < 0.005, "{} {row:?}", division.t_end);
    }
}

/// A pitchfork lies where the growth rate of odd modes is zero.
#[test]
fn a_pitchfork_with_a_regulator_is_where_the_odd_growth_rate_vanishes() {
    let cell = cued(2.0, SELF_ORGANISED);
    let pitchfork = first(&cell);
    let threshold = pitchfork.point.xi_s;
    let rate = |xi_s: f64| {
        let shape = stationary(&Cell { xi_s, ..cell.clone() }, &Numerics::default()).unwrap();
        shape.spectrum().unwrap().rightmost(Some(Parity::Odd)).unwrap().re
    };
    let [low, high] = [threshold * (1.0 - 1e-4), threshold * (1.0 + 1e-4)];
    let [below, above] = [low, high].map(rate);
    let crossing = low - below * (high - low) / (above - below);
    println!(
        "ξ_s* = {threshold:.9}, {:?}; rates {below:.3e} {above:.3e}, zero at {crossing:.9}",
        pitchfork.criticality()
    );
    assert!(below < 0.0 && above > 0.0, "{below} {above}");
    assert!((crossing / threshold - 1.0).abs() < 1e-6, "{crossing} {threshold}");
}

/// With a source of the regulator off the equator, the fold of a cell is where its leading growth rate vanishes, as the root of the distance.
#[test]
fn a_fold_with_a_regulator_is_where_the_growth_rate_vanishes() {
    let cell = cued(2.0, SOURCED);
    let fold = primary::failure_fold(&cell, &Numerics::default(), &StepBudget::unlimited()).unwrap();
    let cortex = Cortex::new(&cell, Domain::Full, &[Parameter::XiS]);
    let there = Stability::new(fold.shape.m).growth_rate(&cortex, &fold.shape).unwrap();
    let at = |margin: f64| {
        let cell = Cell { xi_s: fold.point.xi_s * (1.0 - margin), ..cell.clone() };
        stationary(&cell, &Numerics::default())
    };
    let [near, far] = [1e-4, 4e-4].map(|margin| at(margin).unwrap().spectrum().unwrap().growth_rate());
    println!("fold at {:.9}, rates {there:.1e} {near:.4e} {far:.4e}", fold.point.xi_s);
    assert!(there.abs() < 1e-5 * near.abs(), "{there}");
    assert!(near < 0.0 && (far / near - 2.0).abs() < 0.05, "{near} {far}");
    let beyond = at(-1e-6);
    assert!(matches!(beyond, Err(StationaryError::OutOfReach { .. })), "{:?}", beyond.map(|shape| shape.length()));
}

/// Cells a millionth smaller than the critical radius found by continuation rest, and those a millionth larger divide.
#[test]
fn divisions_with_a_regulator_agree_with_their_critical_radius() {
    for (cue, kind) in [(SELF_ORGANISED, BoundaryKind::Pitchfork), (SOURCED, BoundaryKind::CuedFold)] {
        let cell = cued(1.0, cue);
        let critical = critical_radius(&cell, &Numerics::default()).unwrap();
        println!("{cue}: {:?} R0_c = {:.8}", critical.kind, critical.r0);
        assert_eq!(critical.kind, kind);
        for margin in [1e-2, 1e-4, 1e-6] {
            check_threshold(margin, |factor| Cell { r0: factor * critical.r0, ..cell.clone() });
        }
    }
}
