//! `furrow boundary`: curves of pitchforks and folds, and the critical radius.

use super::interrupt::write_deferred;
use super::output::{csv_of, to_json, writable_file};
use super::prelude::*;
use super::vary::{Varied, VaryArgs};
use furrow_cell::{Cue, Parameter};
use furrow_figures::plot::{self, boundary::Boundary};
use furrow_formats::write_atomically;
use furrow_mechanics::equilibria::critical::{self, Stored};
use furrow_mechanics::equilibria::curves::{self, Curve, CurveEnd, CurvePoint};
use furrow_mechanics::equilibria::{Criticality, PointKind, StepBudget};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  furrow boundary --vary r0 --from 1.7 --to 2 --no-folds
  furrow boundary --vary r0 --from 1.6 --to 1.9 --critical --no-folds --json
  furrow boundary --vary r0 --from 1.6 --to 1.9 --no-folds --plot boundary.svg --csv all.csv
  furrow boundary --vary epsilon --from 0.85 --to 0.9 --r0 2 --no-folds")]
pub struct BoundaryArgs {
    #[command(flatten)]
    vary: VaryArgs,
    /// Activity ξ_s of --critical
    #[arg(help_heading = "Cell", long, value_name = "X", allow_negative_numbers = true, value_parser = number)]
    xi: Option<f64>,
    /// Solves for the value at which the boundary lies at the cell's own activity
    #[arg(help_heading = "Output", long)]
    critical: bool,
    /// Skips the folds of the symmetric shapes
    #[arg(help_heading = "Output", long)]
    no_folds: bool,
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

/// A row of `--csv`: a point and its curve.
#[derive(Serialize)]
struct CsvRow<'a> {
    curve: &'a str,
    #[serde(flatten)]
    point: &'a PointAnswer,
}

/// A point of a curve.
#[derive(Serialize)]
#[allow(non_snake_case)]
struct PointAnswer {
    r0: f64,
    epsilon: f64,
    /// Value of the parameter that varies.
    value: f64,
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
            value: point.value,
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

/// How a curve of folds ended.
#[derive(Serialize)]
struct EndAnswer {
    curve: usize,
    /// Value of the parameter where it did.
    value: f64,
    reason: &'static str,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Answer {
    /// The parameter that varies; `value` of every point is its value.
    vary: String,
    cue: Cue,
    pitchfork: Vec<PointAnswer>,
    /// Where criticality changes.
    degenerate: Vec<PointAnswer>,
    folds: Vec<FoldAnswer>,
    /// How the curves of folds ended.
    ends: Vec<EndAnswer>,
    /// Where two folds are born.
    cusps: Vec<PointAnswer>,
    /// Value of the parameter varied at which the boundary lies at ξ_s.
    critical: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    critical_point: Option<PointAnswer>,
}

pub fn run(args: &BoundaryArgs, mut context: Context) -> Result<(), CliError> {
    if let Some(xi) = args.xi {
        context.settings.set_number("--xi", "xi_s", xi)?;
    }
    let varied = args.vary.read(&mut context)?;
    args.check(&varied)?;
    let picture = args.plot.file()?;
    let Varied { cell, parameter, range } = &varied;
    let numerics = &context.settings.numerics;
    if let Some(path) = &args.write {
        let cues: Vec<Cue> = args.vary.cue.lineage()?.cues.into_values().filter(|cue| !cue.is_none()).collect();
        let stored = Stored::compute(cell, numerics, &[vec![Cue::none()], cues].concat(), *range)?;
        write_deferred(path, to_json(&stored)?.as_bytes())?;
    }
    let (kind, mut found) = curves::boundary_curves(cell, numerics, *parameter, *range)?;
    let (pitchfork, folds) = match kind {
        PointKind::Pitchfork if args.no_folds => (found.remove(0), Vec::new()),
        PointKind::Pitchfork => (found.remove(0), curves::fold_curves(cell, numerics, *parameter, *range)?),
        _ => (Curve::default(), found),
    };
    let unlimited = StepBudget::unlimited();
    let critical = match args.critical {
        true => Some(critical::critical_value(cell, numerics, *parameter, &starts(*parameter, *range), &unlimited)?.1),
        false => None,
    };
    for (k, fold) in folds.iter().enumerate() {
        match (&fold.ended, fold.error()) {
            (_, Some(error)) => tracing::warn!("fold {k} is followed no further: {error}"),
            (CurveEnd::Cusp(cusp), _) if kind != PointKind::Pitchfork => {
                tracing::warn!("fold {k} ends within the range, in a cusp at {parameter} = {:.6}", cusp.value);
            }
            _ => {}
        }
    }
    let document = Answer::new(&varied, &pitchfork, &folds, critical);
    if let Some(file) = &args.csv {
        let named = document.named();
        write_atomically(file, &csv_of(HEADER, named.iter().map(|(curve, point)| CsvRow { curve, point }))?)?;
    }
    let (parameter, range, cusps) = (*parameter, *range, cusps(&folds));
    picture.write(|| {
        let (pitchfork, folds, cusps) = (&pitchfork, &folds[..], &cusps[..]);
        plot::boundary::draw(&Boundary { cell, parameter, range, pitchfork, folds, cusps, critical })
    })?;
    print_as(context.json, &document, || if args.points { document.list() } else { document.text() })
}

/// The cusps of fold curves, each of which two curves lead to.
fn cusps(folds: &[Curve]) -> Vec<CurvePoint> {
    let mut cusps: Vec<CurvePoint> = Vec::new();
    for cusp in folds.iter().filter_map(Curve::cusp) {
        let same =
            |c: &CurvePoint| (c.value - cusp.value).abs() + (c.xi_s - cusp.xi_s).abs() < 1e-6 * (1.0 + cusp.xi_s.abs());
        if !cusps.iter().any(same) {
            cusps.push(cusp);
        }
    }
    cusps
}

/// Where a critical value is looked for first.
fn starts(parameter: Parameter, [from, to]: [f64; 2]) -> Vec<f64> {
    let mut starts = vec![0.5 * (from + to), from, to];
    if parameter == Parameter::R0 {
        starts.extend(critical::STARTS);
    }
    starts
}

impl BoundaryArgs {
    fn check(&self, varied: &Varied) -> Result<(), InputError> {
        let [from, to] = varied.range;
        if from == to {
            return Err(InputError::not_allowed("--to", "to", to, "different from --from"));
        }
        if self.write.is_some() && varied.parameter != Parameter::R0 {
            let allowed = "r0: what is stored is a boundary over R0";
            return Err(InputError::not_allowed("--write", "vary", varied.parameter, allowed));
        }
        writable_file("--csv", self.csv.as_deref())?;
        writable_file("--write", self.write.as_deref())
    }
}

impl Answer {
    fn new(varied: &Varied, pitchfork: &Curve, folds: &[Curve], critical: Option<CurvePoint>) -> Answer {
        let ends = folds.iter().enumerate().map(|(curve, fold)| EndAnswer {
            curve,
            value: fold.cusp().or(fold.points.last().copied()).map_or(f64::NAN, |point| point.value),
            reason: fold.ended.name(),
        });
        let fold_point = |curve: usize, point: &CurvePoint| FoldAnswer { curve, point: PointAnswer::new(point) };
        Answer {
            vary: varied.parameter.to_string(),
            cue: varied.cell.cue.clone(),
            ends: ends.collect(),
            pitchfork: pitchfork.points.iter().map(PointAnswer::new).collect(),
            // Neither sub- nor supercritical.
            degenerate: pitchfork
                .degenerate
                .iter()
                .map(|p| PointAnswer::new(&CurvePoint { coefficient: None, ..*p }))
                .collect(),
            cusps: cusps(folds).iter().map(PointAnswer::new).collect(),
            folds: folds
                .iter()
                .enumerate()
                .flat_map(|(curve, fold)| fold.points.iter().map(move |point| fold_point(curve, point)))
                .collect(),
            critical: critical.map(|point| point.value),
            critical_point: critical.as_ref().map(PointAnswer::new),
        }
    }

