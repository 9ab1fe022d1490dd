//! A cell and how it is computed, every value checked.

use std::borrow::Cow;
use std::ffi::CString;
use std::path::{Path, PathBuf};

use furrow_analysis::compare::names_of;
use furrow_analysis::{Constants, Shard};
use furrow_cell::settings::{self, Overrides, SHELL_PROFILE, Settings, Value};
use furrow_cell::{Cell, Cue, CueError, Law, Numerics};
use furrow_input::{InputError, read_text, shown};
use furrow_lineage::{Length, Lineage};
use furrow_measured::matching::Matching;
use furrow_measured::names::Names;
use furrow_measured::per_embryo::PerEmbryo;
use furrow_mechanics::division::DivisionInput;
use furrow_mechanics::polarity::resolved;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyInt, PyString};
use serde::{Deserialize, Serialize};

use crate::document::Document;
use crate::errors::{ARGUMENTS, Error, wrong_type};

/// A text, or its file.
pub type Source = (Option<String>, Option<PathBuf>);

/// Tables: files, and one as text.
pub type Tables = (Vec<PathBuf>, Option<String>);

/// Whether there is no table.
pub fn is_empty((files, text): &Tables) -> bool {
    files.is_empty() && text.is_none()
}

/// A source's text, and what errors call it: the file, or `name`.
pub fn text_of(source: &Source, name: &str) -> Result<Option<(String, String)>, InputError> {
    Ok(match source {
        (Some(text), _) => Some((text.clone(), name.to_owned())),
        (None, Some(file)) => Some((read_text(file)?, file.display().to_string())),
        (None, None) => None,
    })
}

/// What [`positive`] allows of most arguments.
pub const ABOVE_0: &str = "a finite number above 0";

/// A finite number above 0; `allowed` is what errors say.
pub fn positive(field: &str, value: f64, allowed: &str) -> Result<f64, InputError> {
    InputError::require(value.is_finite() && value > 0.0, ARGUMENTS, field, value, allowed).map(|()| value)
}

/// Numbers of embryos by name; without a name of all others.
pub type OfEmbryos = Vec<(Option<String>, f64)>;

/// The numbers, each finite and above 0; `allowed` is what errors say.
pub fn of_embryos(field: &str, given: &OfEmbryos, allowed: &str) -> Result<PerEmbryo, InputError> {
    given.iter().try_for_each(|(_, value)| positive(field, *value, allowed).map(|_| ()))?;
    Ok(PerEmbryo::new(given.iter().cloned()))
}

/// What cells are called in tables: a table of names, and roots.
pub type MatchAsked = (Source, Vec<String>);

/// The names of a lineage's cells, to which others are matched.
pub fn matched_names(lineage: &Lineage, (table, roots): &MatchAsked) -> Result<Names, InputError> {
    let matching = match text_of(table, "names")? {
        Some((text, file)) => Matching::parse(&text, &file, roots, ARGUMENTS)?,
        None => Matching::read(None, roots, ARGUMENTS)?,
    };
    names_of(lineage).matched_by(matching)
}

