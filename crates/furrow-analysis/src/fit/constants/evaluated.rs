//! A set of constants with the tree that it grows.
//!
//! The misfit of a set of constants follows from its tree:
//!
//! * \[F.3 misfit\] M = w_r ⟨|mean rounds − observed|⟩ + w_t ⟨|log₂(terminal cells/observed)|⟩ + w_χ ⟨|χ − measured|⟩ + (1 for each
//!   founder that should divide symmetrically and does not, for each pitchfork of another kind than the given one, and for each
//!   division that ends otherwise than given),
//!
//! averaged over the founders and divisions in the targets. Counts are piecewise constant and have no useful derivative.
//! The second objective is
//!
//! * \[F.4 thresholds\] T = rms of ξ_s*/published − 1, over the published pitchforks.
//!
//! Shapes depend on gain and activity only through gξ_s: the gain makes the mean logarithmic deviation of the thresholds
//! zero, and the activity follows.

use super::Objective;
use crate::fit::targets::{MeasuredChi, Targets};
use crate::ranges::grow_alone;
use furrow_cell::{Cell, Parameter};
use furrow_lineage::{EndRule, Founder, Rounds, Thresholds, Tree, TreeSettings, founder_rounds};
use furrow_mechanics::calibration::Threshold;
use furrow_mechanics::calibration::statements::GivenCriticality;
use furrow_mechanics::critical::CriticalRadii;
use furrow_mechanics::division::Outcome;
use furrow_mechanics::equilibria::{BranchOptions, Pitchfork, pitchfork};
use serde::Serialize;

/// A founder of a tree beside its observations.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FounderFit {
    /// Name.
    pub name: String,
    /// Rounds of the model; `None` if it is never born.
    pub rounds: Option<Rounds>,
    /// Observed mean rounds.
    pub observed_mean: Option<f64>,
    /// Observed terminal cells.
    pub observed_terminal: Option<u32>,
    /// χ of its division, where it divides.
    pub chi: Option<f64>,
    /// Whether it divides into equal daughters.
    pub symmetric: bool,
}

/// The parts of a misfit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Parts {
    /// Mean of |mean rounds − observed|.
    pub rounds: f64,
    /// Mean of |log₂(terminal cells/observed)|.
    pub terminal: f64,
    /// Mean of |χ − measured|.
    pub chi: f64,
    /// Founders that should divide symmetrically and do not.
    pub not_symmetric: usize,
    /// Pitchforks with their asymmetric branch on the side opposite to the given one.
    pub reversed: usize,
    /// Divisions that end otherwise than given.
    pub contradicted: usize,
}

/// A threshold beside the published one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ThresholdFit {
    /// Cell radius R0.
    pub r0: f64,
    /// Volume fraction ε.
    pub epsilon: f64,
    /// ξ_s* as published.
    pub xi_s: f64,
    /// ξ_s* of these constants.
    pub computed: f64,
}

/// A set of constants with the tree that it grows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evaluated {
    /// Constants searched for, and the gain.
    pub constants: Vec<(Parameter, f64)>,
    /// Misfit of the counts, M.
    pub misfit: f64,
    /// Its parts.
    pub parts: Parts,
    /// T: rms relative deviation of the thresholds; `None` if one was not found.
    pub thresholds_rms: Option<f64>,
    /// Thresholds; `None` if one was not found.
    pub thresholds: Vec<ThresholdFit>,
    /// Founders, in the lineage's order.
    pub founders: Vec<FounderFit>,
    /// The first cell with these constants.
    #[serde(skip)]
    pub cell: Cell,
}

impl Evaluated {
    pub(super) fn rms(&self) -> f64 {
        self.thresholds_rms.unwrap_or(f64::INFINITY)
    }
}

pub(super) fn by_misfit(a: &Evaluated, b: &Evaluated) -> std::cmp::Ordering {
    a.misfit.total_cmp(&b.misfit).then(a.rms().total_cmp(&b.rms()))
}

