//! `furrow fit constants`: one set of constants for an observed embryo.

use clap::Args;
use serde_json::json;

use super::{Fit, LineageArgs, SearchArgs, TargetsArgs, at_limit_text, or_dash};
use crate::cli::context::Context;
use crate::cli::error::CliError;
use crate::cli::interrupt;
use crate::cli::output::{merged, print_as, writable_file};
use crate::cli::picture::PlotArgs;
use furrow_analysis::fit::{Evaluated, FitRun, FittedConstants, Targets, fit_constants};
use furrow_cell::Parameter;
use furrow_figures::plot;
use furrow_formats::write_atomically;
use std::fmt::Write;
use std::path::PathBuf;

// No doc comment, since clap would use it as the help of `furrow fit`, which has these options too.
#[derive(Debug, Args)]
pub struct ConstantsArgs {
    #[command(flatten)]
    lineage: LineageArgs,
    #[command(flatten)]
    targets: TargetsArgs,
    #[command(flatten)]
    search: SearchArgs,
    /// File for the fitted constants, for --config
    #[arg(help_heading = "Output", long, value_name = "FILE.ron")]
    out: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotArgs,
}

pub fn run(args: &ConstantsArgs, context: &Context) -> Result<(), CliError> {
    context.settings.check_paper_model("constants fitted with it")?;
    let fit = Fit::new(&args.lineage, context)?;
    let (targets, file) = fit.targets(&args.targets)?;
    targets.check_searched(&file)?;
    let picture = args.plot.file()?;
    writable_file("--out", args.out.as_deref())?;
    let memo = context.memo()?;
    // Divisions of trees are cached.
    interrupt::finish();
    let search = |run: &FitRun<'_>| fit_constants(run, &targets, &memo, args.search.budget());
    let found = fit.search(context, "sets of constants", search)?;
    if let Some(file) = &args.out {
        write_atomically(file, found.best.as_ron().as_bytes())?;
    }
    picture.write(|| plot::fit::draw_constants(&found))?;
    let elapsed_s = fit.elapsed_s();
    let run = json!({ "seed": args.search.seed, "elapsed_s": elapsed_s });
    let document = merged(found.document(&targets), run);
    print_as(context.json, &document, || {
        let used = |file: &PathBuf| format!("; use them with --config {}", file.display());
        let (text, tried) = (constants_text(&found, &targets), found.tried);
        let written = args.out.as_ref().map_or(String::new(), used);
        format!("{text}{tried} sets of constants tried, {elapsed_s:.0} s{written}\n")
    })
}

fn constants_text(found: &FittedConstants, targets: &Targets) -> String {
    let FittedConstants { best, start, .. } = found;
    let limits = at_limit_text(&found.at_limit, "change unknowns in a file for --targets");
    let mut out = values_text(found) + &limits + &founders_text(best, targets);
    for (name, Evaluated { misfit, parts, thresholds_rms, .. }) in [("start", start), ("best", best)] {
        let rms = thresholds_rms.map_or("not found".to_owned(), |rms| format!("{:.2} %", 100.0 * rms));
        let _ = writeln!(
            out,
            "\n{name}: misfit {misfit:.3}: mean rounds off by {:.3}, terminal cells by {:.3} doublings, χ by {:.3}; {} not symmetric; thresholds off by {rms}, {} of another kind",
            parts.rounds, parts.terminal, parts.chi, parts.not_symmetric, parts.reversed
        );
        if !targets.divisions.is_empty() {
            let _ =
                writeln!(out, "  {} of {} given divisions contradicted", parts.contradicted, targets.divisions.len());
        }
    }
    let names: String = best.constants.iter().map(|(p, _)| format!("{:>9}", p.to_string())).collect();
    out += "\nThe front between the embryo's counts and the published thresholds:\n";
    let _ = writeln!(out, "{:>8} {:>8} {:>12} {names}", "misfit", "rounds", "thresholds");
    for set in &found.front {
        let values: String = set.constants.iter().map(|(_, value)| format!("{value:>9.4}")).collect();
        let rms = 100.0 * set.thresholds_rms.unwrap_or(f64::NAN);
        let _ = writeln!(out, "{:>8.3} {:>8.3} {rms:>10.2} % {values}", set.misfit, set.parts.rounds);
    }
    out + "\n"
}

/// The initial and the best constants, with the sharpness of the minimum.
fn values_text(found: &FittedConstants) -> String {
    let FittedConstants { best, start, sharpness, plateau, .. } = found;
    let mut out = "constant      start       best   misfit +0.05, alone    tried, misfit +0.05  \n".to_owned();
    for (k, (parameter, value)) in best.constants.iter().enumerate() {
        let ranges = sharpness.get(k).map_or(String::new(), |sharp| {
            let limit = if sharp.reaches_limit { " (limit)" } else { "" };
            let [from, to] = plateau[k].1;
            format!("{:<21}  {from:.4}..{to:.4}", format!("{:.4}..{:.4}{limit}", sharp.from, sharp.to))
        });
        let _ = writeln!(out, "{:<8} {:>10.5} {value:>10.5}   {ranges}", parameter.to_string(), start.constants[k].1);
    }
    if let Some((_, xi_s)) = best.constants.iter().find(|(p, _)| *p == Parameter::XiS) {
        let _ = writeln!(out, "g xi_s = {:.3}", xi_s * best.cell.material.gain);
    }
    out
}

/// The founders of the best fit, compared with the observed ones.
fn founders_text(best: &Evaluated, targets: &Targets) -> String {
    let mut out = "\nfounder   mean rounds, observed     terminal, observed                χ\n".to_owned();
    for founder in &best.founders {
        let [rounds, mean] = [founder.rounds.map(|r| r.mean), founder.observed_mean]
            .map(|mean| or_dash(mean.map(|mean| format!("{mean:.2}"))));
        let [terminal, cells] = [founder.rounds.map(|r| r.terminal), founder.observed_terminal].map(or_dash);
        let measured = targets.chi.iter().find(|chi| chi.cell == founder.name);
        let beside = measured.map_or(String::new(), |chi| format!(", {:.3}", chi.mean));
        let chi = or_dash(founder.chi.map(|chi| format!("{chi:.3}{beside}")));
        let mark = if targets.founders.contains(&founder.name) { "  fitted" } else { "" };
        let _ = writeln!(out, "{:<8} {rounds:>14}, {mean:>6} {terminal:>14}, {cells:>6} {chi:>16}{mark}", founder.name);
    }
    out
}
