//! Sets of constants as a table: one row a set, columns by the names of parameters, `PARAMETER` or `PARAMETER@CLASS` for a class of
//! cells, and their weights.

use super::table::csv_of;
use furrow_cell::parameter::UnknownParameter;
use furrow_cell::settings::number_set_by;
use furrow_cell::{Cell, Cue, Parameter};
use furrow_input::table::{Row, Table, malformed, text as text_of};
use furrow_input::{InputError, did_you_mean, shown};
use furrow_lineage::{Founder, FounderPhysics, Lineage, TreeSettings};
use std::fmt::Display;

/// Classes of cells beside the founders' names: the first cell and, from mother to daughter, the founders that are the smaller
/// daughter; and all others.
pub(crate) const GERMLINE: &str = "germline";
pub(crate) const SOMATIC: &str = "somatic";
/// In place of a class: the standard deviation of a parameter between embryos.
pub(crate) const EMBRYO: &str = "embryo";

/// The kind of a constant or of a fitted number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConstantKind {
    /// A parameter of cells; a number of a cue belongs to every cue of the lineage that has it.
    Parameter(Parameter),
    /// Volume at division divided by volume at birth.
    Growth,
}

/// The name of [`ConstantKind::Growth`].
pub(crate) const GROWTH: &str = "growth";

impl ConstantKind {
    /// The parameter of cells, if it is one.
    pub fn parameter(self) -> Option<Parameter> {
        match self {
            ConstantKind::Parameter(parameter) => Some(parameter),
            ConstantKind::Growth => None,
        }
    }

    /// Whether it is a number of a cue.
    pub fn is_of_cue(self) -> bool {
        self.parameter().is_some_and(Parameter::is_of_cue)
    }

    /// Checks a value.
    ///
    /// # Errors
    /// The allowed values.
    pub fn validate(self, value: f64) -> Result<(), &'static str> {
        match self {
            ConstantKind::Parameter(parameter) => parameter.validate(value),
            ConstantKind::Growth if Founder::GROWTH.contains(&value) => Ok(()),
            ConstantKind::Growth => Err("a number from 0.01 to 100"),
        }
    }
}

impl std::fmt::Display for ConstantKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            ConstantKind::Parameter(parameter) => parameter.fmt(f),
            ConstantKind::Growth => f.write_str(GROWTH),
        }
    }
}

impl std::str::FromStr for ConstantKind {
    type Err = UnknownParameter;

    fn from_str(text: &str) -> Result<ConstantKind, UnknownParameter> {
        if text == GROWTH { Ok(ConstantKind::Growth) } else { text.parse().map(ConstantKind::Parameter) }
    }
}

/// A constant of all cells, or of a class of cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Constant {
    /// Its kind.
    pub kind: ConstantKind,
    /// The class: `germline`, `somatic` or a founder; `None` for all cells.
    pub class: Option<String>,
    /// Its value.
    pub value: f64,
}

impl Constant {
    /// Its name, as `epsilon` or `epsilon@somatic`.
    pub fn name(&self) -> String {
        named(self.kind, self.class.as_deref())
    }
}

/// The name of a number of a class of cells.
pub(crate) fn named(kind: ConstantKind, class: Option<&str>) -> String {
    class.map_or_else(|| kind.to_string(), |class| format!("{kind}@{class}"))
}

/// A set of constants with its share of the whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Constants {
    /// The constants.
    pub values: Vec<Constant>,
    /// Its weight; 1 if the table has no weights.
    pub weight: f64,
}

