//! What a fit is held against, and between which limits constants are searched: the file of targets.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::calibration::Threshold;
use crate::cell::{Cell, Parameter};
use crate::input::{InputError, did_you_mean, parse_document};
use crate::lineage::Lineage;

/// The built-in targets: the wild-type embryo of C. elegans.
pub const EMBRYO: &str = include_str!("../../../../../data/embryo.ron");

/// A constant that is searched for, evenly in its logarithm.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Searched {
    /// Which.
    pub parameter: Parameter,
    /// The lower limit.
    pub from: f64,
    /// The upper limit.
    pub to: f64,
}

/// A measured size asymmetry.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredChi {
    /// The founder that divides.
    pub cell: String,
    /// Mean of χ over embryos.
    pub mean: f64,
    /// Its standard deviation over embryos.
    pub sd: f64,
}

/// What counts how much in the misfit.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Weights {
    /// A round by which a founder's mean rounds are off.
    pub rounds: f64,
    /// A doubling by which its terminal cells are off.
    pub terminal: f64,
    /// A χ that is off by 1.
    pub chi: f64,
}

impl Default for Weights {
    fn default() -> Weights {
        Weights { rounds: 1.0, terminal: 1.0, chi: 1.0 }
    }
}

/// Measurements that nothing is fitted to.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutOfSample {
    /// What they are of.
    pub name: String,
    /// Volumes that are given in place of what divisions give, as shares of the first cell's.
    pub volumes: BTreeMap<String, f64>,
    /// What was measured.
    pub chi: Vec<MeasuredChi>,
}

/// The targets of a fit.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Fit")]
pub struct Targets {
    /// Constants searched for.
    pub unknowns: Vec<Searched>,
    /// Founders whose observed rounds and terminal cells are to be met.
    pub founders: Vec<String>,
    /// Founders that divide into equal daughters.
    #[serde(default)]
    pub symmetric: Vec<String>,
    /// Measured size asymmetries.
    #[serde(default)]
    pub chi: Vec<MeasuredChi>,
    /// What counts how much.
    #[serde(default)]
    pub weights: Weights,
    /// Published pitchfork thresholds.
    #[serde(default)]
    pub thresholds: Vec<Threshold>,
    /// What is predicted with the cue that fits.
    #[serde(default)]
    pub out_of_sample: Option<OutOfSample>,
}

impl Targets {
    /// The built-in ones.
    ///
    /// # Errors
    /// None in practice; reading is typed as fallible.
    pub fn embryo() -> Result<Targets, InputError> {
        parse_document(EMBRYO, "embryo.ron (built in)", "a file of targets", "Fit")
    }

    /// Checks every value, and that the lineage has the founders named and their counts; `source_name` is what errors call
    /// the file.
    ///
    /// # Errors
    /// Names the field, its value and what is allowed.
    pub fn check(&self, source_name: &str, lineage: &Lineage) -> Result<(), InputError> {
        let refuse = |field: String, value: String, allowed: String| {
            Err(InputError::not_allowed(source_name, field, value, allowed))
        };
        if self.unknowns.is_empty() {
            return refuse("unknowns".into(), "[]".into(), "at least one constant".into());
        }
        for (k, unknown) in self.unknowns.iter().enumerate() {
            let Searched { parameter, from, to } = *unknown;
            let name = parameter.to_string();
            if matches!(parameter, Parameter::R0 | Parameter::Cue { .. } | Parameter::Gain) {
                let allowed = "a constant of the cortex or of the shell, the activity or epsilon; the gain follows from the thresholds";
                return refuse(format!("unknowns[{k}].parameter"), name, allowed.into());
            }
            if self.unknowns[..k].iter().any(|other| other.parameter == parameter) {
                return refuse(format!("unknowns[{k}].parameter"), name, "named only once".into());
            }
            for (field, value) in [("from", from), ("to", to)] {
                if !(value > 0.0 && parameter.refuses(value).is_none()) {
                    let allowed = parameter.refuses(value).unwrap_or("a finite number above 0");
                    return refuse(format!("unknowns[{k}].{field}"), value.to_string(), allowed.into());
                }
            }
            if to <= from {
                return refuse(format!("unknowns[{k}].to"), to.to_string(), format!("above from = {from}"));
            }
        }
        for (k, threshold) in self.thresholds.iter().enumerate() {
            threshold.check(source_name, &format!("thresholds[{k}]"))?;
        }
        self.check_founders(source_name, lineage)?;
        let Weights { rounds, terminal, chi } = self.weights;
        for (field, value) in [("rounds", rounds), ("terminal", terminal), ("chi", chi)] {
            if !(value.is_finite() && value >= 0.0) {
                return refuse(format!("weights.{field}"), value.to_string(), "a finite number, 0 or above".into());
            }
        }
        Ok(())
    }