impl Objective<'_> {
    pub(super) fn evaluate(&self, cell: &Cell) -> Option<Evaluated> {
        let settings = TreeSettings { cell: cell.clone(), ..self.run.settings.clone() };
        let ends = Thresholds::new(CriticalRadii::new(&settings.numerics));
        let (tree, _) =
            grow_alone(self.run.lineage, settings, EndRule::Thresholds(&ends), self.memo, self.run.cancel).ok()?;
        let founders = self.founders(&tree);
        let (cell, thresholds, reversed) = self.thresholds(cell);
        let contradicted =
            self.targets.contradicted(&cell, self.run.settings.numerics, self.memo, self.run.cancel).ok()?;
        let parts = Parts { reversed, contradicted, ..self.parts(&founders) };
        let weights = self.targets.weights;
        let misfit = weights.rounds * parts.rounds
            + weights.terminal * parts.terminal
            + weights.chi * parts.chi
            + (parts.not_symmetric + parts.reversed + parts.contradicted) as f64;
        let thresholds_rms = (!thresholds.is_empty()).then(|| {
            let sum: f64 = thresholds.iter().map(|t| (t.computed / t.xi_s - 1.0).powi(2)).sum();
            (sum / thresholds.len() as f64).sqrt()
        });
        let searched = self.targets.unknowns.iter().map(|u| u.parameter);
        let constants = searched.chain([Parameter::Gain]).map(|p| (p, p.get(&cell))).collect();
        Some(Evaluated { constants, misfit, parts, thresholds_rms, thresholds, founders, cell })
    }

    fn founders(&self, tree: &Tree) -> Vec<FounderFit> {
        let row = |(founder, rounds): (usize, Option<Rounds>)| {
            let Founder { name, observed, .. } = &self.run.lineage.founders[founder];
            let fate = tree.founder_cell(founder).map(|id| &tree.cell(id).fate);
            FounderFit {
                name: name.clone(),
                rounds,
                observed_mean: observed.and_then(|o| o.mean),
                observed_terminal: observed.and_then(|o| o.terminal),
                chi: fate.and_then(|fate| fate.chi()),
                symmetric: fate.is_some_and(|fate| fate.outcome() == Some(Outcome::Symmetric)),
            }
        };
        founder_rounds(tree).into_iter().enumerate().map(row).collect()
    }

    fn parts(&self, founders: &[FounderFit]) -> Parts {
        let named = |name: &String| founders.iter().find(|founder| founder.name == *name);
        // The sum of no numbers is −0 in floating point.
        let mean = |numbers: Vec<f64>| (0.0 + numbers.iter().sum::<f64>()) / numbers.len().max(1) as f64;
        let counted = || self.targets.founders.iter().filter_map(named);
        // A founder that is never born has no rounds and no cell.
        let rounds = |f: &FounderFit| (f.rounds.map_or(0.0, |r| r.mean) - f.observed_mean.unwrap_or(0.0)).abs();
        let terminal = |f: &FounderFit| {
            let observed = f64::from(f.observed_terminal.unwrap_or(1));
            (f.rounds.map_or(0.5, |r| f64::from(r.terminal)) / observed).log2().abs()
        };
        let chi = |measured: &MeasuredChi| {
            // A cell that does not divide, or equally, is off by all of it.
            (named(&measured.cell).and_then(|f| f.chi).unwrap_or(0.0) - measured.mean).abs()
        };
        Parts {
            rounds: mean(counted().map(rounds).collect()),
            terminal: mean(counted().map(terminal).collect()),
            chi: mean(self.targets.chi.iter().map(chi).collect()),
            reversed: 0,
            contradicted: 0,
            not_symmetric: self.targets.symmetric.iter().filter_map(named).filter(|f| !f.symmetric).count(),
        }
    }

    /// The published thresholds with these constants, and the cell with the gain that suits them best; no thresholds if one is not
    /// found. The last is the number of pitchforks of another kind than the given one; it does not depend on the gain.
    fn thresholds(&self, cell: &Cell) -> (Cell, Vec<ThresholdFit>, usize) {
        let Targets { thresholds: given, criticalities, .. } = self.targets;
        let threshold = |given: &Threshold| {
            pitchfork::first(&given.cell(cell), &self.run.settings.numerics, &BranchOptions::default())
        };
        let found: Vec<Pitchfork> = match given.iter().map(threshold).collect() {
            Ok(found) if !given.is_empty() => found,
            _ => return (cell.clone(), vec![], criticalities.len()),
        };
        let is_reversed = |kind: &&GivenCriticality| {
            let mut of_cell = given.iter().zip(&found).filter(|(t, _)| [t.r0, t.epsilon] == [kind.r0, kind.epsilon]);
            of_cell.any(|(_, found)| found.criticality() != kind.kind)
        };
        let reversed = criticalities.iter().filter(is_reversed).count();
        let computed: Vec<f64> = found.iter().map(|found| found.point.xi_s).collect();
        let logs: f64 = computed.iter().zip(given).map(|(found, given)| (found / given.xi_s).ln()).sum();
        let factor = (logs / computed.len() as f64).exp();
        let mut cell = cell.clone();
        cell.material.gain *= factor;
        cell.xi_s /= factor;
        let fit = |(found, &Threshold { r0, epsilon, xi_s, .. }): (f64, &Threshold)| ThresholdFit {
            r0,
            epsilon,
            xi_s,
            computed: found / factor,
        };
        (cell, computed.into_iter().zip(given).map(fit).collect(), reversed)
    }
}
