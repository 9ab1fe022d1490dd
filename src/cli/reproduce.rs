//! `furrow reproduce`: the paper's statements compared with computed values.

use super::cell::{AxisArgs, one_of};
use super::context::{Context, Globals};
use super::error::CliError;
use super::interrupt::{self, write_deferred};
use super::messages;
use super::output::{filled, merged, print, to_json, writable_file, writable_folder};
use super::progress::ProgressLine;
use clap::Args;
use furrow_analysis::reproduce::{
    self, NamedArtifact, ReproduceError, measured::measured_divisions, paper::selected, reproduce,
};
use furrow_figures::drawing::Format;
use furrow_figures::plot;
use furrow_formats::files::FileSet;
use furrow_report::reproduction::{FILES, markdown, stage, text};
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow reproduce 3C S4 S5
  furrow reproduce 5B 5D --data data/jankele2021_volumes.csv
  furrow reproduce 1 S3 --out reproduced --json
  furrow reproduce movies --table movies.md")]
pub struct ReproduceArgs {
    /// Figures, tables and movies of the paper; default all
    #[arg(value_name = "FIGURE")]
    figures: Vec<String>,
    /// Volumes of cells for the measured rows of 5B, 5D and 6B: a table as for `furrow compare volumes`; default the measurements
    /// of Jankele, Jelier & Gönczy 2021
    #[arg(help_heading = "Input", long, value_name = "FILE.csv")]
    data: Option<PathBuf>,
    /// Output folder for pictures, tables, reproduction.md, results.csv and reproduce.json
    #[arg(help_heading = "Output", long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// File format of the pictures
    #[arg(help_heading = "Output", long, value_name = "KIND", default_value = "svg", requires = "out",
        value_parser = one_of(Format::ALL.map(|format| (format.0, format))))]
    format: (&'static str, Format),
    /// Writes the table as Markdown
    #[arg(help_heading = "Output", long, value_name = "FILE.md")]
    table: Option<PathBuf>,
    #[command(flatten)]
    pub axis: AxisArgs,
}

pub fn run(args: &ReproduceArgs, context: &Context) -> Result<(), CliError> {
    let start = Instant::now();
    interrupt::finish();
    let statements = selected(&args.figures)?;
    context.settings.check_divisions("settings")?;
    context.settings.check_activity("settings")?;
    writable_folder("--out", args.out.as_deref(), &FILES)?;
    writable_file("--table", args.table.as_deref())?;
    let measured = args.data.as_deref().map(measured_divisions).transpose()?;
    let memo = context.memo()?;
    let line = ProgressLine::new(context.progress);
    let figures = reproduce::Context {
        settings: &context.settings,
        memo: &memo,
        threads: context.threads,
        cancel: interrupt::flag(),
        measured: measured.as_ref().map(|(name, divisions)| (name.as_str(), divisions.as_slice())),
        progress: &|figure: &str, done, of| line.show_share(done, of, || format!("figures, now {figure}")),
    };
    let found = reproduce(&figures, &statements);
    drop(line);
    let found = found.map_err(|error| match error {
        ReproduceError::Input(error) => error.into(),
        ReproduceError::Workers(error) => error.into(),
        _ => CliError::Interrupted,
    })?;
    messages::warn_of(&found.warnings);
    let constants = constants(&context.globals);
    let document = found.document(&constants);
    let run = filled(json!({
        "elapsed_s": start.elapsed().as_secs_f64(),
        "out": args.out.as_ref().map(|folder| folder.display().to_string()),
    }));
    let document = merged(document, run);
    let json = to_json(&document)?;
    let page = markdown(&found, &constants);
    if let Some(file) = &args.table {
        write_deferred(file, page.as_bytes())?;
    }
    if let Some(folder) = &args.out {
        let mut files = FileSet::new(folder);
        let (extension, format) = args.format;
        let draw = |panel: &NamedArtifact| Ok::<_, CliError>(plot::reproduction::draw(panel).bytes(format)?);
        stage(&mut files, &found, (&page, &json), extension, draw)?;
        interrupt::defer(|| files.commit())?;
    }
    if context.json { print(&json) } else { print(&text(&found, &constants)) }
}

/// A name for the constants in use.
fn constants(globals: &Globals) -> String {
    let file = globals.config.iter().map(|_| "a configuration file");
    let set = globals.set.iter().map(String::as_str);
    [globals.preset.as_str()].into_iter().chain(file).chain(set).collect::<Vec<_>>().join(", ")
}