impl Constants {
    /// Checks whether a lineage can have these constants; errors name the table `file`.
    ///
    /// # Errors
    /// Names the column.
    pub fn check(&self, lineage: &Lineage, file: &str) -> Result<(), InputError> {
        // The spread between embryos says nothing of the typical one.
        for constant in self.values.iter().filter(|constant| constant.class.as_deref() != Some(EMBRYO)) {
            let Constant { kind, class, .. } = constant;
            let founders = class.as_ref().map(|class| founders_of(class, lineage, file, "column")).transpose()?;
            let Some(parameter) = kind.parameter() else { continue };
            let (is_known, allowed) = match parameter.is_of_cue() {
                true => {
                    let has = |cue: &Cue| parameter.is_of(&Cell::new(1.0).with_cue(cue.clone()));
                    let own = |k: &usize| lineage.founders[*k].cue.as_deref().and_then(|name| lineage.cue(name));
                    let is_known = match &founders {
                        None => lineage.cues.values().any(has),
                        Some(founders) => founders.iter().filter_map(own).any(|cue| has(&cue)),
                    };
                    (
                        is_known,
                        "a number of a cue of the lineage, of a class of cells one that its founders name: choose the cue by --cue",
                    )
                }
                false => {
                    (founders.is_none() || FounderPhysics::can_have(parameter), "a parameter that founders can have")
                }
            };
            InputError::require(is_known, file, "column", shown(&constant.name()), allowed)?;
            let of_class = founders.unwrap_or_else(|| (0..lineage.founders.len()).collect());
            let acts = !of_class.iter().all(|k| lineage.rules_replace(*k, parameter));
            let allowed = "a parameter that physics_rules do not set in all of its cells";
            InputError::require(acts, file, "column", shown(&constant.name()), allowed)?;
        }
        Ok(())
    }

    /// Refuses a setting of a parameter that the constants set in all cells, and would override. `given` are the settings by option or
    /// other source, [canonical name](furrow_cell::settings::canonical_name) and value; errors name the source and the table `file`.
    ///
    /// # Errors
    /// Names the source, the parameter and its value.
    pub fn check_given<V: Display>(
        &self,
        file: &str,
        given: impl IntoIterator<Item = (&'static str, &'static str, V)>,
    ) -> Result<(), InputError> {
        let of_all = self.values.iter().filter(|constant| constant.class.is_none());
        let columns: Vec<&str> = of_all.filter_map(|constant| constant.kind.parameter()).map(Parameter::name).collect();
        for (source, name, value) in given {
            let column = number_set_by(name);
            let allowed = format!("left out where {file} has a column {column}, which sets it");
            InputError::require(!columns.contains(&column), source, name, value, allowed)?;
        }
        Ok(())
    }

    /// A lineage and the settings of its divisions with these constants, without those that the lineage cannot have. A founder's own
    /// value in the lineage file gives way to one of all cells.
    pub fn applied(&self, lineage: &Lineage, settings: &TreeSettings) -> (Lineage, TreeSettings) {
        let (mut lineage, mut settings) = (lineage.clone(), settings.clone());
        // A smaller class has the last word.
        let size = |class: &Option<String>| match class {
            None => usize::MAX,
            Some(class) => founders_of(class, &lineage, "", "").map_or(0, |founders| founders.len()),
        };
        let of_cells = |constant: &&Constant| constant.class.as_deref() != Some(EMBRYO);
        let mut values: Vec<&Constant> = self.values.iter().filter(of_cells).collect();
        values.sort_by_cached_key(|constant| std::cmp::Reverse(size(&constant.class)));
        for Constant { kind, class, value } in values {
            let Some(parameter) = kind.parameter() else {
                let founders = of_class(class.as_deref(), &lineage, |_| true);
                founders.into_iter().for_each(|k| lineage.founders[k].growth = Some(*value));
                continue;
            };
            if class.is_none() {
                if parameter == Parameter::R0 {
                    let first = lineage.given_r0(lineage.first()).unwrap_or(settings.cell.r0);
                    lineage.scale_radii(value / first);
                }
                parameter.set(&mut settings.cell, *value);
            }
            if parameter.is_of_cue() {
                if let Some(class) = class {
                    for founder in of_class(Some(class), &lineage, |_| false) {
                        lineage.set_own_cue(founder, parameter, *value);
                    }
                    continue;
                }
                for cue in lineage.cues.values_mut() {
                    let mut cell = Cell::new(1.0).with_cue(cue.clone());
                    parameter.set(&mut cell, *value);
                    *cue = cell.cue;
                }
                continue;
            }
            let founders = of_class(class.as_deref(), &lineage, |founder| founder.sets(parameter));
            founders.into_iter().for_each(|k| lineage.founders[k].physics.set(parameter, *value));
        }
        (lineage, settings)
    }
}

