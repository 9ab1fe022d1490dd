//! `furrow branch`: stationary shapes of one cell over activity.

use super::cell::{SizeArgs, positive, read_cue};
use super::context::{Context, answer};
use super::error::CliError;
use super::pitchfork::criticality_name;
use crate::cortex::{Cue, Numerics, Physics};
use crate::shapes::asymmetric::{self, Scaling};
use crate::shapes::cued;
use crate::shapes::symmetric::{
    self, Branch, BranchEnd, BranchEvent, BranchOptions, Criticality, ShapePoint, SteadyError,
};
use clap::Args;
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;

/// Follows the mirror-symmetric and the asymmetric stationary shapes over ξ_s, with their folds and pitchforks; with a cue,
/// the shapes that grow out of the passive one
#[derive(Debug, Args)]
pub struct BranchArgs {
    #[command(flatten)]
    size: SizeArgs,
    /// Largest ξ_s
    #[arg(long, value_name = "X", default_value_t = 100.0, allow_negative_numbers = true)]
    xi_max: f64,
    /// Largest step along a branch, in its arclength
    #[arg(long, value_name = "S", default_value_t = 1.0, allow_negative_numbers = true)]
    max_step: f64,
    /// Polarity cue: none, a name in the lineage file, or kappa:u0=..,omega=..,amplitude=..
    #[arg(long, value_name = "CUE", default_value = "none")]
    cue: String,
    /// Lineage file whose cues have names here; default the built-in one
    #[arg(long, value_name = "LINEAGE.ron")]
    lineage: Option<PathBuf>,
}

#[derive(Serialize)]
#[allow(non_snake_case)]
struct PointAnswer {
    branch: &'static str,
    xi_s: f64,
    H: f64,
    L: f64,
    p: f64,
    r_eq: f64,
    /// Absent if the growth rate could not be computed.
    #[serde(skip_serializing_if = "Option::is_none")]
    stable: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    growth_rate: Option<f64>,
    delta_u: f64,
}

#[derive(Serialize)]
#[allow(non_snake_case)]
struct EventAnswer {
    kind: &'static str,
    branch: &'static str,
    xi_s: f64,
    H: f64,
    L: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    criticality: Option<Criticality>,
    #[serde(skip_serializing_if = "Option::is_none")]
    coefficient: Option<f64>,
    /// Of folds: whether ξ_s is largest here along the branch.
    #[serde(skip_serializing_if = "Option::is_none")]
    maximum: Option<bool>,
}

/// Why a branch is followed no further than its last point.
#[derive(Serialize)]
struct EndAnswer {
    branch: &'static str,
    xi_s: f64,
    reason: &'static str,
    /// Of `pinched`: the neck at which shapes count as pinched off, in R0.
    #[serde(skip_serializing_if = "Option::is_none")]
    neck: Option<f64>,
}

/// How Δu opens at the pitchfork: |Δu| = prefactor |ξ_s − ξ_s*|^exponent.
#[derive(Serialize)]
struct ScalingAnswer {
    exponent: f64,
    prefactor: f64,
    coefficient: f64,
    points: usize,
}

#[derive(Serialize)]
struct Answer {
    r0: f64,
    epsilon: f64,
    cue: Cue,
    points: Vec<PointAnswer>,
    events: Vec<EventAnswer>,
    /// Of the asymmetric branch of the first pitchfork.
    #[serde(skip_serializing_if = "Option::is_none")]
    scaling: Option<ScalingAnswer>,
    steps: usize,
    newton_iterations: usize,
    ends: Vec<EndAnswer>,
    /// What went wrong where a branch ended.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    stopped_by: Vec<String>,
}

pub fn run(args: &BranchArgs, mut context: Context) -> Result<(), CliError> {
    let r0 = args.size.read(&mut context)?;
    let mut options = BranchOptions { xi: [0.0, positive("--xi-max", "xi_max", args.xi_max)?], ..Default::default() };
    options.settings.max_step = positive("--max-step", "max_step", args.max_step)?;
    options.settings.first_step = options.settings.first_step.min(options.settings.max_step);
    options.growth_rates = true;
    let (physics, numerics) = (&context.settings.physics, &context.settings.numerics);
    let cue = read_cue(&args.cue, args.lineage.as_deref())?;
    let mut document = Answer {
        r0,
        epsilon: physics.epsilon,
        cue,
        points: Vec::new(),
        events: Vec::new(),
        scaling: None,
        steps: 0,
        newton_iterations: 0,
        ends: Vec::new(),
        stopped_by: Vec::new(),
    };
    match cue {
        Cue::None => document.follow_without_cue(physics, numerics, &options)?,
        Cue::Kappa { .. } => document.add("cued", &cued::follow(physics, numerics, r0, &cue, &options, |_| true)?),
    }
    if context.json {
        answer(&format!("{}\n", serde_json::to_string_pretty(&document)?))
    } else {
        answer(&document.text())
    }
}