/// Numbers by name as numpy arrays, which take over the memory of the vectors.
pub type Columns = Vec<(&'static str, Vec<f64>)>;

/// Columns as a dict of arrays.
pub fn arrays(py: Python<'_>, columns: Columns) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    columns.into_iter().try_for_each(|(name, values)| dict.set_item(name, fixed(PyArray1::from_vec(py, values))?))?;
    Ok(dict)
}

/// An array that cannot be written to: results do not change.
pub fn fixed<T>(array: Bound<'_, T>) -> PyResult<Bound<'_, T>> {
    array.as_any().call_method1("setflags", (false,))?;
    Ok(array)
}

/// Numbers and words by name, from a dict.
#[derive(Clone)]
pub struct Named(pub Vec<(String, Value)>);

impl<'py> FromPyObject<'_, 'py> for Named {
    type Error = PyErr;

    fn extract(dict: Borrowed<'_, 'py, PyAny>) -> PyResult<Named> {
        let dict: Bound<'py, PyDict> = dict.extract()?;
        let pair = |(name, value): (Bound<'py, PyAny>, Bound<'py, PyAny>)| {
            let name: String = name.extract()?;
            // A cell without a profile has None, and so may calls.
            if value.is_none() && is_shell_profile(&name) {
                return Ok(None);
            }
            let value = value_of(&name, &value)?;
            Ok(Some((name, value)))
        };
        let pairs = dict.iter().map(pair).collect::<PyResult<Vec<_>>>()?;
        Ok(Named(pairs.into_iter().flatten().collect()))
    }
}

impl Named {
    /// The parameters by their canonical names. None may be given twice, by two names.
    pub fn overrides(&self) -> Result<Overrides, InputError> {
        let unknown = |name: &str, allowed| InputError::not_allowed(ARGUMENTS, "parameter", shown(name), allowed);
        let mut pairs: Vec<(&'static str, Value)> = Vec::new();
        for (name, value) in &self.0 {
            let canonical = settings::canonical_name(name).map_err(|allowed| unknown(name, allowed))?;
            if let Some(at) = pairs.iter().position(|(other, _)| *other == canonical) {
                let allowed = format!("left out: {} is the same parameter", self.0[at].0);
                return Err(InputError::not_allowed(ARGUMENTS, name, value, allowed));
            }
            pairs.push((canonical, value.clone()));
        }
        Ok(Overrides { source_name: ARGUMENTS, pairs })
    }

    /// Turns a radius in µm into one in L_h by the units of a lineage. The radius as it was given.
    pub fn scale_radius(&mut self, lineage: &Lineage) -> Result<Option<Length>, InputError> {
        let mut given = self.0.iter_mut();
        let is_radius = |name: &str| settings::canonical_name(name) == Ok("r0");
        let Some((_, value)) = given.find(|(name, _)| is_radius(name)) else { return Ok(None) };
        let length = match &*value {
            Value::Number(r0) => Length::Natural(*r0),
            Value::Text(text) => text.parse().map_err(|_: String| {
                InputError::not_allowed(ARGUMENTS, "r0", shown(text), "a number of L_h, as 5.4, or of µm, as '17um'")
            })?,
        };
        *value = Value::Number(length.in_units(&lineage.units()));
        Ok(Some(length))
    }
}

/// Whether a name denotes the table of a shell.
fn is_shell_profile(name: &str) -> bool {
    settings::canonical_name(name) == Ok(SHELL_PROFILE)
}

/// A number, which keeps every bit, or a word; a path for the table of a shell; True and False are words. InputError for any other value.
pub fn value_of(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Value> {
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Value::Text(text.to_str()?.trim().to_owned()));
    }
    if is_shell_profile(name)
        && let Ok(path) = value.extract::<PathBuf>()
    {
        return Ok(Value::Text(path.display().to_string()));
    }
    let wrong_type = |_| wrong_type(name, value, "a number, or a word where the parameter has words");
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(Value::Text(flag.is_true().to_string()));
    }
    // A whole number of more than 308 digits is no f64.
    if value.is_instance_of::<PyInt>() {
        return Ok(Value::Number(value.extract().unwrap_or(f64::INFINITY)));
    }
    Ok(Value::Number(value.extract().map_err(|_| wrong_type(()))?))
}

/// The law of a text, of a file, or of a name; `None` is the paper's.
fn law_of(given: &str) -> Result<Option<Law>, InputError> {
    let is_text = given.trim_start().starts_with('(') || given.contains("Law(");
    if is_text { Law::parse(given, "law").map(Some) } else { Law::read(Path::new(given)) }
}

/// Given parameters, by the names of `--set`. They override a configuration file, which overrides a preset. A law may replace the
/// paper's.
#[derive(Clone)]
pub struct Given {
    /// The parameters.
    pub parameters: Named,
    /// The preset.
    pub preset: String,
    /// The configuration file.
    pub config: Option<PathBuf>,
    /// The law: its text, its file or its name.
    pub law: Option<String>,
}

impl<'py> FromPyObject<'_, 'py> for Given {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Given> {
        let (parameters, preset, config, law) = given.extract()?;
        Ok(Given { parameters, preset, config, law })
    }
}

impl Given {
    /// A name for the constants: the preset, and what differs from it.
    pub fn named(&self) -> String {
        let file = self.config.iter().map(|_| "a configuration file".to_owned());
        let set = self.parameters.0.iter().map(|(name, value)| format!("{name}={value}"));
        let law = self.law.iter().map(|_| "a law".to_owned());
        [self.preset.clone()].into_iter().chain(file).chain(law).chain(set).collect::<Vec<_>>().join(", ")
    }

    /// The preset, the configuration file and the law, without the parameters.
    pub fn base(&self) -> Result<Settings, InputError> {
        let mut settings = Settings::load(&self.preset, self.config.as_deref(), None, &[])?;
        if let Some(law) = &self.law {
            settings.cell.law = law_of(law)?.map(Box::new);
        }
        Ok(settings)
    }

    /// The settings, checked.
    pub fn settings(&self) -> Result<Settings, InputError> {
        let mut settings = self.base()?;
        settings.assign(ARGUMENTS, &self.parameters.overrides()?.pairs)?;
        settings.check(ARGUMENTS)?;
        Ok(settings)
    }

