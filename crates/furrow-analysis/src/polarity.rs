//! PAR polarity along the germline: at which sizes it exists, what cue follows from it, and how the cells then divide.

use crate::json::{filled, merged};
use furrow_cell::cue::{Field, Term};
use furrow_cell::{Cell, Cue, CueError, Settings};
use furrow_input::InputError;
use furrow_lineage::batch::scheduler;
use furrow_lineage::{Daughter, Lineage, Mother, Place};
use furrow_measured::events::MotherSummary;
use furrow_measured::published::jankele2021;
use furrow_mechanics::critical::{CriticalRadius, critical_radius};
use furrow_mechanics::division::{Division, DivisionError, DivisionInput, divide};
use furrow_mechanics::equilibria::ShapeError;
use furrow_mechanics::polarity::{
    Chemistry, PolarityError, PolarityLimit, Readings, SurfaceToVolume, Towards, profile, readings,
};
use serde_json::{Value, json};

/// A cell of the germline, or any other.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedCell {
    /// Its name; `None` for a cell outside a lineage.
    pub name: Option<String>,
    /// The cell, with the cue that its lineage gives it.
    pub cell: Cell,
}

/// A cell with its polarity.
#[derive(Clone, Debug, PartialEq)]
pub struct PolarisedCell {
    /// Its name.
    pub name: Option<String>,
    /// Radius R0, in L_h.
    pub r0: f64,
    /// Surface of its passive shape per volume, in 1/µm; `None` if it has no passive shape.
    pub surface_to_volume: Option<f64>,
    /// The readings of its polarised state; `Ok(None)` if it has no such state.
    pub polarity: Result<Option<Readings>, PolarityError>,
    /// u, A and P from pole to pole; empty without polarity.
    pub profile: Vec<[f64; 3]>,
    /// The resulting cue; empty without one.
    pub cue: Cue,
    /// Its division with this cue, or the error; `None` if the cue is not known.
    pub division: Option<Result<Division, DivisionError>>,
    /// The measured χ of its division.
    pub measured: Option<MotherSummary>,
}

/// Polarity of several cells, and the sizes at which chemistry and mechanics end.
#[derive(Clone, Debug, PartialEq)]
pub struct PolarityStudy {
    /// The cells.
    pub cells: Vec<PolarisedCell>,
    /// The smallest cell with a polarised state, or why there is no such size.
    pub smallest: Result<PolarityLimit, PolarityError>,
    /// The largest.
    pub largest: Result<PolarityLimit, PolarityError>,
    /// The smallest cell that divides without a cue.
    pub mechanics: Result<CriticalRadius, ShapeError>,
}

