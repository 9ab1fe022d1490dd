//! `furrow fit`: constants, activities or a cue fitted to observations.

use clap::{Args, ValueEnum};
use serde_json::{Map, Value, json};

use super::cell::one_of;
use super::context::Context;
use super::error::CliError;
use super::interrupt;
use super::output::{merged, number, print_as, writable_file};
use super::picture::PlotArgs;
use super::progress::ProgressLine;
use super::tree::bad_cue;
use furrow_analysis::fit::{
    ChiResidual, Evaluated, FittedConstants, FittedCue, FounderActivity, Reading, SearchBudget, Targets, activities,
    fit_constants, fit_cue,
};
use furrow_analysis::tree_settings;
use furrow_cell::Parameter;
use furrow_figures::plot;
use furrow_formats::write_atomically;
use furrow_input::{InputError, parse_document, read_text};
use furrow_lineage::{Lineage, TreeSettings};
use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow fit constants --out fitted.ron
  furrow fit activity --rounds max
  furrow fit cue --preset sulston1983
  furrow fit cue --cue activity:step,u0=0.5,omega=0.1,amplitude=0.1 --particles 4 --moves 1")]
pub struct FitArgs {
    /// What to fit
    #[arg(value_name = "WHAT", default_value = "constants")]
    what: What,
    /// Founders with their observed rounds; default the built-in C. elegans founders
    #[arg(help_heading = "Targets", long, value_name = "LINEAGE.ron")]
    lineage: Option<PathBuf>,
    /// Observations that constants and cues are fitted to; default the built-in data/embryo.ron
    #[arg(help_heading = "Targets", long, value_name = "TARGETS.ron")]
    targets: Option<PathBuf>,
    /// Which count of rounds activities are fitted to
    #[arg(help_heading = "Activity", long, value_name = "READING", default_value = "mean", value_parser = one_of(READINGS))]
    rounds: Reading,
    /// Lower limit of the activity ξ_s
    #[arg(help_heading = "Activity", long, value_name = "XI", default_value_t = 4.0, value_parser = number)]
    xi_from: f64,
    /// Upper limit of the activity ξ_s
    #[arg(help_heading = "Activity", long, value_name = "XI", default_value_t = 100.0, value_parser = number)]
    xi_to: f64,
    /// Start of the search: the terms of this cue are kept, their numbers are fitted
    #[arg(help_heading = "Cue", long, value_name = "CUE", default_value = CUE)]
    cue: String,
    /// Particles of the swarm
    #[arg(help_heading = "Search", long, value_name = "N", default_value_t = 24, value_parser = clap::value_parser!(u32).range(2..=10_000))]
    particles: u32,
    /// Moves of the swarm
    #[arg(help_heading = "Search", long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    moves: u32,
    /// Seed of the search
    #[arg(help_heading = "Search", long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// File for the fitted constants, for --config
    #[arg(help_heading = "Output", long, value_name = "FILE.ron")]
    out: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum What {
    Constants,
    Activity,
    Cue,
}

/// The published cue.
const CUE: &str = "kappa:band,u0=0.465,omega=0.0577,amplitude=0.1";

/// Readings of "rounds" by the names of the option.
const READINGS: [(&str, Reading); 3] = [("min", Reading::Min), ("mean", Reading::Mean), ("max", Reading::Max)];

pub fn run(args: &FitArgs, context: &Context) -> Result<(), CliError> {
    let start = Instant::now();
    let lineage = Lineage::load(args.lineage.as_deref())?;
    let settings = &context.settings;
    settings.check_divisions("settings")?;
    settings.check_activity("settings")?;
    let settings = &tree_settings(settings.clone(), &lineage, 0, context.quantisation);
    let fine = args.out.is_none() || args.what == What::Constants;
    InputError::require(fine, "--out", "out", format!("{:?}", args.out), "used only with constants")?;
    if args.what != What::Cue {
        // Divisions of trees go to the cache, those of trial cues do not.
        interrupt::finish();
    }
    let fit = Fit { args, context, lineage: &lineage, settings, start };
    match args.what {
        What::Constants => fit.constants(),
        What::Activity => fit.activity(),
        What::Cue => fit.cue(),
    }
}

/// The input of a fit.
struct Fit<'a> {
    args: &'a FitArgs,
    context: &'a Context,
    lineage: &'a Lineage,
    settings: &'a TreeSettings,
    start: Instant,
}

