//! PAR polarity: two antagonists with finite cytosolic pools on the surface of a cell at rest.
//!
//! A and P diffuse on the membrane, attach to it from well-mixed pools, detach, and each removes the other:
//!
//! * \[P.1 antagonists\] ∂ₜA = D_A ∇²A + k_onA (ρ_A − ψĀ) − k_offA A − k_AP P A,
//! * and ∂ₜP = D_P ∇²P + k_onP (ρ_P − ψP̄) − k_offP P − k_PA A² P.
//!
//! Bars are means over the surface, ψ is its size per volume, and ρ the amount of each per volume. The surface is the
//! [passive shape](mod@crate::equilibria::passive), which stays as it is. P is high at the posterior pole, u = 0.
//!
//! Polarised states exist in a range of sizes: below it the boundary between both antagonists is too wide for the cell. If κ
//! follows P, the place and width of the cue are computed and no longer given: [`polarised_step`].
//!
//! | file | contents |
//! |---|---|
//! | [`constants`] | the constants by name, those of Goehring et al. 2011, uniform states |
//! | [`membrane`] | the passive shape in µm |
//! | [`problem`] | the equations as a boundary-value problem, with exact derivatives |
//! | [`states`] | evolution in time, what is read off a state |
//! | [`branch`] | polarised states over size, the folds where they end |
//! | [`error`] | why polarity could not be computed |
//!
//! # References
//! Goehring et al., Science 334, 1137 (2011) (the model and its constants). Hubatsch et al., Nature Physics 15, 1078 (2019)
//! (a smallest size for polarity).

pub mod branch;
pub mod constants;
pub mod error;
pub mod membrane;
pub mod problem;
pub mod states;
#[cfg(test)]
mod tests;

pub use branch::{Chemistry, PolarityLimit, Towards};
pub use constants::{LENGTH_UM, ParConstants, SurfaceToVolume, Uniform, ZYGOTE_SURFACE_TO_VOLUME};
pub use error::PolarityError;
pub use membrane::Membrane;
pub use states::{Readings, Resolution, profile, readings};

use furrow_cell::Cell;

/// Place u0 and width ω of the step that follows P on a cell whose L_h is `length_scale_um` µm: ω is negative, as P falls from the
/// posterior pole. None where no polarised state exists at the cell's size.
///
/// ```
/// use furrow_cell::Cell;
/// use furrow_mechanics::polarity::{LENGTH_UM, ParConstants, polarised_step};
///
/// let step = |r0: f64| polarised_step(&Cell::new(r0), &ParConstants::GOEHRING2011, LENGTH_UM);
/// let (u0, omega) = step(5.4)?.unwrap();
/// assert!((u0 - 0.469).abs() < 1e-3 && omega < 0.0);
/// assert_eq!(step(2.2)?, None);
/// # Ok::<(), furrow_mechanics::polarity::PolarityError>(())
/// ```
///
/// # Errors
/// [`PolarityError`].
pub fn polarised_step(
    cell: &Cell,
    constants: &ParConstants,
    length_scale_um: f64,
) -> Result<Option<(f64, f64)>, PolarityError> {
    let state = Chemistry::new(*constants, length_scale_um).polarised(cell)?;
    Ok(state.as_ref().and_then(readings).map(|found| (found.u0, found.omega)))
}
