//! `furrow compare`: the model beside measured embryos.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs::File;
use std::path::PathBuf;

use clap::{Args, Subcommand};
use measured::events::{Divisions, GroupSummary, divisions, summaries};
use measured::published::{SOURCE, jankele2021};
use measured::trend::{AdjacentTest, VolumeBin, adjacent_tests, volume_bins};
use measured::volumes::{ReadOptions, Skipped, Volumes};
use serde::Serialize;

use super::cell::number;
use super::compare_files as files;
use super::context::Context;
use super::error::CliError;
use super::interrupt;
use super::output::{answer, writable_folder};
use super::plot::PlotArgs;
use super::tree::{grown, of_tree};
use crate::input::{InputError, read_text};
use crate::lineage::{Lineage, Tree, TreeSettings};
use crate::study::compare::counts::{Counts, READINGS, counts};
use crate::study::compare::volumes::{
    Beside, GroupBeside, Modelled, Regression, beside, length_scale, modelled, regression, with_first_division_of,
};
use crate::study::scenarios::Scenario;

/// Holds the model beside measured embryos
#[derive(Debug, Args)]
pub struct CompareArgs {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Counts(CountsArgs),
    Volumes(VolumesArgs),
}

/// Rounds of division per founder beside the observed ones, by every reading of "rounds" and at several stages
///
/// Observed are the rounds of C. elegans at hatching and in embryos of 349 and 549 cells (Sulston et al. 1983). Says by which
/// reading rounds are within one of the observed, whether the paper's sentence on rounds holds, and where cells ended and why.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow compare counts
  furrow compare counts --preset sulston1983 --json")]
struct CountsArgs {
    /// A tree that was grown before; default the built-in C. elegans founders, grown now
    #[arg(value_name = "TREE.json")]
    tree: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotArgs,
}

/// Size asymmetries of measured divisions beside the model's
///
/// Tables of volumes are long ones, with columns embryo, cell and volume (or volume_um3, volume_voxels, relative_volume) and,
/// if wanted, group, frame and n; or grids of frames by cells of one embryo each, in voxels, as SampleNN_Volume.csv. Without a
/// table the model is held beside published means. The model says χ twice: grown from its zygote, and with AB and P1 as large
/// as each group measures them.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow compare volumes
  furrow compare volumes --preset sulston1983 --plot chi.svg --json")]
struct VolumesArgs {
    /// Tables of cell volumes, CSV
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Tables of a second condition, for the regression of one on the other
    #[arg(help_heading = "Tables", long, value_name = "FILE", requires = "files")]
    against: Vec<PathBuf>,
    /// Edge of a voxel, in µm: volumes in voxels become µm³
    #[arg(help_heading = "Tables", long, value_name = "UM", value_parser = number)]
    voxel: Option<f64>,
    /// Two groups to regress on each other, as wt,ctrl
    #[arg(help_heading = "Statistics", long, value_name = "X,Y")]
    regress: Option<String>,
    /// Edges of the bins of the mother's volume, rising, as 100,1000,10000; default decades
    #[arg(help_heading = "Statistics", long, value_name = "V,V,..", value_delimiter = ',', value_parser = number)]
    bins: Option<Vec<f64>>,
    /// One L_h in µm; default such that P0 is as large as measured
    #[arg(help_heading = "Statistics", long, value_name = "UM", value_parser = number)]
    length_scale: Option<f64>,
    /// Lineage that the model grows; default the built-in C. elegans founders
    #[arg(help_heading = "Model", long, value_name = "LINEAGE.ron")]
    lineage: Option<PathBuf>,
    /// Folder for chi.csv, divisions.csv, bins.csv and compare.json
    #[arg(help_heading = "Output", long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotArgs,
}

/// Groups with whose own first division a tree is grown.
const MOST_GROUPS: usize = 50;

/// What is told of so much that was skipped, a line each.
const MOST_SKIPPED: usize = 10;

pub fn run(args: &CompareArgs, context: &Context) -> Result<(), CliError> {
    interrupt::gently();
    match &args.what {
        What::Counts(args) => compare_counts(args, context),
        What::Volumes(args) => compare_volumes(args, context),
    }
}

/// Trees of several lineages with the parameters of the command, in one run.
fn trees_of(lineages: Vec<Lineage>, context: &Context) -> Result<Vec<Tree>, CliError> {
    context.settings.check_divisions("settings")?;
    let scenario = |lineage: Lineage| Scenario {
        name: String::new(),
        label: String::new(),
        cue: None,
        settings: of_tree(context.settings.clone(), &lineage, 0, context),
        lineage,
    };
    let scenarios: Vec<Scenario> = lineages.into_iter().map(scenario).collect();
    Ok(grown(&scenarios, false, context)?.0)
}

