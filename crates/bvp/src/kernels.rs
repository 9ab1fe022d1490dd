//! Kernels for sizes known at compile time, for problems that ask for them.
//!
//! Most of a Newton step goes into small dense blocks whose sizes follow from the problem. Compiled for sizes that are
//! known, loops over them are unrolled: with seven components and four stages intervals are condensed in little more than
//! half the time, and a whole Newton step takes a third less. Neither kind reorders a sum, so that the results are the same
//! to the last bit.

use multiversion::multiversion;

use crate::condense::{Condensed, Layout};
use crate::dense::PivotFailure;
use crate::gauss::Gauss;
use crate::stages::{self, Interval};

/// The functions that run over the stages of one interval, for any sizes or for given ones.
///
/// A problem asks for them in [`BoundaryValueProblem::kernels`](crate::BoundaryValueProblem::kernels). Kernels for other
/// sizes than the problem has are not used: asking for the wrong ones costs speed, and nothing else.
#[derive(Clone, Copy, Debug)]
pub struct Kernels {
    /// Components, integrable components, stages and lanes; `None` for any.
    sizes: Option<[usize; 4]>,
    pub(crate) factor: fn(&mut Condensed, &Gauss, usize) -> Result<(), PivotFailure>,
    pub(crate) particular: fn(&Condensed, &Gauss, usize, &[f64], &mut [f64]),
    pub(crate) differences: fn(&Gauss, Interval<'_>, &mut [f64], &mut [f64]),
}

impl Kernels {
    /// Kernels for any sizes.
    pub fn general() -> Kernels {
        Kernels { sizes: None, ..Kernels::of::<0, 0, 0, 0>() }
    }

    /// Kernels for N components, of which the first E are integrable, with M stages and with N components and the scalar
    /// unknowns together in LANES groups of eight, rounded up: N = 7 and 2 scalars make 9 values and 2 groups.
    ///
    /// ```
    /// use bvp::Kernels;
    /// let kernels = Kernels::sized::<7, 3, 4, 2>();
    /// ```
    pub fn sized<const N: usize, const E: usize, const M: usize, const LANES: usize>() -> Kernels {
        const { assert!(N > 0 && E <= N && M > 0 && LANES > 0, "sizes of zero stand for any size") };
        Kernels::of::<N, E, M, LANES>()
    }

    fn of<const N: usize, const E: usize, const M: usize, const LANES: usize>() -> Kernels {
        Kernels {
            sizes: Some([N, E, M, LANES]),
            factor: factor::<N, E, M, LANES>,
            particular: particular::<N, E, M>,
            differences: differences::<M, N>,
        }
    }

    /// Whether these are kernels for given sizes.
    pub fn is_sized(&self) -> bool {
        self.sizes.is_some()
    }

    /// These kernels if they are for the sizes of `layout`, the general ones otherwise.
    pub(crate) fn suited_to(self, layout: &Layout) -> Kernels {
        let sizes = [layout.dims.components, layout.dims.integrable, layout.m, layout.map_lanes];
        if self.sizes.is_none_or(|own| own == sizes) { self } else { Kernels::general() }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx+avx2", "aarch64+neon"))]
fn factor<const N: usize, const E: usize, const M: usize, const LANES: usize>(
    condensed: &mut Condensed,
    gauss: &Gauss,
    i: usize,
) -> Result<(), PivotFailure> {
    condensed.factor::<N, E, M, LANES>(gauss, i)
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx+avx2", "aarch64+neon"))]
fn particular<const N: usize, const E: usize, const M: usize>(
    condensed: &Condensed,
    gauss: &Gauss,
    i: usize,
    r: &[f64],
    y: &mut [f64],
) {
    condensed.particular_stages::<N, E, M>(gauss, i, r, y)
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx+avx2", "aarch64+neon"))]
fn differences<const M: usize, const N: usize>(
    gauss: &Gauss,
    interval: Interval<'_>,
    residual: &mut [f64],
    node: &mut [f64],
) {
    stages::differences::<M, N>(gauss, interval, residual, node)
}
