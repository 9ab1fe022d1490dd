//! Translates messages of the library for Python: options of the command line become arguments.

use furrow_input::InputError;

use crate::errors::ARGUMENTS;

/// Phrases about the command line, and their replacements in Python. All other options become arguments of the same name.
const PHRASES: [(&str, &str); 10] = [
    (" (--three-dimensional)", ""),
    ("compute it with --three-dimensional", "compute it with modes=4"),
    ("leave out --three-dimensional, and set modes = 0", "set modes=0"),
    ("leave out --three-dimensional", "set modes=0"),
    ("--three-dimensional", "modes=4"),
    ("furrow test --shard", "furrow.test(shard=…)"),
    ("`furrow cache verify --repair`", "furrow.cache.verify(…, repair=True)"),
    ("with --to ", "with the format "),
    ("option --tree, or the first file of compare counts", "furrow.read_tree"),
    ("options --lineage and --tree take it", "lineage= takes it"),
];

/// Options that have another name as arguments.
const RENAMED: [(&str, &str); 2] = [("class", "class_columns"), ("branch-lengths", "lengths")];

/// The argument of an option, which is given without its hyphens.
fn argument(option: &str) -> String {
    let renamed = RENAMED.iter().find(|(of_program, _)| *of_program == option);
    renamed.map_or_else(|| option.replace('-', "_"), |(_, argument)| (*argument).to_owned())
}

/// A text with the names of arguments in place of options.
pub fn of_python(text: &str) -> String {
    let mut left = text.to_owned();
    for (of_program, of_python) in PHRASES {
        left = left.replace(of_program, of_python);
    }
    let mut parts = left.split("--");
    let mut words = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end = part.find(|c: char| !(c.is_ascii_lowercase() || c == '-')).unwrap_or(part.len());
        let (option, rest) = part.split_at(end);
        match rest.strip_prefix(' ').and_then(|rest| rest.split_once("=UM")) {
            // Hyphens within a name.
            _ if option.is_empty() || words.ends_with(char::is_alphanumeric) => words += &format!("--{part}"),
            // One number of an embryo by its name.
            Some((embryo, rest)) => words += &format!("{}={{{embryo:?}: …}}{rest}", argument(option)),
            None => words += &(argument(option) + rest),
        }
    }
    words
}

/// An error with the names of arguments in place of options. Values stay as they were given.
pub fn error_of_python(error: InputError) -> InputError {
    match error {
        InputError::NotAllowed { source_name, field, value, allowed } => {
            let field = argument(&field.replace('_', "-"));
            let source_name = match source_name.strip_prefix("--").map(argument) {
                Some(option) if option != field && option != "set" => option,
                None if source_name != "settings" => source_name,
                _ => ARGUMENTS.to_owned(),
            };
            InputError::NotAllowed { source_name, field, value, allowed: of_python(&allowed) }
        }
        InputError::OtherFile { file, wanted, reason } => {
            InputError::OtherFile { file, wanted, reason: of_python(&reason) }
        }
        InputError::Malformed { file, line, column, message } => {
            InputError::Malformed { file, line, column, message: of_python(&message) }
        }
        other => other,
    }
}
