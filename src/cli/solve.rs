//! `furrow solve`: the values of one parameter that give a required division.

use super::cell::{AxisArgs, CueArgs, length};
use super::context::Context;
use super::error::CliError;
use super::interrupt;
use super::messages;
use super::output::{filled, merged, number, print_as, seed};
use super::vary::{Given, parameter};
use clap::Args;
use furrow_analysis::solve::{Measure, POINTS, Question, Root, Solution, default_range, solve};
use furrow_cell::Parameter;
use furrow_input::InputError;
use furrow_lineage::{Length, Units};
use serde_json::json;
use std::fmt::Write;

#[derive(Debug, Args)]
#[command(after_help = "\
The range is scanned at --points values; every change of sign of outcome - wanted between neighbours (with --chi C of signed chi - C \
and of signed chi + C) is refined by Brent's method until it lies between two values 1e-9 of the range apart. Where the outcomes at \
these differ by more than 1e-3 (of a time: 1e-3 of the wanted one), the outcome jumps and there is no root. Where a cell does not \
divide there is a gap.

Ranges without --from and --to: r0 1 to 10, epsilon 0.6 to 0.95, xi_s 5 to 60 (times kappa/gain), cue.u0 0 to 1, cue.amplitude -0.9 \
to 0.9 (or twice the amplitude), and so strengths of a regulator; others from a quarter to four times the value, or to 1 if it is 0.

Examples:
  furrow solve --for epsilon --chi 0.41 --r0 2.977 --cue germline
  furrow solve --for r0 --u 0.47 --cue germline --from 3 --to 6
  furrow solve --for cue.amplitude --chi-signed 0.185 --r0 5.4 --cue germline
  furrow solve --for xi_s --t 10 --r0 4")]
pub struct SolveArgs {
    /// The unknown: r0, epsilon, xi_s, or any other parameter of a cell in --set; for a cue cue.u0, cue.omega,
    /// cue.amplitude or regulator.turnover and the like
    #[arg(long = "for", value_name = "NAME")]
    unknown: String,
    #[command(flatten)]
    wanted: WantedArgs,
    /// First value of the range; see below for the default
    #[arg(help_heading = "Range", long, value_name = "A", value_parser = length)]
    from: Option<Length>,
    /// Last value of the range
    #[arg(help_heading = "Range", long, value_name = "B", value_parser = length)]
    to: Option<Length>,
    /// Number of trial values in the range; a larger number separates roots that are closer together
    #[arg(help_heading = "Range", long, value_name = "N", default_value_t = POINTS as u32, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    points: u32,
    /// Radius R0 of the cell, in L_h, or in µm, such as 17um
    #[arg(help_heading = "Cell", long, value_name = "R", value_parser = length)]
    r0: Option<Length>,
    /// Volume of the cell divided by the volume of its shell, ε
    #[arg(help_heading = "Cell", long, value_name = "E", value_parser = number)]
    epsilon: Option<f64>,
    /// Activity ξ_s as published; default 25, the preset's
    #[arg(help_heading = "Cell", long, value_name = "X", value_parser = number)]
    xi: Option<f64>,
    #[command(flatten)]
    cue: CueArgs,
    #[command(flatten)]
    pub axis: AxisArgs,
    /// Seed of the noise in the first step
    #[arg(help_heading = "Numerics", long, value_name = "S", default_value_t = 0, value_parser = seed)]
    seed: u64,
}

// Exactly one required quantity.
#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
#[command(next_help_heading = "Wanted")]
struct WantedArgs {
    /// Size asymmetry χ, above 0 and below 1
    #[arg(long, value_name = "CHI", value_parser = number)]
    chi: Option<f64>,
    /// Signed χ: positive if the posterior daughter, at u = 0, is smaller
    #[arg(long, value_name = "CHI", value_parser = number)]
    chi_signed: Option<f64>,
    /// Position u of the furrow, from 0 (posterior pole) to 1
    #[arg(long, value_name = "U", value_parser = number)]
    u: Option<f64>,
    /// Time of pinch-off, in τ
    #[arg(long, value_name = "TAU", value_parser = number)]
    t: Option<f64>,
}

