//! `furrow boundary`: curves of pitchforks and folds, and the critical radius.

use super::cell::positive;
use super::context::{Context, answer};
use super::error::CliError;
use super::pitchfork::criticality_name;
use crate::cortex::{Parameter, Cue};
use crate::input::InputError;
use crate::io::{parse_cue, write_atomically};
use crate::lineage::Lineage;
use crate::shapes::critical::Stored;
use crate::shapes::curves::{self, Curve, CurvePoint};
use crate::shapes::symmetric::Criticality;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;

/// Which parameter the curves run over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Vary {
    /// Radius R0
    R0,
    /// Volume fraction ε
    Epsilon,
}

/// Continues the pitchfork and the folds of the stationary shapes over R0 or ε; with a cue, the fold that ends the stable
/// shapes
#[derive(Debug, Args)]
pub struct BoundaryArgs {
    /// Parameter the curves run over
    #[arg(long, value_name = "NAME")]
    vary: Vary,
    /// Its first value
    #[arg(long, value_name = "A", allow_negative_numbers = true)]
    from: f64,
    /// Its last value
    #[arg(long, value_name = "B", allow_negative_numbers = true)]
    to: f64,
    /// Radius R0 where ε varies
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    r0: Option<f64>,
    /// Volume fraction ε where R0 varies
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    epsilon: Option<f64>,
    /// Activity ξ_s of --critical
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    xi: Option<f64>,
    /// Also solves for the value at which the boundary lies at the cell's own activity
    #[arg(long)]
    critical: bool,
    /// Leaves out the folds of the symmetric shapes
    #[arg(long)]
    no_folds: bool,
    /// Polarity cue: none, a name in the lineage file, or kappa:u0=..,omega=..,amplitude=..
    #[arg(long, value_name = "CUE", default_value = "none")]
    cue: String,
    /// Lineage file whose cues have names here; default the built-in one
    #[arg(long, value_name = "LINEAGE.ron")]
    lineage: Option<PathBuf>,
    /// Stores the boundary over R0, with the critical radii of all cues of the lineage, for `furrow tree` to use
    #[arg(long, value_name = "FILE.json")]
    write: Option<PathBuf>,
}

/// A point of a curve.
#[derive(Serialize)]
#[allow(non_snake_case)]
struct PointAnswer {
    r0: f64,
    epsilon: f64,
    xi_s: f64,
    H: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    criticality: Option<Criticality>,
    #[serde(skip_serializing_if = "Option::is_none")]
    coefficient: Option<f64>,
}

impl PointAnswer {
    fn new(point: &CurvePoint) -> PointAnswer {
        PointAnswer {
            r0: point.r0,
            epsilon: point.epsilon,
            xi_s: point.xi_s,
            H: point.elongation,
            criticality: point.criticality(),
            coefficient: point.coefficient,
        }
    }
}

