//! The inner loops compiled for sizes that are known at compile time, for problems that request them.
//!
//! Most of a Newton step goes into small dense blocks with sizes that follow from the problem. Compiled for sizes that are
//! known, loops over them are unrolled. Neither kind reorders a sum, so that the results are the same to the last bit.

use multiversion::multiversion;
use multiversion::target::match_target;

use crate::dense::PivotFailure;
use crate::dimensions::Dimensions;
use crate::direction::{Direction, LinearCondition, Residual};
use crate::gauss::Gauss;
use crate::solution::Solution;

use super::block::BlockFactor;
use super::condense::Condensed;
use super::operator::Responses;
use super::shape::{Components, RuntimeSizes, Shape, StaticSizes};
use super::stages;

/// The functions that run over all intervals, for any sizes or for given ones.
///
/// A problem requests them in [`BoundaryValueProblem::kernels`](crate::BoundaryValueProblem::kernels). Kernels for other
/// sizes than the problem has are ignored: the wrong ones cost only speed. A problem with 1, 2, 3, 4 or 6 components and four stages needs
/// no request: it gets kernels for its number of components. With 2, 4 or 6 components the first one may be a quadrature.
#[derive(Clone, Copy, Debug)]
pub struct Kernels {
    /// Sizes of the problem but for its right conditions, and stages; `None` for any.
    sizes: Option<(Dimensions, usize)>,
    #[cfg(test)]
    known: bool,
    pub(crate) condense: fn(&mut Condensed, &Gauss) -> Result<(), PivotFailure>,
    pub(crate) particular: fn(&Condensed, &Gauss, &Residual, &mut Direction, &mut [f64]),
    pub(crate) complete: fn(&Condensed, &Gauss, &mut Direction),
    pub(crate) residuals: fn(&Gauss, &Solution, &mut Residual),
    pub(crate) apply: fn(&Condensed, &Gauss, &Direction, &mut Residual),
    pub(crate) eliminate: fn(&mut BlockFactor, &Condensed, &[LinearCondition]) -> Result<(), PivotFailure>,
    pub(crate) forward: fn(&mut BlockFactor, &[f64], &mut [f64], &mut [f64]),
    pub(crate) backward: fn(&mut BlockFactor, &mut [f64], &[f64]),
    pub(crate) fill_responses: fn(&mut Responses, &Condensed, &Gauss, &[f64], &[f64]),
}

impl Kernels {
    /// Kernels for any sizes.
    // Inlined, it would be compiled again, with all kernels, in every crate that states a problem.
    #[inline(never)]
    pub fn general() -> Kernels {
        Kernels::of::<RuntimeSizes>()
    }

    /// Kernels for N components with E quadratures, T of them the last components; M stages; LEFT conditions at the left end; P scalar
    /// unknowns; I integral conditions.
    ///
    /// ```
    /// use furrow_bvp::Kernels;
    /// let kernels = Kernels::sized::<7, 3, 0, 4, 4, 2, 1>();
    /// ```
    pub fn sized<
        const N: usize,
        const E: usize,
        const T: usize,
        const M: usize,
        const LEFT: usize,
        const P: usize,
        const I: usize,
    >() -> Kernels {
        const { assert!(N > 0 && E <= N && T <= E && M > 0, "a problem has components and stages") };
        Kernels::of::<StaticSizes<N, E, T, M, LEFT, P, I>>()
    }

    fn of<S: Shape>() -> Kernels {
        Kernels {
            sizes: S::STATIC,
            #[cfg(test)]
            known: S::KNOWN,
            condense: condense::<S>,
            particular: particular::<S>,
            complete: complete::<S>,
            residuals: residuals::<S>,
            apply: apply::<S>,
            eliminate: eliminate::<S>,
            forward: forward::<S>,
            backward: backward::<S>,
            fill_responses: fill_responses::<S>,
        }
    }

    /// Whether these are kernels for given sizes.
    #[cfg(test)]
    pub(crate) fn is_sized(&self) -> bool {
        self.sizes.is_some()
    }

    /// Whether some sizes were known when these were compiled.
    #[cfg(test)]
    pub(crate) fn has_known_sizes(&self) -> bool {
        self.known
    }

    /// These kernels if they are sized and for these sizes and m stages, otherwise those for its number of components, or the general ones.
    pub(crate) fn matching(self, dims: Dimensions, m: usize) -> Kernels {
        let sizes = (Dimensions { right: 0, ..dims }, m);
        if self.sizes == Some(sizes) { self } else { Kernels::for_components(dims, m) }
    }

