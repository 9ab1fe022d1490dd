//! `furrow reproduce`: every statement of the paper that computation can reach, beside what is computed.

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::Globals;
use super::context::{Context, warn_of_store};
use super::error::CliError;
use super::interrupt;
use super::output::{answer, csv_of, writable_file, writable_folder, write_unbroken};
use super::progress::ProgressLine;
use crate::drawing::Format;
use crate::io::files::FileSet;
use crate::plot::reproduction::draw;
use crate::report::reproduction::{markdown, text};
use crate::study::reproduce::paper::selected;
use crate::study::reproduce::{self, Artifact, Item, Panel, Reproduction, Verdict, reproduce};
use crate::study::table::csv_text;

/// Computes what the paper says, figure by figure, and tells what agrees and what differs
///
/// A figure is one of the paper's, as 2A, S5, `Table S3` or `Movie 1`; a panel of several that are one row, as 2D; or a whole,
/// as 2 or movies. Without one all of them are computed, which takes a minute or two. Sizes,
/// confinement, activity and cues of single cells are the paper's; the constants, and all of lineages, are those of the preset,
/// and of --config and --set.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow reproduce 2C S4 S5
  furrow reproduce 1 S3 --out reproduced --json
  furrow reproduce movies --table movies.md")]
pub struct ReproduceArgs {
    /// Figures, tables and movies of the paper; default all
    #[arg(value_name = "FIGURE")]
    figures: Vec<String>,
    /// Folder for pictures, tables, reproduction.md, results.csv and reproduce.json
    #[arg(help_heading = "Output", long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Kind of the pictures
    #[arg(help_heading = "Output", long, value_name = "KIND", value_enum, default_value_t = Kind::Svg, requires = "out")]
    format: Kind,
    /// Writes the table as Markdown
    #[arg(help_heading = "Output", long, value_name = "FILE.md")]
    table: Option<PathBuf>,
}

/// Kinds of pictures by the extension of their files.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Kind {
    Svg,
    Png,
}

/// The columns of results.csv.
const COLUMNS: [&str; 12] = [
    "figure",
    "id",
    "quantity",
    "paper",
    "computed",
    "published_scheme",
    "rel_error",
    "pass",
    "verdict",
    "criterion",
    "note",
    "seconds",
];
/// What stands beside the pictures.
const FILES: [&str; 3] = ["reproduction.md", "reproduce.json", "results.csv"];

/// What `--json` prints.
#[derive(Serialize)]
struct Answer<'a> {
    constants: &'a str,
    items: &'a [Item],
    agrees: usize,
    differs: usize,
    not_pinned_down: usize,
    elapsed_s: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    out: Option<String>,
}

pub fn run(args: &ReproduceArgs, context: &Context, globals: &Globals) -> Result<(), CliError> {
    let start = Instant::now();
    interrupt::gently();
    let statements = selected(&args.figures)?;
    context.settings.check_divisions("settings")?;
    context.settings.check_activity("settings")?;
    if let Some(folder) = &args.out {
        writable_folder("--out", "out", folder, &FILES)?;
    }
    if let Some(file) = &args.table {
        writable_file("--table", "table", file)?;
    }
    let memo = context.memo()?;
    let line = ProgressLine::new(context.progress);
    let figures = reproduce::Context {
        settings: &context.settings,
        memo: &memo,
        threads: context.threads,
        cancel: interrupt::flag(),
        progress: &|figure: &str| line.say(format!("figure {figure}")),
    };
    let found = reproduce(&figures, &statements);
    drop(line);
    let found = found?;
    warn_of_store(&found.warnings);
    let constants = constants(globals);
    let document = Answer {
        constants: &constants,
        items: &found.items,
        agrees: found.count(Verdict::Agrees),
        differs: found.count(Verdict::Differs),
        not_pinned_down: found.count(Verdict::NotPinnedDown),
        elapsed_s: start.elapsed().as_secs_f64(),
        out: args.out.as_ref().map(|folder| folder.display().to_string()),
    };
    let json = format!("{}\n", serde_json::to_string_pretty(&document)?);
    let page = markdown(&found, &constants);
    if let Some(file) = &args.table {
        write_unbroken(file, page.as_bytes())?;
    }
    if let Some(folder) = &args.out {
        let mut files = FileSet::new(folder);
        files.stage("reproduction.md", page.as_bytes())?;
        files.stage("reproduce.json", json.as_bytes())?;
        files.stage("results.csv", &csv_of(&COLUMNS, &found.items)?)?;
        pictures(&mut files, &found, args.format)?;
        interrupt::unbroken(|| files.commit())?;
    }
    if context.json { answer(&json) } else { answer(&text(&found, &constants)) }
}

/// What the constants in force are called.
fn constants(globals: &Globals) -> String {
    let file = globals.config.as_ref().map(|_| "a configuration file".to_owned());
    let parts: Vec<String> =
        [globals.preset.clone()].into_iter().chain(file).chain(globals.set.iter().cloned()).collect();
    parts.join(", ")
}

/// A picture of every panel, and a table of those that are drawn from one.
fn pictures(files: &mut FileSet, found: &Reproduction, kind: Kind) -> Result<(), CliError> {
    let (format, extension) = match kind {
        Kind::Svg => (Format::Svg, "svg"),
        Kind::Png => (Format::Png, "png"),
    };
    for panel in &found.panels {
        files.stage(&format!("{}.{extension}", panel.name), &draw(panel).bytes(format)?)?;
        if let Some(table) = table(panel)? {
            files.stage(&format!("{}.csv", panel.name), &table)?;
        }
    }
    Ok(())
}

/// A point of a disturbed shape's way.
#[derive(Serialize)]
struct Distance<'a> {
    shape: &'a str,
    t: f64,
    dis: f64,
}

/// The numbers behind a picture, where they are not those of a single cell.
fn table(panel: &Panel) -> Result<Option<Vec<u8>>, CliError> {
    Ok(match &panel.artifact {
        Artifact::Sweep(sweep, rows) => Some(csv_text(&sweep.columns(), rows)?),
        Artifact::Map(map) => Some(csv_of(&["x", "xi_s", "outcome", "chi", "by"], &map.diagram.cells)?),
        Artifact::Perturbations(_, watched) => {
            let rows: Vec<Distance<'_>> = watched
                .iter()
                .flat_map(|(shape, found)| {
                    found.distances.iter().map(move |[t, dis]| Distance { shape, t: *t, dis: *dis })
                })
                .collect();
            Some(csv_of(&["shape", "t", "dis"], &rows)?)
        }
        _ => None,
    })
}