impl Fit<'_> {
    /// The targets of a file, or the built-in ones, checked.
    fn targets(&self) -> Result<Targets, CliError> {
        let (targets, file) = match &self.args.targets {
            None => (Targets::embryo()?, "embryo.ron (built in)".to_owned()),
            Some(path) => {
                let file = path.display().to_string();
                (parse_document(&read_text(path)?, &file, "a file of targets of a fit", "Fit")?, file)
            }
        };
        targets.check(&file, self.lineage)?;
        Ok(targets)
    }

    fn budget(&self) -> SearchBudget {
        let FitArgs { particles, moves, seed, .. } = *self.args;
        SearchBudget { particles: particles as usize, moves: u64::from(moves), seed }
    }

    fn constants(&self) -> Result<(), CliError> {
        let (Fit { args, context, lineage, settings, .. }, flag) = (self, interrupt::flag());
        let targets = self.targets()?;
        let picture = args.plot.file()?;
        writable_file("--out", args.out.as_deref())?;
        let line = ProgressLine::new(context.progress);
        let show =
            |tried: usize, misfit: f64| line.message(format!("{tried} sets of constants, least misfit {misfit:.3}"));
        let memo = context.memo()?;
        let found =
            fit_constants(lineage, &targets, settings, &memo, self.budget(), context.threads, flag, Some(&show))?;
        drop(line);
        if let Some(file) = &args.out {
            write_atomically(file, config(&found.best).as_bytes())?;
        }
        picture.write(|| plot::fit::draw_constants(&found))?;
        let elapsed_s = self.start.elapsed().as_secs_f64();
        let number = |(parameter, value): &(Parameter, f64)| (parameter.to_string(), Value::from(*value));
        let sharpness = found.sharpness.iter().zip(&found.plateau);
        let sharpness = sharpness.map(|(sharp, (_, plateau))| merged(json!(sharp), json!({ "plateau": plateau })));
        let document = json!({
            "constants": found.best.constants.iter().map(number).collect::<Map<_, _>>(),
            "misfit": found.best.misfit,
            "residuals": residuals(&found.best, &targets),
            "best": found.best,
            "start": found.start,
            "front": found.front,
            "sharpness": sharpness.collect::<Vec<_>>(),
            "tried": found.tried,
            "seed": args.seed,
            "elapsed_s": elapsed_s,
        });
        print_as(context.json, &document, || {
            let used = |file: &PathBuf| format!("; use them with --config {}", file.display());
            let (text, tried) = (constants_text(&found, &targets), found.tried);
            let written = args.out.as_ref().map_or(String::new(), used);
            format!("{text}{tried} sets of constants tried, {elapsed_s:.0} s{written}\n")
        })
    }

    fn activity(&self) -> Result<(), CliError> {
        let (Fit { args, context, lineage, settings, .. }, flag) = (self, interrupt::flag());
        for (option, value) in [("--xi-from", args.xi_from), ("--xi-to", args.xi_to)] {
            let mut one = context.settings.clone();
            one.cell.xi_s = value;
            InputError::require(value > 0.0, option, "xi_s", value, "a number above 0")?;
            one.check_activity(option)?;
        }
        let range = [args.xi_from, args.xi_to];
        let allowed = format!("above --xi-from = {}", range[0]);
        InputError::require(range[1] > range[0], "--xi-to", "xi_s", range[1], allowed)?;
        let (memo, reading) = (context.memo()?, args.rounds);
        let picture = args.plot.file()?;
        let (found, trees) = activities(lineage, settings, &memo, reading, range, context.threads, flag)?;
        picture.write(|| plot::fit::draw_activities(&found, settings.cell.xi_s))?;
        let elapsed_s = self.start.elapsed().as_secs_f64();
        let document = json!({ "rounds": reading, "founders": found, "trees": trees, "elapsed_s": elapsed_s });
        print_as(context.json, &document, || {
            format!("{}\n{trees} trees, {elapsed_s:.0} s\n", activity_text(&found, reading, settings))
        })
    }

    fn cue(&self) -> Result<(), CliError> {
        let (Fit { args, context, lineage, settings, .. }, flag) = (self, interrupt::flag());
        let targets = self.targets()?;
        let template = lineage.parse_cue(&args.cue).map_err(bad_cue)?;
        InputError::require(!template.is_none(), "--cue", "cue", &args.cue, "a cue with at least one term")?;
        let file = args.targets.as_ref().map_or(String::new(), |path| path.display().to_string());
        InputError::require(!targets.chi.is_empty(), file, "chi", "[]", "at least one measured χ")?;
        let picture = args.plot.file()?;
        let found = fit_cue(lineage, &targets, settings, &template, self.budget(), context.threads, flag)?;
        picture.write(|| plot::fit::draw_cue(&found))?;
        let elapsed_s = self.start.elapsed().as_secs_f64();
        let document = merged(json!(found), json!({ "seed": args.seed, "elapsed_s": elapsed_s }));
        print_as(context.json, &document, || {
            let out_of_sample = targets.out_of_sample.as_ref().map_or("", |out| &out.name);
            format!("{}{} cues tried, {elapsed_s:.0} s\n", cue_text(&found, out_of_sample), found.tried)
        })
    }
}

