//! Reads and checks a sweep file: every axis known and given once, every value allowed by itself, not too many points.

use super::points::{Axes, Axis, AxisValue, Target};
use super::sample::{MOST_AXES, halton};
use super::sweep::{Kind, Sweep};
use furrow_cell::settings::{self, NumericsOverrides, Overrides, PhysicsOverrides, Settings, canonical_name};
use furrow_cell::{Cue, Parameter};
use furrow_input::{InputError, did_you_mean, listed, parse_document, read_text, shown};
use furrow_lineage::batch::phase::spaced;
use furrow_lineage::{Length, Lineage};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Most divisions, trees or shapes of one sweep.
const MOST_POINTS: usize = 10_000_000;

/// Most values of all axes together: all are held in memory.
const MOST_VALUES: usize = 20_000_000;

/// The file as written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "Sweep")]
struct Document {
    kind: Kind,
    axes: Vec<AxisDocument>,
    cue: Option<String>,
    #[serde(default = "one")]
    replicates: u32,
    #[serde(default)]
    seed: u64,
    #[serde(default)]
    physics: PhysicsOverrides,
    #[serde(default)]
    numerics: NumericsOverrides,
    lineage: Option<PathBuf>,
}

fn one() -> u32 {
    1
}

/// An axis as written, with exactly one of the three.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "Axis")]
struct AxisDocument {
    parameter: String,
    range: Option<Interval>,
    list: Option<Vec<AxisValue>>,
    sample: Option<Interval>,
}

/// A given number of values between two ends, which are included if the values are evenly spaced.
#[derive(Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
struct Interval {
    from: Length,
    to: Length,
    count: usize,
}

/// A sweep over lists of values.
#[derive(Clone, Debug)]
pub struct ListedSweep {
    /// The kind of computation.
    pub kind: Kind,
    /// Parameters with their values; the first varies slowest.
    pub axes: Vec<(String, Vec<AxisValue>)>,
    /// The cue, as users write it.
    pub cue: Option<String>,
    /// Divisions at each point.
    pub replicates: u32,
    /// Seed of the first of them.
    pub seed: u64,
    /// The file of the lineage of trees, which also names cues; the built-in one by default.
    pub lineage: Option<PathBuf>,
}

impl Sweep {
    /// Reads and checks a sweep file. `base` gives the parameters that the file does not set; `overrides` replace the file's parameters,
    /// but not its axes. A lineage is looked for from the file's own folder.
    ///
    /// # Errors
    /// Names the file, the field, its value and the allowed values.
    pub fn read(path: &Path, base: &Settings, overrides: &Overrides) -> Result<Sweep, InputError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        Sweep::parse_in(folder, &read_text(path)?, &path.display().to_string(), base, overrides)
    }

    /// Reads and checks a sweep from RON text, as [`read`](Self::read) does; errors name it `file`.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(text: &str, file: &str, base: &Settings, overrides: &Overrides) -> Result<Sweep, InputError> {
        Sweep::parse_in(Path::new(""), text, file, base, overrides)
    }

    /// A sweep over lists of values, like a file without ranges and samples; errors call it `source_name`.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn over(lists: ListedSweep, source_name: &str, base: &Settings, set: &Overrides) -> Result<Sweep, InputError> {
        let ListedSweep { kind, axes, cue, replicates, seed, lineage } = lists;
        let listed = |(parameter, list)| AxisDocument { parameter, list: Some(list), range: None, sample: None };
        let axes = axes.into_iter().map(listed).collect();
        let (physics, numerics) = Default::default();
        let document = Document { kind, axes, cue, replicates, seed, physics, numerics, lineage };
        Sweep::of(document, Path::new(""), source_name, base, set)
    }

    fn parse_in(folder: &Path, text: &str, file: &str, base: &Settings, set: &Overrides) -> Result<Sweep, InputError> {
        let document: Document = parse_document(text, file, "a sweep file", "Sweep")?;
        Sweep::of(document, folder, file, base, set)
    }

    fn of(
        mut document: Document,
        folder: &Path,
        file: &str,
        base: &Settings,
        set: &Overrides,
    ) -> Result<Sweep, InputError> {
        let path = document.lineage.take().map(|path| folder.join(path));
        let mut lineage = Lineage::load(path.as_deref())?;
        let mut settings = base.clone();
        settings.apply_physics(&document.physics, file)?;
        if settings.cell.r0 != base.cell.r0 || set.pairs.iter().any(|(name, _)| *name == "r0") {
            lineage.forget_first_radius();
        }
        if document.kind == Kind::Tree {
            let of_file = |parameter: &Parameter| (file, parameter.name(), parameter.get(&settings.cell).to_string());
            let changed = |parameter: &&Parameter| parameter.get(&settings.cell) != parameter.get(&base.cell);
            let of_set = set.pairs.iter().map(|(name, value)| (set.source_name, *name, value.to_string()));
            Lineage::check_taken(&[&lineage], Parameter::ALL.iter().filter(changed).map(of_file).chain(of_set))?;
        }
        settings.apply_numerics(&document.numerics);
        settings.check_fields(file)?;
        let in_units =
            |(name, value): &(&'static str, AxisValue)| (*name, lineage.units().natural(name, value.clone()));
        let pairs = set.pairs.iter().map(in_units).collect();
        settings.override_fields(&Overrides { pairs, ..*set })?;
        Check { file, document: &document, settings: &settings, lineage: &lineage }.run()
    }
}

