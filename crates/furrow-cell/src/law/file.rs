//! Laws in RON and JSON.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Deserializer, Serialize};

use super::names::{ConstantName, Known, LONGEST_NAME, reserved};
use super::program::Program;
use super::text::{ExpressionError, compile};
use super::{Constant, Expression, Law};
use furrow_input::{InputError, did_you_mean, forbidden, parse_document, read_text, shown, unique_map};

/// Largest number of characters of a law's name.
const LONGEST: usize = 60;

/// A law as written in files.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename = "Law")]
pub(super) struct Document {
    name: String,
    #[serde(default, deserialize_with = "constants", skip_serializing_if = "BTreeMap::is_empty")]
    constants: BTreeMap<String, Constant>,
    stress_uu: String,
    stress_phiphi: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    moment: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    normal_force: Option<String>,
    /// Whether u is measured from the other pole.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    reversed: bool,
}

/// Reads constants by name, and rejects duplicate names.
fn constants<'de, D: Deserializer<'de>>(deserializer: D) -> Result<BTreeMap<String, Constant>, D::Error> {
    unique_map(deserializer, "constants by name", |name| format!("the constant {name} stands twice"))
}

/// The reason why a document is not a law.
#[derive(Debug)]
enum Fault {
    Expression(Expression, ExpressionError),
    Field { field: String, value: String, allowed: String },
}

impl Fault {
    fn field(field: impl Into<String>, value: impl ToString, allowed: impl Into<String>) -> Fault {
        Fault::Field { field: field.into(), value: value.to_string(), allowed: allowed.into() }
    }

    /// The error in a file with a text.
    fn of_file(self, text: &str, file: &str, document: &Document) -> InputError {
        match self {
            Fault::Field { field, value, allowed } => InputError::not_allowed(file, field, value, allowed),
            Fault::Expression(which, error) => {
                let written = document.texts()[which as usize].clone().unwrap_or_default();
                let message = |place: &str| format!("{}: {place}{}", which.name(), error.message);
                // The position is within the file if the expression is written there without escapes.
                match text.find(&format!("\"{written}\"")).filter(|_| !written.is_empty()) {
                    Some(start) => {
                        let before = &text[..start + 1 + error.at];
                        let line = before.matches('\n').count() + 1;
                        let column = before.rsplit('\n').next().map_or(0, |last| last.chars().count()) + 1;
                        InputError::Malformed { file: file.to_owned(), line, column, message: message("") }
                    }
                    None => {
                        let place = format!("character {}: ", written[..error.at].chars().count() + 1);
                        InputError::Founders { file: file.to_owned(), message: message(&place) }
                    }
                }
            }
        }
    }
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Fault::Expression(which, error) => {
                write!(f, "law.{}: character {}: {}", which.name(), error.at + 1, error.message)
            }
            Fault::Field { field, value, allowed } => write!(f, "law.{field} = {value}: must be {allowed}"),
        }
    }
}

impl Document {
    fn texts(&self) -> [Option<String>; 4] {
        let Document { moment, stress_uu, stress_phiphi, normal_force, .. } = self;
        [moment.clone(), Some(stress_uu.clone()), Some(stress_phiphi.clone()), normal_force.clone()]
    }

    /// A law without units; texts are in the order of [`Expression::ALL`].
    pub(super) fn new(name: &str, constants: BTreeMap<String, Constant>, texts: [Option<String>; 4]) -> Document {
        let [moment, stress_uu, stress_phiphi, normal_force] = texts;
        let [stress_uu, stress_phiphi] = [stress_uu, stress_phiphi].map(Option::unwrap_or_default);
        Document { name: name.to_owned(), constants, stress_uu, stress_phiphi, moment, normal_force, reversed: false }
    }

    /// The law, or the error in a file that has a text.
    pub(super) fn checked(&self, text: &str, file: &str) -> Result<Law, InputError> {
        self.law().map_err(|fault| fault.of_file(text, file, self))
    }

    fn check_name(&self) -> Result<(), Fault> {
        let fits = (1..=LONGEST).contains(&self.name.chars().count()) && forbidden(&self.name).is_none();
        let allowed = format!("from 1 to {LONGEST} printable characters");
        if fits { Ok(()) } else { Err(Fault::field("name", shown(&self.name), allowed)) }
    }

    fn check_constants(&self) -> Result<(), Fault> {
        for (name, Constant { value, .. }) in &self.constants {
            let taken = reserved().any(|known| known == name);
            if ConstantName::new(name).is_none() || taken {
                let allowed = match taken {
                    true => "another name: expressions know this one already".to_owned(),
                    false => format!("a letter followed by letters, digits and _, {LONGEST_NAME} at most"),
                };
                return Err(Fault::field("constants", shown(name), allowed));
            }
            if !value.is_finite() {
                return Err(Fault::field(format!("constants[{name:?}].value"), value, "a finite number"));
            }
        }
        Ok(())
    }

    fn law(&self) -> Result<Law, Fault> {
        self.check_name()?;
        self.check_constants()?;
        let (texts, mut program) = (self.texts(), Program::default());
        for which in Expression::ALL {
            let Some(text) = &texts[which as usize] else { continue };
            let names = Known(&self.constants);
            let result = compile(text, &names, &mut program).map_err(|error| Fault::Expression(which, error))?;
            program.end(which as usize, result);
        }
        let Document { name, constants, reversed, .. } = self.clone();
        let law = Law { name, constants, texts, reversed, program: Arc::new(program) };
        law.check().map_err(|(field, value, allowed)| Fault::Field { field, value, allowed })?;
        Ok(law)
    }
}

impl TryFrom<Document> for Law {
    type Error = String;

    fn try_from(document: Document) -> Result<Law, String> {
        document.law().map_err(|fault| fault.to_string())
    }
}

impl From<Law> for Document {
    fn from(law: Law) -> Document {
        let Law { name, constants, texts, reversed, .. } = law;
        Document { reversed, ..Document::new(&name, constants, texts) }
    }
}

/// Names of the built-in laws, which the equations implement with hand-written derivatives.
pub const BUILT_IN: [&str; 1] = ["paper"];

impl Law {
    /// Reads a law; `file` is the name of the text in errors.
    ///
    /// # Errors
    /// Names the file, the field or the position in an expression, and the allowed values.
    pub fn parse(text: &str, file: &str) -> Result<Law, InputError> {
        let document: Document = parse_document(text, file, "a law", "Law")?;
        document.checked(text, file)
    }

    /// Reads the law of an option: a file, or `paper` for the built-in law, which is `None`.
    ///
    /// # Errors
    /// As [`parse`](Self::parse), and if the file cannot be read.
    pub fn read(given: &Path) -> Result<Option<Law>, InputError> {
        let file = given.display().to_string();
        if BUILT_IN.contains(&file.as_str()) {
            return Ok(None);
        }
        match read_text(given) {
            Ok(text) => Law::parse(&text, &file).map(Some),
            // A word without a folder or an extension was probably meant as a name.
            Err(_) if !file.contains(['.', '/', '\\']) => {
                let allowed = format!("a file, or {}{}", BUILT_IN.join(", "), did_you_mean(&file, BUILT_IN));
                Err(InputError::not_allowed("--law", "law", shown(&file), allowed))
            }
            Err(error) => Err(error),
        }
    }
}