impl Answer {
    /// The mirror-symmetric branch, and the asymmetric one of its first pitchfork.
    fn follow_without_cue(
        &mut self,
        physics: &Physics,
        numerics: &Numerics,
        options: &BranchOptions,
    ) -> Result<(), SteadyError> {
        let branch = symmetric::follow(physics, numerics, self.r0, options, |_| true)?;
        self.add("symmetric", &branch);
        let first = branch.events.iter().find_map(|event| match event {
            BranchEvent::Pitchfork(pitchfork) => Some(pitchfork),
            BranchEvent::Fold(_) => None,
        });
        if let Some(pitchfork) = first {
            let found = asymmetric::follow(pitchfork, physics, self.r0, options);
            self.add("asymmetric", &found.branch);
            self.scaling = found.scaling.map(|Scaling { exponent, prefactor, coefficient, points }| ScalingAnswer {
                exponent,
                prefactor,
                coefficient,
                points,
            });
        }
        Ok(())
    }

    fn add(&mut self, name: &'static str, branch: &Branch) {
        if let Some(reason) = &branch.stopped_by {
            tracing::warn!("the {name} branch is followed no further: {reason}");
            self.stopped_by.push(reason.to_string());
        }
        let (reason, neck) = match branch.ended {
            BranchEnd::Bound(_) => ("bound", None),
            BranchEnd::PointLimit(_) => ("point_limit", None),
            BranchEnd::Pinched(neck) => ("pinched", Some(neck)),
            BranchEnd::Rejoined => ("rejoined", None),
            BranchEnd::Stopped => match branch.stopped_by {
                Some(SteadyError::Branch { .. }) => ("lost", None),
                _ => ("not_located", None),
            },
        };
        let xi_s = branch.points.last().map_or(f64::NAN, |point| point.xi_s);
        self.ends.push(EndAnswer { branch: name, xi_s, reason, neck });
        self.points.extend(branch.points.iter().map(|p: &ShapePoint| PointAnswer {
            branch: name,
            xi_s: p.xi_s,
            H: p.elongation,
            L: p.length,
            p: p.pressure,
            r_eq: p.equator_radius,
            stable: p.growth_rate.map(|rate| rate < 0.0),
            growth_rate: p.growth_rate,
            delta_u: p.delta_u,
        }));
        self.events.extend(branch.events.iter().map(|event| {
            let point = event.point();
            let (kind, criticality, coefficient, maximum) = match event {
                BranchEvent::Pitchfork(p) => ("pitchfork", Some(p.criticality()), Some(p.coefficient), None),
                BranchEvent::Fold(fold) => ("fold", None, None, Some(fold.maximum)),
            };
            EventAnswer {
                kind,
                branch: name,
                xi_s: point.xi_s,
                H: point.elongation,
                L: point.length,
                criticality,
                coefficient,
                maximum,
            }
        }));
        self.steps += branch.work.steps;
        self.newton_iterations += branch.work.iterations;
    }

    fn text(&self) -> String {
        let mut out = format!("R0 = {}, ε = {}\n", self.r0, self.epsilon);
        out.push_str("branch          ξ_s         H         L   growth rate        Δu\n");
        for p in &self.points {
            let rate = p.growth_rate.map_or("-".to_owned(), |rate| format!("{rate:.4}"));
            let _ = writeln!(
                out,
                "{:<10} {:>9.5} {:>9.6} {:>9.5} {rate:>13} {:>9.5}",
                p.branch, p.xi_s, p.H, p.L, p.delta_u
            );
        }
        for e in &self.events {
            let of = match (e.criticality, e.maximum) {
                (Some(criticality), _) => criticality_name(criticality),
                (_, Some(true)) => "largest ξ_s",
                _ => "smallest ξ_s",
            };
            let _ = writeln!(out, "{} of the {} branch at ξ_s = {:.6}, H = {:.6}: {of}", e.kind, e.branch, e.xi_s, e.H);
        }
        for end in &self.ends {
            let why = match (end.reason, end.neck) {
                ("pinched", Some(neck)) => format!("its neck is narrower than {neck} R0"),
                ("bound", _) => "the bound of ξ_s".to_owned(),
                ("point_limit", _) => "the largest number of points".to_owned(),
                ("rejoined", _) => "its shapes are mirror-symmetric again".to_owned(),
                ("lost", _) => "lost".to_owned(),
                _ => "a singular point that cannot be located".to_owned(),
            };
            let _ = writeln!(out, "the {} branch is followed to ξ_s = {:.6}: {why}", end.branch, end.xi_s);
        }
        if let Some(s) = &self.scaling {
            let _ = writeln!(out, "|Δu| = {:.4} |ξ_s − ξ_s*|^{:.4} from {} points", s.prefactor, s.exponent, s.points);
        }
        out
    }
}
