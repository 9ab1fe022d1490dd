//! `furrow compare counts`: rounds compared with the observed ones.

use super::super::messages;
use super::lifetimes::Model;
use super::skipped_text;
use crate::cli::context::Context;
use crate::cli::embryos::MatchArgs;
use crate::cli::error::CliError;
use crate::cli::output::{or_dash, print_as};
use crate::cli::picture::PlotArgs;
use clap::Args;
use furrow_analysis::compare::counts::{Count, Counts, READINGS, StageCounts, counts, counts_of_embryo};
use furrow_figures::plot;
use furrow_formats::read_tree;
use furrow_input::{InputError, listed};
use furrow_measured::tracked::{Absent, TrackOptions, read_embryo};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Compares rounds of division with the observed ones, by every definition of "rounds" and at several stages
///
/// The observed counts are those in the tree's lineage file; for C. elegans they are the rounds at hatching and in embryos of 349 and 549
/// cells (Sulston et al. 1983). Prints which definitions give rounds within one of the observed, where and why branches ended, and for
/// C. elegans whether the paper's statement on rounds holds. With --measured the tree is compared with an embryo tracked by another
/// program, up to its last frame.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow compare counts
  furrow compare counts --preset sulston1983 --json")]
pub struct CountsArgs {
    /// A tree.json of an earlier run, or a lineage file to grow; default the built-in C. elegans founders
    #[arg(value_name = "TREE.json|LINEAGE.ron")]
    tree: Option<PathBuf>,
    /// An embryo tracked by another program: nuclei (zip) or CD table of AceTree, spots of TrackMate, MaMuT (XML, CSV) or Mastodon
    /// (CSV), tracks of napari, ultrack (CSV) or the Cell Tracking Challenge (txt), GEFF; or the CSV of furrow export
    #[arg(help_heading = "Tables", long, value_name = "FILE")]
    measured: Option<PathBuf>,
    #[command(flatten)]
    matching: MatchArgs,
    #[command(flatten)]
    plot: PlotArgs,
}

pub fn run(args: &CountsArgs, context: &Context) -> Result<(), CliError> {
    let picture = args.plot.file()?;
    let is_lineage = |file: &&Path| file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ron"));
    let model = match args.tree.as_deref() {
        Some(file) if !is_lineage(&file) => Model::Grown(Box::new(read_tree(file)?)),
        lineage => Model::read(lineage)?,
    };
    let names = args.matching.names(model.lineage())?;
    let read = |path: &Path| {
        let embryo = read_embryo(path, &TrackOptions::default(), &names)?;
        Ok::<_, InputError>((embryo, path.display().to_string()))
    };
    let measured = args.measured.as_deref().map(read).transpose()?;
    names.require_met()?;
    let tree = model.tree(context)?;
    let source = args.tree.as_ref().map_or("c_elegans.ron (built in)".to_owned(), |file| file.display().to_string());
    let found = match &measured {
        Some((measured, file)) => counts_of_embryo(&tree, measured, &names, file)?,
        None => counts(&tree, &source)?,
    };
    if let Some(first) = found.skipped.first() {
        messages::warning!("{} values or cells are not used; the first is {first}", found.skipped_count);
    }
    if !found.not_followed.is_empty() {
        messages::warning!("{}", not_followed_text(&found));
    }
    picture.write(|| plot::rounds::draw(&tree))?;
    print_as(context.json, &found, || counts_text(&found))
}

fn counts_text(found: &Counts) -> String {
    let mut out = String::new();
    for StageCounts { cells, founders } in &found.stages {
        let names: String = READINGS.iter().map(|reading| format!("{:>20}", reading.replace('_', " "))).collect();
        let of = cells.map_or(found.lineage.clone(), |cells| format!("embryo of {cells} cells"));
        let _ = writeln!(out, "observed {of} (model, observed; * within one round)");
        let width = founders.iter().map(|founder| founder.founder.chars().count()).fold(8, usize::max);
        let _ = writeln!(out, "{:<width$}{names}", "founder");
        for founder in founders {
            let _ = write!(out, "{:<width$}", founder.founder);
            let counts = READINGS.map(|reading| format!("{:>20}", count_text(reading, founder.counts.get(reading))));
            let _ = writeln!(out, "{}", counts.concat().trim_end());
        }
        out.push('\n');
    }
    if let Some(matched) = &found.matched {
        let _ = writeln!(out, "{matched}");
    }
    for Absent { founder, why } in &found.absent {
        let _ = writeln!(out, "no row for {founder}: {why}");
    }
    if !found.not_followed.is_empty() {
        let _ = writeln!(out, "{}", not_followed_text(found));
    }
    out += &skipped_text(&[(&found.skipped, found.skipped_count)]);
    if !(found.absent.is_empty() && found.not_followed.is_empty() && found.skipped.is_empty()) {
        out.push('\n');
    }
    if !found.sentence.is_empty() {
        out += "\"To within a single round for the EMS and P lineages\", and not elsewhere, at the last stage:\n";
    }
    for sentence in &found.sentence {
        let parts = [sentence.ems, sentence.germline, sentence.elsewhere_not, sentence.holds];
        let [ems, germline, off, all] = parts.map(|holds| if holds { "yes" } else { "no" });
        let reading = sentence.reading.replace('_', " ");
        let _ = writeln!(
            out,
            "  {reading:<16} EMS {ems:<4} germline {germline:<4} AB, C and D off by more {off:<4} all: {all}"
        );
    }
    if let Some([model, observed]) = found.germline {
        let _ = writeln!(out, "Divisions down the germline: {model} in the model, {observed} observed\n");
    }
    out += "Where cells of each founder end, and why:\n";
    for ends in &found.ends {
        let reasons: Vec<String> = ends.ended.iter().map(|(why, n)| format!("{n} {}", why.replace('_', " "))).collect();
        let r0 = ends.r0.map_or(String::new(), |[least, most]| format!(", R0 {least:.3} to {most:.3}"));
        let _ = writeln!(out, "  {:<6} {}{r0}", ends.founder, reasons.join(", "));
    }
    out
}

/// The cells that were not followed although their sisters were.
fn not_followed_text(found: &Counts) -> String {
    let cells = listed(found.not_followed.iter().map(String::as_str), ", ");
    format!("not followed although the sister was, and each counted as one terminal cell: {cells}")
}

/// The model's count and the observed one, if known.
fn count_text(reading: &str, count: Option<&Count>) -> String {
    let Some(Count { model, observed, within_one }) = count else { return String::new() };
    let digits = if reading == "mean" { 2 } else { 0 };
    let model = or_dash(*model, digits);
    format!("{model}, {observed:.digits$}{}", if *within_one { '*' } else { ' ' })
}
