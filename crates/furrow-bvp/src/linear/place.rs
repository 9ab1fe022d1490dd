//! The values of the equations that are not finite, by name.

use crate::dimensions::Dimensions;
use crate::direction::Residual;
use crate::invalid::short;
use crate::kernels::Condensed;

use super::system::System;

/// A value of the equations, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Place {
    /// A component of the right-hand side.
    #[error("component {component} of the right-hand side at x = {}", short(*x))]
    Rhs {
        /// The component.
        component: usize,
        /// Where.
        x: f64,
    },
    /// A derivative of a component of the right-hand side.
    #[error("a derivative of component {component} of the right-hand side at x = {}", short(*x))]
    RhsDerivative {
        /// The component.
        component: usize,
        /// Where.
        x: f64,
    },
    /// A condition at the left end, or a derivative of it.
    #[error("condition {index} at the left end")]
    Left {
        /// The condition.
        index: usize,
    },
    /// A condition at the right end, or a derivative of it.
    #[error("condition {index} at the right end")]
    Right {
        /// The condition.
        index: usize,
    },
    /// An integrand, or a derivative of it.
    #[error("integrand {index} at x = {}", short(*x))]
    Integrand {
        /// The integral condition.
        index: usize,
        /// Where.
        x: f64,
    },
    /// The part of an integral condition that depends on the scalar unknowns alone, or a derivative of it.
    #[error("integral condition {index}")]
    Integral {
        /// The condition.
        index: usize,
    },
}

impl System {
    /// The first value of the last evaluation that is not finite.
    pub(crate) fn undefined(&self) -> Option<Place> {
        let Dimensions { components: n, scalars: np, integrals: ni, .. } = self.dimensions();
        let first = |values: &[f64]| values.iter().position(|v| !v.is_finite());
        let at = |equation: usize, width: usize, values: &[f64], part: fn(usize, f64) -> Place| {
            let index = first(values)? / width.max(1);
            let x = self.places.get(index / equation.max(1)).copied().unwrap_or(f64::NAN);
            Some(part(index % equation.max(1), x))
        };
        let Residual { stages, left, right, border, .. } = &self.residual;
        let Condensed { fy, fp, gy, gp, .. } = &self.condensed;
        let ends = &self.ends;
        let condition = |parts: [(&[f64], usize); 3], place: fn(usize) -> Place| {
            parts.into_iter().find_map(|(values, width)| first(values).map(|index| place(index / width.max(1))))
        };
        at(n, 1, stages, |component, x| Place::Rhs { component, x })
            .or_else(|| condition([(left, 1), (&ends.left[0], n), (&ends.left[1], np)], |index| Place::Left { index }))
            .or_else(|| {
                condition([(right, 1), (&ends.right[0], n), (&ends.right[1], np)], |index| Place::Right { index })
            })
            .or_else(|| at(ni, 1, &self.integrands, |index, x| Place::Integrand { index, x }))
            .or_else(|| {
                condition([(border.get(..ni).unwrap_or_default(), 1), (&ends.offsets, np), (&[], 1)], |index| {
                    Place::Integral { index }
                })
            })
            .or_else(|| at(n, n, fy, |component, x| Place::RhsDerivative { component, x }))
            .or_else(|| at(n, np, fp, |component, x| Place::RhsDerivative { component, x }))
            .or_else(|| at(ni, n, gy, |index, x| Place::Integrand { index, x }))
            .or_else(|| at(ni, np, gp, |index, x| Place::Integrand { index, x }))
    }
}
