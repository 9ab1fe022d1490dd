//! The file of targets: observations, and the limits of the search.

use std::fmt::Display;

use furrow_cell::{Cell, Numerics, Parameter};
use furrow_input::{InputError, did_you_mean, parse_document, unique_map};
use furrow_lineage::batch::scheduler::{SchedulerError, SchedulerOptions};
use furrow_lineage::batch::{Memo, scheduler, solve};
use furrow_lineage::{Founder, Lineage};
use furrow_mechanics::calibration::Threshold;
use furrow_mechanics::calibration::statements::{GivenCriticality, GivenDivision};
use furrow_mechanics::division::DivisionInput;
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::num::NonZeroU32;
use std::sync::atomic::AtomicBool;

/// The built-in targets: the wild-type embryo of C. elegans.
pub(crate) const EMBRYO: &str = include_str!("../../data/embryo.ron");

/// A constant to search for, uniformly in its logarithm.
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
#[serde(from = "WrittenChi")]
pub struct MeasuredChi {
    /// The founder that divides.
    pub cell: String,
    /// Mean of χ over embryos.
    pub mean: f64,
    /// The error of the mean: `sd` of the file by √`n`.
    pub sd: f64,
}

/// A measured size asymmetry as files have it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "MeasuredChi")]
struct WrittenChi {
    cell: String,
    mean: f64,
    /// The standard deviation over `n` embryos; without `n` the error of the mean.
    sd: f64,
    #[serde(default)]
    n: Option<NonZeroU32>,
}

impl From<WrittenChi> for MeasuredChi {
    fn from(WrittenChi { cell, mean, sd, n }: WrittenChi) -> MeasuredChi {
        MeasuredChi { cell, mean, sd: sd / n.map_or(1.0, |n| f64::from(n.get()).sqrt()) }
    }
}

/// Weights of the misfit.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Weights {
    /// An error of one in a founder's mean rounds.
    pub rounds: f64,
    /// An error of one doubling in its terminal cells.
    pub terminal: f64,
    /// An error of 1 in χ.
    pub chi: f64,
}

impl Default for Weights {
    fn default() -> Weights {
        Weights { rounds: 1.0, terminal: 1.0, chi: 1.0 }
    }
}

/// Measurements that the fit does not use.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutOfSample {
    /// Their name.
    pub name: String,
    /// Volumes that replace those from divisions, as shares of the first cell's.
    #[serde(deserialize_with = "volumes")]
    pub volumes: BTreeMap<String, f64>,
    /// What was measured.
    pub chi: Vec<MeasuredChi>,
}

/// Reads volumes by name, and refuses duplicate names.
fn volumes<'de, D: Deserializer<'de>>(deserializer: D) -> Result<BTreeMap<String, f64>, D::Error> {
    unique_map(deserializer, "volumes by the cell's name", |name| format!("the volume of {name} stands twice"))
}

/// The targets of a fit.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Fit")]
pub struct Targets {
    /// Constants searched for; empty for the fit of a cue.
    #[serde(default)]
    pub unknowns: Vec<Searched>,
    /// Founders with observed rounds and terminal cells that the fit should meet.
    #[serde(default)]
    pub founders: Vec<String>,
    /// Founders that divide into equal daughters.
    #[serde(default)]
    pub symmetric: Vec<String>,
    /// Measured size asymmetries.
    #[serde(default)]
    pub chi: Vec<MeasuredChi>,
    /// Weights of the misfit.
    #[serde(default)]
    pub weights: Weights,
    /// Published pitchfork thresholds.
    #[serde(default)]
    pub thresholds: Vec<Threshold>,
    /// The side on which the asymmetric branch lies at some of these thresholds.
    #[serde(default)]
    pub criticalities: Vec<GivenCriticality>,
    /// How cells are known to divide, as for `calibrate`.
    #[serde(default)]
    pub divisions: Vec<GivenDivision>,
    /// Measurements predicted with the fitted cue.
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

    /// Checks every value, and that the lineage has the named founders with their counts; errors name the file
    /// `source_name`.
    ///
    /// # Errors
    /// Names the field, its value and the allowed values.
    pub fn check(&self, source_name: &str, lineage: &Lineage) -> Result<(), InputError> {
        self.check_unknowns(source_name)?;
        self.check_statements(source_name)?;
        self.check_founders(source_name, lineage)?;
        self.check_measured(source_name, lineage)?;
        let Weights { rounds, terminal, chi } = self.weights;
        for (name, value) in [("rounds", rounds), ("terminal", terminal), ("chi", chi)] {
            let holds = value.is_finite() && value >= 0.0;
            InputError::require(holds, source_name, format!("weights.{name}"), value, "a finite number, 0 or above")?;
        }
        Ok(())
    }

