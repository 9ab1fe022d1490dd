//! Third-order normal form of a pitchfork.
//!
//! Along the branch that breaks the symmetry x = x* + aφ + a²η + O(a³) (N.11), and the free parameter λ = λ* + c a² + O(a⁴):
//!
//! * O(a²): J η = −½ D²F\[φ, φ\], η mirror-symmetric, determined up to a multiple of the null direction b of the
//!   symmetric problem: η = η₀ + s b
//! * O(a³): D²F\[φ, η\] + ⅙ D³F\[φ, φ, φ\] is in the range of the antisymmetric problem, which gives s
//!
//! and c is the parameter's component of η. c > 0: supercritical, the branch exists for λ > λ*; c < 0: subcritical.

use crate::direction::{Direction, Residual};
use crate::problem::derivatives::{power_residuals, second_residual};
use crate::problem::{Directional, MirrorSymmetric};
use crate::solution::Solution;

use super::minimally_augmented::MinimallyAugmented;
use super::singularity::SingularError;
use super::symmetry_breaking::SymmetryBreaking;

/// Normal form of a pitchfork, for the normalisation of φ of the [`SymmetryBreaking`] it comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalForm {
    /// The mirror-symmetric response η.
    pub response: Direction,
    /// Components of η along the free parameters: λ = λ* + parameters\[0\] a².
    pub parameters: Vec<f64>,
}

/// The normal form at a pitchfork on which `point` has just converged to `y`; a second free parameter is held fixed.
///
/// # Errors
/// [`SingularError::Singular`] if the coefficients are not finite (e.g. where two pitchforks meet).
pub fn pitchfork_normal_form<P: Directional + MirrorSymmetric>(
    point: &mut MinimallyAugmented<P, SymmetryBreaking>,
    y: &Solution,
) -> Result<NormalForm, SingularError> {
    let MinimallyAugmented { problem, singularity, system, basis, slopes, .. } = point;
    let dims = system.dimensions();
    singularity.null.check(y)?;
    system.check(problem, y)?;
    let conditions = dims.linear_conditions();
    let (mut square, mut cube, mut mixed) = (Residual::default(), Residual::default(), Residual::default());
    let gauss = system.gauss.clone();
    power_residuals(&gauss, problem, y, &singularity.null, conditions, [&mut square, &mut cube]);
    let mut response = Direction::default();
    system.solve(&square, &mut response)?;
    response.scale(0.5);
    second_residual(&gauss, problem, y, [&singularity.null, &response], conditions, &mut mixed);
    // The antisymmetric problem has no other equations: at the mirror its conditions are linear.
    for (mixed, cube) in [(&mut mixed.stages, &cube.stages), (&mut mixed.left, &cube.left)] {
        mixed.iter_mut().zip(cube).for_each(|(mixed, cube)| *mixed += cube / 6.0);
    }
    mixed.right.clear();
    mixed.right.resize(problem.vanishing_at_mirror().len(), 0.0);
    let s = -singularity.project(system, &mixed)? / slopes[0];
    response.add(s, &basis[0]);
    let parameters = response.scalars[dims.scalars - conditions..].to_vec();
    if parameters.iter().all(|c| c.is_finite()) {
        Ok(NormalForm { response, parameters })
    } else {
        Err(SingularError::Singular { iterations: 0 })
    }
}
