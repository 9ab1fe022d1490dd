//! `furrow new-lineage`: writes a template for a lineage file.

use super::context::Globals;
use super::error::CliError;
use super::output::print_as;
use clap::Args;
use furrow_cell::ZYGOTE;
use furrow_formats::write_atomically;
use furrow_input::InputError;
use furrow_lineage::{Length, TEMPLATE, Units};
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow new-lineage mine.ron
  furrow new-lineage ascidian.ron --first-cell 140um")]
pub struct NewLineageArgs {
    /// Output file; an existing file is not overwritten
    #[arg(value_name = "FILE.ron")]
    file: PathBuf,
    /// Diameter of a sphere with the volume of the first cell, in µm, such as 55um. The file gets the radius R0 and the L_h for which
    /// this radius is 5.4, as in the worm
    #[arg(help_heading = "Output", long, value_name = "DIAMETER", value_parser = diameter)]
    first_cell: Option<Length>,
}

/// The allowed values of --first-cell.
const DIAMETER: &str = "a diameter in µm, from 0.001um to 1000000um, such as 55um";

/// Reads the value of --first-cell.
fn diameter(text: &str) -> Result<Length, String> {
    let finite = text.parse().ok().filter(|length: &Length| f64::is_finite(length.in_units(&Units::default())));
    finite.ok_or_else(|| format!("must be {DIAMETER}; other units are not read"))
}

/// The template for a first cell of a diameter in µm.
fn template(diameter: Option<Length>) -> Result<String, InputError> {
    let Some(diameter) = diameter else { return Ok(TEMPLATE.to_owned()) };
    let um = match diameter {
        Length::Micrometres(um) if (1e-3..=1e6).contains(&um) => um,
        Length::Natural(um) => {
            let allowed = format!("{DIAMETER}: if it is in µm, write {um}um");
            return Err(InputError::not_allowed("--first-cell", "first_cell", diameter, allowed));
        }
        _ => return Err(InputError::not_allowed("--first-cell", "first_cell", diameter, DIAMETER)),
    };
    let radius = short(0.5 * um);
    let length = short(0.5 * um / ZYGOTE);
    let about = format!(
        "    // L_h is not measured: with {length} the first cell has the R0 of the worm's zygote, 5.4. Other ways are in the book, under\n    \
         // Your own animal. τ is a guess too, which only times depend on.\n    units: (length_um: {length},"
    );
    let text = TEMPLATE.replace("    units: (length_um: 3.16,", &about);
    let text = text.replace(
        "r0: \"17um\",                 // or 5.38, in L_h;",
        &format!("r0: \"{radius}um\",                 // or 5.4, in L_h;"),
    );
    // The counts in the template are the worm's and serve as an example.
    Ok(text.replace(" observed: (", " // observed: ("))
}

/// A number with five digits.
fn short(value: f64) -> f64 {
    format!("{value:.4e}").parse().unwrap_or(value)
}

pub fn run(args: &NewLineageArgs, globals: &Globals) -> Result<(), CliError> {
    let (new, name) = (args.file.symlink_metadata().is_err(), format!("{:?}", args.file.display().to_string()));
    InputError::require(new, "new-lineage", "FILE.ron", name, "a file that does not exist yet")?;
    let template = template(args.first_cell)?;
    write_atomically(&args.file, template.as_bytes())?;
    let file = args.file.display();
    print_as(globals.json, &json!({ "out": file.to_string(), "bytes": template.len() }), || {
        format!("{file} written; change it, then: furrow tree {file}\n")
    })
}
