//! `furrow reproduce`: the paper's statements beside computed values.

use super::cell::one_of;
use super::context::{Context, Globals, warn_of_store};
use super::error::CliError;
use super::interrupt::{self, write_deferred};
use super::output::{csv_of, filled, print, to_json, writable_file, writable_folder};
use super::progress::ProgressLine;
use clap::Args;
use furrow_analysis::reproduce::{self, Artifact, NamedArtifact, ReproduceError, Verdict, paper::selected, reproduce};
use furrow_analysis::table::csv_text;
use furrow_figures::drawing::Format;
use furrow_figures::plot;
use furrow_formats::files::FileSet;
use furrow_input::{InputError, open_file};
use furrow_measured::events::{Division, divisions};
use furrow_measured::volumes::{ReadOptions, Volumes};
use furrow_report::reproduction::{markdown, text};
use serde_json::json;
use std::path::{Path, PathBuf};
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
    /// Volumes of cells, for the measured rows of 5B, 5D and 6B: a table as of `furrow compare volumes`; default that of Jankele,
    /// Jelier & Gönczy 2021
    #[arg(help_heading = "Input", long, value_name = "FILE.csv")]
    data: Option<PathBuf>,
    /// Output folder for pictures, tables, reproduction.md, results.csv and reproduce.json
    #[arg(help_heading = "Output", long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// File format of the pictures
    #[arg(help_heading = "Output", long, value_name = "KIND", default_value = "svg", requires = "out",
        value_parser = one_of(FORMATS.map(|format| (format.0, format))))]
    format: (&'static str, Format),
    /// Writes the table as Markdown
    #[arg(help_heading = "Output", long, value_name = "FILE.md")]
    table: Option<PathBuf>,
}

/// Formats of pictures by the extension of their files.
const FORMATS: [(&str, Format); 2] = [("svg", Format::Svg), ("png", Format::Png)];

/// The columns of results.csv.
const HEADER: &str =
    "figure,id,quantity,paper,computed,published_scheme,published_fine,rel_error,pass,verdict,criterion,note,seconds";
/// Files other than pictures and tables of panels.
const FILES: [&str; 3] = ["reproduction.md", "reproduce.json", "results.csv"];

pub fn run(args: &ReproduceArgs, context: &Context) -> Result<(), CliError> {
    let start = Instant::now();
    interrupt::finish();
    let statements = selected(&args.figures)?;
    context.settings.check_divisions("settings")?;
    context.settings.check_activity("settings")?;
    writable_folder("--out", args.out.as_deref(), &FILES)?;
    writable_file("--table", args.table.as_deref())?;
    let measured = args.data.as_deref().map(measured).transpose()?;
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
    warn_of_store(&found.warnings);
    let constants = constants(&context.globals);
    let document = filled(json!({
        "constants": constants,
        "items": found.items,
        "agrees": found.count(Verdict::Agrees),
        "differs": found.count(Verdict::Differs),
        "apart": found.count(Verdict::Apart),
        "elapsed_s": start.elapsed().as_secs_f64(),
        "out": args.out.as_ref().map(|folder| folder.display().to_string()),
    }));
    let json = to_json(&document)?;
    let page = markdown(&found, &constants);
    if let Some(file) = &args.table {
        write_deferred(file, page.as_bytes())?;
    }
    if let Some(folder) = &args.out {
        let mut files = FileSet::new(folder);
        files.stage("reproduction.md", page.as_bytes())?;
        files.stage("reproduce.json", json.as_bytes())?;
        files.stage("results.csv", &csv_of(HEADER, &found.items)?)?;
        // A picture of every panel, and a table of those that are drawn from one.
        let (extension, format) = args.format;
        for panel in &found.panels {
            let picture = plot::reproduction::draw(panel).bytes(format)?;
            files.stage(&format!("{}.{extension}", panel.name), &picture)?;
            if let Some(table) = table(panel)? {
                files.stage(&format!("{}.csv", panel.name), &table)?;
            }
        }
        interrupt::defer(|| files.commit())?;
    }
    if context.json { print(&json) } else { print(&text(&found, &constants)) }
}

/// The divisions in a table of volumes.
fn measured(file: &Path) -> Result<(String, Vec<Division>), CliError> {
    let name = file.display().to_string();
    let mut volumes = Volumes::default();
    volumes.read(open_file(file)?, &name, &ReadOptions::default())?;
    let divisions = divisions(&volumes).divisions;
    match divisions.is_empty() {
        true => {
            Err(InputError::not_allowed(&name, "cells", "no division", "both daughters of one cell at least").into())
        }
        false => Ok((name, divisions)),
    }
}

/// A name for the constants in use.
fn constants(globals: &Globals) -> String {
    let file = globals.config.iter().map(|_| "a configuration file");
    let set = globals.set.iter().map(String::as_str);
    [globals.preset.as_str()].into_iter().chain(file).chain(set).collect::<Vec<_>>().join(", ")
}

/// The table of a panel that is drawn from many cells.
fn table(panel: &NamedArtifact) -> Result<Option<Vec<u8>>, CliError> {
    Ok(match &panel.artifact {
        Artifact::Sweep(sweep, rows) => Some(csv_text(&sweep.columns(), rows).into_bytes()),
        Artifact::Map(map) => Some(csv_of("x,xi_s,outcome,chi,by", &map.diagram.cells)?),
        Artifact::Perturbations(_, watched) => {
            let rows =
                watched.iter().flat_map(|(shape, found)| found.distances.iter().map(move |[t, dis]| (shape, t, dis)));
            Some(csv_of("shape,t,dis", rows)?)
        }
        _ => None,
    })
}