    /// Refuses parameters that sets of constants, of a table of this name, set in all cells.
    pub fn check_beside(&self, sets: &[Constants], table: &str) -> Result<(), InputError> {
        let Overrides { pairs, .. } = self.parameters.overrides()?;
        let given = pairs.iter().map(|(name, value)| (ARGUMENTS, *name, value));
        sets.first().map_or(Ok(()), |first| first.check_given(table, given))
    }

    /// The settings for divisions, checked.
    pub fn for_divisions(&self) -> Result<Settings, InputError> {
        let settings = self.settings()?;
        settings.check_activity(ARGUMENTS)?;
        settings.check_divisions(ARGUMENTS)?;
        Ok(settings)
    }
}

/// The lineage of a file, of a text that begins with a lineage, or the built-in one.
pub fn lineage_of(given: Option<&str>) -> Result<Lineage, InputError> {
    match given {
        None | Some("c_elegans") => Lineage::c_elegans(),
        Some(text) if text.trim_start().starts_with('(') || text.contains("Lineage(") => {
            Lineage::parse(text, "lineage")
        }
        Some(path) => Lineage::read(Path::new(path)),
    }
}

/// The error of a cue.
pub fn bad_cue(CueError { field, value, allowed }: CueError) -> InputError {
    InputError::not_allowed(ARGUMENTS, field, value, allowed)
}

/// The values of the terms of a cue along a contour, by the names of their fields.
type TermsAt<'py> = Vec<(&'static str, Bound<'py, PyArray1<f64>>)>;

/// A cell and its numerics, checked.
#[pyclass(frozen, eq, module = "furrow._furrow")]
#[derive(Clone, PartialEq, Serialize, Deserialize)]
pub struct Inputs {
    /// The cell.
    pub cell: Cell,
    /// How it is computed.
    pub numerics: Numerics,
}

impl Inputs {
    /// The input of its division with a seed, checked.
    pub fn division(&self, seed: u64) -> Result<DivisionInput, Error> {
        let settings = self.settings();
        settings.check_activity(ARGUMENTS)?;
        settings.check_divisions(ARGUMENTS)?;
        Ok(DivisionInput { cell: settings.cell, numerics: self.numerics, seed })
    }

    /// The same, refused with azimuthal modes: for functions with axisymmetric equations only.
    pub fn axisymmetric(&self) -> Result<Inputs, Error> {
        self.settings().check_axisymmetric(ARGUMENTS)?;
        Ok(self.clone())
    }

    /// The cell of settings with a cue, checked together.
    fn checked(settings: Settings, cue: Cue) -> Result<Inputs, InputError> {
        settings.check_cue(ARGUMENTS, &cue)?;
        let cell = settings.cell.with_cue(cue);
        cell.check_law(ARGUMENTS)?;
        Ok(Inputs { cell, numerics: settings.numerics })
    }

    /// As parameters.
    pub fn settings(&self) -> Settings {
        Settings::of(self.cell.clone(), self.numerics)
    }
}

