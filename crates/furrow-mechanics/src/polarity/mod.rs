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
pub mod error;
pub mod membrane;
pub mod problem;
pub mod states;
#[cfg(test)]
mod tests;

pub use branch::{Chemistry, PolarityLimit, Towards};
pub use error::PolarityError;
pub use furrow_cell::cue::{LENGTH_UM, ParConstants, SurfaceToVolume, ZYGOTE_SURFACE_TO_VOLUME};
pub use membrane::Membrane;
pub use states::{Readings, Resolution, profile, readings};

use furrow_cell::cue::{Profile, Regulator, Source, Term};
use furrow_cell::{Cell, Cue};
use std::borrow::Cow;

/// The cell, with profiles that [follow PAR polarity](furrow_cell::cue::Profile::Par) replaced by a step that follows
/// P, or a band at the boundary, for the constants and the length L_h that they have. If the cell is not polarised, its cue
/// lacks these terms.
///
/// ```
/// use furrow_cell::Cell;
/// use furrow_mechanics::polarity::resolved;
///
/// let cell = Cell::new(5.4).with_cue("kappa:par_band,amplitude=0.1".parse()?);
/// let cue = resolved(&cell)?.cue.to_string();
/// assert!(cue.starts_with("kappa:band,u0=0.469") && cue.ends_with("amplitude=0.1"), "{cue}");
/// let small = Cell { r0: 2.2, ..cell.clone() };
/// assert!(resolved(&small)?.cue.is_none());
/// let weaker = cell.with_cue("kappa:par_band,k_pa=2.2,amplitude=0.1".parse()?);
/// assert!(resolved(&weaker)?.cue.to_string() != cue);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`PolarityError`].
pub fn resolved(cell: &Cell) -> Result<Cow<'_, Cell>, PolarityError> {
    if !cell.cue.follows_par() {
        return Ok(Cow::Borrowed(cell));
    }
    Ok(Cow::Owned(with_profiles(cell, &placed(cell)?)?))
}

/// The profiles of a cell's cue, of its terms and of its regulator's source, those that follow PAR polarity in their place; `None` for
/// one of a chemistry that does not polarise the cell.
pub(crate) fn placed(cell: &Cell) -> Result<Vec<Option<Profile>>, PolarityError> {
    let mut known: Vec<(ParConstants, f64, Option<Readings>)> = Vec::new();
    let mut place = |profile: Profile| {
        let Profile::Par { band, far, constants, length_um } = profile else { return Ok(Some(profile)) };
        let um = length_um.unwrap_or(LENGTH_UM);
        let found = match known.iter().find(|(others, length, _)| *others == constants && *length == um) {
            Some((.., found)) => *found,
            None => {
                let found = match Chemistry::new(constants, um).polarised(cell) {
                    Ok(state) => state.as_ref().and_then(readings),
                    // No cell of this shape is polarised.
                    Err(PolarityError::NoPolarity { .. }) => None,
                    Err(error) => return Err(error),
                };
                known.push((constants, um, found));
                found
            }
        };
        let followed = |found: Readings| if far { found.followed(band).mirrored().0 } else { found.followed(band) };
        Ok(found.map(followed))
    };
    cell.cue.profiles().map(&mut place).collect()
}

/// The cell with these profiles in its cue. A term without a profile is left out, and so is a source.
pub(crate) fn with_profiles(cell: &Cell, profiles: &[Option<Profile>]) -> Result<Cell, PolarityError> {
    let placed = cell.cue.terms().iter().zip(profiles);
    let terms = placed.filter_map(|(term, profile)| Some(Term { profile: (*profile)?, ..*term })).collect();
    let of_source = profiles.last().copied().flatten();
    let regulator = cell.cue.regulator().map(|regulator| {
        let source = regulator.source.and_then(|source| Some(Source { profile: of_source?, ..source }));
        Regulator { source, ..regulator.clone() }
    });
    Ok(Cell { cue: Cue::with_regulator(terms, regulator)?, ..cell.clone() })
}