/// A sweep file to check, with the inputs of the check.
struct Check<'a> {
    /// The file's name in errors.
    file: &'a str,
    document: &'a Document,
    /// Settings that no axis changes.
    settings: &'a Settings,
    /// The lineage that names cues.
    lineage: &'a Lineage,
}

impl Check<'_> {
    /// The sweep, if all of it is allowed.
    fn run(&self) -> Result<Sweep, InputError> {
        let document = self.document;
        self.most_values()?;
        let mut axes: Vec<Axis> = Vec::new();
        for (k, given) in document.axes.iter().enumerate() {
            let target = self.target(k, given, &axes)?;
            let sampled = axes.iter().filter(|axis| axis.sampled).count();
            let values = self.values((k, target), given, sampled)?;
            let mut axis =
                Axis { name: given.parameter.clone(), target, values, cues: vec![], sampled: given.sample.is_some() };
            self.sampled_alike(k, &axis, &axes)?;
            self.allowed(k, given, &mut axis)?;
            axes.push(axis);
        }
        let cue = document.cue.as_ref().map(|text| self.cue("cue", text)).transpose()?;
        let sweep = Sweep {
            file: self.file.to_owned(),
            kind: document.kind,
            axes: Axes(axes),
            settings: self.settings.clone(),
            cue,
            replicates: document.replicates,
            seed: document.seed,
            lineage: self.lineage.clone(),
        };
        self.cue_numbers(&sweep)?;
        self.counts(&sweep)?;
        self.first_point(&sweep)?;
        Ok(sweep)
    }

    fn refuse<T>(&self, field: String, value: impl ToString, allowed: impl Into<String>) -> Result<T, InputError> {
        Err(InputError::not_allowed(self.file, field, value, allowed))
    }

    fn require(
        &self,
        holds: bool,
        field: impl Into<String>,
        value: impl ToString,
        allowed: &str,
    ) -> Result<(), InputError> {
        InputError::require(holds, self.file, field, value, allowed)
    }

    /// Refuses more values than there may be points, before any of them is made.
    fn most_values(&self) -> Result<(), InputError> {
        let listed_values = |axis: &AxisDocument| axis.list.as_ref().map_or(0, Vec::len);
        let of = |axis: &AxisDocument| axis.range.or(axis.sample).map_or(listed_values(axis), |given| given.count);
        let counts: Vec<usize> = self.document.axes.iter().map(of).collect();
        let all = counts.iter().fold(0, |sum: usize, count| sum.saturating_add(*count));
        let counts: Vec<String> = counts.iter().map(usize::to_string).collect();
        let counts = listed(counts.iter().map(String::as_str), " + ");
        self.require(all <= MOST_VALUES, "axes", counts, &format!("axes of {MOST_VALUES} values at most, all together"))
    }

    /// What an axis sets, which no axis before it does.
    fn target(&self, k: usize, given: &AxisDocument, before: &[Axis]) -> Result<Target, InputError> {
        let name = given.parameter.as_str();
        let target = match (name, name.parse()) {
            ("cue", _) => Some(Target::Cue),
            ("seed", _) => Some(Target::Seed),
            (_, Ok(parameter @ (Parameter::Cue { .. } | Parameter::Regulator(_)))) => {
                Some(Target::CueNumber(parameter))
            }
            _ => canonical_name(name).ok().map(Target::Field),
        };
        let field = || format!("axes[{k}].parameter");
        let has_seeds = matches!(self.document.kind, Kind::Division | Kind::Tree);
        if name == "seed" && !has_seeds {
            let allowed = "another parameter: only divisions and trees have an axis of seeds";
            return self.refuse(field(), shown(name), allowed);
        }
        let Some(target) = target else {
            let seed = has_seeds.then_some("seed");
            let known: Vec<&str> = settings::names().chain(seed).chain(["cue"]).chain(Parameter::OF_CUES).collect();
            let nearest = did_you_mean(name, known.iter().copied());
            return self.refuse(field(), shown(name), format!("one of {}{nearest}", known.join(", ")));
        };
        let searched = match self.document.kind {
            Kind::Pitchfork if target == Target::Field("xi_b") => {
                Some(("xi_b", "pitchforks are searched for along ξ_s with a fixed ratio ξ_b/ξ_s: use xi_ratio"))
            }
            Kind::Pitchfork => Some(("xi_s", "pitchforks are searched for along ξ_s")),
            Kind::Critical => Some(("r0", "critical radii are searched for along R0")),
            Kind::Division | Kind::Tree => None,
        };
        if let Some((_, why)) = searched.filter(|(name, _)| target == Target::Field(name)) {
            return self.refuse(field(), shown(name), format!("another parameter: {why}"));
        }
        if let Some(first) = before.iter().position(|axis| axis.target == target) {
            return self.refuse(field(), shown(name), format!("a parameter of one axis, and axes[{first}] has it"));
        }
        if let Some(first) = before.iter().position(|axis| axis.target.number() == target.number()) {
            let allowed =
                format!("a parameter that no other axis sets, and axes[{first}] = {} does", before[first].name);
            return self.refuse(field(), shown(name), allowed);
        }
        if let (Kind::Tree, Target::Field(of)) = (self.document.kind, target)
            && let Some(allowed) = Lineage::allowed_of_run([self.lineage], of)
        {
            return self.refuse(field(), shown(name), allowed);
        }
        Ok(target)
    }

    /// The values of an axis; `sampled` axes before it are.
    fn values(
        &self,
        (k, target): (usize, Target),
        given: &AxisDocument,
        sampled: usize,
    ) -> Result<Vec<AxisValue>, InputError> {
        let AxisDocument { parameter, range, list, sample } = given;
        let given = [range.is_some(), list.is_some(), sample.is_some()].into_iter().filter(|given| *given).count();
        self.require(given == 1, format!("axes[{k}]"), shown(parameter), "given with one of range, list, sample")?;
        let Some(Interval { from, to, count }) = range.or(*sample) else {
            let units = self.lineage.units();
            let natural = |value: &AxisValue| match target {
                Target::Field(name) => units.natural(name, value.clone()),
                _ => value.clone(),
            };
            let list: Vec<AxisValue> = list.iter().flatten().map(natural).collect();
            self.require(!list.is_empty(), format!("axes[{k}].list"), "[]", "a list of one value at least")?;
            return Ok(list);
        };
        let of = if range.is_some() { "range" } else { "sample" };
        let end = |name: &str, value: Length| {
            let is_radius = target == Target::Field("r0");
            let natural = value.in_units(&self.lineage.units());
            let fine = natural.is_finite() && (is_radius || matches!(value, Length::Natural(_)));
            let allowed = if is_radius { "a finite number, or one of µm as in \"17um\"" } else { "a finite number" };
            self.require(fine, format!("axes[{k}].{of}.{name}"), value, allowed)?;
            Ok::<f64, InputError>(natural)
        };
        let (from, to) = (end("from", from)?, end("to", to)?);
        let allowed = format!("a whole number from 1 to {MOST_POINTS}");
        self.require((1..=MOST_POINTS).contains(&count), format!("axes[{k}].{of}.count"), count, &allowed)?;
        if range.is_some() {
            let allowed = format!("2 at least where from and to differ; of one value write list: [{from}]");
            self.require(count > 1 || from == to, format!("axes[{k}].{of}.count"), count, &allowed)?;
            let values = spaced(from, to, count).into_iter().map(|value| rounded(value, [from, to]));
            return Ok(values.map(AxisValue::Number).collect());
        }
        let allowed = format!("one of {MOST_AXES} samples at most");
        self.require(sampled < MOST_AXES, format!("axes[{k}].sample"), "(…)", &allowed)?;
        let unit = halton(sampled, self.document.seed, count);
        Ok(unit.into_iter().map(|x| AxisValue::Number(from + (to - from) * x)).collect())
    }

    /// Sampled axes are one axis of points, and so have one count.
    fn sampled_alike(&self, k: usize, axis: &Axis, before: &[Axis]) -> Result<(), InputError> {
        let Some(first) = before.iter().position(|axis| axis.sampled).filter(|_| axis.sampled) else { return Ok(()) };
        let (count, wanted) = (axis.values.len(), before[first].values.len());
        let allowed = format!("{wanted}, the count of axes[{first}]: sampled axes are sampled together");
        self.require(count == wanted, format!("axes[{k}].sample.count"), count, &allowed)
    }

    /// Checks each value of an axis, and reads the cues of an axis of cues.
    fn allowed(&self, k: usize, given: &AxisDocument, axis: &mut Axis) -> Result<(), InputError> {
        for (j, value) in axis.values.iter().enumerate() {
            let place = match (given.list.is_some(), given.range.is_some()) {
                (true, _) => format!("axes[{k}].list[{j}]"),
                (_, true) => format!("axes[{k}].range"),
                _ => format!("axes[{k}].sample"),
            };
            match (axis.target, value) {
                (Target::Cue, AxisValue::Text(text)) => axis.cues.push(self.cue(&place, text)?),
                (Target::Cue, _) => return self.refuse(place, value.text(), "a cue in quotes, as \"none\""),
                (Target::CueNumber(_), AxisValue::Text(text)) => return self.refuse(place, shown(text), "a number"),
                (Target::CueNumber(_), _) => {}
                (Target::Seed, value) => {
                    let whole = matches!(value, AxisValue::Number(seed) if seed.fract() == 0.0 && (0.0..=2f64.powi(53)).contains(seed));
                    self.require(whole, place, value.text(), "a whole number from 0 to 9007199254740992")?;
                }
                (Target::Field(name), value) => self.field_value(&format!("{place} ({name})"), name, value)?,
            }
        }
        Ok(())
    }

    fn field_value(&self, place: &str, name: &'static str, value: &AxisValue) -> Result<(), InputError> {
        let written = match value {
            AxisValue::Number(number) => number.to_string(),
            AxisValue::Text(text) => shown(text),
        };
        let quoted = matches!(value, AxisValue::Text(text) if text.parse::<f64>().is_ok());
        self.require(!quoted, place, &written, "a number without quotes")?;
        let mut trial = self.settings.clone();
        let allowed = match trial.assign(self.file, &[(name, value.clone())]) {
            Err(InputError::NotAllowed { allowed, .. }) => Some(allowed),
            Err(other) => return Err(other),
            Ok(()) => trial.validate(name).err().map(str::to_owned),
        };
        allowed.map_or(Ok(()), |allowed| self.refuse(place.to_owned(), written, allowed))
    }

    fn cue(&self, place: &str, text: &str) -> Result<Cue, InputError> {
        self.lineage.parse_cue(text).map_err(|error| {
            let field = if error.field == "cue" { place.to_owned() } else { format!("{place}: {}", error.field) };
            InputError::not_allowed(self.file, field, error.value, error.allowed)
        })
    }

    /// Axes over numbers of a cue need cues that have them.
    fn cue_numbers(&self, sweep: &Sweep) -> Result<(), InputError> {
        let Axes(axes) = &sweep.axes;
        let cues: Vec<Cue> = match axes.iter().find(|axis| axis.target == Target::Cue) {
            Some(axis) => axis.cues.clone(),
            None => vec![sweep.cue.clone().unwrap_or_default()],
        };
        for (k, axis) in axes.iter().enumerate() {
            let Target::CueNumber(parameter) = axis.target else { continue };
            for cue in &cues {
                let mut cell = sweep.settings.cell.clone().with_cue(cue.clone());
                if !parameter.is_of(&cell) {
                    let mut allowed = Parameter::allowed_of_cue(cue);
                    if *cue == Cue::none() {
                        allowed += ": see cue";
                    }
                    return self.refuse(format!("axes[{k}].parameter"), shown(&axis.name), allowed);
                }
                for value in &axis.values {
                    let AxisValue::Number(number) = value else { continue };
                    parameter.set(&mut cell, *number);
                    if let Err(error) = cell.cue.check() {
                        let field = format!("axes[{k}]: {}", error.field);
                        return self.refuse(field, error.value, error.allowed);
                    }
                }
            }
        }
        Ok(())
    }

    fn counts(&self, sweep: &Sweep) -> Result<(), InputError> {
        let replicates = sweep.replicates;
        let fine = replicates == 1 || (replicates > 1 && sweep.kind == Kind::Division);
        self.require(fine, "replicates", replicates, "1, or of divisions more")?;
        let all = sweep.axes.points().and_then(|points| points.checked_mul(replicates as usize));
        let counts: Vec<String> = sweep.axes.0.iter().map(|axis| axis.values.len().to_string()).collect();
        let allowed = format!("axes that span {MOST_POINTS} points at most, replicates included");
        self.require(all.is_some_and(|all| all <= MOST_POINTS), "axes", counts.join(" × "), &allowed)
    }

    /// Refuses a sweep if all its points are invalid, whatever the values of its axes: one error is clearer than one per point.
    fn first_point(&self, sweep: &Sweep) -> Result<(), InputError> {
        let without_axes = Sweep { axes: Axes::default(), ..sweep.clone() };
        let fine = |sweep: &Sweep, index| sweep.checked(index).1.is_ok();
        if fine(&without_axes, 0) || (1..sweep.points()).any(|index| fine(sweep, index)) {
            return Ok(());
        }
        sweep.checked(0).1
    }
}

/// A value of a range without rounding noise in its last digits, 1.7 for 1.7000000000000002, as a list would have it. The ends
/// stay as they were given.
fn rounded(value: f64, ends: [f64; 2]) -> f64 {
    if ends.contains(&value) { value } else { format!("{value:.12e}").parse().unwrap_or(value) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_hold_the_numbers_that_one_would_write() {
        let ends = [1.6, 5.4];
        let values: Vec<f64> = spaced(1.6, 5.4, 39).into_iter().map(|value| rounded(value, ends)).collect();
        let written: Vec<f64> =
            (16..=54).map(|tenths: i32| format!("{}.{}", tenths / 10, tenths % 10).parse().unwrap()).collect();
        assert_eq!(values, written);
        assert_ne!(spaced(1.6, 5.4, 39), written);
        assert_eq!(rounded(1.0 / 3.0, [1.0 / 3.0, 1.0]), 1.0 / 3.0);
    }
}