/// Why polarity was not computed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PolarityStudyError {
    /// The chemistry failed.
    #[error(transparent)]
    Polarity(#[from] PolarityError),
    /// A division on the way to a cell of the germline failed.
    #[error("{name}: {source}")]
    Division {
        /// The cell.
        name: String,
        /// Its error.
        source: DivisionError,
    },
    /// A rule of the lineage gives a cell a value that is not allowed.
    #[error("{name}: {why}")]
    Rule {
        /// The cell.
        name: String,
        /// The value, and the allowed values.
        why: String,
    },
    /// The cue that follows is not allowed.
    #[error(transparent)]
    Cue(#[from] CueError),
    /// The table of measured divisions is damaged.
    #[error(transparent)]
    Measured(#[from] InputError),
}

/// Places of a profile.
const PLACES: usize = 200;

/// The cells from the first one to the last that is the smaller daughter of the one before: in *C. elegans* P0 to P4. Each is as
/// large as its mother's division with the lineage's own cue makes it.
///
/// # Errors
/// [`PolarityStudyError`].
pub fn germline(lineage: &Lineage, settings: &Settings) -> Result<Vec<NamedCell>, PolarityStudyError> {
    let smaller = |mother: &str| {
        let is = |daughter: Option<Daughter>| daughter == Some(Daughter::Smaller);
        lineage.founders.iter().position(|f| f.mother.as_deref() == Some(mother) && is(f.daughter))
    };
    let first = lineage.first();
    let mut next = Some((first, lineage.given_r0(first).unwrap_or(settings.cell.r0)));
    let mut cells: Vec<NamedCell> = Vec::new();
    let mut before: Option<Division> = None;
    while let Some((founder, r0)) = next.take() {
        let name = lineage.founders[founder].name.clone();
        let place = Place { founder, round: 0, generation: lineage.generation(founder), r0, apart: 0 };
        let mut cell = Cell { r0, cue: lineage.cue_at(place), ..settings.cell.clone() };
        let mother = cells.last().map(|mother| Mother::of(&mother.cell, before.as_ref()));
        let failed_rule = |why| PolarityStudyError::Rule { name: name.clone(), why };
        lineage.set_physics(place, &mut cell, mother).map_err(failed_rule)?;
        if let Some(daughter) = smaller(&name) {
            let input = DivisionInput { cell: cell.clone(), numerics: settings.numerics, seed: 0 };
            let failed = |source| PolarityStudyError::Division { name: name.clone(), source };
            let division = divide(&input).map_err(failed)?;
            let own = lineage.given_r0(daughter);
            next = own.or(division.daughters().map(|[a, b]| a.min(b))).map(|r0| (daughter, r0));
            before = Some(division);
        }
        cells.push(NamedCell { name: Some(name), cell });
    }
    Ok(cells)
}

/// How κ follows P.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Follows {
    /// As P itself, a step between the poles.
    Step,
    /// As a band at the boundary of P, where both antagonists meet, as wide as the boundary.
    Band,
}

impl Follows {
    /// All of them, with the names that users write.
    pub const NAMED: [(&str, Follows); 2] = [("step", Follows::Step), ("band", Follows::Band)];
}

/// The cue κ = κ0 (1 + amplitude · f), P.4, f from 0 to 1 as P has it.
///
/// # Errors
/// The amplitude brings κ to 0.
pub(crate) fn cue_of(polarity: &Readings, follows: Follows, amplitude: f64) -> Result<Cue, CueError> {
    let profile = polarity.followed(follows == Follows::Band);
    Cue::new(vec![Term { field: Field::Kappa, profile, amplitude, side: None }])
}

/// Polarity of cells, and the divisions that follow where κ follows P.
///
/// # Errors
/// [`PolarityStudyError`].
pub fn polarity(
    cells: &[NamedCell],
    settings: &Settings,
    chemistry: &Chemistry,
    (follows, amplitude): (Follows, f64),
) -> Result<PolarityStudy, PolarityStudyError> {
    let measured =
        jankele2021()?.into_iter().find(|group| group.group == "wt").map_or(Vec::new(), |group| group.events);
    let of = |NamedCell { name, cell }: &NamedCell| {
        // One cell without an answer does not cost the others theirs.
        let state = match chemistry.polarised(cell) {
            Err(PolarityError::NoPolarity { .. }) => Ok(None),
            found => found,
        };
        let polarity = state.as_ref().map(|state| state.as_ref().and_then(readings)).map_err(Clone::clone);
        let cue = match &polarity {
            Ok(Some(found)) => cue_of(found, follows, amplitude)?,
            _ => Cue::none(),
        };
        let input = || DivisionInput { cell: cell.clone().with_cue(cue.clone()), numerics: settings.numerics, seed: 0 };
        Ok::<PolarisedCell, PolarityStudyError>(PolarisedCell {
            r0: cell.r0,
            surface_to_volume: chemistry.membrane(cell).ok().map(|membrane| membrane.surface_to_volume),
            profile: state.ok().flatten().map_or(Vec::new(), |state| profile(&state, PLACES)),
            division: polarity.is_ok().then(|| divide(&input())),
            polarity,
            cue,
            measured: measured.iter().find(|event| name.as_ref() == Some(&event.mother)).cloned(),
            name: name.clone(),
        })
    };
    let like = cells.first().map_or(&settings.cell, |first| &first.cell);
    let limits = || {
        let smallest = chemistry.limit(like, Towards::Smaller);
        let largest = match &smallest {
            // No size at all.
            Err(error @ PolarityError::NoPolarity { .. }) => Err(error.clone()),
            _ => chemistry.limit(like, Towards::Larger),
        };
        (smallest, largest, critical_radius(&like.clone().with_cue(Cue::none()), &settings.numerics))
    };
    let all = || scheduler::in_parallel(cells.len(), |k| of(&cells[k]));
    let (found, (smallest, largest, mechanics)) = rayon::join(all, limits);
    Ok(PolarityStudy { cells: found.into_iter().collect::<Result<_, _>>()?, smallest, largest, mechanics })
}

impl PolarityStudy {
    /// What ends first as cells shrink.
    fn ends_first(&self) -> Option<&'static str> {
        let (Ok(chemistry), Ok(mechanics)) = (&self.smallest, &self.mechanics) else { return None };
        Some(if chemistry.r0 > mechanics.r0 { "chemistry" } else { "mechanics" })
    }

    /// The document that `furrow polarity --json` prints; `amplitude` is the amplitude of κ.
    pub fn document(&self, chemistry: &Chemistry, amplitude: f64) -> Value {
        let um = |r0: f64| r0 * chemistry.length_um;
        let limit = |limit: &Result<PolarityLimit, PolarityError>| match limit {
            Ok(limit) => merged(json!({ "r0": limit.r0, "r0_um": um(limit.r0) }), json!(limit.state)),
            Err(error) => json!({ "why": error.to_string() }),
        };
        let mechanics = match &self.mechanics {
            Ok(critical) => json!({ "r0": critical.r0, "r0_um": um(critical.r0), "kind": critical.kind }),
            Err(error) => json!({ "why": error.to_string() }),
        };
        json!({
            "constants": chemistry.constants,
            "length_um": chemistry.length_um,
            "amplitude": amplitude,
            "cells": self.cells.iter().map(|cell| cell.document(chemistry)).collect::<Vec<_>>(),
            "smallest_polarised": limit(&self.smallest),
            "largest_polarised": limit(&self.largest),
            "smallest_dividing": mechanics,
            "ends_first": self.ends_first(),
        })
    }
}

