//! `furrow fit clock`: how lifetimes depend on volume, by founder.

use clap::Args;
use serde_json::json;

use crate::cli::cell::load_lineage;
use crate::cli::context::Context;
use crate::cli::embryos::{
    MatchArgs, OfEmbryo, files_of, frame_minutes, matched_text, of_embryo, times_text, warn_of_averages, warn_of_times,
};
use crate::cli::error::CliError;
use crate::cli::output::{merged, or_dash, print_as, writable_file};
use crate::cli::picture::PlotArgs;
use furrow_analysis::fit::{FittedClock, FittedLaw, Unused, fit_clock};
use furrow_figures::plot;
use furrow_formats::write_atomically;
use furrow_input::listed;
use furrow_measured::lifetimes::{LifetimeOptions, Lifetimes};
use furrow_measured::published::{SOURCE, jankele2021_lifetimes, jankele2021_volumes};
use furrow_measured::tracked::TableKind;
use furrow_measured::volumes::{ReadOptions, Volumes};
use std::fmt::Write;
use std::path::PathBuf;

/// Fits the lifetimes of cells as powers of their volumes, by founder
///
/// For each founder with three cells or more, a straight line is fitted to ln lifetime over ln volume. Prints a clock for a lineage
/// file.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow fit clock
  furrow fit clock lifetimes.csv --volumes volumes.csv --out clock.ron --plot clock.svg
  furrow fit clock lifetimes.csv --json")]
pub struct ClockArgs {
    /// Lifetimes: tables (CSV) or tracked embryos, as for compare lifetimes; default the published ones
    #[arg(value_name = "TABLE")]
    tables: Vec<PathBuf>,
    /// Volumes of the cells: tables (CSV) or tracked embryos, as for compare volumes; default the published ones
    #[arg(help_heading = "Targets", long, value_name = "TABLE")]
    volumes: Vec<PathBuf>,
    /// Minutes per frame, for embryos with times in frames; EMBRYO=MIN sets the value of one embryo. If the file also has times with a
    /// unit, like the XML of TrackMate, frames are used
    #[arg(help_heading = "Targets", long, value_name = "MIN|EMBRYO=MIN",
        value_parser = of_embryo, requires = "tables")]
    frame_minutes: Vec<OfEmbryo>,
    /// Divides the times of each embryo by its time factor before averaging over embryos
    #[arg(help_heading = "Targets", long, requires = "tables")]
    common_pace: bool,
    /// Divides the volumes of each embryo by its size factor before averaging over embryos
    #[arg(help_heading = "Targets", long, requires = "volumes")]
    common_size: bool,
    #[command(flatten)]
    matching: MatchArgs,
    /// Lineage with the founders to fit; default the built-in C. elegans founders
    #[arg(help_heading = "Targets", long, value_name = "LINEAGE.ron")]
    lineage: Option<PathBuf>,
    /// Writes the clock as a lineage file, based on the built-in lineage unless --lineage is given
    #[arg(help_heading = "Output", long, value_name = "FILE.ron")]
    out: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotArgs,
}