    /// Kernels for few components and four stages, the general ones for others. A web page has the general ones alone.
    fn for_components(dims: Dimensions, m: usize) -> Kernels {
        if cfg!(target_family = "wasm") || m != 4 || dims.trailing_quadratures > 0 {
            return Kernels::general();
        }
        match (dims.components, dims.quadratures) {
            (1, 0) => Kernels::of::<Components<1, 0, 4>>(),
            (2, 0) => Kernels::of::<Components<2, 0, 4>>(),
            (2, 1) => Kernels::of::<Components<2, 1, 4>>(),
            (3, 0) => Kernels::of::<Components<3, 0, 4>>(),
            (4, 0) => Kernels::of::<Components<4, 0, 4>>(),
            (4, 1) => Kernels::of::<Components<4, 1, 4>>(),
            (6, 0) => Kernels::of::<Components<6, 0, 4>>(),
            (6, 1) => Kernels::of::<Components<6, 1, 4>>(),
            _ => Kernels::general(),
        }
    }
}

/// Calls the kernel for a shape where it is worth its size: processors without AVX2 are rare among those that run x86-64.
macro_rules! in_shape {
    ($of:ident.$method:ident($($argument:ident),*)) => {
        match_target! {
            "x86_64+avx+avx2" => $of.$method::<S>($($argument),*),
            _ => if S::KNOWN && cfg!(target_arch = "x86_64") {
                $method::<RuntimeSizes>($of, $($argument),*)
            } else {
                $of.$method::<S>($($argument),*)
            },
        }
    };
}

// Lanes of four fill half of the registers of AVX-512: kernels for it would take longer to compile than they save.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn condense<S: Shape>(condensed: &mut Condensed, gauss: &Gauss) -> Result<(), PivotFailure> {
    in_shape!(condensed.condense(gauss))
}

#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn particular<S: Shape>(
    condensed: &Condensed,
    gauss: &Gauss,
    residual: &Residual,
    out: &mut Direction,
    borders: &mut [f64],
) {
    in_shape!(condensed.particular(gauss, residual, out, borders))
}

#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn complete<S: Shape>(condensed: &Condensed, gauss: &Gauss, out: &mut Direction) {
    in_shape!(condensed.complete(gauss, out))
}

#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn eliminate<S: Shape>(
    block: &mut BlockFactor,
    condensed: &Condensed,
    conditions: &[LinearCondition],
) -> Result<(), PivotFailure> {
    in_shape!(block.eliminate(condensed, conditions))
}

#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn forward<S: Shape>(block: &mut BlockFactor, nodes: &[f64], carried: &mut [f64], border: &mut [f64]) {
    in_shape!(block.forward(nodes, carried, border))
}

#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn backward<S: Shape>(block: &mut BlockFactor, nodes: &mut [f64], scalars: &[f64]) {
    in_shape!(block.backward(nodes, scalars))
}

#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn residuals<S: Shape>(gauss: &Gauss, y: &Solution, out: &mut Residual) {
    stages::residuals::<S>(gauss, y, out);
}

#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn apply<S: Shape>(condensed: &Condensed, gauss: &Gauss, direction: &Direction, out: &mut Residual) {
    stages::apply::<S>(condensed, gauss, direction, out);
}

#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
fn fill_responses<S: Shape>(
    responses: &mut Responses,
    condensed: &Condensed,
    gauss: &Gauss,
    force: &[f64],
    reading: &[f64],
) {
    // Only one force with one reading has sized kernels, except in a web page, which they would enlarge by a hundred kilobytes.
    let general = cfg!(target_family = "wasm") || (responses.forces, responses.readings) != (1, 1);
    if S::KNOWN && general {
        fill_responses::<RuntimeSizes>(responses, condensed, gauss, force, reading)
    } else {
        in_shape!(responses.fill_responses(condensed, gauss, force, reading))
    }
}

// Known sizes would not make the two below much faster.
#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
pub(crate) fn forces_onto_nodes(
    responses: &Responses,
    condensed: &Condensed,
    from: &[f64],
    nodes: &mut [f64],
    borders: &mut [f64],
) {
    responses.onto_nodes(condensed, from, nodes, borders)
}

#[multiversion(targets("x86_64+avx+avx2", "aarch64+neon"))]
pub(crate) fn read_responses(
    responses: &Responses,
    condensed: &Condensed,
    from: &[f64],
    unknowns: [&[f64]; 2],
    to: &mut [f64],
) {
    responses.read(condensed, from, unknowns, to)
}
