//! `furrow phase`: outcomes over a plane of one parameter and activity.

use super::cell::AxisArgs;
use super::context::Context;
use super::error::CliError;
use super::interrupt;
use super::messages;
use super::output::{number, print_as, seed};
use super::picture::PlotArgs;
use super::progress::ProgressLine;
use super::steady::MOST_AZIMUTHAL;
use super::vary::{Varied, VaryArgs};
use clap::Args;
use furrow_analysis::bent::bent_edges;
use furrow_analysis::edges;
use furrow_cell::Parameter;
use furrow_figures::plot;
use furrow_input::InputError;
use furrow_lineage::batch::phase::{PhaseOutcome, spaced};
use furrow_lineage::batch::{PhaseDiagram, PhasePlane};
use furrow_mechanics::equilibria::at_rest::Edge;
use serde_json::json;
use std::fmt::Write;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow phase --vary r0 --from 1.6 --to 2.4 --xi-from 15 --xi-to 25
  furrow phase --vary r0 --from 1.6 --to 2.4 --azimuthal 1 --plot phase.svg
  furrow phase --vary r0 --from 1.4 --to 2 --points 2 --xi-points 2 --three-dimensional
  furrow phase --vary epsilon --from 0.8 --to 0.9 --r0 2 --points 2 --json")]
pub struct PhaseArgs {
    #[command(flatten)]
    vary: VaryArgs,
    #[command(flatten)]
    pub axis: AxisArgs,
    /// Number of values of the parameter
    #[arg(help_heading = "Diagram", long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    points: u32,
    /// First ξ_s
    #[arg(help_heading = "Diagram", long, value_name = "X", default_value_t = 5.0, value_parser = number)]
    xi_from: f64,
    /// Last ξ_s
    #[arg(help_heading = "Diagram", long, value_name = "X", default_value_t = 30.0, value_parser = number)]
    xi_to: f64,
    /// Number of values of ξ_s
    #[arg(help_heading = "Diagram", long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    xi_points: u32,
    /// Seed of the noise in the first step
    #[arg(help_heading = "Numerics", long, value_name = "S", default_value_t = 0, value_parser = seed)]
    seed: u64,
    /// Draws the activity above which disturbances cos mφ, m = 1 to M, grow
    #[arg(help_heading = "Output", long, value_name = "M", requires = "plot", value_parser = clap::value_parser!(u8).range(1..=MOST_AZIMUTHAL))]
    azimuthal: Option<u8>,
    #[command(flatten)]
    plot: PlotArgs,
}

pub fn run(args: &PhaseArgs, mut context: Context) -> Result<(), CliError> {
    for (option, value) in [("--xi-from", args.xi_from), ("--xi-to", args.xi_to)] {
        let fine = value.is_finite() && value >= 0.0;
        InputError::require(fine, option, "xi_s", value, "a finite number, 0 or above")?;
    }
    let Varied { cell, parameter, range } = args.vary.read(&mut context)?;
    let fine = args.points > 1 || range[0] == range[1];
    InputError::require(fine, "--points", "points", args.points, "2 at least where --from and --to differ")?;
    context.check_azimuthal(args.azimuthal)?;
    context.settings.check_divisions("settings")?;
    let picture = args.plot.file()?;
    let plane = PhasePlane {
        cell,
        numerics: context.settings.numerics,
        parameter,
        across: spaced(range[0], range[1], args.points as usize),
        up: spaced(args.xi_from, args.xi_to, args.xi_points as usize),
        seed: args.seed,
    };
    let diagram = solve(&context, &plane)?;
    let azimuthal = args.azimuthal.map_or(0, usize::from);
    picture.write(|| {
        let (mut edges, mut warnings) = edges(&plane, azimuthal);
        edges.bent = bent_edges(&plane, &mut warnings);
        messages::warn_of(warnings);
        plot::phase::draw(&plane, &diagram, &edges)
    })?;
    let (vary, cue) = (parameter.to_string(), &plane.cell.cue);
    let document = json!({ "vary": vary, "cue": cue, "cells": diagram.cells, "columns": diagram.columns });
    print_as(context.json, &document, || text(&plane, &diagram))
}

/// Computes the diagram; logs points that could not be computed.
fn solve(context: &Context, plane: &PhasePlane) -> Result<PhaseDiagram, CliError> {
    let memo = context.memo()?;
    let line = ProgressLine::new(context.progress);
    let show = |progress| {
        // Divisions are cached; the stationary shapes, computed before, are not.
        interrupt::finish();
        line.show_all(progress);
    };
    let column = |done, of| line.show_share(done, of, || "columns of shapes".to_owned());
    let diagram = plane.compute_shown(&memo, &context.scheduling(&show), &column);
    drop(line);
    let diagram = diagram?;
    messages::warn_of(diagram.summary.described());
    if let Some((failure, count)) = &diagram.undecided {
        let others = if *count > 1 { format!(" (and {} more)", count - 1) } else { String::new() };
        messages::warning!("left undecided: {failure}{others}");
    }
    for column in &diagram.columns {
        if let Some(error) = &column.error {
            messages::warning!("no edges at {} = {}, left to divisions: {error}", plane.parameter, column.x);
        }
    }
    if diagram.summary.interrupted { Err(CliError::Interrupted) } else { Ok(diagram) }
}

fn text(plane: &PhasePlane, diagram: &PhaseDiagram) -> String {
    let name = match plane.parameter {
        Parameter::R0 => "R0".to_owned(),
        Parameter::Epsilon => "ε".to_owned(),
        other => other.to_string(),
    };
    let across: String = diagram.columns.iter().map(|column| format!(" {:>8.4}", column.x)).collect();
    let mut out = format!(
        "χ where the cell divides (0: equal daughters), - where it stays at rest, ? undecided\n{:>9}{across}  {name}\n",
        "ξ_s"
    );
    for (row, xi_s) in plane.up.iter().enumerate().rev() {
        let _ = write!(out, "{xi_s:>9.4}");
        for cell in diagram.cells.iter().skip(row).step_by(plane.up.len()) {
            let shown = match (cell.outcome, cell.chi) {
                (PhaseOutcome::Symmetric, _) => "0".to_owned(),
                (_, Some(chi)) => format!("{chi:.3}"),
                (PhaseOutcome::Failed, _) => "-".to_owned(),
                _ => "?".to_owned(),
            };
            let _ = write!(out, " {shown:>8}");
        }
        out.push('\n');
    }
    out += "edges of the stable shapes (pitchfork P, fold F, Hopf point H):\n";
    for column in &diagram.columns {
        let edge = |edge: &Edge| {
            let kind = match edge {
                Edge::Pitchfork { .. } => "P",
                Edge::BentPitchfork { .. } => "bent P",
                Edge::BentFold { .. } => "bent F",
                Edge::Hopf { .. } => "H",
                _ => "F",
            };
            format!("{kind} {:.4}", edge.xi_s())
        };
        let edges = match (&column.edges[..], &column.error) {
            ([], Some(_)) => "not computed".to_owned(),
            ([], None) => "none in this range of ξ_s".to_owned(),
            (edges, _) => edges.iter().map(edge).collect::<Vec<_>>().join(", "),
        };
        let _ = writeln!(out, "{name} = {:.4}: {edges}", column.x);
    }
    out
}
