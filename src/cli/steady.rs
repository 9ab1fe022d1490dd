//! `furrow steady`: one stationary shape and its stability.

use super::cell::{ActiveCellArgs, AxisArgs, described};
use super::context::Context;
use super::error::CliError;
use super::messages;
use super::output::{filled, merged, print_as};
use super::picture::PlotArgs;
use clap::Args;
use furrow_cell::Cell;
use furrow_figures::plot;
use furrow_input::InputError;
use furrow_mechanics::azimuthal::mode::Mode;
use furrow_mechanics::division::DivisionInput;
use furrow_mechanics::equilibria::stationary;
use furrow_report::surfaces::rest_report;
use furrow_report::{AzimuthalStability, stationary_report};
use furrow_surface::steady::steady;
use serde_json::json;
use std::fmt::Write;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow steady --r0 2
  furrow steady --r0 2 --xi 15 --epsilon 0.8 --json
  furrow steady --r0 2 --cue regulator:none,turnover=10,diffusion=1,activity=0.3
  furrow steady --r0 2 --xi 21 --azimuthal 4 --plot modes.png")]
pub struct SteadyArgs {
    #[command(flatten)]
    cell: ActiveCellArgs,
    #[command(flatten)]
    pub axis: AxisArgs,
    /// Also computes growth rates of non-axisymmetric disturbances cos mφ, m up to M
    #[arg(help_heading = "Output", long, value_name = "M", value_parser = clap::value_parser!(u8).range(0..=MOST_AZIMUTHAL))]
    azimuthal: Option<u8>,
    #[command(flatten)]
    plot: PlotArgs,
}

/// Largest allowed azimuthal mode number: modes of larger m decay ever faster.
pub const MOST_AZIMUTHAL: i64 = 16;

/// One line for each azimuthal mode number.
fn lines(found: &[AzimuthalStability]) -> String {
    let mut out = "beyond axial symmetry, leading growth rates (1/τ):\n".to_owned();
    for AzimuthalStability { m, spectrum, mode } in found {
        let of_mode = mode.as_ref().map_or(String::new(), |mode| {
            let rigid = mode.rigid().map_or(String::new(), |rigid| {
                format!(", {:.0} % shift, {:.0} % tilt of the cell", 100.0 * rigid.translation, 100.0 * rigid.rotation)
            });
            format!("  {}{rigid}", format!("{:?}", mode.parity()).to_lowercase())
        });
        let _ = writeln!(out, "  m = {m:<2} {:>14.6}{of_mode}", spectrum.growth_rate());
    }
    let rate = |row: &AzimuthalStability| row.spectrum.growth_rate();
    if let Some(fastest) =
        found.iter().max_by(|a, b| rate(a).total_cmp(&rate(b))).filter(|row| row.m > 0 && rate(row) > 0.0)
    {
        let _ = writeln!(out, "disturbances m = {} grow fastest: the cell does not stay axisymmetric", fastest.m);
    }
    out
}

/// The stationary state without axial symmetry, with its leading growth rates.
fn without_axis(cell: Cell, context: &Context) -> Result<(), CliError> {
    let input = DivisionInput { numerics: context.settings.numerics, ..DivisionInput::new(cell) };
    let found = steady(&input)?;
    let rest = found.at_rest(input.cell.r0)?;
    let Cell { r0, epsilon, xi_s, cue, .. } = &input.cell;
    let of_cell = json!({
        "r0": r0, "epsilon": epsilon, "xi_s": xi_s, "cue": cue, "r0_um": context.units.micrometres(*r0),
    });
    let document = filled(merged(of_cell, rest_report(&found, rest)));
    print_as(context.json, &document, || {
        let verdict = if rest.growth_rate() < 0.0 { "stable" } else { "unstable" };
        let cell = described(&input.cell, &context.units, Some(*xi_s));
        let mut out = format!("{cell}, without axial symmetry: {verdict}\n");
        let (l, p, h) = (rest.length(), rest.state.pressure, rest.elongation());
        let _ = writeln!(out, "L = {l:.6}, p = {p:.6}, H = {h:.6}, equator radius {:.6}", rest.equator_radius());
        let part = if rest.has_waist() { "waist" } else { "no waist; middle" };
        let _ = writeln!(out, "{part} {:.6} L_h from the axis", rest.offset());
        out += "growth rates of all modes (1/τ):\n";
        for rate in &rest.rates {
            let imaginary = if rate.im == 0.0 { String::new() } else { format!(" {:+.6}i", rate.im) };
            let _ = writeln!(out, "  {:>14.6}{imaginary}", rate.re);
        }
        out
    })
}