    /// Refuses targets without a constant to search for, which a fit of constants needs.
    ///
    /// # Errors
    /// Names the file `source_name`.
    pub fn check_searched(&self, source_name: &str) -> Result<(), InputError> {
        InputError::require(!self.unknowns.is_empty(), source_name, "unknowns", "[]", "at least one constant")
    }

    fn check_unknowns(&self, source_name: &str) -> Result<(), InputError> {
        let require = |holds: bool, field: String, value: &dyn Display, allowed: &str| {
            InputError::require(holds, source_name, field, value, allowed)
        };
        for (k, Searched { parameter, from, to }) in self.unknowns.iter().enumerate() {
            let field = |name: &str| format!("unknowns[{k}].{name}");
            let searchable = !parameter.is_of_cue() && !matches!(parameter, Parameter::R0 | Parameter::Gain);
            let allowed = "a constant of the cortex or of the shell, the activity or epsilon; the gain follows from the thresholds";
            require(searchable, field("parameter"), parameter, allowed)?;
            let new = self.unknowns[..k].iter().all(|other| other.parameter != *parameter);
            require(new, field("parameter"), parameter, "named only once")?;
            for (name, value) in [("from", *from), ("to", *to)] {
                let allowed = parameter.validate(value).err();
                let holds = value > 0.0 && allowed.is_none();
                require(holds, field(name), &value, allowed.unwrap_or("a finite number above 0"))?;
            }
            require(to > from, field("to"), to, &format!("above from = {from}"))?;
        }
        Ok(())
    }

    /// Checks the thresholds and the divisions.
    fn check_statements(&self, source_name: &str) -> Result<(), InputError> {
        for (k, threshold) in self.thresholds.iter().enumerate() {
            threshold.check(source_name, &format!("thresholds[{k}]"))?;
        }
        for (k, GivenCriticality { r0, epsilon, .. }) in self.criticalities.iter().enumerate() {
            let known = self.thresholds.iter().any(|t| [t.r0, t.epsilon] == [*r0, *epsilon]);
            let (field, value) = (format!("criticalities[{k}].r0"), format!("{r0} at epsilon = {epsilon}"));
            InputError::require(known, source_name, field, value, "a cell of one of the thresholds")?;
        }
        for (k, given) in self.divisions.iter().enumerate() {
            given.check(source_name, &format!("divisions[{k}]"))?;
        }
        Ok(())
    }

    /// Checks the founders that are fitted and those that divide equally.
    fn check_founders(&self, source_name: &str, lineage: &Lineage) -> Result<(), InputError> {
        for (list, names) in [("founders", &self.founders), ("symmetric", &self.symmetric)] {
            for (k, name) in names.iter().enumerate() {
                let (field, value) = (format!("{list}[{k}]"), format!("{name:?}"));
                InputError::require(!names[..k].contains(name), source_name, field, value, "named only once")?;
            }
        }
        for (k, name) in self.founders.iter().enumerate() {
            let field = format!("founders[{k}]");
            let observed = founder(source_name, &field, lineage, name)?.observed;
            let counted = observed.is_some_and(|o| o.mean.is_some() && o.terminal.is_some_and(|n| n > 0));
            let allowed = "a founder with observed mean rounds and terminal cells";
            InputError::require(counted, source_name, field, format!("{name:?}"), allowed)?;
        }
        for (k, name) in self.symmetric.iter().enumerate() {
            founder(source_name, &format!("symmetric[{k}]"), lineage, name)?;
        }
        Ok(())
    }

    /// Checks what was measured, in the fit and outside it.
    fn check_measured(&self, source_name: &str, lineage: &Lineage) -> Result<(), InputError> {
        let require = |holds: bool, field: String, value: f64, allowed: &str| {
            InputError::require(holds, source_name, field, value, allowed)
        };
        let others = self.out_of_sample.iter().flat_map(|out| &out.chi).map(|chi| ("out_of_sample.chi", chi));
        for (list, MeasuredChi { cell, mean, sd }) in self.chi.iter().map(|chi| ("chi", chi)).chain(others) {
            founder(source_name, &format!("{list}.cell"), lineage, cell)?;
            let fine = *mean >= 0.0 && *mean < 1.0;
            require(fine, format!("{list}.mean of {cell}"), *mean, "from 0 to 1, 1 excluded")?;
            let positive = sd.is_finite() && *sd > 0.0;
            require(positive, format!("{list}.sd of {cell}"), *sd, "a finite number above 0")?;
        }
        for (name, share) in self.out_of_sample.iter().flat_map(|out| &out.volumes) {
            founder(source_name, "out_of_sample.volumes", lineage, name)?;
            let allowed = "a share of the first cell's volume, above 0 and below 1";
            require(*share > 0.0 && *share < 1.0, format!("out_of_sample.volumes of {name}"), *share, allowed)?;
        }
        Ok(())
    }

