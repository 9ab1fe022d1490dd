//! A cell and how it is computed, every value checked.

use std::path::PathBuf;

use furrow_cell::settings::{self, Settings, canonical_name};
use furrow_cell::{Cell, Numerics};
use furrow_input::{InputError, shown};
use furrow_lineage::{Length, Lineage};
use furrow_mechanics::division::DivisionInput;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyInt, PyString};
use serde::{Deserialize, Serialize};

use crate::errors::{Error, raised, refused, unwritable};

/// The source that errors name for arguments of a call.
pub const ARGUMENTS: &str = "furrow";

/// Parameters by the names of `--set`, with their values as text.
pub type Pairs = Vec<(String, String)>;

/// A value as the text that a parameter is set by.
///
/// # Errors
/// InputError for what is neither a number nor a word.
pub fn value_text(name: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(text.to_str()?.trim().to_owned());
    }
    let refused = || refused(value.py(), name, value, "a number, or a word where the parameter has words");
    if value.is_instance_of::<PyBool>() {
        return Err(refused());
    }
    if value.is_instance_of::<PyInt>() {
        return Ok(value.str()?.to_str()?.to_owned());
    }
    // Numbers of numpy are whole where they have an index.
    if let Ok(whole) = value.call_method0("__index__") {
        return Ok(whole.str()?.to_str()?.to_owned());
    }
    let number: f64 = value.extract().map_err(|_| refused())?;
    Ok(number.to_string())
}

/// Keywords as pairs of names and texts.
///
/// # Errors
/// As [`value_text`].
pub fn pairs(parameters: &Bound<'_, pyo3::types::PyDict>) -> PyResult<Pairs> {
    let mut pairs = Pairs::new();
    for (name, value) in parameters.iter() {
        let name: String = name.extract()?;
        let text = value_text(&name, &value)?;
        pairs.push((name, text));
    }
    Ok(pairs)
}

/// A preset, overridden by a configuration file and then by keywords, and checked.
pub fn settings_of(preset: &str, config: Option<&PathBuf>, pairs: &Pairs) -> Result<Settings, InputError> {
    let mut settings = Settings::load(preset, config.map(PathBuf::as_path), &[])?;
    let mut named = Vec::new();
    for (name, value) in pairs {
        let unknown = |allowed| InputError::not_allowed(ARGUMENTS, "parameter", shown(name), allowed);
        named.push((canonical_name(name).map_err(unknown)?, value.as_str()));
    }
    settings.assign(ARGUMENTS, &named)?;
    settings.check(ARGUMENTS)?;
    Ok(settings)
}

/// The lineage of a file, of a text that begins with one, or the built-in one.
pub fn lineage_of(given: Option<&str>) -> Result<Lineage, InputError> {
    match given {
        None | Some("c_elegans") => Lineage::c_elegans(),
        Some(text) if text.trim_start().starts_with('(') || text.contains("Lineage(") => {
            Lineage::parse(text, "lineage")
        }
        Some(path) => Lineage::read(std::path::Path::new(path)),
    }
}

/// A radius in L_h, or in µm if the lineage has units.
pub fn radius_of(text: &str, lineage: &Lineage) -> Result<f64, InputError> {
    let refused = |allowed: String| InputError::not_allowed(ARGUMENTS, "r0", shown(text), allowed);
    let length: Length =
        text.parse().map_err(|_| refused("a number of L_h, as 5.4, or of µm, as '17um'".to_owned()))?;
    length.in_units(&lineage.units()).map_err(refused)
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
        Ok(DivisionInput { cell: self.cell.clone(), numerics: self.numerics, seed })
    }

    /// As parameters.
    pub fn settings(&self) -> Settings {
        Settings { cell: self.cell.clone(), numerics: self.numerics }
    }
}

#[pymethods]
impl Inputs {
    /// A cell from a preset, a configuration file, keywords and a cue, which may be one that a lineage names.
    #[new]
    #[pyo3(signature = (parameters, cue="none", preset="gao2026", config=None, lineage=None))]
    fn new(
        py: Python<'_>,
        parameters: &Bound<'_, pyo3::types::PyDict>,
        cue: &str,
        preset: &str,
        config: Option<PathBuf>,
        lineage: Option<&str>,
    ) -> PyResult<Inputs> {
        let mut pairs = pairs(parameters)?;
        let mut build = || -> Result<Inputs, InputError> {
            let lineage = lineage_of(lineage)?;
            if let Some((_, text)) = pairs.iter_mut().find(|(name, _)| name == "r0" || name == "R0") {
                *text = radius_of(text, &lineage)?.to_string();
            }
            let Settings { cell, numerics } = settings_of(preset, config.as_ref(), &pairs)?;
            let bad = |e: furrow_cell::CueError| InputError::not_allowed(ARGUMENTS, e.field, e.value, e.allowed);
            let cue = lineage.parse_cue(cue).map_err(bad)?;
            Ok(Inputs { cell: cell.with_cue(cue), numerics })
        };
        build().map_err(|error| raised(py, error.into(), 0))
    }

    /// Every parameter by its name, and the cue, as JSON.
    fn parameters(&self) -> PyResult<String> {
        let settings = self.settings();
        let mut map = serde_json::Map::new();
        for (_, name, text) in settings::listing(&settings) {
            let value = match (name, text.parse::<f64>()) {
                ("stages" | "intervals", Ok(number)) => serde_json::Value::from(number as u64),
                (_, Ok(number)) => number.into(),
                (_, Err(_)) => text.into(),
            };
            map.insert(name.to_owned(), value);
        }
        map.insert("cue".to_owned(), self.cell.cue.to_string().into());
        serde_json::to_string(&map).map_err(unwritable)
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
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(self).map_err(unwritable)
    }

    /// Reads what [`to_json`](Inputs::to_json) wrote.
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<Inputs> {
        let read = || -> Result<Inputs, InputError> {
            let inputs: Inputs = serde_json::from_str(text).map_err(|error| InputError::OtherFile {
                file: ARGUMENTS.to_owned(),
                wanted: "a cell as furrow writes it".to_owned(),
                reason: error.to_string(),
            })?;
            inputs.settings().check(ARGUMENTS)?;
            Ok(inputs)
        };
        read().map_err(|error| raised(py, error.into(), 0))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Inputs>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((slf.get_type().getattr("from_json")?, (slf.get().to_json()?,)))
    }
}

/// The names of all parameters, and for each the section it is in.
#[pyfunction]
pub fn parameter_names() -> Vec<(String, String)> {
    let listed = settings::listing(&Settings::default());
    let plain = listed.into_iter().map(|(section, name, _)| (name.to_owned(), section.to_owned()));
    plain.chain([("xi_b".to_owned(), "physics".to_owned())]).collect()
}

/// The names of the presets.
#[pyfunction]
pub fn presets() -> Vec<String> {
    settings::presets().map(str::to_owned).collect()
}
