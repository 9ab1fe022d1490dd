//! Passages of a curve of singular points through an activity, detected during its continuation.

use furrow_bvp::{AugmentedReport, Codim2Curve, Singularity};

use super::curves::SECOND;
use super::point::XI;
use crate::cortex::Cortex;

/// The passages of a curve through one activity. The curve itself is not changed: each passage keeps a copy.
pub(super) struct Passage<S> {
    xi_s: f64,
    /// (ξ_s, value) of the newest point.
    newest: [f64; 2],
    /// The curve just beyond each passage, and the values on both sides of it.
    seen: Vec<(Codim2Curve<Cortex, S>, [f64; 2])>,
}

impl<S: Singularity<Cortex> + Clone> Passage<S> {
    /// For a curve at its first point.
    pub(super) fn of(xi_s: f64, curve: &Codim2Curve<Cortex, S>) -> Passage<S> {
        Passage { xi_s, newest: parameters(curve), seen: Vec::new() }
    }

    /// Adds the newest point of the curve.
    pub(super) fn take_in(&mut self, curve: &Codim2Curve<Cortex, S>) {
        let now = parameters(curve);
        let before = std::mem::replace(&mut self.newest, now);
        if (before[0] - self.xi_s) * (now[0] - self.xi_s) <= 0.0 {
            self.seen.push((curve.clone(), [before[1], now[1]]));
        }
    }

    /// The curve at its passage, with the report of the Newton iteration; `None` unless it passes exactly once, and if
    /// the solver leads to a point outside the interval of the passage.
    pub(super) fn solve(mut self) -> Option<(Codim2Curve<Cortex, S>, AugmentedReport)> {
        let (mut curve, [a, b]) = self.seen.pop().filter(|_| self.seen.is_empty())?;
        let (y, report) = curve.at(XI, self.xi_s).ok()?;
        curve.tangent = curve.augmented.curve_direction(&y);
        curve.solution = y;
        let value = curve.solution.scalars[SECOND];
        (a.min(b)..=a.max(b)).contains(&value).then_some((curve, report))
    }
}

fn parameters<S>(curve: &Codim2Curve<Cortex, S>) -> [f64; 2] {
    [curve.solution.scalars[XI], curve.solution.scalars[SECOND]]
}

#[cfg(test)]
mod tests {
    use crate::critical::{BoundaryKind, STARTS, critical_value, value_on};
    use crate::equilibria::StepBudget;
    use crate::equilibria::curves::{BoundaryCurves, boundary_and_folds, boundary_curves};
    use furrow_cell::{Cell, Cue, Numerics, Parameter};

    /// The boundary over a range, with the cell's own activity recorded.
    fn along(cell: &Cell, parameter: Parameter, range: [f64; 2]) -> BoundaryCurves {
        boundary_curves(cell, &Numerics::default(), parameter, range, Some(cell.xi_s)).unwrap()
    }

    #[test]
    fn the_passage_of_a_curve_agrees_with_the_search() {
        let gradient: Cue = "tension:gradient,amplitude=0.1".parse().unwrap();
        for (cell, parameter, range, starts, kind) in [
            (Cell::new(1.0), Parameter::R0, [1.6, 1.9], &STARTS[..], BoundaryKind::Pitchfork),
            (Cell::new(2.22), Parameter::Epsilon, [0.92, 0.85], &[0.88], BoundaryKind::Pitchfork),
            (Cell::new(1.0).with_cue(Cue::published()), Parameter::R0, [1.7, 2.2], &STARTS, BoundaryKind::CuedFold),
            (Cell::new(1.0).with_cue(gradient), Parameter::R0, [2.0, 1.6], &STARTS, BoundaryKind::CuedFold),
        ] {
            let searched =
                critical_value(&cell, &Numerics::default(), parameter, starts, &StepBudget::unlimited()).unwrap();
            let passed = value_on(&along(&cell, parameter, range), parameter).unwrap();
            assert_eq!((passed.0, searched.0), (kind, kind));
            let (a, b) = (passed.1, searched.1);
            println!("{parameter} = {} and {}", a.value, b.value);
            for [a, b] in [[a.value, b.value], [a.slope, b.slope], [a.elongation, b.elongation], [a.xi_s, b.xi_s]] {
                assert!((a / b - 1.0).abs() < 1e-8, "{a} {b}");
            }
            assert_eq!(a.coefficient.is_some(), kind == BoundaryKind::Pitchfork);
            assert!(a.coefficient.zip(b.coefficient).is_none_or(|(a, b)| (a / b - 1.0).abs() < 1e-5), "{a:?} {b:?}");
        }
    }

    #[test]
    fn curves_without_a_valid_passage_give_no_value() {
        let cell = Cell::new(1.0);
        assert_eq!(value_on(&along(&cell, Parameter::R0, [1.8, 1.9]), Parameter::R0), None, "ξ_s is not passed");
        let unasked = boundary_and_folds(&cell, &Numerics::default(), Parameter::R0, [1.6, 1.9], None).unwrap();
        assert_eq!(value_on(&unasked, Parameter::R0), None);
        // If ξ_s rises with R0, smaller cells have no stable shape.
        let mut rising = along(&cell, Parameter::R0, [1.6, 1.9]);
        for point in rising.pitchforks.iter_mut().flat_map(|curve| &mut curve.at_activity) {
            point.slope = -point.slope;
        }
        assert_eq!(value_on(&rising, Parameter::R0), None);
        assert!(value_on(&rising, Parameter::Epsilon).is_some());
    }
}