    /// Number of divisions that the constants of a cell contradict; one that cannot be computed is contradicted.
    ///
    /// # Errors
    /// [`SchedulerError`] if no worker can be started.
    pub fn contradicted(
        &self,
        cell: &Cell,
        numerics: Numerics,
        memo: &Memo,
        cancel: &AtomicBool,
    ) -> Result<usize, SchedulerError> {
        if self.divisions.is_empty() {
            return Ok(0);
        }
        let inputs = self.divisions.iter().map(|given| DivisionInput { cell: given.cell(cell), numerics, seed: 0 });
        let options = SchedulerOptions { threads: 1, interrupt: Some(cancel), ..SchedulerOptions::default() };
        let found = scheduler::solve_all(inputs, memo, &options, solve)?.divisions;
        let contradicted = |(given, found): &(&GivenDivision, &Option<_>)| {
            found.as_ref().is_none_or(|division| given.contradiction(division).is_some())
        };
        Ok(self.divisions.iter().zip(&found).filter(contradicted).count())
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

    /// The place of a cell's constants in the unit cube; outside of it if they are beyond the limits.
    pub(crate) fn place_of(&self, cell: &Cell) -> Vec<f64> {
        let share = |u: &Searched| (u.parameter.get(cell) / u.from).ln() / (u.to / u.from).ln();
        self.unknowns.iter().map(share).collect()
    }
}

/// The founder of a name; errors name the file `source_name` and the field.
fn founder<'a>(source_name: &str, field: &str, lineage: &'a Lineage, name: &str) -> Result<&'a Founder, InputError> {
    let names = || lineage.founders.iter().map(|founder| founder.name.as_str());
    lineage.founder_named(name).map(|founder| &lineage.founders[founder]).ok_or_else(|| {
        let (all, nearest) = (names().collect::<Vec<_>>().join(", "), did_you_mean(name, names()));
        let allowed = format!("a founder of {}: {all}{nearest}", lineage.name);
        InputError::not_allowed(source_name, field, format!("{name:?}"), allowed)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use furrow_cell::settings::Settings;
    use furrow_lineage::batch::Quantisation;

    #[test]
    fn a_volume_that_is_given_twice_is_refused() {
        let text = EMBRYO.replacen("volumes: {", r#"volumes: {"P1": 0.2, "P1": 0.3, "#, 1);
        let error = parse_document::<Targets>(&text, "t.ron", "a file of targets", "Fit").unwrap_err().to_string();
        assert!(error.ends_with(r#"the volume of "P1" stands twice"#), "{error}");
    }

    /// The mean of n embryos has the error sd/√n.
    #[test]
    fn the_number_of_embryos_divides_the_variance() {
        let text = r#"Fit(chi: [(cell: "P0", mean: 0.18, sd: 0.06, n: 9), (cell: "P1", mean: 0.17, sd: 0.06)])"#;
        let targets = parse_document::<Targets>(text, "t.ron", "a file of targets", "Fit").unwrap();
        assert_eq!([targets.chi[0].sd, targets.chi[1].sd], [0.02, 0.06]);
        let none = parse_document::<Targets>(&text.replace("n: 9", "n: 0"), "t.ron", "a file of targets", "Fit");
        assert!(none.is_err());
    }

    /// A zygote without a cue divides equally in embryos: one preset says so too, the other contradicts it.
    #[test]
    fn the_statement_of_a_zygote_without_a_cue_excludes_constants() {
        let with = |statement: &str| {
            let text = EMBRYO.replacen("    weights:", &format!("    divisions: [{statement}],\n    weights:"), 1);
            parse_document::<Targets>(&text, "t.ron", "a file of targets", "Fit").unwrap()
        };
        let lineage = Lineage::c_elegans().unwrap();
        let targets = with("(r0: 5.4, outcome: symmetric)");
        targets.check("t.ron", &lineage).unwrap();
        let contradicted = ["gao2026", "gao2026-thresholds"].map(|preset| {
            let Settings { cell, numerics, .. } = Settings::load(preset, None, None, &[]).unwrap();
            targets.contradicted(&cell, numerics, &Memo::new(Quantisation::DEFAULT), &false.into()).unwrap()
        });
        assert_eq!(contradicted, [0, 1]);
        let refusal = with("(r0: 5.4)").check("t.ron", &lineage).unwrap_err().to_string();
        assert_eq!(refusal, "t.ron: divisions[0].outcome = (none): must be given, unless furrow is");
    }
}
