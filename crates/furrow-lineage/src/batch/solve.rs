//! One division by the solver that its numerics choose.

use furrow_mechanics::division::{self, Division, DivisionError, DivisionInput};

/// One division, with axial symmetry or, if the numerics have azimuthal modes, without.
///
/// # Errors
/// [`DivisionError`].
pub fn solve(input: &DivisionInput) -> Result<Division, DivisionError> {
    if input.numerics.modes == 0 { division::divide(input) } else { without_axis(input) }
}

#[cfg(not(target_family = "wasm"))]
fn without_axis(input: &DivisionInput) -> Result<Division, DivisionError> {
    furrow_surface::division::divide(input, &mut |_, _| ()).map(|found| found.division)
}

/// The page's module has no surfaces.
#[cfg(target_family = "wasm")]
fn without_axis(input: &DivisionInput) -> Result<Division, DivisionError> {
    division::divide(input)
}
