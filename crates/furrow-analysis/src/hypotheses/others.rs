//! What was observed beside χ: rounds of founders and lifetimes of cells, from the tree that a hypothesis grows.
//!
//! * \[F.15 rounds\] ln L = −½ Σ_f ((N_f − N(f, θ))²/σ² + ln 2πσ²) over founders f below whom the lineage lists no founder, with their mean
//!   rounds N; a founder that is never born has N = 0.
//! * \[F.16 lifetimes\] ln L = −½ Σ_g (d_g²/σ² + ln 2πσ²) over the generations g of each founder, where d_g is the mean of
//!   ln(measured/model) over measured cells. A cell that does not divide in the model counts as 1.
//!
//! Cells of one generation have nearly one size, so that their lifetimes are one measurement and not many.

use std::collections::{BTreeMap, HashMap};

use furrow_input::InputError;
use furrow_lineage::{CellId, CellTimes, EndRule, Founder, Lineage, Tree, founder_rounds};
use furrow_measured::lifetimes::Lifetimes;
use furrow_measured::statistics::mean;
use serde::Serialize;

use super::noise::{UNDIVIDED, log_density};
use crate::compare::names_of;
use crate::constants::{Constant, Constants};
use crate::fit::chain::Model;
use crate::fit::unknowns::Unknown;
use crate::ranges::grow_alone;

/// A kind of observation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Mean rounds of founders.
    Rounds,
    /// Lifetimes of cells in minutes, by founder and generation.
    Lifetimes,
}

impl Quantity {
    /// Its name in texts.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::Rounds => "rounds",
            Quantity::Lifetimes => "lifetimes",
        }
    }

    /// What its errors are errors of, in texts.
    pub(super) fn scale(self) -> &'static str {
        match self {
            Quantity::Rounds => " rounds",
            Quantity::Lifetimes => " of ln lifetime",
        }
    }
}

/// One observation.
#[derive(Clone, Debug, PartialEq)]
struct Row {
    /// The founder, of lifetimes with the generation.
    name: String,
    /// Mean rounds; the geometric mean of lifetimes in minutes.
    observed: f64,
    /// Cells with their lifetimes.
    cells: Vec<(String, f64)>,
}

/// Observations of one kind, which are left out together.
#[derive(Clone, Debug, PartialEq)]
pub struct Others {
    /// Their kind.
    pub quantity: Quantity,
    /// Their standard deviation: of mean rounds, or of ln lifetime.
    pub sd: f64,
    rows: Vec<Row>,
}

/// An observation beside a hypothesis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OtherScore {
    /// The founder, of lifetimes with the generation.
    pub name: String,
    /// Cells; of rounds 1.
    pub n: usize,
    /// Mean rounds, or minutes.
    pub observed: f64,
    /// The same in the model; `None` if no cell divides.
    pub model: Option<f64>,
    /// Measured cells that do not divide in the model.
    pub resting: usize,
    /// Its log density.
    pub log_likelihood: f64,
    /// Its deviation from the model, in the units of the standard deviation's quantity.
    #[serde(skip)]
    off: f64,
}

/// Observations of one kind under a hypothesis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OthersScore {
    /// Their kind.
    pub quantity: Quantity,
    /// Their standard deviation.
    pub sd: f64,
    /// Their log likelihood under the fit to all data.
    pub log_likelihood: f64,
    /// The same, fitted without them.
    pub left_out: f64,
    /// Each.
    pub rows: Vec<OtherScore>,
}

impl Others {
    /// The observed mean rounds of a lineage's founders below whom it lists no founder; errors name the option `source`.
    ///
    /// # Errors
    /// A standard deviation that is not above 0, and a lineage without observed rounds.
    pub fn rounds(lineage: &Lineage, sd: f64, source: &str) -> Result<Others, InputError> {
        positive(sd, source)?;
        let below = lineage.daughters();
        let of = |(founder, below): (&Founder, &Option<(usize, usize)>)| {
            let observed = founder.observed?.mean.filter(|_| below.is_none())?;
            Some(Row { name: founder.name.clone(), observed, cells: Vec::new() })
        };
        let rows: Vec<Row> = lineage.founders.iter().zip(&below).filter_map(of).collect();
        let allowed = "a lineage with `observed: (mean: ..)` of a founder below whom no founder is listed";
        InputError::require(!rows.is_empty(), source, "observed", "(none)", allowed)?;
        Ok(Others { quantity: Quantity::Rounds, sd, rows })
    }

    /// Measured lifetimes of cells of a lineage with a clock; errors name the option `source`.
    ///
    /// # Errors
    /// A standard deviation that is not above 0, a lineage without a clock, and a table without a cell of it.
    pub fn lifetimes(lifetimes: &Lifetimes, lineage: &Lineage, sd: f64, source: &str) -> Result<Others, InputError> {
        positive(sd, source)?;
        let has_clock = lineage.clock.is_some();
        InputError::require(has_clock, source, "clock", "(none)", "a lineage with a clock")?;
        let names = names_of(lineage);
        let mut by_place: BTreeMap<(usize, u32), Vec<(String, f64)>> = BTreeMap::new();
        for cell in &lifetimes.cells {
            let mut line = std::iter::successors(Some(cell.cell.as_str()), |cell| Some(names.birth(cell)?.0)).zip(0..);
            let Some(place) = line.find_map(|(name, round)| Some((lineage.founder_named(name)?, round))) else {
                continue;
            };
            by_place.entry(place).or_default().push((cell.cell.clone(), cell.mean));
        }
        let of = |((founder, round), cells): ((usize, u32), Vec<(String, f64)>)| {
            let own = &lineage.founders[founder].name;
            let name = if round == 0 { own.clone() } else { format!("{own}+{round}") };
            let observed = mean(&cells.iter().map(|(_, minutes)| minutes.ln()).collect::<Vec<_>>()).exp();
            Row { name, observed, cells }
        };
        let rows: Vec<Row> = by_place.into_iter().map(of).collect();
        let allowed = format!("at least one lifetime of a cell of {}", lineage.name);
        InputError::require(!rows.is_empty(), source, "cells", "(none)", allowed)?;
        Ok(Others { quantity: Quantity::Lifetimes, sd, rows })
    }

