//! The boundary of division: below which radius a cell cannot divide, and why.
//!
//! Without a cue it is the pitchfork, ξ_s*(R0_c, ε) = ξ_s; with one, the fold at which the stable cued branch ends. The
//! radii of the preset are kept in a small file beside the code, with a hash of the parameters they belong to; other
//! parameters are solved for when first asked about.

use std::sync::Mutex;

use serde::{Deserialize, Serialize};

use super::curves::{self, Curve, CurvePoint, STARTS};
use super::symmetric::SteadyError;
use crate::cortex::{Control, Cue, Numerics, Physics};

/// Version of the file's format and of the method behind its numbers.
pub const FORMAT: u32 = 1;

/// The file kept for the preset `gao2026`; rewritten by `furrow boundary --vary r0 --from 1.5 --to 5.4 --write FILE`.
const PRESET: &str = include_str!("../../cache/gao2026.boundary.json");

/// What bounds division.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BoundaryKind {
    /// The pitchfork of the mirror-symmetric branch (no cue).
    Pitchfork,
    /// The fold of the stable branch of a cell with a cue.
    CuedFold,
}

/// The radius at which cells with one cue begin to divide.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CriticalRadius {
    /// Their cue.
    pub cue: Cue,
    /// What bounds them.
    pub kind: BoundaryKind,
    /// Critical radius R0.
    pub r0: f64,
    /// Slope dξ_s/dR0 of the curve there.
    pub slope: f64,
}

/// Why a cell cannot divide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// What bounds it.
    pub kind: BoundaryKind,
    /// Radius below which cells like it do not divide.
    pub critical_r0: f64,
    /// R0/critical − 1 of the cell: negative.
    pub margin: f64,
}

/// Why a stored boundary is not used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BoundaryError {
    /// It is not a boundary file.
    #[error("{file}: not a boundary file: {reason}")]
    Malformed {
        /// The file.
        file: String,
        /// What is wrong.
        reason: String,
    },
    /// It belongs to other parameters or to an older method.
    #[error(
        "{file}: stale: computed for parameters {found}, not {expected}; regenerate it with furrow boundary --write"
    )]
    Stale {
        /// The file.
        file: String,
        /// Hash of the parameters in force.
        expected: String,
        /// Hash in the file.
        found: String,
    },
}

/// A boundary as stored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stored {
    /// Version of the format.
    pub format: u32,
    /// Hash of what the numbers depend on, see [`parameters_hash`].
    pub parameters: String,
    /// Physical parameters, to be read by people.
    pub physics: Physics,
    /// Critical radii at the activity of `physics`.
    pub radii: Vec<CriticalRadius>,
    /// The curve of pitchforks ξ_s*(R0).
    pub pitchfork: Vec<CurvePoint>,
    /// Where criticality changes sign on it.
    pub degenerate: Vec<CurvePoint>,
}

/// Hash of everything a boundary depends on: physics (but the first cell's R0), collocation, and the method's version.
pub fn parameters_hash(physics: &Physics, numerics: &Numerics) -> String {
    let mut hasher = blake3::Hasher::new();
    // Fields in the order of their names and numbers in shortest form: the same on every host.
    let physics = Physics { r0: 1.0, ..*physics };
    let text = serde_json::to_string(&(FORMAT, physics, numerics.stages, numerics.intervals)).unwrap_or_default();
    hasher.update(text.as_bytes());
    hasher.finalize().to_hex()[..16].to_string()
}

impl Stored {
    /// Computes a boundary for a set of cues, with its curve of pitchforks over a range of R0.
    ///
    /// # Errors
    /// [`SteadyError`].
    pub fn compute(
        physics: &Physics,
        numerics: &Numerics,
        cues: &[Cue],
        range: [f64; 2],
    ) -> Result<Stored, SteadyError> {
        let radii = cues.iter().map(|cue| critical_radius(physics, numerics, cue)).collect::<Result<_, _>>()?;
        let Curve { points, degenerate, .. } =
            curves::pitchfork_curve(physics, numerics, range[0], Control::R0, range)?;
        Ok(Stored {
            format: FORMAT,
            parameters: parameters_hash(physics, numerics),
            physics: *physics,
            radii,
            pitchfork: points,
            degenerate,
        })
    }

    /// Reads a stored boundary (`file` is what errors call it), refusing one that belongs to other parameters.
    ///
    /// # Errors
    /// [`BoundaryError`].
    pub fn parse(text: &str, file: &str, physics: &Physics, numerics: &Numerics) -> Result<Stored, BoundaryError> {
        let stored: Stored = serde_json::from_str(text)
            .map_err(|error| BoundaryError::Malformed { file: file.into(), reason: error.to_string() })?;
        let expected = parameters_hash(physics, numerics);
        if stored.format != FORMAT || stored.parameters != expected {
            return Err(BoundaryError::Stale { file: file.into(), expected, found: stored.parameters });
        }
        Ok(stored)
    }
}