fn compare_counts(args: &CountsArgs, context: &Context) -> Result<(), CliError> {
    let picture = args.plot.file()?;
    let tree = match &args.tree {
        Some(file) => Tree::from_json(&read_text(file)?).map_err(|error| InputError::OtherFile {
            file: file.display().to_string(),
            wanted: "a tree as furrow tree writes it".to_owned(),
            reason: error.to_string(),
        })?,
        None => trees_of(vec![Lineage::load(None)?], context)?.remove(0),
    };
    let found = counts(&tree)?;
    if let Some(picture) = picture {
        picture.write(&crate::plot::rounds::draw(&tree))?;
    }
    if context.json {
        return answer(&format!("{}\n", serde_json::to_string_pretty(&found)?));
    }
    answer(&counts_text(&found))
}

fn counts_text(found: &Counts) -> String {
    let mut out = String::new();
    for stage in &found.stages {
        let _ = writeln!(out, "observed embryo of {} cells (model, observed; * within one round)", stage.cells);
        let names: String = READINGS.iter().map(|reading| format!("{:>20}", reading.replace('_', " "))).collect();
        let _ = writeln!(out, "{:<8}{names}", "founder");
        for founder in &stage.founders {
            let _ = write!(out, "{:<8}", founder.founder);
            for reading in READINGS {
                let count = &founder.counts[reading];
                let digits = if reading == "mean" { 2 } else { 0 };
                let model = count.model.map_or("-".to_owned(), |model| format!("{model:.digits$}"));
                let mark = if count.within_one { '*' } else { ' ' };
                let _ = write!(out, "{:>20}", format!("{model}, {:.digits$}{mark}", count.observed));
            }
            out.push('\n');
        }
        out.push('\n');
    }
    let _ =
        writeln!(out, "\"To within a single round for the EMS and P lineages\", and not elsewhere, at the last stage:");
    for sentence in &found.sentence {
        let word = |holds: bool| if holds { "yes" } else { "no" };
        let _ = writeln!(
            out,
            "  {:<16} EMS {:<4} germline {:<4} AB, C and D off by more {:<4} all: {}",
            sentence.reading.replace('_', " "),
            word(sentence.ems),
            word(sentence.germline),
            word(sentence.elsewhere_not),
            word(sentence.holds)
        );
    }
    let _ = writeln!(
        out,
        "Divisions down the germline: {} in the model, {} observed",
        found.germline[0], found.germline[1]
    );
    let _ = writeln!(out, "\nWhere cells of each founder end, and why:");
    for ends in &found.ends {
        let reasons: Vec<String> = ends.ended.iter().map(|(why, n)| format!("{n} {}", why.replace('_', " "))).collect();
        let r0 = ends.r0.map_or(String::new(), |[least, most]| format!(", R0 {least:.3} to {most:.3}"));
        let _ = writeln!(out, "  {:<6} {}{r0}", ends.founder, reasons.join(", "));
    }
    out
}

/// What `compare volumes --json` prints.
#[derive(Serialize)]
struct Answer<'a> {
    source: Option<&'static str>,
    groups: &'a [GroupBeside],
    used: u64,
    skipped: &'a [Skipped],
    skipped_count: u64,
    divisions: usize,
    half_seen: &'a [measured::events::HalfSeen],
    unit: Option<measured::volumes::Unit>,
    length_scale_um: Option<f64>,
    bins: Vec<VolumeBin>,
    tests: Vec<AdjacentTest>,
    regressions: Vec<Regression>,
}

/// The measured side of a comparison.
struct Measured {
    source: Option<&'static str>,
    volumes: Volumes,
    found: Divisions,
    groups: Vec<GroupSummary>,
}

