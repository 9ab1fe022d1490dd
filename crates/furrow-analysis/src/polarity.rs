//! PAR polarity along the germline: at which sizes it exists, what cue follows from it, and how the cells then divide.

use crate::json::{filled, merged};
use furrow_cell::cue::{Field, Term};
use furrow_cell::{Cell, Cue, CueError, Settings};
use furrow_input::InputError;
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
    /// Its name; none for a cell that is not of a lineage.
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
    /// Surface of its passive shape per volume, in 1/µm.
    pub surface_to_volume: f64,
    /// What is read off its polarised state; none where no such state exists.
    pub polarity: Option<Readings>,
    /// u, A and P from pole to pole; empty without polarity.
    pub profile: Vec<[f64; 3]>,
    /// The cue that follows, or none.
    pub cue: Cue,
    /// How it divides with this cue, or why that is not known.
    pub division: Result<Division, Undivided>,
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

/// Why a cell has no division: its chemistry, its cue or its mechanics failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Undivided {
    /// No state was found, with or without polarity.
    #[error(transparent)]
    Chemistry(#[from] PolarityError),
    /// The cue that follows is not allowed.
    #[error(transparent)]
    Cue(#[from] CueError),
    /// The division was not computed.
    #[error(transparent)]
    Division(#[from] DivisionError),
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
        /// The value, and what is allowed.
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
        let place = Place { founder, round: 0, generation: lineage.generation(founder), r0 };
        let mut cell = Cell { r0, cue: lineage.cue_at(place), ..settings.cell.clone() };
        let mother = cells.last().map(|mother| Mother::of(&mother.cell, before.as_ref()));
        let refused = |why| PolarityStudyError::Rule { name: name.clone(), why };
        lineage.set_physics(place, &mut cell, mother).map_err(refused)?;
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
pub fn cue_of(polarity: &Readings, follows: Follows, amplitude: f64) -> Result<Cue, CueError> {
    let profile = polarity.followed(follows == Follows::Band);
    Cue::new(vec![Term { field: Field::Kappa, profile, amplitude }])
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
        let (surface, state) = (chemistry.membrane(cell), chemistry.polarised(cell));
        let polarity = state.as_ref().ok().and_then(|state| readings(state.as_ref()?));
        let cue = polarity.as_ref().map_or(Ok(Cue::none()), |found| cue_of(found, follows, amplitude));
        let cued = cell.clone().with_cue(cue.clone().unwrap_or_default());
        let input = DivisionInput { cell: cued, numerics: settings.numerics, seed: 0 };
        let divided = || divide(&input).map_err(Undivided::from);
        let profile =
            state.as_ref().map_or(Vec::new(), |state| state.iter().flat_map(|s| profile(s, PLACES)).collect());
        let surface_to_volume = surface.as_ref().map_or(f64::NAN, |membrane| membrane.surface_to_volume);
        let (shape, chemical) = (surface.map_err(Undivided::from), state.map_err(Undivided::from));
        PolarisedCell {
            r0: cell.r0,
            surface_to_volume,
            profile,
            polarity,
            cue: cue.clone().unwrap_or_default(),
            division: shape.and(chemical).and(cue.map_err(Undivided::from)).and_then(|_| divided()),
            measured: measured.iter().find(|event| name.as_ref() == Some(&event.mother)).cloned(),
            name: name.clone(),
        }
    };
    let found = cells.iter().map(of).collect();
    let like = cells.first().map_or(&settings.cell, |first| &first.cell);
    Ok(PolarityStudy {
        cells: found,
        smallest: chemistry.limit(like, Towards::Smaller),
        largest: chemistry.limit(like, Towards::Larger),
        mechanics: critical_radius(&like.clone().with_cue(Cue::none()), &settings.numerics),
    })
}

impl PolarityStudy {
    /// What ends first as cells shrink.
    fn ends_first(&self) -> Option<&'static str> {
        let (Ok(chemistry), Ok(mechanics)) = (&self.smallest, &self.mechanics) else { return None };
        Some(if chemistry.r0 > mechanics.r0 { "chemistry" } else { "mechanics" })
    }

    /// As `furrow polarity --json` prints it; `amplitude` is that of κ.
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
    fn document(&self, chemistry: &Chemistry) -> Value {
        let division = self.division.as_ref().ok();
        let psi = match chemistry.constants.surface_to_volume {
            SurfaceToVolume::Shape => self.surface_to_volume,
            SurfaceToVolume::Fixed(psi) => psi,
        };
        let own = json!({
            "cell": self.name, "r0": self.r0, "r0_um": self.r0 * chemistry.length_um,
            "surface_to_volume": self.surface_to_volume, "psi": psi, "polarised": self.polarity.is_some(),
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
        let why = json!({ "why": self.division.as_ref().err().map(Undivided::to_string) });
        let state = self.polarity.map_or(json!({}), |found| json!(found));
        filled(merged(merged(merged(own, state), divided), why))
    }
}