/// The critical radius of cells with one cue, solved for directly.
///
/// # Errors
/// [`SteadyError`] if there is none.
pub fn critical_radius(physics: &Physics, numerics: &Numerics, cue: &Cue) -> Result<CriticalRadius, SteadyError> {
    let (kind, point) = match cue {
        Cue::None => {
            (BoundaryKind::Pitchfork, curves::critical_pitchfork(physics, numerics, 1.0, Control::R0, &STARTS)?)
        }
        Cue::Kappa { .. } => {
            (BoundaryKind::CuedFold, curves::critical_cued_fold(physics, numerics, 1.0, cue, Control::R0, &STARTS)?)
        }
    };
    Ok(CriticalRadius { cue: *cue, kind, r0: point.value, slope: point.slope })
}

/// Answers whether cells divide, from stored radii where they apply and solving for others once each.
#[derive(Debug)]
pub struct Boundary {
    physics: Physics,
    numerics: Numerics,
    /// Each with its value on the finer mesh once a cell came near it.
    known: Mutex<Vec<(CriticalRadius, Option<CriticalRadius>)>>,
}

/// Cells nearer to their critical radius than this, relative, are judged by one computed on a mesh twice as fine.
const NEAR: f64 = 1e-3;

impl Boundary {
    /// With the radii stored for the preset if `physics` is the preset, else with none.
    pub fn new(physics: &Physics, numerics: &Numerics) -> Boundary {
        let stored = Stored::parse(PRESET, "gao2026.boundary.json", physics, numerics);
        let radii = stored.map_or_else(|_| Vec::new(), |stored| stored.radii);
        Boundary::with_radii(physics, numerics, radii)
    }

    /// With given radii.
    pub fn with_radii(physics: &Physics, numerics: &Numerics, radii: Vec<CriticalRadius>) -> Boundary {
        let known = Mutex::new(radii.into_iter().map(|radius| (radius, None)).collect());
        Boundary { physics: *physics, numerics: *numerics, known }
    }

    /// Why a cell of radius `r0` with `cue` cannot divide; `None` if it can.
    ///
    /// # Errors
    /// [`SteadyError`] if the critical radius was not known and cannot be found.
    pub fn ends(&self, r0: f64, cue: &Cue) -> Result<Option<End>, SteadyError> {
        let mut known = self.known.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let index = match known.iter().position(|(radius, _)| radius.cue == *cue) {
            Some(index) => index,
            None => {
                known.push((critical_radius(&self.physics, &self.numerics, cue)?, None));
                known.len() - 1
            }
        };
        let (mut radius, refined) = known[index];
        if (r0 / radius.r0 - 1.0).abs() < NEAR {
            // Cells farther away keep the coarser radius: what is said of a cell must not depend on those asked about
            // before, whose order is one of timing.
            radius = match refined {
                Some(radius) => radius,
                None => {
                    let finer = Numerics { intervals: 2 * self.numerics.intervals, ..self.numerics };
                    critical_radius(&self.physics, &finer, cue)?
                }
            };
            known[index].1 = Some(radius);
        }
        let margin = r0 / radius.r0 - 1.0;
        Ok((margin < 0.0).then_some(End { kind: radius.kind, critical_r0: radius.r0, margin }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn preset() -> Stored {
        Stored::parse(PRESET, "preset", &Physics::GAO2026, &Numerics::default()).unwrap()
    }

    #[test]
    fn the_stored_boundary_is_fresh_and_right() {
        let stored = preset();
        assert!(stored.radii.len() >= 2);
        for radius in &stored.radii {
            let again = critical_radius(&Physics::GAO2026, &Numerics::default(), &radius.cue).unwrap();
            assert_eq!(again.kind, radius.kind);
            assert!((again.r0 / radius.r0 - 1.0).abs() < 1e-9, "{again:?} {radius:?}");
        }
    }

    #[test]
    fn other_parameters_are_refused() {
        let physics = Physics { epsilon: 0.86, ..Physics::GAO2026 };
        let error = Stored::parse(PRESET, "preset", &physics, &Numerics::default()).unwrap_err();
        assert!(matches!(error, BoundaryError::Stale { .. }), "{error}");
        let error = Stored::parse("{}", "preset", &physics, &Numerics::default()).unwrap_err();
        assert!(matches!(error, BoundaryError::Malformed { .. }), "{error}");
        // The first cell's radius is no parameter of the boundary.
        let physics = Physics { r0: 4.0, ..Physics::GAO2026 };
        assert!(Stored::parse(PRESET, "preset", &physics, &Numerics::default()).is_ok());
    }

    #[test]
    fn cells_near_the_boundary_are_judged_by_a_finer_solution() {
        // A stored radius that is off by 5e-4 must not decide about a cell within 1e-3 of it.
        let exact = preset().radii.into_iter().find(|radius| radius.cue == Cue::None).unwrap();
        let off = CriticalRadius { r0: exact.r0 * 1.0005, ..exact };
        let boundary = Boundary::with_radii(&Physics::GAO2026, &Numerics::default(), vec![off]);
        assert_eq!(boundary.ends(exact.r0 * 1.0002, &Cue::None).unwrap(), None);
        let end = boundary.ends(exact.r0 * 0.9999, &Cue::None).unwrap().unwrap();
        assert!((end.critical_r0 / exact.r0 - 1.0).abs() < 1e-8);
        assert!((end.margin + 1e-4).abs() < 1e-7);
    }
}