/// Numbers of the model beside the observed ones.
fn residuals(best: &Evaluated, targets: &Targets) -> Vec<Value> {
    let residual = |founder: &str, quantity: &str, observed: f64, computed: Option<f64>| -> Value {
        json!({ "founder": founder, "quantity": quantity, "observed": observed, "computed": computed })
    };
    let mut out = Vec::new();
    for founder in best.founders.iter().filter(|founder| targets.founders.contains(&founder.name)) {
        let mean = founder.observed_mean.unwrap_or(f64::NAN);
        out.push(residual(&founder.name, "mean_rounds", mean, founder.rounds.map(|r| r.mean)));
        let (observed, computed) = (founder.observed_terminal.unwrap_or(0), founder.rounds.map(|r| r.terminal.into()));
        out.push(residual(&founder.name, "terminal_cells", observed.into(), computed));
    }
    for chi in &targets.chi {
        let computed = best.founders.iter().find(|founder| founder.name == chi.cell).and_then(|founder| founder.chi);
        out.push(residual(&chi.cell, "chi", chi.mean, computed));
    }
    out
}

/// The constants as a configuration file.
fn config(best: &Evaluated) -> String {
    let lines: String = best.constants.iter().map(|(p, value)| format!("        {p}: {value},\n")).collect();
    format!("// Found by furrow fit constants.\nConfig(\n    physics: (\n{lines}    ),\n)\n")
}

fn constants_text(found: &FittedConstants, targets: &Targets) -> String {
    let FittedConstants { best, start, .. } = found;
    let mut out = values_text(found) + &founders_text(best, targets);
    for (name, Evaluated { misfit, parts, thresholds_rms, .. }) in [("start", start), ("best", best)] {
        let rms = thresholds_rms.map_or("not found".to_owned(), |rms| format!("{:.2} %", 100.0 * rms));
        let _ = writeln!(
            out,
            "\n{name}: misfit {misfit:.3}: mean rounds off by {:.3}, terminal cells by {:.3} doublings, χ by {:.3}; {} not symmetric; thresholds off by {rms}, {} of another kind",
            parts.rounds, parts.terminal, parts.chi, parts.not_symmetric, parts.reversed
        );
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

/// The constants of the start and of the best fit, with the sharpness of its minimum.
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

/// A number that may be missing.
fn or_dash(value: Option<impl std::fmt::Display>) -> String {
    value.map_or("-".to_owned(), |value| value.to_string())
}

/// The founders of the best fit beside the observed ones.
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

fn activity_text(found: &[FounderActivity], reading: Reading, settings: &TreeSettings) -> String {
    let which = match reading {
        Reading::Min => "fewest",
        Reading::Mean => "mean, to half a round",
        Reading::Max => "most",
    };
    let xi_s = settings.cell.xi_s;
    let mut out = format!(
        "Activity that a founder and its descendants would need for the observed rounds ({which}), all else at xi_s = {xi_s}\n\n\
         founder  observed    model   xi_s                   nearest\n"
    );
    for FounderActivity { name, observed, rounds, xi_s, intervals, nearest, searched } in found {
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
        let _ = writeln!(out, "{name:<8} {observed:>8.2} {model:>8}   {needed:<22} {nearest}{others}");
    }
    out
}

fn cue_text(found: &FittedCue, out_of_sample: &str) -> String {
    let mut out = format!("cue {}\n\n", found.cue);
    for number in &found.numbers {
        let sd = number.sd.map_or("undetermined".to_owned(), |sd| format!("± {sd:.4}"));
        let [from, to] = number.searched;
        let _ = writeln!(out, "{:<18} {:>9.4} {sd}  (searched {from}..{to})", number.name, number.value);
    }
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
    let _ = writeln!(out, "\nχ² = {:.2} over {} divisions", found.chi_squared, found.residuals.len());
    out += &table(&found.residuals);
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
