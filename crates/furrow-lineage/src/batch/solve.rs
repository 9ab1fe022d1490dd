//! One division, and critical radii, by the solver that the numerics select.

use super::store::Store;
use furrow_cell::{Cell, Numerics};
use furrow_mechanics::critical::{AXISYMMETRIC, Archive, CriticalRadii, Method};
use furrow_mechanics::division::{self, Division, DivisionError, DivisionInput};
use furrow_mechanics::equilibria::ShapeError;
use furrow_mechanics::equilibria::at_rest::{RestShapes, rest_shapes};
#[cfg(not(target_family = "wasm"))]
use {furrow_surface::bent_curves::WITHOUT_AXIS, furrow_surface::film::Film, std::sync::OnceLock};

/// The page's module has no surfaces.
#[cfg(target_family = "wasm")]
const WITHOUT_AXIS: Method = AXISYMMETRIC;

/// One division, with axial symmetry, or without if the numerics have azimuthal modes.
///
/// # Errors
/// [`DivisionError`].
pub fn solve(input: &DivisionInput) -> Result<Division, DivisionError> {
    if input.numerics.modes == 0 { division::divide(input) } else { without_axis(input) }
}

/// The activities up to `xi_max` at which a cell comes to rest, with axial symmetry or without.
///
/// # Errors
/// [`ShapeError`].
pub fn resting(cell: &Cell, numerics: &Numerics, xi_max: f64) -> Result<RestShapes, ShapeError> {
    if numerics.modes == 0 { rest_shapes(cell, numerics, xi_max) } else { resting_bent(cell, numerics, xi_max) }
}

#[cfg(not(target_family = "wasm"))]
use furrow_surface::bent_curves::resting_bent;

/// The page's module has no surfaces.
#[cfg(target_family = "wasm")]
use furrow_mechanics::equilibria::at_rest::rest_shapes as resting_bent;

/// The function that computes critical radii, with or without axial symmetry.
pub fn method(numerics: &Numerics) -> Method {
    if numerics.modes == 0 { AXISYMMETRIC } else { WITHOUT_AXIS }
}

/// Critical radii, with or without axial symmetry; a store keeps them for later runs.
pub fn critical_radii<'a>(numerics: &Numerics, store: Option<&'a Store>) -> CriticalRadii<'a> {
    let radii = match numerics.modes {
        0 => CriticalRadii::new(numerics),
        _ => CriticalRadii::by(WITHOUT_AXIS, numerics),
    };
    radii.kept_in(store.map(|store| store as &dyn Archive))
}

#[cfg(not(target_family = "wasm"))]
fn without_axis(input: &DivisionInput) -> Result<Division, DivisionError> {
    furrow_surface::division::divide(input, &mut |_, _| ()).map(|found| found.division)
}

/// Solves divisions without axial symmetry and keeps the shapes of the first with a given seed.
#[cfg(not(target_family = "wasm"))]
#[derive(Debug)]
pub struct Filming {
    seed: u64,
    film: OnceLock<Film>,
}

#[cfg(not(target_family = "wasm"))]
impl Filming {
    /// Keeps the shapes of the division with this seed.
    pub fn of(seed: u64) -> Filming {
        Filming { seed, film: OnceLock::new() }
    }

    /// Solves one division.
    ///
    /// # Errors
    /// [`DivisionError`].
    pub fn solve(&self, input: &DivisionInput) -> Result<Division, DivisionError> {
        if input.seed != self.seed {
            return solve(input);
        }
        let film = Film::compute(input)?;
        let division = film.found.division.clone();
        self.film.get_or_init(|| film);
        Ok(division)
    }

    /// The kept shapes; `None` if the division was not solved, for example because it was in the memo.
    pub fn into_film(self) -> Option<Film> {
        self.film.into_inner()
    }
}

/// The page's module has no surfaces.
#[cfg(target_family = "wasm")]
fn without_axis(input: &DivisionInput) -> Result<Division, DivisionError> {
    division::divide(input)
}