fn compare_volumes(args: &VolumesArgs, context: &Context) -> Result<(), CliError> {
    check(args)?;
    let picture = args.plot.file()?;
    if let Some(out) = &args.out {
        writable_folder("--out", "out", out, &files::NAMES)?;
    }
    let measured = read(args)?;
    let lineage = Lineage::load(args.lineage.as_deref())?;
    let settings: TreeSettings = of_tree(context.settings.clone(), &lineage, 0, context);
    let r0 = settings.cell.r0;
    let given: Vec<(String, Lineage)> = measured
        .groups
        .iter()
        .filter_map(|group| Some((group.group.clone(), with_first_division_of(&lineage, group, r0)?)))
        .take(MOST_GROUPS)
        .collect();
    let lineages = std::iter::once(lineage).chain(given.iter().map(|(_, lineage)| lineage.clone())).collect();
    let trees: Vec<BTreeMap<String, Modelled>> = trees_of(lineages, context)?.iter().map(modelled).collect();
    let Some((free, firsts)) = trees.split_first() else { return Ok(()) };
    let firsts = given.into_iter().map(|(group, _)| group).zip(firsts.iter().cloned()).collect();
    let all = &measured.found.divisions;
    let groups = beside(measured.groups.clone(), all, free, &firsts, args.bins.as_deref());
    let bins = volume_bins(all, args.bins.as_deref());
    let answer_of = Answer {
        source: measured.source,
        used: measured.volumes.used,
        skipped: &measured.volumes.skipped,
        skipped_count: measured.volumes.skipped_count,
        divisions: all.len(),
        half_seen: &measured.found.half_seen,
        unit: measured.volumes.unit,
        length_scale_um: args.length_scale.or_else(|| {
            let micrometres = measured.volumes.unit == Some(measured::volumes::Unit::CubicMicrometres);
            length_scale(all, r0).filter(|_| micrometres)
        }),
        tests: adjacent_tests(&bins),
        bins,
        regressions: regressions(args, &groups)?,
        groups: &groups,
    };
    if let Some(out) = &args.out {
        let json = format!("{}\n", serde_json::to_string_pretty(&answer_of)?);
        files::write(out, &groups, all, (&answer_of.bins, &answer_of.tests), &json)?;
    }
    if let Some(picture) = picture {
        let unit = answer_of.unit.map_or(String::new(), |unit| format!("({})", unit.symbol().trim_matches(['(', ')'])));
        picture.write(&crate::plot::comparison::draw(&groups, all, &unit, answer_of.length_scale_um))?;
    }
    if context.json {
        return answer(&format!("{}\n", serde_json::to_string_pretty(&answer_of)?));
    }
    answer(&volumes_text(&answer_of))
}

fn check(args: &VolumesArgs) -> Result<(), InputError> {
    for (option, field, value) in
        [("--voxel", "voxel", args.voxel), ("--length-scale", "length_scale", args.length_scale)]
    {
        if let Some(value) = value.filter(|value| *value <= 0.0) {
            return Err(InputError::not_allowed(option, field, value, "a length above 0, in µm"));
        }
    }
    if let Some(edges) = &args.bins
        && (edges.len() < 2 || edges.windows(2).any(|pair| pair[0] >= pair[1]))
    {
        let given = edges.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        return Err(InputError::not_allowed("--bins", "bins", given, "two numbers or more, rising"));
    }
    Ok(())
}

fn read(args: &VolumesArgs) -> Result<Measured, CliError> {
    let mut volumes = Volumes::default();
    if args.files.is_empty() {
        let groups = jankele2021()?;
        return Ok(Measured { source: Some(SOURCE), volumes, found: Divisions::default(), groups });
    }
    // Two conditions are two groups, if their tables name none.
    let names = |name: &str| (!args.against.is_empty()).then(|| name.to_owned());
    for (files, group) in [(&args.files, names("measured")), (&args.against, names("against"))] {
        let options = ReadOptions { voxel: args.voxel, group };
        for file in files {
            let name = file.display().to_string();
            let opened = File::open(file).and_then(|opened| match opened.metadata()?.is_dir() {
                true => Err(std::io::Error::other("it is a folder, not a file")),
                false => Ok(opened),
            });
            let opened = opened.map_err(|e| InputError::Unreadable { file: name.clone(), reason: e.to_string() })?;
            volumes.read(opened, &name, &options)?;
        }
    }
    let found = divisions(&volumes);
    let groups = summaries(&found.divisions);
    Ok(Measured { source: None, volumes, found, groups })
}

/// The regressions asked for: of named groups, or of two conditions.
fn regressions(args: &VolumesArgs, groups: &[GroupBeside]) -> Result<Vec<Regression>, InputError> {
    let names = match &args.regress {
        Some(text) => text.split_once(',').map(|(x, y)| (x.trim().to_owned(), y.trim().to_owned())),
        None if !args.against.is_empty() => Some(("measured".to_owned(), "against".to_owned())),
        None => return Ok(Vec::new()),
    };
    let known: Vec<&str> = groups.iter().map(|group| group.group.as_str()).collect();
    let allowed = format!("two groups of the tables, as X,Y; groups are {}", known.join(", "));
    let find = |name: &str| groups.iter().find(|group| group.group == name);
    let given = || args.regress.clone().unwrap_or_default();
    let refused = || InputError::not_allowed("--regress", "regress", given(), &allowed);
    let (x, y) = names.ok_or_else(refused)?;
    match (find(&x), find(&y)) {
        (Some(x), Some(y)) => Ok(vec![regression(x, y)]),
        // Tables that name groups of their own have none by the condition.
        _ if args.regress.is_none() => Ok(Vec::new()),
        _ => Err(refused()),
    }
}

