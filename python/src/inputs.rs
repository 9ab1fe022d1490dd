//! A cell and how it is computed, every value checked.

use std::path::{Path, PathBuf};

use furrow_cell::settings::{self, Settings, canonical_name};
use furrow_cell::{Cell, CueError, Numerics};
use furrow_input::{InputError, read_text, shown};
use furrow_lineage::{Length, Lineage};
use furrow_mechanics::division::DivisionInput;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyInt, PyString};
use serde::{Deserialize, Serialize};

use crate::document::Document;
use crate::errors::{ARGUMENTS, Error, refused};

/// A text, or the file that has it.
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

/// Numbers by name as numpy arrays, which take over the memory of the vectors.
pub type Columns = Vec<(&'static str, Vec<f64>)>;

/// Columns as a dict of arrays.
pub fn arrays(py: Python<'_>, columns: Columns) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    columns.into_iter().try_for_each(|(name, values)| dict.set_item(name, PyArray1::from_vec(py, values)))?;
    Ok(dict)
}

/// What a computation is given: parameters by the names of `--set` with their values as text, which override a configuration file,
/// which overrides a preset.
#[derive(Clone)]
pub struct Given {
    /// The parameters.
    pub pairs: Vec<(String, String)>,
    /// The preset.
    pub preset: String,
    /// The configuration file.
    pub config: Option<PathBuf>,
}

impl<'py> FromPyObject<'_, 'py> for Given {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Given> {
        let (parameters, preset, config): (Bound<'py, PyDict>, _, _) = given.extract()?;
        let pair = |(name, value): (Bound<'py, PyAny>, Bound<'py, PyAny>)| {
            let name: String = name.extract()?;
            let text = value_text(&name, &value)?;
            Ok((name, text))
        };
        Ok(Given { pairs: parameters.iter().map(pair).collect::<PyResult<_>>()?, preset, config })
    }
}

/// A value as the text that a parameter is set by. InputError for what is neither a number nor a word.
fn value_text(name: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(text.to_str()?.trim().to_owned());
    }
    let refused = || refused(name, value, "a number, or a word where the parameter has words");
    if value.is_instance_of::<PyBool>() {
        return Err(refused());
    }
    // Numbers of numpy are whole where they have an index.
    let whole = if value.is_instance_of::<PyInt>() { Ok(value.clone()) } else { value.call_method0("__index__") };
    match whole {
        Ok(whole) => Ok(whole.str()?.to_str()?.to_owned()),
        Err(_) => Ok(value.extract::<f64>().map_err(|_| refused())?.to_string()),
    }
}

impl Given {
    /// A name for the constants: the preset, and what differs from it.
    pub fn named(&self) -> String {
        let file = self.config.iter().map(|_| "a configuration file".to_owned());
        let set = self.pairs.iter().map(|(name, value)| format!("{name}={value}"));
        [self.preset.clone()].into_iter().chain(file).chain(set).collect::<Vec<_>>().join(", ")
    }

    /// The settings, checked.
    pub fn settings(&self) -> Result<Settings, InputError> {
        let mut settings = Settings::load(&self.preset, self.config.as_deref(), &[])?;
        let unknown = |name: &str, allowed| InputError::not_allowed(ARGUMENTS, "parameter", shown(name), allowed);
        let named = |(name, value): &(String, String)| {
            Ok((canonical_name(name).map_err(|allowed| unknown(name, allowed))?, value.clone()))
        };
        settings.assign(ARGUMENTS, &self.pairs.iter().map(named).collect::<Result<Vec<_>, InputError>>()?)?;
        settings.check(ARGUMENTS)?;
        Ok(settings)
    }

    /// The settings for divisions, checked.
    pub fn for_divisions(&self) -> Result<Settings, InputError> {
        let settings = self.settings()?;
        settings.check_activity(ARGUMENTS)?;
        settings.check_divisions(ARGUMENTS)?;
        Ok(settings)
    }

    /// Turns a radius in µm into one in L_h by the units of a lineage. Whether there is a radius.
    pub fn scale_radius(&mut self, lineage: &Lineage) -> Result<bool, InputError> {
        let Some((_, text)) = self.pairs.iter_mut().find(|(name, _)| name == "r0" || name == "R0") else {
            return Ok(false);
        };
        let length = text.parse::<Length>().map_err(|_| "a number of L_h, as 5.4, or of µm, as '17um'".to_owned());
        let radius = length.and_then(|length| length.in_units(&lineage.units()));
        *text = radius.map_err(|allowed| InputError::not_allowed(ARGUMENTS, "r0", shown(text), allowed))?.to_string();
        Ok(true)
    }
}

/// The lineage of a file, of a text that begins with one, or the built-in one.
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
    /// The input of its division with a seed, checked as such.
    pub fn division(&self, seed: u64) -> Result<DivisionInput, Error> {
        let settings = self.settings();
        settings.check_activity(ARGUMENTS)?;
        settings.check_divisions(ARGUMENTS)?;
        Ok(DivisionInput { cell: settings.cell, numerics: self.numerics, seed })
    }

    /// As parameters.
    pub fn settings(&self) -> Settings {
        Settings { cell: self.cell.clone(), numerics: self.numerics }
    }
}

#[pymethods]
impl Inputs {
    /// A cell from parameters, a preset and a configuration file, and a cue, which may be one that a lineage names.
    #[new]
    #[pyo3(signature = (given, cue="none", lineage=None))]
    fn new(mut given: Given, cue: &str, lineage: Option<&str>) -> Result<Inputs, Error> {
        let lineage = lineage_of(lineage)?;
        given.scale_radius(&lineage)?;
        let Settings { cell, numerics } = given.settings()?;
        Ok(Inputs { cell: cell.with_cue(lineage.parse_cue(cue).map_err(bad_cue)?), numerics })
    }

    /// Every parameter by its name, and the cue.
    fn parameters(&self) -> Result<Document, Error> {
        let mut map = serde_json::Map::new();
        for (_, name, text) in settings::listing(&self.settings()) {
            let value = match (name, text.parse::<f64>()) {
                ("stages" | "intervals", Ok(number)) => (number as u64).into(),
                (_, Ok(number)) => number.into(),
                (_, Err(_)) => text.into(),
            };
            map.insert(name.to_owned(), value);
        }
        map.insert("cue".to_owned(), self.cue().into());
        Document::of(map)
    }

    /// The cue as users write it.
    #[getter]
    fn cue(&self) -> String {
        self.cell.cue.to_string()
    }

    /// The values A f(u) of each term of the cue on a contour of the given length, by the name of its field.
    fn cue_at<'py>(
        &self,
        py: Python<'py>,
        u: PyReadonlyArray1<'py, f64>,
        length: f64,
    ) -> Vec<(&'static str, Bound<'py, PyArray1<f64>>)> {
        let at = |term: &furrow_cell::cue::Term| u.as_array().iter().map(|u| term.at(*u, length)[0]).collect();
        let terms = self.cell.cue.terms().iter();
        terms.map(|term| (term.field.name(), PyArray1::from_vec(py, at(term)))).collect()
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
    listed.map(|(section, name, _)| (name, section)).chain([("xi_b", "physics")]).collect()
}

/// The names of the presets.
#[pyfunction]
pub fn presets() -> Vec<&'static str> {
    settings::presets().collect()
}