/// Largest relative error of a growth rate that causes no warning; rates below 0.1/τ count as 0.1/τ.
const WELL_KNOWN: f64 = 0.01;

/// The warning about a growth rate that the mesh does not resolve; `error` is its change on halved intervals.
fn mesh_warning(rate: f64, error: f64) -> Option<String> {
    let found = match error {
        error if error <= WELL_KNOWN * rate.abs().max(0.1) => return None,
        error if error.is_infinite() => "halved intervals do not confirm this shape".to_owned(),
        error => format!("the growth rate {rate:.6} changes by {error:.6} on halved intervals"),
    };
    Some(format!("the mesh is too coarse: {found}; repeat with twice the intervals"))
}

pub fn run(args: &SteadyArgs, mut context: Context) -> Result<(), CliError> {
    let cell = args.cell.read(&mut context)?;
    context.check_azimuthal(args.azimuthal)?;
    let picture = args.plot.file()?;
    if context.settings.numerics.modes > 0 {
        let only = "absent without axial symmetry, where growth rates are those of all modes";
        InputError::require(args.azimuthal.is_none(), "--azimuthal", "M", args.azimuthal.unwrap_or(0), only)?;
        InputError::require(!picture.is_wanted(), "--plot", "plot", "a picture of azimuthal modes", only)?;
        return without_axis(cell, &context);
    }
    let most = args.azimuthal.unwrap_or(0);
    InputError::require(
        !picture.is_wanted() || most > 0,
        "--azimuthal",
        "M",
        most,
        "1 to 16 with --plot, which draws the modes",
    )?;
    let shape = stationary(&cell, &context.settings.numerics)?;
    let spectrum = shape.spectrum()?;
    let Cell { r0, epsilon, xi_s, cue, .. } = &shape.cortex.cell;
    let error = shape.growth_rate_error(&spectrum);
    messages::warn_of(mesh_warning(spectrum.growth_rate(), error));
    let found = stationary_report(&shape, &spectrum, error);
    let mut document = merged(json!({ "r0": r0, "epsilon": epsilon, "xi_s": xi_s, "cue": cue }), found);
    document = merged(document, filled(json!({ "r0_um": context.units.micrometres(*r0) })));
    let disturbed = args.azimuthal.map(|most| AzimuthalStability::up_to(usize::from(most), &shape, &spectrum));
    let disturbed = disturbed.transpose()?;
    if let Some(disturbed) = &disturbed {
        document["azimuthal"] = disturbed.iter().map(AzimuthalStability::report).collect();
        let modes: Vec<Mode> = disturbed.iter().filter_map(|row| row.mode.clone()).collect();
        picture.write(|| plot::azimuthal::draw(&shape.cortex, &modes))?;
    }
    print_as(context.json, &document, || {
        let verdict = if spectrum.is_stable() { "stable" } else { "unstable" };
        let mut out = format!("{}: {verdict}\n", described(&cell, &context.units, Some(*xi_s)));
        let (l, p, h) = (shape.length(), shape.pressure(), shape.elongation());
        let _ = writeln!(out, "L = {l:.6}, p = {p:.6}, H = {h:.6}, equator radius {:.6}", shape.equator_radius());
        if let (Some(middle), Some(pole)) = (shape.regulator_at(0.5), shape.regulator_at(0.0)) {
            let _ = writeln!(out, "regulator φ = {middle:.5} at u = 0.5, {pole:.5} at u = 0");
        }
        out += "growth rates (1/τ):\n";
        for rate in &spectrum.values {
            let imaginary = if rate.im == 0.0 { String::new() } else { format!(" {:+.6}i", rate.im) };
            let _ = writeln!(out, "  {:>14.6}{imaginary}  {}", rate.re, format!("{:?}", rate.parity).to_lowercase());
        }
        if let Some(disturbed) = &disturbed {
            out += &lines(disturbed);
        }
        if !shape.folds.is_empty() {
            let folds: Vec<String> = shape.folds.iter().map(|x| format!("{x:.5}")).collect();
            let _ = writeln!(out, "reached after folds at ξ_s = {}", folds.join(", "));
        }
        out
    })
}
