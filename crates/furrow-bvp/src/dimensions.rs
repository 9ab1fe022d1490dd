//! Sizes of a problem, and the limits of the kernels.

use crate::dense::{LANE, MAX_LANES, lanes_for};

/// Sizes of a boundary-value problem.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dimensions {
    /// Components n of y.
    pub components: usize,
    /// The first `quadratures` components have derivatives that depend on the other components and on p only, never on one
    /// another. They are integrated out of the stage equations, which makes a Newton step several times cheaper. Zero is
    /// always correct; all components may be quadratures.
    pub quadratures: usize,
    /// So are the last `trailing_quadratures` components.
    pub trailing_quadratures: usize,
    /// Scalar unknowns p.
    pub scalars: usize,
    /// Conditions at the left end.
    pub left: usize,
    /// Conditions at the right end.
    pub right: usize,
    /// Integral conditions ∫ g dx + h(p) = 0.
    pub integrals: usize,
}

/// Largest number of stages offered.
pub const MAX_STAGES: usize = 5;

/// Most unknowns at one point, components and scalars together.
pub const MAX_UNKNOWNS: usize = 32;

/// Most unknowns at the stages of one interval, quadrature components left out.
pub const MAX_STAGE_UNKNOWNS: usize = MAX_LANES * LANE;

/// Most linear conditions in addition to the problem's own.
pub const MAX_CONDITIONS: usize = 8;

/// Why a problem does not fit the kernels, which work on blocks of bounded size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TooLarge {
    /// A number of stages that is not offered.
    #[error("collocation is offered with 1 to {MAX_STAGES} stages, not {stages}")]
    Stages {
        /// Stages asked for.
        stages: usize,
    },
    /// No components, or more quadratures than components.
    #[error("{quadratures} of {components} components cannot be quadratures")]
    Components {
        /// Components of y.
        components: usize,
        /// Quadrature components.
        quadratures: usize,
    },
    /// More than [`MAX_UNKNOWNS`] components and scalar unknowns.
    #[error("{unknowns} components and scalar unknowns are more than {MAX_UNKNOWNS}")]
    Unknowns {
        /// Components and scalar unknowns.
        unknowns: usize,
    },
    /// The stage equations of an interval are wider than the kernels are built for.
    #[error(
        "{stage_unknowns} stage unknowns are more than {MAX_STAGE_UNKNOWNS}: fewer stages, or more quadrature components"
    )]
    StageUnknowns {
        /// Stages times components that are not quadratures.
        stage_unknowns: usize,
    },
    /// The problem has more conditions than unknowns, or lacks more than [`MAX_CONDITIONS`].
    #[error("{missing} further conditions would make the system square; possible are 0 to {MAX_CONDITIONS}")]
    Conditions {
        /// Unknowns less conditions.
        missing: isize,
    },
}

impl Dimensions {
    /// Conditions that a square system needs in addition to the problem's own, e.g. one for pseudo-arclength.
    pub fn missing_conditions(&self) -> isize {
        let conditions = self.left.saturating_add(self.right).saturating_add(self.integrals);
        signed(self.components.saturating_add(self.scalars)).saturating_sub(signed(conditions))
    }

    /// [`missing_conditions`](Self::missing_conditions) of a problem that has no more conditions than unknowns, 0 otherwise.
    pub(crate) fn linear_conditions(&self) -> usize {
        usize::try_from(self.missing_conditions()).unwrap_or(0)
    }

    /// Quadrature components, leading and trailing.
    pub fn all_quadratures(&self) -> usize {
        self.quadratures.saturating_add(self.trailing_quadratures)
    }

    /// Checks that the kernels can solve problems of these sizes with the given number of stages. Limits are checked here
    /// and nowhere else.
    ///
    /// # Errors
    /// [`TooLarge`] says which limit is exceeded.
    pub fn check(&self, stages: usize) -> Result<(), TooLarge> {
        let Dimensions { components, .. } = *self;
        let quadratures = self.all_quadratures();
        if !(1..=MAX_STAGES).contains(&stages) {
            return Err(TooLarge::Stages { stages });
        }
        if components == 0 || quadratures > components {
            return Err(TooLarge::Components { components, quadratures });
        }
        let unknowns = components.saturating_add(self.scalars);
        if unknowns > MAX_UNKNOWNS {
            return Err(TooLarge::Unknowns { unknowns });
        }
        // Blocks of nodes are no wider: with as many conditions as unknowns they need no more than 2 · MAX_UNKNOWNS rows and
        // columns.
        let stage_unknowns = stages * (components - quadratures);
        if stage_unknowns > MAX_STAGE_UNKNOWNS {
            return Err(TooLarge::StageUnknowns { stage_unknowns });
        }
        let missing = self.missing_conditions();
        if !(0..=MAX_CONDITIONS as isize).contains(&missing) {
            return Err(TooLarge::Conditions { missing });
        }
        Ok(())
    }
}

/// A count as a signed number, the largest one for any beyond it.
fn signed(count: usize) -> isize {
    isize::try_from(count).unwrap_or(isize::MAX)
}

/// Rows of one block of nodes: carried conditions, conditions of the interval, and borders.
pub(crate) const MAX_ROWS: usize = 2 * MAX_UNKNOWNS;

/// Lanes that hold all unknowns of one point.
pub(crate) const MAX_UNKNOWN_LANES: usize = lanes_for(MAX_UNKNOWNS);

const _: () =
    assert!(MAX_ROWS <= MAX_LANES * LANE, "a row of a block of nodes has no more columns than it may have rows");
