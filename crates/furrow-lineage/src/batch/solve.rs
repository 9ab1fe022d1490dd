//! One division by the solver that its numerics choose.

use furrow_mechanics::division::{self, Division, DivisionError, DivisionInput};
#[cfg(not(target_family = "wasm"))]
use {furrow_surface::film::Film, std::sync::OnceLock};

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

    /// The kept shapes; `None` if the division was not solved, as where the memo knows it.
    pub fn into_film(self) -> Option<Film> {
        self.film.into_inner()
    }
}

/// The page's module has no surfaces.
#[cfg(target_family = "wasm")]
fn without_axis(input: &DivisionInput) -> Result<Division, DivisionError> {
    division::divide(input)
}
