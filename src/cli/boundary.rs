//! `furrow boundary`: curves of pitchforks and folds, and the critical radius.

use super::cell::{AxisArgs, set};
use super::context::Context;
use super::error::CliError;
use super::interrupt::write_deferred;
use super::messages;
use super::output::{number, print_as, records_csv, to_json, writable_file};
use super::picture::PlotArgs;
use super::steady::MOST_AZIMUTHAL;
use super::vary::{Varied, VaryArgs};
use clap::Args;
use furrow_analysis::bent::{boundary_with_bent, can_vary};
use furrow_analysis::boundary::point_document;
use furrow_analysis::{BoundaryOptions, BoundaryStudy};
use furrow_cell::{Cue, Parameter};
use furrow_figures::plot;
use furrow_formats::write_atomically;
use furrow_input::InputError;
use furrow_lineage::Units;
use furrow_mechanics::critical::Stored;
use furrow_mechanics::equilibria::curves::{Curve, CurveEnd, CurvePoint};
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow boundary --vary r0 --from 1.7 --to 2 --plot boundary.svg
  furrow boundary --vary r0 --from 1.6 --to 1.9 --critical --no-folds --json
  furrow boundary --vary r0 --from 1.3 --to 2.1 --no-folds --three-dimensional
  furrow boundary --vary epsilon --from 0.85 --to 0.9 --r0 2 --no-folds")]
pub struct BoundaryArgs {
    #[command(flatten)]
    vary: VaryArgs,
    #[command(flatten)]
    pub axis: AxisArgs,
    /// Activity ξ_s for --critical
    #[arg(help_heading = "Cell", long, value_name = "X", value_parser = number, requires = "critical")]
    xi: Option<f64>,
    /// Solves for the value at which the boundary lies at the cell's own activity
    #[arg(help_heading = "Output", long)]
    critical: bool,
    /// Skips the folds of the symmetric shapes
    #[arg(help_heading = "Output", long)]
    no_folds: bool,
    /// Also follows the activity above which non-axisymmetric disturbances cos mφ, m = 1 to M, grow
    #[arg(help_heading = "Output", long, value_name = "M", value_parser = clap::value_parser!(u8).range(1..=MOST_AZIMUTHAL))]
    azimuthal: Option<u8>,
    /// Stores the boundary over R0, with the critical radii of all cues of the lineage
    #[arg(help_heading = "Output", long, value_name = "FILE.json")]
    write: Option<PathBuf>,
    /// Prints every point of the curves instead of a summary
    #[arg(help_heading = "Output", long)]
    points: bool,
    /// Writes every point of the curves as CSV
    #[arg(help_heading = "Output", long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotArgs,
}

/// The columns of `--csv`.
const HEADER: &str = "curve,r0,epsilon,value,xi_s,H,criticality,coefficient";

pub fn run(args: &BoundaryArgs, mut context: Context) -> Result<(), CliError> {
    set(&context.globals, &mut context.settings, [("--xi", "xi_s", args.xi)])?;
    let varied = args.vary.read(&mut context)?;
    context.check_azimuthal(args.azimuthal)?;
    args.check(&varied, context.settings.numerics.modes)?;
    let picture = args.plot.file()?;
    let Varied { cell, parameter, range } = &varied;
    let numerics = &context.settings.numerics;
    if let Some(path) = &args.write {
        let cues: Vec<Cue> = args
            .vary
            .cue
            .lineage()?
            .cues
            .into_values()
            .filter(|cue| cell.clone().with_cue(cue.clone()).has_cue())
            .collect();
        let stored = Stored::compute(cell, numerics, &[vec![Cue::none()], cues].concat(), *range)?;
        write_deferred(path, to_json(&stored)?.as_bytes())?;
    }
    let options =
        BoundaryOptions { folds: !args.no_folds, critical: args.critical, azimuthal: args.azimuthal.map(usize::from) };
    let found = boundary_with_bent(cell, numerics, *parameter, *range, options)?;
    messages::warn_of(&found.warnings);
    let named = found.named();
    if let Some(file) = &args.csv {
        let rows = named.iter().map(|(name, p)| point_document(name.as_str(), p));
        write_atomically(file, &records_csv(HEADER, rows)?)?;
    }
    picture.write(|| plot::boundary::draw(&found))?;
    print_as(context.json, &found.document(), || {
        let units = &context.units;
        if args.points { list(&named, units) } else { text(&found, units) }
    })
}

