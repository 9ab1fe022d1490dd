//! `furrow compare lifetimes`: measured lifetimes compared with the lifetimes in a tree with a clock.

use super::{skipped_text, trees_of};
use crate::cli::cell::load_lineage;
use crate::cli::context::Context;
use crate::cli::embryos::{
    MatchArgs, OfEmbryo, files_of, frame_minutes, matched_text, of_embryo, times_text, warn_of_averages, warn_of_times,
};
use crate::cli::error::CliError;
use crate::cli::output::{or_dash, print_as};
use crate::cli::picture::PlotArgs;
use clap::Args;
use furrow_analysis::compare::departure::{Counts, Departure, LoneDivision};
use furrow_analysis::compare::lifetimes::{
    CellComparison, Deviation, FounderComparison, LifetimesComparison, Order, SistersComparison, compare_lifetimes,
    document,
};
use furrow_figures::plot;
use furrow_formats::read_tree;
use furrow_input::InputError;
use furrow_lineage::{Lineage, Tree};
use furrow_measured::lifetimes::{Agreement, LifetimeOptions, Lifetimes, mean_volumes};
use furrow_measured::names::Names;
use furrow_measured::published::{SOURCE, jankele2021_lifetimes, jankele2021_volumes};
use furrow_measured::significance::Trend;
use furrow_measured::statistics::SPREAD_FROM;
use furrow_measured::tracked::TableKind;
use furrow_measured::volumes::{ReadOptions, Volumes};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Compares measured lifetimes of cells with the lifetimes in a tree with a clock
///
/// A table has the columns cell and lifetime_min (or lifetime_s, lifetime_h; or birth_min and division_min), and optionally embryo, n,
/// sd_min and birth_min; lines that begin with # are comments. As for compare volumes, embryos tracked by other programs can be read
/// too. If there are several embryos, each has a time factor and a minute 0. Without a table the means of 28 embryos of C. elegans are
/// used. Prints every cell, the lifetime over the volume by founder, which sister of each pair divides first, and when the number of
/// cells in the model departs from the embryo's. The clock is fitted, so the model's lifetimes are not predictions; its cells, their
/// sizes and therefore the order of sisters are.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow compare lifetimes
  furrow compare lifetimes lifetimes.csv --tree furrow-out/tree.json")]
pub struct LifetimesArgs {
    /// Tables of lifetimes (CSV), embryos tracked by other programs, or folders of these; default published means
    #[arg(value_name = "TABLE")]
    tables: Vec<PathBuf>,
    /// A tree.json of an earlier run, or a lineage file to grow; default the built-in C. elegans founders
    #[arg(help_heading = "Model", long, visible_alias = "lineage", value_name = "TREE.json|LINEAGE.ron")]
    tree: Option<PathBuf>,
    /// Tables of cell volumes, as for compare volumes; default the published ones, for a lineage with the founders of C. elegans
    #[arg(help_heading = "Tables", long, value_name = "FILE")]
    volumes: Vec<PathBuf>,
    /// Minutes per frame, for embryos with times in frames; EMBRYO=MIN sets the value of one embryo. If the file also has times with a
    /// unit, like the XML of TrackMate, frames are used
    #[arg(help_heading = "Tables", long, value_name = "MIN|EMBRYO=MIN",
        value_parser = of_embryo, requires = "tables")]
    frame_minutes: Vec<OfEmbryo>,
    /// Divides the times of each embryo by its time factor before averaging over embryos
    #[arg(help_heading = "Tables", long, requires = "tables")]
    common_pace: bool,
    /// Divides the volumes of each embryo by its size factor before averaging over embryos
    #[arg(help_heading = "Tables", long, requires = "volumes")]
    common_size: bool,
    #[command(flatten)]
    matching: MatchArgs,
    #[command(flatten)]
    plot: PlotArgs,
}

pub fn run(args: &LifetimesArgs, context: &Context) -> Result<(), CliError> {
    let picture = args.plot.file()?;
    let model = Model::read(args.tree.as_deref())?;
    let names = args.matching.names(model.lineage())?;
    let lifetimes = lifetimes(args, &names)?;
    let of_worm = names.are_of_worm();
    let mut volumes = match &args.volumes[..] {
        [] if of_worm => jankele2021_volumes()?,
        [] => Volumes::default(),
        files => Volumes::of_files(
            &files_of(files, TableKind::Volumes)?,
            &ReadOptions { names: names.clone(), ..ReadOptions::default() },
        )?,
    };
    names.require_met()?;
    volumes.common_size = args.common_size;
    warn_of_averages(&volumes);
    warn_of_times(&lifetimes.embryos);
    let tree = model.tree(context)?;
    let found = compare_lifetimes(&tree, &lifetimes, &mean_volumes(&volumes));
    let is_used = found.cells.iter().any(|cell| cell.volume.is_some());
    let allowed = "tables with the volume of a cell that has a lifetime";
    InputError::require(is_used || args.volumes.is_empty(), "--volumes", "cells", "(none)", allowed)?;
    picture.write(|| plot::lifetimes::draw(&found, volumes.unit))?;
    let published = [args.tables.is_empty(), args.volumes.is_empty() && of_worm];
    print_as(context.json, &document(&found, &lifetimes, &volumes, published), || {
        let source = if published[0] { format!("measured: means published by {SOURCE}\n") } else { String::new() };
        let used = format!("{} rows of lifetimes used, {} skipped\n", lifetimes.used, lifetimes.skipped_count);
        let places = [(&*lifetimes.skipped, lifetimes.skipped_count), (&*volumes.skipped, volumes.skipped_count)];
        let embryos = times_text(&lifetimes.embryos) + &matched_text(&lifetimes.matched);
        source + &text(&found) + &embryos + &used + &skipped_text(&places)
    })
}

