//! Sizes that kernels work with, known at compile time or not.

use crate::dense;
use crate::dimensions::Dimensions;

use super::condense::QUAD;

/// Sizes of a problem and its discretisation.
#[derive(Clone, Copy)]
pub struct Sizes {
    /// Components.
    pub n: usize,
    /// Quadrature components.
    pub e: usize,
    /// Stages.
    pub m: usize,
    /// Components that are not quadratures, one behind the other.
    pub nn: usize,
    /// The first of them.
    pub first: usize,
    /// Stage unknowns.
    pub s: usize,
    /// Lanes of the stage unknowns.
    pub lanes: usize,
    /// Quads of the quadrature components.
    pub quads: usize,
    /// Conditions at the left end.
    pub left: usize,
    /// Scalar unknowns.
    pub np: usize,
    /// Integral conditions.
    pub ni: usize,
    /// Lanes of the outputs of an interval: the components of its right node, then the integrals.
    pub outputs: usize,
}

impl Sizes {
    /// The sizes of a problem of `dims` with m stages.
    #[inline(always)]
    pub fn of(dims: Dimensions, m: usize) -> Sizes {
        let Dimensions { components: n, quadratures: first, left, scalars: np, integrals: ni, .. } = dims;
        let e = dims.all_quadratures();
        let nn = n - e;
        let (lanes, outputs) = (dense::lanes_for(m * nn), dense::lanes_for(n + ni));
        Sizes { n, e, m, nn, first, s: m * nn, lanes, quads: e.div_ceil(QUAD), left, np, ni, outputs }
    }

    /// The component of quadrature k: some precede the other components, some follow them.
    #[inline(always)]
    pub fn quadrature(self, k: usize) -> usize {
        if k < self.first { k } else { self.nn + k }
    }

    /// How many quadratures from this one on make up a quad.
    #[inline(always)]
    pub fn width(self, from: usize) -> usize {
        (self.e - from).min(QUAD)
    }

    /// Columns of a transition: components and scalar unknowns.
    #[inline(always)]
    pub fn columns(self) -> usize {
        self.n + self.np
    }
}

/// The source of the sizes of a kernel.
pub trait Shape {
    /// Sizes of the problem but for its right conditions, and stages, if all of them are known at compile time.
    const STATIC: Option<(Dimensions, usize)>;

    /// Whether some sizes are known at compile time.
    const KNOWN: bool = Self::STATIC.is_some();

    /// The sizes of a problem.
    #[inline(always)]
    fn sizes(dims: Dimensions, m: usize) -> Sizes {
        let (dims, m) = Self::STATIC.unwrap_or((dims, m));
        Sizes::of(dims, m)
    }
}

/// Sizes known at run time.
pub struct RuntimeSizes;

impl Shape for RuntimeSizes {
    const STATIC: Option<(Dimensions, usize)> = None;
}

/// Sizes known at compile time: N components with E quadratures, T of them the last components; M stages; LEFT conditions at the left
/// end; P scalar unknowns; I integral conditions.
pub struct StaticSizes<
    const N: usize,
    const E: usize,
    const T: usize,
    const M: usize,
    const LEFT: usize,
    const P: usize,
    const I: usize,
>;

impl<const N: usize, const E: usize, const T: usize, const M: usize, const LEFT: usize, const P: usize, const I: usize>
    Shape for StaticSizes<N, E, T, M, LEFT, P, I>
{
    const STATIC: Option<(Dimensions, usize)> = Some((
        Dimensions {
            components: N,
            quadratures: E - T,
            trailing_quadratures: T,
            scalars: P,
            left: LEFT,
            right: 0,
            integrals: I,
        },
        M,
    ));
}

/// N components with the first E as quadratures, and M stages. All other sizes are known at run time.
pub struct Components<const N: usize, const E: usize, const M: usize>;

impl<const N: usize, const E: usize, const M: usize> Shape for Components<N, E, M> {
    const STATIC: Option<(Dimensions, usize)> = None;
    const KNOWN: bool = true;

    #[inline(always)]
    fn sizes(dims: Dimensions, _: usize) -> Sizes {
        Sizes::of(Dimensions { components: N, quadratures: E, trailing_quadratures: 0, ..dims }, M)
    }
}