/// The founders of a class of cells. Without a class, all founders for which `has` is true.
fn of_class(class: Option<&str>, lineage: &Lineage, has: impl Fn(&Founder) -> bool) -> Vec<usize> {
    match class {
        Some(class) => founders_of(class, lineage, "", "").unwrap_or_default(),
        None => (0..lineage.founders.len()).filter(|k| has(&lineage.founders[*k])).collect(),
    }
}

/// The founders of a class of cells; errors name `field` of `source`.
///
/// # Errors
/// The class has no founder.
pub(crate) fn founders_of(class: &str, lineage: &Lineage, source: &str, field: &str) -> Result<Vec<usize>, InputError> {
    let germline = lineage.smaller_line();
    let founders: Vec<usize> = match class {
        GERMLINE => germline,
        SOMATIC => (0..lineage.founders.len()).filter(|founder| !germline.contains(founder)).collect(),
        name => lineage.founder_named(name).into_iter().collect(),
    };
    let names = || [GERMLINE, SOMATIC].into_iter().chain(lineage.founders.iter().map(|f| f.name.as_str()));
    let allowed = || {
        let nearest = did_you_mean(class, names());
        format!("a class of cells: {}{nearest}", names().collect::<Vec<_>>().join(", "))
    };
    if founders.is_empty() {
        return Err(InputError::not_allowed(source, field, format!("{class:?}"), allowed()));
    }
    Ok(founders)
}

/// The name of the column of weights.
const WEIGHT: &str = "weight";

/// The table as text; numbers with all their digits, so that reading gives the same numbers.
pub fn write_constants(sets: &[Constants]) -> String {
    let Some(first) = sets.first() else { return String::new() };
    let head = first.values.iter().map(Constant::name).chain([WEIGHT.to_owned()]).collect();
    let row = |set: &Constants| -> Vec<String> {
        set.values.iter().map(|constant| constant.value).chain([set.weight]).map(|number| number.to_string()).collect()
    };
    csv_of(std::iter::once(head).chain(sets.iter().map(row)))
}

/// Reads a table for a lineage; errors name it `file`.
///
/// # Errors
/// As [`read_constants`], and a constant that the lineage cannot have.
pub fn read_constants_of(text: &str, file: &str, lineage: &Lineage) -> Result<Vec<Constants>, InputError> {
    let sets = read_constants(text, file)?;
    if let Some(first) = sets.first() {
        first.check(lineage, file)?;
    }
    Ok(sets)
}

/// Reads a table; errors name it `file`. Lines that begin with `#` are passed over.
///
/// # Errors
/// Names the line, the column, its value and the allowed values.
pub fn read_constants(text: &str, file: &str) -> Result<Vec<Constants>, InputError> {
    let mut table = Table::open(text.as_bytes(), file)?;
    let (_, columns) = table.header(|_| false)?;
    let known: Vec<&str> = Parameter::ALL.iter().map(|parameter| parameter.name()).chain([GROWTH, WEIGHT]).collect();
    // Columns without a name have no values either.
    for (k, name) in columns.iter().enumerate().filter(|(_, name)| !name.is_empty()) {
        let kind = parsed(name).map(|(kind, _)| kind);
        let listed = |kind: ConstantKind| kind.parameter().is_none_or(|p| p.is_of_cue() || Parameter::ALL.contains(&p));
        let is_known = *name == WEIGHT || kind.is_some_and(listed);
        let allowed = format!(
            "one of {}, or a number of the cue such as cue.amplitude; all but weight also with @ and a class of cells{}",
            known.join(", "),
            did_you_mean(name, known.iter().copied())
        );
        InputError::require(is_known, file, format!("column {}", k + 1), shown(name), allowed)?;
        // A parameter has two names where one of them is short.
        let same = |other: &String| other == name || kind.is_some() && parsed(other) == parsed(name);
        let new = !columns[..k].iter().any(same);
        InputError::require(new, file, format!("column {}", k + 1), shown(name), "named once")?;
    }
    let mut out = Vec::new();
    while let Some(row) = table.next_row()? {
        if let Some((_, why)) = row.surplus() {
            return Err(malformed(file, row.line as usize, why));
        }
        out.push(constants(&columns, row).map_err(|(column, allowed)| {
            let value = text_of(row.text(column));
            InputError::not_allowed(format!("{file}:{}", row.line), &columns[column], shown(&value), allowed)
        })?);
    }
    InputError::require(!out.is_empty(), file, "rows", "(none)", "at least one set of constants")?;
    let all = out.iter().map(|set| set.weight).sum::<f64>();
    InputError::require(all > 0.0, file, WEIGHT, "0 in every row", "above 0 in some row")?;
    let allowed = "small enough that their sum is a finite number; only their ratios count";
    InputError::require(all.is_finite(), file, WEIGHT, "too large in all rows together", allowed)?;
    Ok(out)
}