fn lifetimes(args: &LifetimesArgs, names: &Names) -> Result<Lifetimes, InputError> {
    if args.tables.is_empty() {
        return jankele2021_lifetimes();
    }
    let (frame_minutes, common_pace) = (frame_minutes(&args.frame_minutes)?, args.common_pace);
    Lifetimes::read_files(
        &files_of(&args.tables, TableKind::Lifetimes)?,
        &LifetimeOptions { frame_minutes, common_pace, names: names.clone() },
    )
}

/// A grown tree, or a lineage to grow.
pub(super) enum Model {
    Grown(Box<Tree>),
    ToGrow(Box<Lineage>),
}

impl Model {
    /// Reads a tree.json or a lineage file, distinguished by the extension.
    pub(super) fn read(file: Option<&Path>) -> Result<Model, InputError> {
        let is_json = |file: &&Path| file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
        match file.filter(is_json) {
            Some(file) => Ok(Model::Grown(Box::new(read_tree(file)?))),
            None => Ok(Model::ToGrow(Box::new(load_lineage(file)?))),
        }
    }

    pub(super) fn lineage(&self) -> &Lineage {
        match self {
            Model::Grown(tree) => &tree.lineage,
            Model::ToGrow(lineage) => lineage,
        }
    }

    /// The tree in the file, or a tree grown from the lineage.
    pub(super) fn tree(self, context: &Context) -> Result<Tree, CliError> {
        match self {
            Model::Grown(tree) => Ok(*tree),
            Model::ToGrow(lineage) => Ok(trees_of(vec![*lineage], &context.memo()?, context)?.remove(0)),
        }
    }
}

fn text(found: &LifetimesComparison) -> String {
    let mut out = match found.has_clock {
        true => format!("model: {}, lifetimes by its clock\n\n", found.lineage),
        false => format!("model: {}, which has no clock: see clock in the book\n\n", found.lineage),
    };
    out += "lifetimes in minutes\ncell            n          measured    model (sd off)\n";
    out.extend(found.cells.iter().map(cell_text));
    out += &founders_text(found);
    out += &order_text(&found.order);
    let off = |which: &str, deviation: Option<Deviation>| {
        deviation.map_or(String::new(), |deviation| {
            let Deviation { cells, rms_ln, mean_ln, too_short, too_long, with_sd, within_two_sd } = deviation;
            let off = 100.0 * rms_ln;
            let within = match with_sd {
                0 => String::new(),
                _ => format!(", {within_two_sd} of {with_sd} by at most 2 sd"),
            };
            format!(
                "the model's lifetimes of {cells} cells{which} are off by {off:.1} % (root mean square of ln){within}; \
                 {too_short} are too short, {too_long} too long (mean of ln {mean_ln:+.2})\n"
            )
        })
    };
    let deviation = off("", found.deviation) + &off(" without a measured volume", found.deviation_without_volume);
    if found.has_clock {
        out += "the model's lifetimes are those of its clock: where it was fitted to this table they agree by construction\n";
    }
    out + &deviation + &departure_text(found)
}

fn cell_text(cell: &CellComparison) -> String {
    let model = match (cell.model, cell.model_divides) {
        (Some(model), _) => {
            let off = cell.off().map_or(String::new(), |off| format!(" ({off:+.1})"));
            format!("{model:.1}{off}")
        }
        (None, Some(false)) => "does not divide".to_owned(),
        (None, None) => "not born".to_owned(),
        (None, Some(true)) => "-".to_owned(),
    };
    let measured = mean_sd(cell.measured.mean, cell.measured.sd, cell.measured.n);
    format!("{:<12}{:>5}{measured:>18}{model:>18}\n", cell.measured.cell, cell.measured.n)
}

fn mean_sd(mean: f64, sd: Option<f64>, n: u64) -> String {
    let sd = sd.filter(|_| n >= SPREAD_FROM as u64);
    format!("{mean:.1}{}", sd.map_or(String::new(), |sd| format!(" ± {sd:.1}")))
}

