//! States at rest without axial symmetry, and their stability.

use furrow_mechanics::division::{DivisionError, DivisionInput};

use crate::division::{SurfaceDivision, run};

/// The state at rest that a cell reaches from the passive shape, stable or not: a cell whose poles are alike is not disturbed in what
/// is odd about its middle. Without [`rest`](SurfaceDivision::rest) the cell divides instead.
///
/// # Errors
/// [`DivisionError`].
pub fn steady(input: &DivisionInput) -> Result<SurfaceDivision, DivisionError> {
    run(input, input.cell.is_mirror_symmetric(), &mut |_, _| ())
}