impl WantedArgs {
    /// The required quantity and its value.
    fn read(&self) -> Result<(Measure, f64), InputError> {
        let WantedArgs { chi, chi_signed, u, t } = *self;
        let given = [
            (Measure::Chi, "--chi", chi),
            (Measure::ChiSigned, "--chi-signed", chi_signed),
            (Measure::UFurrow, "--u", u),
            (Measure::TEnd, "--t", t),
        ];
        let given = given.into_iter().find_map(|(measure, option, value)| Some((measure, option, value?)));
        // clap ensures that one is given.
        let (measure, option, value) = given.unwrap_or((Measure::Chi, "--chi", f64::NAN));
        let error = |allowed| InputError::not_allowed(option, measure.name(), value, allowed);
        measure.validate(value).map(|()| (measure, value)).map_err(error)
    }
}

pub fn run(args: &SolveArgs, mut context: Context) -> Result<(), CliError> {
    let question = args.question(&mut context)?;
    let memo = context.memo()?;
    interrupt::finish();
    let found = context.shown(|line| solve(&question, &memo, &context.scheduling(&|progress| line.show(progress))))?;
    messages::warn_of(&found.warnings);
    let found = found.with_roots(&question)?;
    let Question { cell, parameter, range, measure, wanted, .. } = &question;
    let of_cell = json!({
        "for": parameter.to_string(), "wanted": { measure.name(): wanted }, "from": range[0], "to": range[1],
        "r0": (*parameter != Parameter::R0).then_some(cell.r0),
        "epsilon": (*parameter != Parameter::Epsilon).then_some(cell.epsilon),
        "xi_s": (*parameter != Parameter::XiS).then_some(cell.xi_s), "cue": cell.cue,
    });
    print_as(context.json, &merged(filled(of_cell), serde_json::to_value(&found)?), || {
        text(&question, &found, &context.units)
    })
}

impl SolveArgs {
    fn question(&self, context: &mut Context) -> Result<Question, CliError> {
        let (measure, wanted) = self.wanted.read()?;
        let parameter = parameter("--for", &self.unknown)?;
        let given =
            Given { option: "--for", parameter, r0: self.r0, epsilon: self.epsilon, xi: self.xi, cue: &self.cue };
        let cell = given.cell(context)?;
        let default = default_range(parameter, &cell);
        let from = self.from.map_or(Ok(default[0]), |end| given.end("--from", end, context))?;
        let to = self.to.map_or(Ok(default[1]), |end| given.end("--to", end, context))?;
        InputError::require(from != to, "--to", "to", to, "different from --from")?;
        given.warn_of_size([self.from, self.to], context);
        // A default range may contain values that are not allowed; these are reported as gaps.
        let cell = match (self.from, self.to) {
            (None, None) => cell,
            _ => given.range(cell, [from, to], context)?.cell,
        };
        context.settings.check_divisions("settings")?;
        if parameter != Parameter::XiS {
            context.settings.check_activity(self.xi.map_or("settings", |_| "--xi"))?;
        }
        let (numerics, points, seed) = (context.settings.numerics, self.points as usize, self.seed);
        Ok(Question { cell, numerics, seed, parameter, range: [from, to], points, measure, wanted })
    }
}

fn text(question: &Question, found: &Solution, units: &Units) -> String {
    let Question { parameter, range: [from, to], measure, wanted, .. } = question;
    let name = parameter.to_string();
    let um = |value: f64| if *parameter == Parameter::R0 { units.in_micrometres(value) } else { String::new() };
    let mut out = format!("{name} from {from}{} to {to}{} with {} = {wanted}\n", um(*from), um(*to), measure.name());
    let _ = writeln!(out, "{name:>16} {:>10} {:>10} {:>10}  smaller daughter", "χ", "u_furrow", "t_end");
    for root in &found.roots {
        let Root { value, chi, smaller, u_furrow, t_end, second_neck, .. } = root;
        let parts =
            second_neck.map_or(String::new(), |neck| format!("; three parts, second neck at u = {:.4}", neck.u));
        let _ =
            writeln!(out, "{value:>16.9} {chi:>10.6} {u_furrow:>10.6} {t_end:>10.6}  {smaller}{}{parts}", um(*value));
    }
    for jump in &found.jumps {
        let ([a, b], [before, behind]) = (jump.between, jump.outcomes);
        let _ = writeln!(out, "jump from {before:.4} at {a:.9} to {behind:.4} at {b:.9}: no root");
    }
    for gap in &found.gaps {
        let _ = writeln!(
            out,
            "no division from {:.6}{} to {:.6}{}: {}",
            gap.from,
            um(gap.from),
            gap.to,
            um(gap.to),
            gap.why
        );
    }
    out
}