impl PolarisedCell {
    /// The readings of its polarised state, if it has one.
    pub fn readings(&self) -> Option<&Readings> {
        self.polarity.as_ref().ok()?.as_ref()
    }

    /// Why its polarity or its division is not known, if so.
    pub fn why(&self) -> Option<String> {
        let division = self.division.as_ref().and_then(|division| division.as_ref().err());
        self.polarity.as_ref().err().map(ToString::to_string).or(division.map(ToString::to_string))
    }

    fn document(&self, chemistry: &Chemistry) -> Value {
        let division = self.division.as_ref().and_then(|division| division.as_ref().ok());
        let psi = match chemistry.constants.surface_to_volume {
            SurfaceToVolume::Shape => self.surface_to_volume,
            SurfaceToVolume::Fixed(psi) => Some(psi),
        };
        let own = json!({
            "cell": self.name, "r0": self.r0, "r0_um": self.r0 * chemistry.length_um,
            "surface_to_volume": self.surface_to_volume, "psi": psi,
            "polarised": self.polarity.as_ref().ok().map(Option::is_some), "why": self.why(),
        });
        let measured =
            self.measured.as_ref().map(|m| json!({ "mean_signed": m.mean_signed, "sd": m.sd_signed, "n": m.n }));
        let divided = json!({
            "cue": self.cue,
            "outcome": division.map(|division| division.outcome()),
            "chi": division.and_then(|division| division.chi()),
            "chi_signed": division.and_then(|division| division.chi_signed()),
            "u_furrow": division.and_then(|division| division.u_furrow()),
            "measured": measured,
        });
        filled(merged(merged(own, self.readings().map_or(json!({}), |found| json!(found))), divided))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use furrow_mechanics::polarity::ParConstants;

    /// ψ is surface over volume of the cell's own shape, or the number given for all cells.
    #[test]
    fn the_document_has_the_psi_that_the_chemistry_ran_with() {
        let cell = PolarisedCell {
            name: None,
            r0: 5.4,
            surface_to_volume: Some(0.18),
            polarity: Ok(None),
            profile: Vec::new(),
            cue: Cue::default(),
            division: None,
            measured: None,
        };
        for (surface_to_volume, psi) in [(SurfaceToVolume::Shape, 0.18), (SurfaceToVolume::Fixed(0.25), 0.25)] {
            let constants = ParConstants { surface_to_volume, ..ParConstants::GOEHRING2011 };
            let document = cell.document(&Chemistry::new(constants, 3.2));
            assert_eq!((&document["psi"], &document["surface_to_volume"]), (&json!(psi), &json!(0.18)), "{document}");
        }
    }
}