    /// All points, each with what it is of.
    fn named<'a>(&'a self) -> Vec<(String, &'a PointAnswer)> {
        let of = |name: &str, points: &'a [PointAnswer]| {
            let name = name.to_owned();
            points.iter().map(move |point| (name.clone(), point))
        };
        let mut all: Vec<(String, &PointAnswer)> = of("pitchfork", &self.pitchfork).collect();
        all.extend(of("degenerate", &self.degenerate));
        all.extend(self.folds.iter().map(|fold| (format!("fold {}", fold.curve), &fold.point)));
        all.extend(of("cusp", &self.cusps));
        all.extend(self.critical_point.iter().map(|point| ("critical".to_owned(), point)));
        all
    }

    /// Every point.
    fn list(&self) -> String {
        let mut out = String::from("curve              R0         ε      value         ξ_s         H\n");
        for (name, point) in self.named() {
            line(&mut out, &name, point);
        }
        out
    }

    /// Every curve by its two ends, and the points at which something happens.
    fn text(&self) -> String {
        let mut out = String::from("curve              R0         ε      value         ξ_s         H\n");
        let mut ends = |name: &str, points: &[&PointAnswer], how: &str| {
            let (Some(first), Some(last)) = (points.first(), points.last()) else { return };
            line(&mut out, name, first);
            line(&mut out, "  to", last);
            let _ = writeln!(out, "  in {} points{how}", points.len());
        };
        ends("pitchfork", &self.pitchfork.iter().collect::<Vec<_>>(), "");
        for end in &self.ends {
            let of = self.folds.iter().filter(|fold| fold.curve == end.curve).map(|fold| &fold.point);
            let how =
                if end.reason == "reached" { String::new() } else { format!("; {} at {:.6}", end.reason, end.value) };
            ends(&format!("fold {}", end.curve), &of.collect::<Vec<_>>(), &how);
        }
        self.degenerate.iter().for_each(|p| line(&mut out, "degenerate", p));
        self.cusps.iter().for_each(|p| line(&mut out, "cusp", p));
        self.critical_point.iter().for_each(|p| line(&mut out, "critical", p));
        out
    }
}

fn line(out: &mut String, name: &str, p: &PointAnswer) {
    let of = p.criticality.map_or(String::new(), |criticality| format!("  {criticality}"));
    let PointAnswer { r0, epsilon, value, xi_s, H: h, .. } = p;
    let _ = writeln!(out, "{name:<12} {r0:>8.5} {epsilon:>9.6} {value:>10.6} {xi_s:>11.6} {h:>9.6}{of}");
}
