//! The inner loops compiled for sizes that are known at compile time, for problems that request them.
//!
//! Most of a Newton step goes into small dense blocks whose sizes follow from the problem. Compiled for sizes that are
//! known, loops over them are unrolled. Neither kind reorders a sum, so that the results are the same to the last bit.

use multiversion::multiversion;

use crate::dense::PivotFailure;
use crate::dimensions::Dimensions;
use crate::direction::{Direction, LinearCondition, Residual};
use crate::gauss::Gauss;

use super::block::BlockFactor;
use super::condense::Condensed;
use super::shape::{Any, Known, Partly};
use super::stages::{self, Interval};

/// The functions that run over all intervals, for any sizes or for given ones.
///
/// A problem requests them in [`BoundaryValueProblem::kernels`](crate::BoundaryValueProblem::kernels). Kernels for other
/// sizes than the problem has are ignored: the wrong ones cost only speed.
#[derive(Clone, Copy, Debug)]
pub struct Kernels {
    /// Components, quadrature components, trailing ones of them, stages and left conditions; `None` for any.
    sizes: Option<[usize; 5]>,
    pub(crate) condense: fn(&mut Condensed, &Gauss) -> Result<(), PivotFailure>,
    pub(crate) particular: fn(&Condensed, &Gauss, &Residual, &mut Direction, &mut [f64]),
    pub(crate) complete: fn(&Condensed, &Gauss, &mut Direction),
    pub(crate) differences: fn(&Gauss, Interval<'_>, &mut [f64], &mut [f64]),
    pub(crate) eliminate: fn(&mut BlockFactor, &Condensed, &[LinearCondition]) -> Result<(), PivotFailure>,
    pub(crate) forward: fn(&mut BlockFactor, &[f64], &mut [f64], &mut [f64]),
    pub(crate) backward: fn(&mut BlockFactor, &mut [f64], &[f64]),
}

impl Kernels {
    /// Kernels for any sizes.
    pub fn general() -> Kernels {
        Kernels { sizes: None, ..Kernels::of::<0, 0, 0, 0, 0>() }
    }

    /// Kernels for N components, of which E are quadratures, the last T of all among them, with M stages and LEFT conditions at the left end.
    ///
    /// ```
    /// use furrow_bvp::Kernels;
    /// let kernels = Kernels::sized::<7, 3, 0, 4, 4>();
    /// ```
    pub fn sized<const N: usize, const E: usize, const T: usize, const M: usize, const LEFT: usize>() -> Kernels {
        const { assert!(N > 0 && E <= N && T <= E && M > 0, "sizes of zero stand for any size") };
        Kernels::of::<N, E, T, M, LEFT>()
    }

    fn of<const N: usize, const E: usize, const T: usize, const M: usize, const LEFT: usize>() -> Kernels {
        Kernels {
            sizes: Some([N, E, T, M, LEFT]),
            condense: condense::<N, E, T, M>,
            particular: particular::<N, E, T, M>,
            complete: complete::<N, E, T, M>,
            differences: differences::<M, N>,
            eliminate: eliminate::<N, LEFT>,
            forward: forward::<N, LEFT>,
            backward: backward::<N, LEFT>,
        }
    }

    /// Whether these are kernels for given sizes.
    pub fn is_sized(&self) -> bool {
        self.sizes.is_some()
    }

    /// These kernels if they are for these sizes and m stages, the general ones otherwise.
    pub(crate) fn suited_to(self, dims: Dimensions, m: usize) -> Kernels {
        let sizes = [dims.components, dims.all_quadratures(), dims.trailing_quadratures, m, dims.left];
        if self.sizes.is_none_or(|own| own == sizes) { self } else { Kernels::general() }
    }
}

/// Calls a method of the condensed intervals for the shape they have.
macro_rules! with_shape {
    ($condensed:ident, $method:ident($($argument:ident),*)) => {{
        let Dimensions { scalars, integrals, .. } = $condensed.dims;
        match (N, scalars, integrals) {
            (0, ..) => $condensed.$method::<Any>($($argument),*),
            (_, 2, 1) => $condensed.$method::<Known<N, E, T, M, 2>>($($argument),*),
            (_, 3, 1) => $condensed.$method::<Known<N, E, T, M, 3>>($($argument),*),
            (_, 4, 1) => $condensed.$method::<Known<N, E, T, M, 4>>($($argument),*),
            _ => $condensed.$method::<Partly<N, E, T, M>>($($argument),*),
        }
    }};
}

/// Calls a method of the blocks for the scalar unknowns that there are.
macro_rules! with_scalars {
    ($block:ident.$method:ident($($argument:ident),*), $scalars:expr) => {
        match (N, $scalars) {
            (0, _) => $block.$method::<0, 0, 0>($($argument),*),
            (_, 2) => $block.$method::<N, LEFT, 2>($($argument),*),
            (_, 3) => $block.$method::<N, LEFT, 3>($($argument),*),
            (_, 4) => $block.$method::<N, LEFT, 4>($($argument),*),
            _ => $block.$method::<N, LEFT, 0>($($argument),*),
        }
    };
}

// Lanes of four fill half of the registers of AVX-512: kernels for it would take longer to compile than they save.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn condense<const N: usize, const E: usize, const T: usize, const M: usize>(
    condensed: &mut Condensed,
    gauss: &Gauss,
) -> Result<(), PivotFailure> {
    with_shape!(condensed, condense(gauss))
}

#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn particular<const N: usize, const E: usize, const T: usize, const M: usize>(
    condensed: &Condensed,
    gauss: &Gauss,
    residual: &Residual,
    out: &mut Direction,
    borders: &mut [f64],
) {
    with_shape!(condensed, particular(gauss, residual, out, borders))
}

#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn complete<const N: usize, const E: usize, const T: usize, const M: usize>(
    condensed: &Condensed,
    gauss: &Gauss,
    out: &mut Direction,
) {
    with_shape!(condensed, complete(gauss, out))
}

#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn eliminate<const N: usize, const LEFT: usize>(
    block: &mut BlockFactor,
    condensed: &Condensed,
    conditions: &[LinearCondition],
) -> Result<(), PivotFailure> {
    with_scalars!(block.eliminate(condensed, conditions), condensed.dims.scalars)
}

#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn forward<const N: usize, const LEFT: usize>(
    block: &mut BlockFactor,
    nodes: &[f64],
    carried: &mut [f64],
    border: &mut [f64],
) {
    block.forward::<N, LEFT, 0>(nodes, carried, border)
}

#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn backward<const N: usize, const LEFT: usize>(block: &mut BlockFactor, nodes: &mut [f64], scalars: &[f64]) {
    with_scalars!(block.backward(nodes, scalars), block.scalars())
}

#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn differences<const M: usize, const N: usize>(
    gauss: &Gauss,
    interval: Interval<'_>,
    residual: &mut [f64],
    node: &mut [f64],
) {
    stages::differences::<M, N>(gauss, interval, residual, node)
}