/// A point of one of the fold curves.
#[derive(Serialize)]
struct FoldAnswer {
    /// Which curve, from 0.
    curve: usize,
    #[serde(flatten)]
    point: PointAnswer,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Answer {
    cue: Cue,
    pitchfork: Vec<PointAnswer>,
    /// Where criticality changes.
    degenerate: Vec<PointAnswer>,
    folds: Vec<FoldAnswer>,
    /// Where two folds are born.
    cusps: Vec<PointAnswer>,
    /// Value of the parameter varied at which the boundary lies at ξ_s.
    #[serde(skip_serializing_if = "Option::is_none")]
    critical: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    critical_point: Option<PointAnswer>,
}

pub fn run(args: &BoundaryArgs, mut context: Context) -> Result<(), CliError> {
    let (control, range) = args.check(&mut context)?;
    let lineage = Lineage::load(args.lineage.as_deref())?;
    let cue = parse_cue(&args.cue, &lineage)?;
    let (physics, numerics) = (&context.settings.physics, &context.settings.numerics);
    let r0 = args.r0.unwrap_or(range[0]);
    if let Some(path) = &args.write {
        let mut cues: Vec<Cue> = vec![Cue::None];
        cues.extend(lineage.cues.values().copied().filter(|cue| *cue != Cue::None));
        let stored = Stored::compute(physics, numerics, &cues, range)?;
        write_atomically(path, format!("{}\n", serde_json::to_string_pretty(&stored)?).as_bytes())?;
    }
    let (pitchfork, folds) = if cue == Cue::None {
        let pitchfork = either_way(range, |range| curves::pitchfork_curve(physics, numerics, r0, control, range))?;
        let folds = match args.no_folds {
            true => Vec::new(),
            false => curves::fold_curves(physics, numerics, r0, control, range)?,
        };
        (pitchfork, folds)
    } else {
        let fold = either_way(range, |range| curves::cued_fold_curve(physics, numerics, r0, &cue, control, range))?;
        (Curve::default(), vec![fold])
    };
    let critical = match (args.critical, cue) {
        (false, _) => None,
        (true, Cue::None) => Some(curves::critical_pitchfork(physics, numerics, r0, control, &starts(control, range))?),
        (true, _) => Some(curves::critical_cued_fold(physics, numerics, r0, &cue, control, &starts(control, range))?),
    };
    for error in folds.iter().filter_map(|fold| fold.stopped_by.as_ref()) {
        tracing::warn!("a curve of folds is followed no further: {error}");
    }
    let document = Answer {
        cue,
        pitchfork: pitchfork.points.iter().map(PointAnswer::new).collect(),
        // Neither sub- nor supercritical.
        degenerate: pitchfork
            .degenerate
            .iter()
            .map(|p| PointAnswer::new(&CurvePoint { coefficient: None, ..*p }))
            .collect(),
        cusps: cusps(&folds).iter().map(PointAnswer::new).collect(),
        folds: folds
            .iter()
            .enumerate()
            .flat_map(|(curve, fold)| {
                fold.points.iter().map(move |point| FoldAnswer { curve, point: PointAnswer::new(point) })
            })
            .collect(),
        critical: critical.map(|point| point.value),
        critical_point: critical.as_ref().map(PointAnswer::new),
    };
    if context.json {
        answer(&format!("{}\n", serde_json::to_string_pretty(&document)?))
    } else {
        answer(&document.text())
    }
}

/// The cusps of fold curves, each of which two curves lead to.
fn cusps(folds: &[Curve]) -> Vec<CurvePoint> {
    let mut cusps: Vec<CurvePoint> = Vec::new();
    for cusp in folds.iter().filter_map(|fold| fold.cusp) {
        let same =
            |c: &CurvePoint| (c.value - cusp.value).abs() + (c.xi_s - cusp.xi_s).abs() < 1e-6 * (1.0 + cusp.xi_s.abs());
        if !cusps.iter().any(same) {
            cusps.push(cusp);
        }
    }
    cusps
}

/// A curve from one end of the range, or else from the other.
fn either_way<E>(range: [f64; 2], follow: impl Fn([f64; 2]) -> Result<Curve, E>) -> Result<Curve, E> {
    follow(range).or_else(|error| {
        let mut curve = follow([range[1], range[0]]).map_err(|_| error)?;
        curve.points.reverse();
        Ok(curve)
    })
}

/// Where a critical value is looked for first.
fn starts(control: Parameter, [from, to]: [f64; 2]) -> Vec<f64> {
    let mut starts = vec![0.5 * (from + to), from, to];
    if control == Parameter::R0 {
        starts.extend(curves::STARTS);
    }
    starts
}

impl BoundaryArgs {
    fn check(&self, context: &mut Context) -> Result<(Parameter, [f64; 2]), InputError> {
        if let Some(xi) = self.xi {
            context.settings.set_number("--xi", "xi_s", xi)?;
        }
        let clash = |option: &str, value: f64, allowed| {
            Err(InputError::not_allowed(option, "vary", value, format!("absent where {allowed}")))
        };
        let control = match self.vary {
            Vary::R0 => {
                if let Some(r0) = self.r0 {
                    return clash("--r0", r0, "R0 varies");
                }
                if let Some(epsilon) = self.epsilon {
                    context.settings.set_number("--epsilon", "epsilon", epsilon)?;
                }
                positive("--from", "r0", self.from)?;
                positive("--to", "r0", self.to)?;
                Parameter::R0
            }
            Vary::Epsilon => {
                if let Some(epsilon) = self.epsilon {
                    return clash("--epsilon", epsilon, "ε varies");
                }
                let Some(r0) = self.r0 else {
                    return Err(InputError::not_allowed("--r0", "r0", "absent", "given where ε varies"));
                };
                positive("--r0", "r0", r0)?;
                for (option, value) in [("--from", self.from), ("--to", self.to)] {
                    context.settings.set_number(option, "epsilon", value)?;
                }
                Parameter::Epsilon
            }
        };
        if self.from == self.to {
            return Err(InputError::not_allowed("--to", "to", self.to, "different from --from"));
        }
        if self.write.is_some() && self.vary != Vary::R0 {
            return Err(InputError::not_allowed(
                "--write",
                "vary",
                "epsilon",
                "r0: what is stored is a boundary over R0",
            ));
        }
        Ok((control, [self.from, self.to]))
    }
}

impl Answer {
    fn text(&self) -> String {
        let mut out = String::from("curve              R0         ε         ξ_s         H\n");
        let mut line = |name: &str, p: &PointAnswer| {
            let of = p.criticality.map_or("", criticality_name);
            let _ = writeln!(out, "{name:<12} {:>8.5} {:>9.6} {:>11.6} {:>9.6}  {of}", p.r0, p.epsilon, p.xi_s, p.H);
        };
        self.pitchfork.iter().for_each(|p| line("pitchfork", p));
        self.degenerate.iter().for_each(|p| line("degenerate", p));
        self.folds.iter().for_each(|f| line(&format!("fold {}", f.curve), &f.point));
        self.cusps.iter().for_each(|p| line("cusp", p));
        self.critical_point.iter().for_each(|p| line("critical", p));
        out
    }
}
