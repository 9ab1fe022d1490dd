//! `furrow fit cue`: the cue that gives the measured χ of the germline.

use clap::Args;
use serde_json::json;

use super::{Fit, LineageArgs, SearchArgs, TargetsArgs, at_limit_text, or_dash};
use crate::cli::context::Context;
use crate::cli::error::CliError;
use crate::cli::output::{merged, print_as};
use crate::cli::picture::PlotArgs;
use crate::cli::tree::bad_cue;
use furrow_analysis::fit::{ChiResidual, FitRun, FittedCue, Jump, fit_cue};
use furrow_figures::plot;
use furrow_input::InputError;
use std::fmt::Write;

/// Fits the numbers of a cue to the measured χ of the germline
///
/// Prints which combinations of the numbers remain undetermined, and predicts divisions that were not fitted.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow fit cue --preset sulston1983
  furrow fit cue --cue tension:gradient,amplitude=0.3 --particles 4 --moves 1")]
pub struct CueArgs {
    #[command(flatten)]
    lineage: LineageArgs,
    #[command(flatten)]
    targets: TargetsArgs,
    /// Start of the search: the terms of this cue are kept, their numbers are fitted
    #[arg(help_heading = "Cue", long, value_name = "CUE", default_value = CUE)]
    cue: String,
    #[command(flatten)]
    search: SearchArgs,
    #[command(flatten)]
    plot: PlotArgs,
}

/// The published cue.
const CUE: &str = "kappa:band,u0=0.465,omega=0.0577,amplitude=0.1";

pub fn run(args: &CueArgs, context: &Context) -> Result<(), CliError> {
    let fit = Fit::new(&args.lineage, context)?;
    let (targets, file) = fit.targets(&args.targets)?;
    let template = fit.lineage.parse_cue(&args.cue).map_err(bad_cue)?;
    InputError::require(!template.is_none(), "--cue", "cue", &args.cue, "a cue with at least one term")?;
    InputError::require(!targets.chi.is_empty(), file, "chi", "[]", "at least one measured χ")?;
    let picture = args.plot.file()?;
    let search = |run: &FitRun<'_>| fit_cue(run, &targets, &template, args.search.budget());
    let found = fit.search(context, "cues", search)?;
    picture.write(|| plot::fit::draw_cue(&found))?;
    let elapsed_s = fit.elapsed_s();
    let document = merged(json!(found), json!({ "seed": args.search.seed, "elapsed_s": elapsed_s }));
    print_as(context.json, &document, || {
        let out_of_sample = targets.out_of_sample.as_ref().map_or("", |out| &out.name);
        format!("{}{} cues tried, {elapsed_s:.0} s\n", cue_text(&found, out_of_sample), found.tried)
    })
}

fn cue_text(found: &FittedCue, out_of_sample: &str) -> String {
    let mut out = format!("cue {}\n\n", found.cue);
    for number in &found.numbers {
        let sd = match (number.sd, found.goodness.error_scale) {
            (Some(sd), _) => format!("± {sd:.4}"),
            (None, Some(_)) if number.without_effect => "without effect on χ".to_owned(),
            (None, Some(_)) => "undetermined".to_owned(),
            (None, None) => "no error".to_owned(),
        };
        let [from, to] = number.searched;
        let _ = writeln!(out, "{:<18} {:>9.4} {sd}  (searched {from}..{to})", number.name, number.value);
    }
    if let Some(image) = &found.mirror_image {
        let _ = writeln!(out, "the mirror image {image} fits equally well");
    }
    out += &at_limit_text(&found.at_limit, "the terms of the cue may not suffice");
    let row = |r: &ChiResidual| {
        let [r0, chi] = [r.r0, r.computed].map(|v| or_dash(v.map(|v| format!("{v:.3}"))));
        let off = or_dash(r.residual.map(|v| format!("{v:+.2}")));
        let measured = format!("{:.3} ± {:.3}", r.measured, r.sd);
        format!("{:<8} {r0:>8} {measured:>18} {chi:>8} {off:>10}\n", r.cell)
    };
    let table = |residuals: &[ChiResidual]| -> String {
        let heading = "cell           R0         χ measured    model  off by sd\n".to_owned();
        [heading].into_iter().chain(residuals.iter().map(row)).collect()
    };
    let errors = match found.goodness.error_scale {
        None => "; no errors: there are no more divisions than numbers".to_owned(),
        Some(factor) if factor > 1.0 => format!("; errors are scaled by the misfit, ×{factor:.2}"),
        Some(_) => String::new(),
    };
    let _ = writeln!(out, "\n{} divisions, {}{errors}", found.residuals.len(), found.goodness);
    out += &table(&found.residuals);
    out += &jumps_text(&found.jumps);
    match &found.combinations {
        None => out += "\nsensitivities skipped (not smooth)\n",
        Some(combinations) => {
            out += "\nstandard deviations of χ per unit step (by logarithm, or in u), by combination:\n";
            for held in combinations {
                let parts = held.components.iter().zip(&found.numbers).map(|(x, n)| format!("{x:+.3} {}", n.name));
                let parts = parts.collect::<Vec<_>>().join(" ");
                let open = if held.determined { "" } else { "  (undetermined)" };
                let _ = writeln!(out, "{:>10.2}  {parts}{open}", held.singular_value);
            }
        }
    }
    if !found.out_of_sample.is_empty() {
        let _ = write!(out, "\n{out_of_sample}, predicted:\n{}", table(&found.out_of_sample));
    }
    out + "\n"
}

/// Fitted divisions with a jump of χ within the errors or within one percent.
fn jumps_text(jumps: &[Jump]) -> String {
    if jumps.is_empty() {
        return String::new();
    }
    let mut out = "\nDivisions jump within these errors or within 1 %; errors mean nothing across a jump:\n".to_owned();
    for Jump { cell, by, best, between: [near, far], chi } in jumps {
        let [before, behind] = chi.map(|chi| chi.map_or("no division".to_owned(), |chi| format!("χ = {chi:.3}")));
        let off = 100.0 * (far / best - 1.0);
        let _ =
            writeln!(out, "{cell:<8} {before} at {by} = {near:.5}, {behind} at {far:.5} ({off:+.2} % from the best)");
    }
    out
}
