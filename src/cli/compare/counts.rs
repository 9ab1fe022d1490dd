//! `furrow compare counts`: rounds beside the observed ones.

use super::trees_of;
use crate::cli::context::Context;
use crate::cli::error::CliError;
use crate::cli::output::print_as;
use crate::cli::picture::PlotArgs;
use clap::Args;
use furrow_analysis::compare::counts::{Count, Counts, READINGS, counts};
use furrow_figures::plot;
use furrow_formats::read_tree;
use furrow_lineage::Lineage;
use std::fmt::Write;
use std::path::PathBuf;

/// Compares rounds of division with the observed ones, by every definition of "rounds" and at several stages
///
/// Observed are the rounds of C. elegans at hatching and in embryos of 349 and 549 cells (Sulston et al. 1983). Says by which
/// reading rounds are within one of the observed, whether the paper's sentence on rounds holds, and where cells ended and why.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow compare counts
  furrow compare counts --preset sulston1983 --json")]
pub struct CountsArgs {
    /// A tree that was grown before; default the built-in C. elegans founders, grown now
    #[arg(value_name = "TREE.json")]
    tree: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotArgs,
}

pub fn run(args: &CountsArgs, context: &Context) -> Result<(), CliError> {
    let picture = args.plot.file()?;
    let tree = match &args.tree {
        Some(file) => read_tree(file)?,
        None => trees_of(vec![Lineage::load(None)?], context)?.remove(0),
    };
    let found = counts(&tree)?;
    picture.write(|| plot::rounds::draw(&tree))?;
    print_as(context.json, &found, || counts_text(&found))
}

fn counts_text(found: &Counts) -> String {
    let mut out = String::new();
    for stage in &found.stages {
        let names: String = READINGS.iter().map(|reading| format!("{:>20}", reading.replace('_', " "))).collect();
        let _ = writeln!(out, "observed embryo of {} cells (model, observed; * within one round)", stage.cells);
        let _ = writeln!(out, "founder {names}");
        for founder in &stage.founders {
            let _ = write!(out, "{:<8}", founder.founder);
            for reading in READINGS {
                let Count { model, observed, within_one } = founder.counts[reading];
                let digits = if reading == "mean" { 2 } else { 0 };
                let model = model.map_or("-".to_owned(), |model| format!("{model:.digits$}"));
                let mark = if within_one { '*' } else { ' ' };
                let _ = write!(out, "{:>20}", format!("{model}, {observed:.digits$}{mark}"));
            }
            out.push('\n');
        }
        out.push('\n');
    }
    out += "\"To within a single round for the EMS and P lineages\", and not elsewhere, at the last stage:\n";
    for sentence in &found.sentence {
        let parts = [sentence.ems, sentence.germline, sentence.elsewhere_not, sentence.holds];
        let [ems, germline, off, all] = parts.map(|holds| if holds { "yes" } else { "no" });
        let reading = sentence.reading.replace('_', " ");
        let _ = writeln!(
            out,
            "  {reading:<16} EMS {ems:<4} germline {germline:<4} AB, C and D off by more {off:<4} all: {all}"
        );
    }
    let [model, observed] = found.germline;
    let _ = writeln!(out, "Divisions down the germline: {model} in the model, {observed} observed");
    out += "\nWhere cells of each founder end, and why:\n";
    for ends in &found.ends {
        let reasons: Vec<String> = ends.ended.iter().map(|(why, n)| format!("{n} {}", why.replace('_', " "))).collect();
        let r0 = ends.r0.map_or(String::new(), |[least, most]| format!(", R0 {least:.3} to {most:.3}"));
        let _ = writeln!(out, "  {:<6} {}{r0}", ends.founder, reasons.join(", "));
    }
    out
}
