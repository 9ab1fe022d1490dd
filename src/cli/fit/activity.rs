//! `furrow fit activity`: the activity that each founder alone would need.

use clap::Args;
use serde_json::json;

use super::{Fit, LineageArgs, at_limit_text, or_dash};
use crate::cli::cell::one_of;
use crate::cli::context::Context;
use crate::cli::error::CliError;
use crate::cli::interrupt;
use crate::cli::output::{merged, number, print_as};
use crate::cli::picture::PlotArgs;
use furrow_analysis::fit::{FitRun, FittedActivities, FounderActivity, Reading, activities};
use furrow_figures::plot;
use furrow_input::InputError;
use furrow_lineage::TreeSettings;
use std::fmt::Write;

/// Finds for each founder separately the activity that gives its observed rounds
///
/// All other parameters of a founder come from the lineage file. The column "model" has the rounds that furrow tree counts.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow fit activity --rounds max
  furrow fit activity --xi-from 10 --xi-to 60 --json")]
pub struct ActivityArgs {
    #[command(flatten)]
    lineage: LineageArgs,
    /// Count of rounds to which activities are fitted
    #[arg(help_heading = "Activity", long, value_name = "READING", default_value = "mean", value_parser = one_of(Reading::NAMED))]
    rounds: Reading,
    /// Lower limit of the activity ξ_s
    #[arg(help_heading = "Activity", long, value_name = "XI", default_value_t = 4.0, value_parser = number)]
    xi_from: f64,
    /// Upper limit of the activity ξ_s
    #[arg(help_heading = "Activity", long, value_name = "XI", default_value_t = 100.0, value_parser = number)]
    xi_to: f64,
    #[command(flatten)]
    plot: PlotArgs,
}

pub fn run(args: &ActivityArgs, context: &Context) -> Result<(), CliError> {
    let fit = Fit::new(&args.lineage, context)?;
    for (option, value) in [("--xi-from", args.xi_from), ("--xi-to", args.xi_to)] {
        let mut one = context.settings.clone();
        one.cell.xi_s = value;
        InputError::require(value > 0.0, option, "xi_s", value, "a number above 0")?;
        one.check_activity(option)?;
    }
    let range = [args.xi_from, args.xi_to];
    let allowed = format!("above --xi-from = {}", range[0]);
    InputError::require(range[1] > range[0], "--xi-to", "xi_s", range[1], allowed)?;
    let memo = context.memo()?;
    let picture = args.plot.file()?;
    // Divisions of trees are cached.
    interrupt::finish();
    let search = |run: &FitRun<'_>| activities(run, &memo, args.rounds, range);
    let found = fit.search(context, "trees", search)?;
    picture.write(|| plot::fit::draw_activities(&found.founders, fit.settings.cell.xi_s))?;
    let elapsed_s = fit.elapsed_s();
    print_as(context.json, &merged(json!(found), json!({ "elapsed_s": elapsed_s })), || {
        format!("{}\n{} trees, {elapsed_s:.0} s\n", activity_text(&found, &fit.settings), found.trees)
    })
}

fn activity_text(found: &FittedActivities, settings: &TreeSettings) -> String {
    let which = match found.rounds {
        Reading::Min => "fewest",
        Reading::Mean => "mean, to half a round",
        Reading::Max => "most",
    };
    let of_run = settings.cell.xi_s;
    let own = if found.founders.iter().any(|founder| founder.run_xi_s != of_run) {
        " or as the lineage file says"
    } else {
        ""
    };
    let mut out = format!(
        "Activity that a founder and its descendants would need for the observed rounds ({which}), all else at xi_s = {of_run}{own}\n\n\
         founder  observed    model  at xi_s   xi_s needed            nearest\n"
    );
    for FounderActivity { name, observed, run_xi_s, rounds, xi_s, intervals, nearest, searched, .. } in &found.founders
    {
        let model = or_dash(rounds.map(|rounds| format!("{rounds:.2}")));
        let interval = |[from, to]: [f64; 2]| {
            let below = if from <= searched[0] { "≤ " } else { "" };
            format!("{below}{from:.3} .. {to:.3}{}", if to >= searched[1] { " ≤" } else { "" })
        };
        let needed = xi_s.map_or("none".to_owned(), interval);
        let nearest = nearest.map_or(String::new(), |(xi_s, rounds)| format!("{rounds:.2} at {xi_s:.2}"));
        let others = match intervals.len() {
            0 | 1 => String::new(),
            count => format!(", and {} narrower", count - 1),
        };
        let _ = writeln!(out, "{name:<8} {observed:>8.2} {model:>8} {run_xi_s:>8}   {needed:<22} {nearest}{others}");
    }
    out + &at_limit_text(&found.at_limit, "change --xi-from or --xi-to")
}