    fn check_founders(&self, source_name: &str, lineage: &Lineage) -> Result<(), InputError> {
        let refuse = |field: String, value: String, allowed: String| {
            Err(InputError::not_allowed(source_name, field, value, allowed))
        };
        let names = || lineage.founders.iter().map(|founder| founder.name.as_str());
        let unknown = |field: String, name: &str| {
            let allowed = format!(
                "a founder of {}: {}{}",
                lineage.name,
                names().collect::<Vec<_>>().join(", "),
                did_you_mean(name, names())
            );
            refuse(field, format!("{name:?}"), allowed)
        };
        for (list, founders) in [("founders", &self.founders), ("symmetric", &self.symmetric)] {
            for (k, name) in founders.iter().enumerate() {
                let Some(founder) = lineage.founders.iter().find(|founder| founder.name == *name) else {
                    return unknown(format!("{list}[{k}]"), name);
                };
                let counted = founder.observed.is_some_and(|o| o.mean.is_some() && o.terminal.is_some_and(|n| n > 0));
                if list == "founders" && !counted {
                    let allowed = "a founder with observed mean rounds and terminal cells";
                    return refuse(format!("{list}[{k}]"), format!("{name:?}"), allowed.into());
                }
            }
        }
        let others = self.out_of_sample.iter().flat_map(|out| &out.chi).map(|chi| ("out_of_sample.chi", chi));
        for (list, MeasuredChi { cell, mean, sd }) in self.chi.iter().map(|chi| ("chi", chi)).chain(others) {
            if !names().any(|name| name == cell) {
                return unknown(format!("{list}.cell"), cell);
            }
            if !(*mean >= 0.0 && *mean < 1.0) {
                return refuse(format!("{list}.mean of {cell}"), mean.to_string(), "from 0 to 1, 1 excluded".into());
            }
            if !(sd.is_finite() && *sd > 0.0) {
                return refuse(format!("{list}.sd of {cell}"), sd.to_string(), "a finite number above 0".into());
            }
        }
        for (name, share) in self.out_of_sample.iter().flat_map(|out| &out.volumes) {
            if !names().any(|known| known == name) {
                return unknown("out_of_sample.volumes".into(), name);
            }
            if !(*share > 0.0 && *share < 1.0) {
                let field = format!("out_of_sample.volumes of {name}");
                return refuse(
                    field,
                    share.to_string(),
                    "a share of the first cell's volume, above 0 and below 1".into(),
                );
            }
        }
        Ok(())
    }

    /// The cell with constants at a place in the unit cube that the limits span.
    pub fn cell_at(&self, cell: &Cell, place: &[f64]) -> Cell {
        let mut out = cell.clone();
        for (unknown, share) in self.unknowns.iter().zip(place) {
            let [from, to] = [unknown.from.ln(), unknown.to.ln()];
            unknown.parameter.set(&mut out, (from + share.clamp(0.0, 1.0) * (to - from)).exp());
        }
        out
    }

    /// Where in the unit cube a cell's constants lie; outside of it where they are beyond the limits.
    pub fn place_of(&self, cell: &Cell) -> Vec<f64> {
        let share = |u: &Searched| (u.parameter.get(cell) / u.from).ln() / (u.to / u.from).ln();
        self.unknowns.iter().map(share).collect()
    }
}