/// The kind of the numbers in a column, and the class of cells.
fn parsed(name: &str) -> Option<(ConstantKind, Option<&str>)> {
    let (kind, class) = name.split_once('@').map_or((name, None), |(kind, class)| (kind, Some(class)));
    Some((kind.parse().ok()?, class))
}

/// Reads one set. An error is the column and the allowed values there.
fn constants(columns: &[String], row: Row<'_>) -> Result<Constants, (usize, String)> {
    let mut out = Constants { values: Vec::new(), weight: 1.0 };
    for (k, name) in columns.iter().enumerate().filter(|(_, name)| !name.is_empty()) {
        let value = row.number(k).map_err(|why| (k, format!("a number ({why})")))?;
        match parsed(name) {
            Some((kind, class)) => {
                kind.validate(value).map_err(|allowed| (k, allowed.to_owned()))?;
                out.values.push(Constant { kind, class: class.map(str::to_owned), value });
            }
            None if value >= 0.0 => out.weight = value,
            None => return Err((k, "a finite number, 0 or above".to_owned())),
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_all(parameter: Parameter, value: f64) -> Constant {
        Constant { kind: ConstantKind::Parameter(parameter), class: None, value }
    }

    /// An aspect ratio of all cells counts for a founder in a shell with a table too, which has its own.
    #[test]
    fn the_aspect_of_a_table_gives_way_to_that_of_all_cells() {
        let egg = r#"{ "name": "egg", "aspect": 1.4, "error": 0, "series": [1] }"#;
        let mut lineage = Lineage::c_elegans().unwrap();
        lineage.founders[1].shell_profile = Some(serde_json::from_str(egg).unwrap());
        let sets = read_constants("aspect\n1.3\n", "c.csv").unwrap();
        let (found, settings) = sets[0].applied(&lineage, &TreeSettings::default());
        let aspect = |founder: usize| found.founders[founder].physics.aspect;
        assert_eq!((aspect(1), aspect(2), settings.cell.shell.aspect), (Some(1.3), None, 1.3));
    }

    /// A posterior's columns: numbers of a class are set in its founders, numbers of a cue in every cue that has them.
    #[test]
    fn classes_and_cues_have_constants_of_their_own() {
        let sets = read_constants("epsilon@somatic,cue[0].amplitude,xi_s,weight\n0.8,0.2,24,1\n", "c.csv").unwrap();
        assert_eq!(read_constants(&write_constants(&sets), "c.csv").unwrap(), sets);
        // A constant of one class may also be given for the other cells.
        sets[0].check_given("c.csv", [("--epsilon", "epsilon", 0.7), ("--set", "p0", 0.1)]).unwrap();
        let mut lineage = Lineage::c_elegans().unwrap();
        lineage.founders[0].physics.set(Parameter::XiS, 30.0);
        sets[0].check(&lineage, "c.csv").unwrap();
        let (found, settings) = sets[0].applied(&lineage, &TreeSettings::default());
        let of = |name: &str| &found.founders[found.founder_named(name).unwrap()].physics;
        assert_eq!((of("AB").epsilon, of("P1").epsilon, settings.cell.xi_s), (Some(0.8), None, 24.0));
        assert_eq!(found.founders[0].physics.xi_s, Some(24.0));
        assert!(found.cues["germline"].to_string().contains("amplitude=0.2"));
        let refused = |text: &str| read_constants_of(text, "c.csv", &lineage).unwrap_err().to_string();
        // Growth is a founder's own, of all of them or of a class.
        let sets = read_constants_of("growth@somatic,growth\n1.5,1.2\n", "c.csv", &lineage).unwrap();
        assert_eq!(read_constants(&write_constants(&sets), "c.csv").unwrap(), sets);
        let (found, _) = sets[0].applied(&lineage, &TreeSettings::default());
        let growth = |name: &str| found.growth(found.founder_named(name).unwrap());
        assert_eq!((growth("AB"), growth("P1")), (1.5, 1.2));
        assert_eq!(refused("growth\n200\n"), "c.csv:2: growth = \"200\": must be a number from 0.01 to 100");
        assert!(refused("epsilon@somatc\n0.8\n").ends_with("did you mean somatic?"));
        assert!(refused("cue[3].u0\n0.4\n").contains("a number of a cue of the lineage"));
        // A smaller class has the last word, in any order; a number of a cue of a class belongs to its founders alone.
        let text = "epsilon@E,epsilon@somatic,epsilon,cue[0].amplitude@P2,cue[0].amplitude\n0.7,0.8,0.85,0.3,0.2\n";
        let sets = read_constants_of(text, "c.csv", &lineage).unwrap();
        let (found, settings) = sets[0].applied(&lineage, &TreeSettings::default());
        let of = |name: &str| found.founders[found.founder_named(name).unwrap()].clone();
        assert_eq!(
            (of("E").physics.epsilon, of("AB").physics.epsilon, settings.cell.epsilon),
            (Some(0.7), Some(0.8), 0.85)
        );
        assert_eq!((of("P2").cue.as_deref(), of("P1").cue.as_deref()), (Some("germline@P2"), Some("germline")));
        assert!(found.cues["germline@P2"].to_string().contains("amplitude=0.3"));
        assert!(found.cues["germline"].to_string().contains("amplitude=0.2"));
        assert!(refused("cue[0].amplitude@AB\n0.4\n").contains("one that its founders name"));
        assert!(refused("r0@AB\n2\n").contains("a parameter that founders can have"));
    }

    #[test]
    fn written_values_are_read_back() {
        let set = |aspect: f64, weight: f64| Constants {
            values: vec![of_all(Parameter::Aspect, aspect), of_all(Parameter::P0, 0.1 + 0.2)],
            weight,
        };
        let sets = [set(1.5, 0.25), set(1.0 / 3.0, 0.75)];
        assert_eq!(read_constants(&write_constants(&sets), "c.csv").unwrap(), sets);
    }

    #[test]
    fn tables_of_other_programs_are_read() {
        let plain = read_constants("aspect,weight\n1.5,1\n2,3\n", "c.csv").unwrap();
        for text in [
            "Unnamed: 0,aspect,weight\n0,1.5,1\n1,2,3\n",
            "aspect;weight;\n1,5;1;\n;;\n2;3;\n",
            "# by hand\naspect\tweight\n1,5\t1\n2\t3\n",
        ] {
            assert_eq!(read_constants(text, "c.csv").unwrap(), plain, "{text}");
        }
    }

    #[test]
    fn errors_name_the_fault() {
        let complaint = |text: &str| read_constants(text, "c.csv").unwrap_err().to_string();
        assert!(complaint("aspect,gian\n1,2\n").ends_with("; did you mean gain?"));
        assert_eq!(complaint("aspect,p0\n1.5\n"), "c.csv:2: p0 = \"\": must be a number (empty)");
        assert_eq!(complaint("aspect,p0\n1,5,2\n"), "c.csv:2:1: line 2 has 3 fields, the heading 2");
        assert!(
            complaint("aspect,weight\n1,1e308\n2,1e308\n")
                .starts_with("c.csv: weight = too large in all rows together")
        );
        assert_eq!(complaint("aspect\n-1\n"), "c.csv:2: aspect = \"-1\": must be a finite number above 0");
        assert_eq!(complaint("gain,p0,g\n1,1,1\n"), "c.csv: column 3 = \"g\": must be named once");
        assert_eq!(complaint("aspect\n"), "c.csv: rows = (none): must be at least one set of constants");
    }
}