pub fn run(args: &ClockArgs, context: &Context) -> Result<(), CliError> {
    let lineage = load_lineage(args.lineage.as_deref())?;
    writable_file("--out", args.out.as_deref())?;
    let picture = args.plot.file()?;
    let names = args.matching.names(&lineage)?;
    let listed_or = |files: &[PathBuf], published: &str| {
        let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
        if files.is_empty() { published.to_owned() } else { listed(files.iter().map(String::as_str), ", ") }
    };
    let lifetimes = match &args.tables[..] {
        [] => jankele2021_lifetimes()?,
        tables => {
            let (frame_minutes, common_pace) = (frame_minutes(&args.frame_minutes)?, args.common_pace);
            let options = LifetimeOptions { frame_minutes, common_pace, names: names.clone() };
            Lifetimes::read_files(&files_of(tables, TableKind::Lifetimes)?, &options)?
        }
    };
    let mut volumes = match &args.volumes[..] {
        [] => jankele2021_volumes()?,
        tables => Volumes::of_files(
            &files_of(tables, TableKind::Volumes)?,
            &ReadOptions { names: names.clone(), ..ReadOptions::default() },
        )?,
    };
    names.require_met()?;
    warn_of_times(&lifetimes.embryos);
    volumes.common_size = args.common_size;
    warn_of_averages(&volumes);
    let files = listed_or(&args.volumes, "the published volumes");
    let found = fit_clock(&lineage, &lifetimes, &volumes, &files)?;
    let ron = found.as_ron(args.lineage.is_none().then_some("c_elegans"));
    if let Some(file) = &args.out {
        write_atomically(file, ron.as_bytes())?;
    }
    picture.write(|| plot::clock::draw(&found))?;
    let (lifetimes_of, volumes_of) = (listed_or(&args.tables, SOURCE), listed_or(&args.volumes, SOURCE));
    let skipped_rows: Vec<_> = lifetimes.skipped.iter().chain(&volumes.skipped).collect();
    let skipped_count = lifetimes.skipped_count + volumes.skipped_count;
    let about = json!({
        "lifetimes": lifetimes_of, "volumes": volumes_of, "skipped_rows": skipped_rows, "skipped_row_count": skipped_count,
        "embryos": lifetimes.embryos, "matched": lifetimes.matched, "ron": ron,
    });
    print_as(context.json, &merged(json!(found), about), || {
        let rows = skipped_rows.iter().take(MOST_ROWS).map(|row| {
            format!("{}, line {}, column {}: {:?}: {}\n", row.file, row.line, row.column, row.value, row.why)
        });
        let rows: String = rows.collect();
        let rows = if skipped_count > 0 { format!("{skipped_count} rows skipped:\n{rows}\n") } else { rows };
        let embryos = times_text(&lifetimes.embryos) + &matched_text(&lifetimes.matched);
        format!("Lifetimes: {lifetimes_of}; volumes: {volumes_of}\n\n{}{embryos}{rows}{ron}", clock_text(&found))
    })
}

/// Largest number of skipped rows listed in the text.
const MOST_ROWS: usize = 10;

fn clock_text(found: &FittedClock) -> String {
    let mut out = "founder  cells   exponent       se     R²   minutes   at volume / first\n".to_owned();
    for FittedLaw { founder, exponent, se, n, lifetime_min, at_volume, r_squared, .. } in
        found.exponents.iter().chain([&found.all])
    {
        let (se, r_squared) = (or_dash(*se, 4), or_dash(*r_squared, 3));
        let _ = writeln!(
            out,
            "{founder:<8} {n:>5}   {exponent:>8.4} {se:>8} {r_squared:>6} {lifetime_min:>9.2}   {at_volume:>9.5}"
        );
    }
    for few in &found.few {
        let _ = writeln!(
            out,
            "{:<8} {:>5}          -        -      - {:>9.2}   {:>9.5}",
            few.founder, few.n, few.lifetime_min, few.at_volume
        );
    }
    out += "Founders with one cell or two get the exponent of all cells.\n";
    if found.exponents.iter().any(|law| law.se.is_none()) {
        out += "An exponent without an error rests on two sizes: a line through two points always fits.\n";
    }
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for Unused { cell, why } in &found.skipped {
        match reasons.iter_mut().find(|(known, _)| known == why) {
            Some((_, cells)) => cells.push(cell),
            None => reasons.push((why, vec![cell])),
        }
    }
    for (why, cells) in reasons {
        let shown = cells.iter().take(MOST_ROWS).copied().collect::<Vec<_>>().join(", ");
        let more = cells.len().saturating_sub(MOST_ROWS);
        let more = if more > 0 { format!(" and {more} more (all with --json)") } else { String::new() };
        let _ = writeln!(out, "{} cells skipped, {why}: {shown}{more}", cells.len());
    }
    out + "\n"
}
