//! Bent states at rest, the events that end them, and the cells beyond.

use furrow_cell::{Cell, Cue, Numerics, Parameter};
use furrow_mechanics::critical::BoundaryKind;
use furrow_mechanics::division::{DivisionInput, Outcome};
use furrow_mechanics::equilibria::{StepBudget, stationary};
use furrow_surface::bent::{BentEvent, branch};
use furrow_surface::bent_curves::{critical_radius, curves, threshold, threshold_curve};
use furrow_surface::division::divide;
use furrow_surface::steady::steady;

use crate::states::within;

fn coarse() -> Numerics {
    Numerics { modes: 3, elements: 32, ..Numerics::default() }
}

/// The two prototypes found rest at 1.43 until t = 60, and a cut at 1.45.
#[test]
fn the_critical_radius_tells_cells_at_rest_from_cells_that_divide() {
    let numerics = coarse();
    let found = critical_radius(&Cell::new(1.0), &numerics, &StepBudget::unlimited()).unwrap();
    assert_eq!(found.kind, BoundaryKind::BentPitchfork);
    within("R0", (found.r0 - 1.4262).abs(), 2e-3);
    let outcome = |share: f64| {
        let input = DivisionInput { numerics, ..DivisionInput::new(Cell::new(share * found.r0)) };
        divide(&input, &mut |_, _| ()).unwrap().division
    };
    let below = outcome(0.998);
    assert_eq!(below.outcome(), Outcome::Arrested);
    // The rate falls to 0 at the critical radius.
    let rate = below.growth_rate().unwrap();
    assert!(rate < 0.0 && rate > -0.1, "{rate}");
    // It stays near the unstable bent state until the odd disturbance has grown, in long steps.
    let above = outcome(1.04);
    assert!(above.chi().unwrap() > 0.5 && above.t_end > 15.0 && above.work.steps < 700, "{above:?}");
}

/// Just above its threshold the bent shape differs from the axisymmetric one only by the bend of its middle ring.
#[test]
fn a_bent_state_without_a_waist_has_an_offset() {
    let cell = Cell { xi_s: 11.55, ..Cell::new(2.0) };
    let found = steady(&DivisionInput { numerics: coarse(), ..DivisionInput::new(cell.clone()) }).unwrap();
    let rest = found.rest.unwrap();
    assert!(!rest.has_waist());
    let expected = branch(&cell, &coarse(), 30.0).unwrap().threshold;
    // The offset weights the ring by its length, the bend by φ.
    let bend = ((cell.xi_s - expected.xi_s) / expected.coefficient).sqrt();
    within("bend", (rest.offset() / cell.r0 / bend - 1.0).abs(), 0.3);
    let straight = stationary(&cell, &Numerics::default()).unwrap();
    let [volume, bending] = straight.reduced_volume_and_bending();
    let [found_volume, found_bending] = rest.reduced_volume_and_bending();
    within("reduced volume", (found_volume - volume).abs(), 1e-4);
    within("energy of bending", (found_bending / bending - 1.0).abs(), 1e-4);
}

#[test]
fn curves_of_bent_events_pass_through_those_of_each_branch() {
    let numerics = Numerics { modes: 2, ..coarse() };
    let events = |r0: f64| {
        let found = branch(&Cell::new(r0), &numerics, 40.0).unwrap();
        assert!(found.threshold.coefficient > 0.0);
        [found.pitchfork.unwrap().xi_s, found.fold.unwrap().xi_s]
    };
    let found = curves(&Cell::new(1.0), &numerics, Parameter::R0, [1.4, 1.5]).unwrap();
    assert_eq!([found[0].0, found[1].0], [BentEvent::Pitchfork, BentEvent::Fold]);
    for (r0, first) in [(1.4, true), (1.5, false)] {
        for ((event, curve), expected) in found.iter().zip(events(r0)) {
            let point = if first { curve.points.first() } else { curve.points.last() }.unwrap();
            within(event.name(), (point.xi_s - expected).abs(), 1e-5);
            assert!((point.r0 - r0).abs() < 1e-12 && point.slope < 0.0);
        }
    }
}

/// At R0 = 2 bent states begin supercritically for ε from 0.647 to 0.942. The branch on either side says so too.
#[test]
fn bent_states_begin_on_another_side_in_loose_shells() {
    let (cell, numerics) = (Cell::new(2.0), Numerics { modes: 2, ..coarse() });
    let at = |epsilon| threshold(&cell, &numerics, Parameter::Epsilon, epsilon);
    let (found, missing) = threshold_curve(vec![at(0.64), at(0.66)], at);
    let ([change], true) = (&found.degenerate[..], missing.is_empty()) else { panic!("{found:?} {missing:?}") };
    within("ε", (change.epsilon - 0.6473).abs(), 5e-4);
    for (point, below) in found.points.iter().zip([true, false]) {
        let of = branch(&Cell { epsilon: point.epsilon, ..cell.clone() }, &numerics, 8.0).unwrap();
        assert_eq!(of.threshold.coefficient, point.coefficient.unwrap());
        let quadratic = of.threshold.xi_s + of.threshold.coefficient * of.points[1].bend.powi(2);
        within("ξ_s", (of.points[1].xi_s - quadratic).abs(), 2e-3);
        assert_eq!(of.points[1].xi_s < of.threshold.xi_s, below);
    }
}

/// At R0 = 0.5 and ε = 0.64 the bent branch turns back to smaller activities at once.
#[test]
fn a_subcritical_bent_branch_ends_no_stable_states() {
    let cell = Cell { epsilon: 0.64, ..Cell::new(0.5) };
    let found = branch(&cell, &coarse(), 40.0).unwrap();
    assert!(found.threshold.coefficient < -10.0 && found.points[1].xi_s < found.threshold.xi_s);
    let error = curves(&cell, &coarse(), Parameter::R0, [0.5, 0.52]).unwrap_err().to_string();
    assert!(error.contains("begin subcritically, at xi_s = 23."), "{error}");
}

/// Near the end of this furrow rings without drag have no spread close to their last one.
#[test]
fn a_cued_furrow_at_one_side_closes() {
    let input = DivisionInput {
        numerics: Numerics { modes: 4, ..Numerics::default() },
        ..DivisionInput::new(Cell::new(2.319).with_cue(Cue::published()))
    };
    let found = divide(&input, &mut |_, _| ()).unwrap().division;
    within("χ", (found.chi().unwrap() - 0.282).abs(), 0.01);
    assert!(found.work.rejected < 20 && found.neck_offset.unwrap() > 1.5, "{found:?}");
}