#[pymethods]
impl Inputs {
    /// A cell from parameters, a preset and a configuration file, and a cue, which may be one that a lineage names.
    #[new]
    #[pyo3(signature = (given, cue="none", lineage=None))]
    fn new(py: Python<'_>, mut given: Given, cue: &str, lineage: Option<&str>) -> Result<Inputs, Error> {
        let lineage = lineage_of(lineage)?;
        given.parameters.scale_radius(&lineage)?;
        let settings = given.settings()?;
        let inputs = Inputs::checked(settings, lineage.parse_cue(cue).map_err(bad_cue)?)?;
        if let Some(doubt) = inputs.cell.lacks_regulator() {
            // Level 2 is the line that makes the Cell.
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), &CString::new(doubt).unwrap_or_default(), 2)?;
        }
        Ok(inputs)
    }

    /// The same with other values of some parameters, and another cue and law if they are given.
    #[pyo3(signature = (parameters, cue=None, law=None))]
    fn replaced(&self, mut parameters: Named, cue: Option<&str>, law: Option<&str>) -> Result<Inputs, Error> {
        let lineage = lineage_of(None)?;
        parameters.scale_radius(&lineage)?;
        let mut settings = self.settings();
        if let Some(law) = law {
            settings.cell.law = law_of(law)?.map(Box::new);
        }
        settings.assign(ARGUMENTS, &parameters.overrides()?.pairs)?;
        settings.check(ARGUMENTS)?;
        let cue = cue.map_or_else(|| Ok(self.cell.cue.clone()), |cue| lineage.parse_cue(cue)).map_err(bad_cue)?;
        Ok(Inputs::checked(settings, cue)?)
    }

    /// Every parameter by its name, and the cue, the law with its constants, and the shell's profile.
    fn parameters(&self) -> Result<Document, Error> {
        let mut map = serde_json::Map::new();
        for (_, name, value) in settings::listing(&self.settings()) {
            let value = match (name, value) {
                ("stages" | "intervals" | "modes" | "elements", Value::Number(number)) => (number as u64).into(),
                (_, Value::Number(number)) => number.into(),
                (_, Value::Text(text)) => text.parse::<bool>().map_or_else(|_| text.into(), serde_json::Value::from),
            };
            map.insert(name.to_owned(), value);
        }
        map.insert("cue".to_owned(), self.cue().into());
        map.insert("law".to_owned(), self.law().into());
        for (name, constant) in self.cell.law.iter().flat_map(|law| law.constants()) {
            map.insert(format!("law.{name}"), constant.value.into());
        }
        map.insert(SHELL_PROFILE.to_owned(), self.shell_profile().into());
        Document::of(map)
    }

    /// The law of active stress, in one line; None for the paper's.
    #[getter]
    fn law(&self) -> Option<String> {
        self.cell.law.as_ref().map(|law| law.described())
    }

    /// The profile of the shell, in one line; None for an ellipsoid.
    #[getter]
    fn shell_profile(&self) -> Option<String> {
        self.cell.shell_profile.as_ref().map(|profile| profile.described())
    }

    /// The cue as users write it.
    #[getter]
    fn cue(&self) -> String {
        self.cell.cue.to_string()
    }

    /// The cue with the position and the width that PAR polarity gives it; `None` if it does not depend on polarity.
    fn resolved_cue(&self, py: Python<'_>) -> Result<Option<String>, Error> {
        Ok(match py.detach(|| resolved(&self.cell)).map_err(Error::no_outcome)? {
            Cow::Borrowed(_) => None,
            Cow::Owned(cell) => Some(cell.cue.to_string()),
        })
    }

    /// The values A f(u) of each term of the cue on a contour of the given length, by the name of its field. Terms that follow PAR
    /// polarity are where it places them.
    fn cue_at<'py>(&self, py: Python<'py>, u: PyReadonlyArray1<'py, f64>, length: f64) -> Result<TermsAt<'py>, Error> {
        let cell = py.detach(|| resolved(&self.cell)).map_err(Error::no_outcome)?;
        let at = |term: &furrow_cell::cue::Term| u.as_array().iter().map(|u| term.at(*u, length)[0]).collect();
        let terms = cell.cue.terms().iter();
        Ok(terms.map(|term| (term.field.name(), PyArray1::from_vec(py, at(term)))).collect())
    }

    /// The mirror image of the cell.
    fn mirrored(&self) -> Inputs {
        Inputs { cell: self.cell.mirrored(), numerics: self.numerics }
    }

    /// Whether the cell is mirror-symmetric.
    fn is_mirror_symmetric(&self) -> bool {
        self.cell.is_mirror_symmetric()
    }

    /// As JSON that [`from_json`](Inputs::from_json) reads to the last bit.
    fn to_json(&self) -> Result<String, Error> {
        Ok(serde_json::to_string(self)?)
    }

    /// Reads what [`to_json`](Inputs::to_json) wrote.
    #[staticmethod]
    fn from_json(text: &str) -> Result<Inputs, Error> {
        let inputs: Inputs = serde_json::from_str(text)
            .map_err(|error| InputError::other_file(ARGUMENTS, "a cell as furrow writes it", error))?;
        inputs.settings().check(ARGUMENTS)?;
        Ok(inputs)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Inputs>) -> Result<(Bound<'py, PyAny>, (String,)), Error> {
        Ok((slf.get_type().getattr("from_json")?, (slf.get().to_json()?,)))
    }
}

/// The names of all parameters, and for each the section it is in.
#[pyfunction]
pub fn parameter_names() -> Vec<(&'static str, &'static str)> {
    let listed = settings::listing(&Settings::default()).into_iter();
    listed
        .map(|(section, name, _)| (name, section))
        .chain([("xi_b", "physics"), ("shell_profile", "physics")])
        .collect()
}

/// The name of the parameter that another name means; any other text is its own.
#[pyfunction]
pub fn canonical_name(name: &str) -> &str {
    settings::canonical_name(name).unwrap_or(name)
}

/// The names of the presets.
#[pyfunction]
pub fn presets() -> Vec<&'static str> {
    settings::presets().collect()
}

/// Part `number` of `of` of a sweep or a sample.
pub fn shard_of((number, of): (u64, u64)) -> Result<Shard, Error> {
    Shard::new(number, of).map_err(|allowed| Error::not_allowed("shard", format!("({number}, {of})"), allowed))
}
