//! PAR polarity: two antagonists with finite cytosolic pools on the surface of a cell at rest.
//!
//! A and P diffuse on the membrane, attach to it from well-mixed pools, detach, and each removes the other:
//!
//! * \[P.1 antagonists\] ∂ₜA = D_A ∇²A + k_onA (ρ_A − ψĀ) − k_offA A − k_AP Pⁿ A,
//! * and ∂ₜP = D_P ∇²P + k_onP (ρ_P − ψP̄) − k_offP P − k_PA A² P.
//!
//! Bars denote means over the surface, ψ is the surface per volume, ρ the amount of each per volume, and n is 1 or 2. The
//! surface is the [passive shape](mod@crate::equilibria::passive), which does not change, or a line. P is high at the posterior pole, u = 0.
//!
//! Polarised states exist in a range of sizes: below it the boundary between the antagonists is too wide for the cell.
//! If κ follows P, the position and width of the cue are computed instead of given: [`resolved`].
//!
//! | file | contents |
//! |---|---|
//! | [`constants`] | named constants, the values of Goehring et al. 2011, uniform states |
//! | [`membrane`] | the passive shape in µm, or a line |
//! | [`problem`] | the equations as a boundary-value problem, with exact derivatives |
//! | [`states`] | evolution in time, observables of a state |
//! | [`branch`] | polarised states over size, and the folds at which they end |
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
pub use constants::{LENGTH_UM, ParConstants, SurfaceToVolume, ZYGOTE_SURFACE_TO_VOLUME};
pub use error::PolarityError;
pub use membrane::Membrane;
pub use states::{Readings, Resolution, profile, readings};

use furrow_cell::cue::{Profile, Regulator, Term};
use furrow_cell::{Cell, Cue};
use std::borrow::Cow;

/// The cell, with profiles that [follow PAR polarity](furrow_cell::cue::Profile::Par) replaced by a step that follows
/// P, or a band at the boundary, for the constants of Goehring et al. 2011 and L_h = [`LENGTH_UM`] µm. If the cell is
/// not polarised, its cue lacks these terms.
///
/// ```
/// use furrow_cell::Cell;
/// use furrow_mechanics::polarity::resolved;
///
/// let cell = Cell::new(5.4).with_cue("kappa:par_band,amplitude=0.1".parse()?);
/// let cue = resolved(&cell)?.cue.to_string();
/// assert!(cue.starts_with("kappa:band,u0=0.469") && cue.ends_with("amplitude=0.1"), "{cue}");
/// let small = Cell { r0: 2.2, ..cell };
/// assert!(resolved(&small)?.cue.is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`PolarityError`].
pub fn resolved(cell: &Cell) -> Result<Cow<'_, Cell>, PolarityError> {
    if !cell.cue.follows_par() {
        return Ok(Cow::Borrowed(cell));
    }
    let state = Chemistry::goehring2011().polarised(cell)?;
    let mut cue = cell.cue.clone();
    let Some(found) = state.as_ref().and_then(readings) else {
        let without = |term: &Term| !matches!(term.profile, Profile::Par { .. });
        let terms = cue.terms().iter().copied().filter(without).collect();
        let regulator = cue.regulator().cloned().map(|regulator| {
            let source = regulator.source.filter(|source| !matches!(source.profile, Profile::Par { .. }));
            Regulator { source, ..regulator }
        });
        let cue = Cue::with_regulator(terms, regulator)?;
        return Ok(Cow::Owned(Cell { cue, ..cell.clone() }));
    };
    for profile in cue.profiles_mut() {
        if let Profile::Par { band, far } = *profile {
            let place = found.followed(band);
            *profile = if far { place.mirrored().0 } else { place };
        }
    }
    Ok(Cow::Owned(Cell { cue, ..cell.clone() }))
}