impl BoundaryArgs {
    fn check(&self, varied: &Varied, modes: usize) -> Result<(), InputError> {
        let [from, to] = varied.range;
        InputError::require(from != to, "--to", "to", to, "different from --from")?;
        let fine = self.write.is_none() || varied.parameter == Parameter::R0;
        InputError::require(fine, "--write", "vary", varied.parameter, "r0: what is stored is a boundary over R0")?;
        let fine = modes == 0 || can_vary(varied.parameter);
        InputError::require(fine, "--vary", "vary", varied.parameter, "r0 or epsilon with --three-dimensional")?;
        writable_file("--csv", self.csv.as_deref())?;
        writable_file("--write", self.write.as_deref())
    }
}

const HEADING: &str = "curve              R0         ε      value         ξ_s         H\n";

/// All points of the curves.
fn list(named: &[(String, CurvePoint)], units: &Units) -> String {
    named.iter().fold(HEADING.to_owned(), |out, (name, point)| out + &line(name, point, units))
}

/// The two ends of every curve, and its special points.
fn text(found: &BoundaryStudy, units: &Units) -> String {
    // Where two pitchforks meet there is no cusp.
    let ends = |name: &str, curve: &Curve, turned: &str| {
        let (Some(first), Some(last)) = (curve.points.first(), curve.points.last()) else { return String::new() };
        let how = match &curve.ended {
            CurveEnd::Reached => String::new(),
            CurveEnd::Cusp(point) => format!("; {turned} at {:.6}", point.value),
            ended => format!("; {} at {:.6}", ended.name(), last.value),
        };
        format!("{}{}  in {} points{how}\n", line(name, first, units), line("  to", last, units), curve.points.len())
    };
    let pitchforks = found.pitchfork_names().map(|(name, curve)| ends(&name, curve, "turns back"));
    let folds = found.folds.iter().enumerate().map(|(k, fold)| ends(&format!("fold {k}"), fold, "cusp"));
    let listed = ["degenerate", "bent degenerate", "cusp", "critical"];
    let events = found.named().into_iter().filter(|(name, _)| listed.contains(&name.as_str()));
    let events = events.map(|(name, point)| line(&name, &point, units));
    let azimuthal = found.azimuthal.iter().flatten().map(|(m, curve)| ends(&format!("m = {m}"), curve, "cusp"));
    let bent = found.bent.iter().flatten().map(|(name, curve)| ends(&format!("bent {name}"), curve, "cusp"));
    let critical = found.bent_critical.map(|CurvePoint { r0, .. }| {
        format!("without axial symmetry cells below R0 = {r0:.5}{} come to rest bent\n", units.in_micrometres(r0))
    });
    let curves = pitchforks.chain(folds).chain(azimuthal).chain(bent).chain(events).chain(critical);
    std::iter::once(HEADING.to_owned()).chain(curves).collect()
}

fn line(name: &str, p: &CurvePoint, units: &Units) -> String {
    let CurvePoint { r0, epsilon, value, xi_s, elongation: h, .. } = p;
    let of = p.criticality().map_or(String::new(), |criticality| format!("  {criticality}"));
    let um = units.in_micrometres(*r0);
    format!("{name:<12} {r0:>8.5} {epsilon:>9.6} {value:>10.6} {xi_s:>11.6} {h:>9.6}{of}{um}\n")
}