    /// Number of observations.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there are no observations. The constructors refuse an empty list.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    fn scores(&self, tree: Option<&Tree>) -> Vec<OtherScore> {
        let score = |row: &Row, model: Option<f64>, off: f64, resting: usize| OtherScore {
            name: row.name.clone(),
            n: row.cells.len().max(1),
            observed: row.observed,
            model,
            resting,
            log_likelihood: log_density(off, self.sd),
            off,
        };
        match self.quantity {
            Quantity::Rounds => {
                let rounds = tree.map_or_else(Vec::new, founder_rounds);
                let of = |row: &Row| {
                    let founder = tree.and_then(|tree| tree.lineage.founder_named(&row.name));
                    let model = founder.and_then(|founder| Some(rounds[founder]?.mean));
                    score(row, model, row.observed - model.unwrap_or(0.0), 0)
                };
                self.rows.iter().map(of).collect()
            }
            Quantity::Lifetimes => {
                let lives = tree.map_or_else(HashMap::new, lives);
                let of = |row: &Row| {
                    let (model, off, resting) = row.beside(&lives);
                    score(row, model, off, resting)
                };
                self.rows.iter().map(of).collect()
            }
        }
    }

    /// Their log likelihood in a tree; `None` is one that cannot be grown.
    pub(super) fn log_likelihood(&self, tree: Option<&Tree>) -> f64 {
        self.scores(tree).iter().map(|row| row.log_likelihood).sum()
    }

    /// Their part of χ².
    pub(super) fn misfit(&self, tree: Option<&Tree>) -> f64 {
        self.scores(tree).iter().map(|row| (row.off / self.sd).powi(2)).sum()
    }

    /// Each beside a tree, with the score of all in the fit without them.
    pub(super) fn scored(&self, tree: Option<&Tree>, left_out: f64) -> OthersScore {
        let rows = self.scores(tree);
        let log_likelihood = rows.iter().map(|row| row.log_likelihood).sum();
        OthersScore { quantity: self.quantity, sd: self.sd, log_likelihood, left_out, rows }
    }
}

impl Row {
    /// Its lifetime in the model, the deviation, and the measured cells that rest.
    fn beside(&self, lives: &HashMap<&str, f64>) -> (Option<f64>, f64, usize) {
        let model = |cell: &str| lives.get(cell).map(|life| life.ln());
        let modelled: Vec<f64> = self.cells.iter().filter_map(|(cell, _)| model(cell)).collect();
        let off = |(cell, minutes): &(String, f64)| model(cell).map_or(UNDIVIDED, |model| minutes.ln() - model);
        let resting = self.cells.len() - modelled.len();
        let middle = (!modelled.is_empty()).then(|| mean(&modelled).exp());
        (middle, mean(&self.cells.iter().map(off).collect::<Vec<_>>()), resting)
    }
}

fn positive(sd: f64, source: &str) -> Result<(), InputError> {
    InputError::require(sd > 0.0 && sd.is_finite(), source, "sd", sd, "a finite number above 0")
}

/// How long each cell that divides lives, in minutes.
fn lives(tree: &Tree) -> HashMap<&str, f64> {
    let times = tree.times().unwrap_or_default();
    let of = |(id, times): (CellId, &CellTimes)| Some((tree.cell(id).name.as_str(), times.lifetime_min()?));
    tree.cells().zip(&times).filter_map(of).collect()
}

/// The tree of a model at values of its unknowns; `None` if it cannot be grown.
pub(super) fn grown(model: &Model<'_>, values: &[f64]) -> Option<Tree> {
    let constant = |(unknown, value): (&Unknown, &f64)| Constant {
        kind: unknown.kind,
        class: unknown.founders.as_ref().map(|(class, _)| class.clone()),
        value: *value,
    };
    let values = model.unknowns.iter().zip(values).map(constant).collect();
    let (lineage, settings) = Constants { values, weight: 1.0 }.applied(model.run.lineage, model.run.settings);
    // Every candidate has its own critical radii, and they cost more than the divisions that they save.
    grow_alone(&lineage, settings, EndRule::Dynamics, model.memo?, model.run.cancel).ok().map(|(tree, _)| tree)
}

/// The sum of `part`, a misfit or a log likelihood, over observations beside χ.
pub(super) fn summed(
    others: &[&Others],
    model: &Model<'_>,
    values: &[f64],
    part: fn(&Others, Option<&Tree>) -> f64,
) -> f64 {
    if others.is_empty() {
        return 0.0;
    }
    let tree = grown(model, values);
    others.iter().map(|others| part(others, tree.as_ref())).sum()
}