fn founders_text(found: &LifetimesComparison) -> String {
    let mut out = "\nby founder, with the slope of ln lifetime over ln volume (all dividing cells of the model)\n\
         founder   cells          measured             model           slope   cells      R²           p   model's slope\n"
        .to_owned();
    let slopes = |slope: Option<Trend>, model: Option<Trend>| {
        let measured = slope.map_or(format!("{:>16}{:>8}{:>8}{:>12}", "-", "-", "-", "-"), |Trend { line, p }| {
            // Two sizes determine a slope without an error.
            let error = if line.slope_error.is_nan() { String::new() } else { format!(" ± {:.3}", line.slope_error) };
            let [slope, p] = [format!("{:.3}{error}", line.slope), p.map_or("-".to_owned(), |p| format!("{p:.2e}"))];
            let r_squared = or_dash(line.r_squared, 3);
            format!("{slope:>16}{:>8}{r_squared:>8}{p:>12}", line.n)
        });
        let model = model.map_or("-".to_owned(), |Trend { line, .. }| format!("{:.3} of {}", line.slope, line.n));
        format!("{measured}{model:>16}")
    };
    for row in &found.founders {
        let FounderComparison { founder, n, mean, sd, model, model_n, .. } = row;
        let model = model.map_or("-".to_owned(), |model| format!("{model:.1} of {model_n}"));
        let (measured, slopes) = (mean_sd(*mean, *sd, *n as u64), slopes(row.slope, row.model_slope));
        let _ = writeln!(out, "{founder:<8}{n:>7}{measured:>18}{model:>18}{slopes}");
    }
    if found.slope.is_some() || found.model_slope.is_some() {
        let _ = writeln!(out, "{:<51}{}", "all", slopes(found.slope, found.model_slope));
    }
    out + "\n"
}

fn order_text(Order { pairs, larger_first, model }: &Order) -> String {
    let agreed = |Agreement { pairs, agree, p }: Agreement| {
        format!("{agree} of {pairs} pairs (p = {p:.2e}, one-sided sign test)")
    };
    if pairs.is_empty() {
        return String::new();
    }
    let certain = |pair: &&SistersComparison| pair.measured.p.is_some_and(|p| p < 0.05);
    let mut out = format!("order of division in {} pairs of sisters", pairs.len());
    // No test is possible for sisters measured only once.
    if pairs.iter().any(|pair| pair.measured.p.is_some()) {
        let is_paired = pairs.iter().any(|pair| pair.measured.embryos > 0);
        let test = if is_paired { "t test paired over embryos" } else { "Welch's test" };
        let _ = write!(out, ", which differ in {} (p < 0.05, {test})", pairs.iter().filter(certain).count());
    }
    out.push('\n');
    if larger_first.pairs > 0 {
        let _ = writeln!(out, "  the larger by measured volume divides first: {}", agreed(*larger_first));
    }
    if let Some(model) = model.filter(|model| model.pairs > 0) {
        let _ = writeln!(out, "  the model's first is the measured one: {}", agreed(model));
    }
    for pair in pairs {
        let (Some(first), Some(model)) = (pair.measured.first, pair.model_first) else { continue };
        let (names, p) =
            (&pair.measured.daughters, pair.measured.p.map_or(String::new(), |p| format!(" (p = {p:.2e})")));
        let _ =
            writeln!(out, "  {:<6} {} measured{p}, {} in the model", pair.measured.mother, names[first], names[model]);
    }
    out + "\n"
}

fn departure_text(found: &LifetimesComparison) -> String {
    let Some(over_time) = &found.over_time else {
        return "the table has no births: numbers of cells over time are not compared\n".to_owned();
    };
    let Some(departure) = &found.departure else {
        let why =
            if found.has_clock { "the model lacks cells that the table begins with" } else { "the model has no clock" };
        return format!("numbers of cells over time are not compared: {why}\n");
    };
    let Departure { known_until, apart, first, lasting, lacking, lacking_count, extra, extra_count, shared } =
        departure;
    let reference = over_time.reference.as_deref().unwrap_or_default();
    let counts = |counts: &Option<Counts>| match counts {
        Some(Counts { min, cells, model }) => format!("{min:.1} min, {cells} cells measured and {model} in the model"),
        None => "never".to_owned(),
    };
    let lone = |division: &Option<LoneDivision>, count: usize| match division {
        Some(LoneDivision { cell, at }) => {
            format!(
                "{cell} at {:.1} min, {} cells measured and {} in the model; {count} in all",
                at.min, at.cells, at.model
            )
        }
        None => "none".to_owned(),
    };
    format!(
        "where the model's tree leaves the embryo's (minutes of the table; the model's clock is set by the birth of {reference}; numbers are \
         known up to {known_until:.1} min)\n  numbers apart by {apart}\n    first: {}\n    for good: {}\n  measured divisions \
         that the model has: {shared}\n  first division that the model lacks: {}\n  first division of the model by then that the table lacks: {}\n",
        counts(first),
        counts(lasting),
        lone(lacking, *lacking_count),
        lone(extra, *extra_count)
    )
}