fn volumes_text(found: &Answer<'_>) -> String {
    let mut out = String::new();
    if let Some(source) = found.source {
        let _ = writeln!(out, "measured: means published by {source}\n");
    }
    for group in found.groups {
        group_text(&mut out, group);
    }
    if !found.bins.is_empty() {
        let unit = found.unit.map_or("", measured::volumes::Unit::symbol);
        let _ = writeln!(out, "χ by the mother's volume, in {unit}, of all groups:");
        bins_text(&mut out, &found.bins, &found.tests);
    }
    for regression in &found.regressions {
        regression_text(&mut out, regression);
    }
    if let Some(scale) = found.length_scale_um {
        let _ = writeln!(out, "one L_h is {scale:.3} µm, by P0");
    }
    if found.source.is_none() {
        let _ = writeln!(
            out,
            "{} volumes used, {} skipped; {} divisions with both daughters, {} with one",
            found.used,
            found.skipped_count,
            found.divisions,
            found.half_seen.len()
        );
    }
    for skipped in found.skipped.iter().take(MOST_SKIPPED) {
        let Skipped { file, line, column, value, why } = skipped;
        let _ = writeln!(out, "  skipped {file}:{line}, column {column}: {value:?}: {why}");
    }
    if found.skipped_count as usize > MOST_SKIPPED {
        let _ = writeln!(out, "  and {} more (--json gives their places)", found.skipped_count as usize - MOST_SKIPPED);
    }
    out
}

fn group_text(out: &mut String, group: &GroupBeside) {
    let name = if group.group.is_empty() { "measured".to_owned() } else { format!("group {}", group.group) };
    let _ = writeln!(out, "{name}, {} embryos", group.embryos);
    let _ = writeln!(
        out,
        "{:<10}{:>4} {:>16} {:>8} {:>16} {:>22}",
        "mother", "n", "χ measured", "signed", "model (sd off)", "AB, P1 as measured"
    );
    for event in &group.events {
        let Beside { measured, model, given_first } = event;
        let sd = measured.sd.map_or("".to_owned(), |sd| format!(" ± {sd:.3}"));
        let of = |modelled: &Option<Modelled>| match modelled {
            Some(Modelled { chi: Some(chi), .. }) => {
                let off = event.off(*chi).map_or(String::new(), |off| format!(" ({off:+.1})"));
                format!("{chi:.3}{off}")
            }
            Some(Modelled { outcome: Some(outcome), .. }) => outcome.name().to_owned(),
            _ => "-".to_owned(),
        };
        let _ = writeln!(
            out,
            "{:<10}{:>4} {:>16} {:>+8.3} {:>16} {:>22}",
            measured.mother,
            measured.n,
            format!("{:.3}{sd}", measured.mean),
            measured.mean_signed,
            of(model),
            of(given_first)
        );
    }
    out.push('\n');
}

fn bins_text(out: &mut String, bins: &[VolumeBin], tests: &[AdjacentTest]) {
    for (k, bin) in bins.iter().enumerate() {
        let sd = bin.sd.map_or(String::new(), |sd| format!(" ± {sd:.3}"));
        let test = k.checked_sub(1).and_then(|k| tests.get(k)).map_or(String::new(), |test| {
            format!("  larger than above: U = {}, p = {:.3e} {}", test.test.u, test.test.p, test.stars)
        });
        let _ = writeln!(out, "  {:<16} n = {:<5} χ = {:.3}{sd}{test}", bin.name(), bin.n, bin.mean);
    }
    out.push('\n');
}

fn regression_text(out: &mut String, regression: &Regression) {
    let _ = writeln!(out, "χ of {} over χ of {}, {} mothers:", regression.y, regression.x, regression.mothers.len());
    if let Some(line) = &regression.through_origin {
        let _ = writeln!(
            out,
            "  through the origin: slope {:.4} ± {:.4}, R² = {:.4}",
            line.slope, line.slope_error, line.r_squared
        );
    }
    if let Some(line) = &regression.with_intercept {
        let _ = writeln!(
            out,
            "  with an intercept: slope {:.4} ± {:.4}, intercept {:+.4}, R² = {:.4}",
            line.slope, line.slope_error, line.intercept, line.r_squared
        );
    }
    out.push('\n');
}
