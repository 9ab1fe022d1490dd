//! Stationary shapes over ξ_s: figures 2C to 2F, those of 2H to 2L, S3 and S4.

use rayon::prelude::*;

use super::lab::{Finding, Found, Lab, LabError, PUBLISHED_ACTIVITY, Shown};
use super::paper::Statement;
use super::size::outcomes;
use crate::batch::phase::{PhasePlane, spaced};
use crate::batch::scheduler;
use crate::calibration::statements::HigherFold;
use crate::cell::{Cell, Parameter};
use crate::shapes::asymmetric::{self, Scaling};
use crate::shapes::critical::critical_value;
use crate::shapes::{Branch, BranchOptions, ShapeError, curves, primary};

/// Longest step along a branch, for smooth pictures.
const STEP: f64 = 1.0;

/// The branches of one cell.
struct Shapes {
    cell: Cell,
    branches: Vec<(&'static str, Branch)>,
    scaling: Option<Scaling>,
}

/// The branch that grows out of the passive shape up to `xi_max`, and the asymmetric one that leaves it.
fn follow(lab: &Lab<'_>, cell: &Cell, xi_max: f64) -> Result<Shapes, ShapeError> {
    let options = BranchOptions { xi: [0.0, xi_max], growth_rates: true, contours: true, ..BranchOptions::default() };
    let options = options.with_max_step(STEP);
    let branch = primary::follow(cell, &lab.numerics(), &options, |_| true)?;
    let off = branch.pitchforks().next().map(|pitchfork| asymmetric::follow(pitchfork, cell, &options));
    let mut branches = vec![("symmetric", branch)];
    let scaling = off.and_then(|off| {
        branches.push(("asymmetric", off.branch));
        off.scaling
    });
    Ok(Shapes { cell: cell.clone(), branches, scaling })
}

/// A cell, and its shapes or why they could not be followed.
type Followed = (Cell, Result<Shapes, ShapeError>);

/// The shapes of all cells that statements are about, each once, with what could not be followed.
fn shapes_of(lab: &Lab<'_>, statements: &[Statement], xi_max: f64) -> Result<Vec<Followed>, LabError> {
    let mut cells: Vec<Cell> = Vec::new();
    for statement in statements.iter().filter(|statement| statement.cell.is_some()) {
        let cell = lab.cell_of(statement);
        if !cells.contains(&cell) {
            cells.push(cell);
        }
    }
    let pool = scheduler::pool(lab.threads)?;
    Ok(pool.install(|| cells.into_par_iter().map(|cell| (cell.clone(), follow(lab, &cell, xi_max))).collect()))
}

impl Shapes {
    /// What a statement about the first pitchfork, its opening or the folds comes to; none of another.
    fn finding(&self, statement: &Statement) -> Option<Finding> {
        let id = statement.id.as_str();
        let (_, symmetric) = self.branches.first()?;
        let pitchfork = symmetric.pitchforks().next();
        let missing = || Finding::not_computed(id, "there is no pitchfork");
        if let Some(kind) = statement.kind {
            return Some(pitchfork.map_or_else(missing, |found| {
                let words = format!("{}, coefficient {:+.2}", found.criticality(), found.coefficient);
                Finding::words(id, found.criticality() == kind, words)
            }));
        }
        if let Some(higher) = statement.higher {
            return Some(self.folds(id, symmetric, higher));
        }
        match id.split('_').next()? {
            "threshold" => Some(pitchfork.map_or_else(missing, |found| Finding::number(id, found.point.xi_s))),
            "opening" => Some(match self.scaling {
                Some(scaling) => Finding::number(id, scaling.exponent),
                None => Finding::not_computed(id, "no asymmetric branch"),
            }),
            "window" => {
                let fold = symmetric.folds().find(|fold| fold.maximum).map(|fold| fold.point.xi_s);
                let threshold = pitchfork.map(|found| found.point.xi_s);
                Some(match (threshold, fold) {
                    (Some(low), Some(high)) => {
                        let holds = low < PUBLISHED_ACTIVITY && PUBLISHED_ACTIVITY < high;
                        Finding::words(id, holds, format!("{low:.2} < 25 < {high:.2}"))
                    }
                    _ => Finding::not_computed(id, "there is no pitchfork, or no fold"),
                })
            }
            _ => None,
        }
    }

    /// Which of the largest ξ_s along the branch, that of the shortest and that of the longest shape, is the larger.
    fn folds(&self, id: &str, branch: &Branch, higher: HigherFold) -> Finding {
        let mut maxima: Vec<[f64; 2]> =
            branch.folds().filter(|fold| fold.maximum).map(|fold| [fold.point.elongation, fold.point.xi_s]).collect();
        maxima.sort_by(|a, b| a[0].total_cmp(&b[0]));
        match maxima[..] {
            [short, .., long] => {
                let holds = (higher == HigherFold::LargeH) == (long[1] > short[1]);
                Finding::words(id, holds, format!("ξ_s = {:.2} at small H, {:.2} at large H", short[1], long[1]))
            }
            _ => Finding::words(id, false, "fewer than two folds".to_owned()),
        }
    }
}

/// Findings and pictures of all statements that shapes answer.
fn answered(
    lab: &Lab<'_>,
    statements: &[Statement],
    xi_max: f64,
    name: &str,
    found: &mut Found,
) -> Result<(), LabError> {
    let shapes = shapes_of(lab, statements, xi_max)?;
    for statement in statements.iter().filter(|statement| statement.cell.is_some()) {
        let cell = lab.cell_of(statement);
        match shapes.iter().find(|(of, _)| *of == cell) {
            Some((_, Ok(shapes))) => found.findings.extend(shapes.finding(statement)),
            Some((_, Err(error))) => found.say(Finding::not_computed(&statement.id, error)),
            None => {}
        }
    }
    for (cell, shapes) in shapes {
        if let Ok(Shapes { cell: of, branches, .. }) = shapes {
            let name = format!("{name}-R0_{}-epsilon_{}", cell.r0, cell.epsilon);
            found.show(&name, Shown::Branches(of, branches));
        }
    }
    Ok(())
}

/// Figures 2C to 2F: shapes of cells of two sizes.
pub fn over_size(lab: &Lab<'_>, statements: &[Statement]) -> Result<Found, LabError> {
    let mut found = Found::default();
    answered(lab, statements, 30.0, "2C-F", &mut found)?;
    Ok(found)
}

/// Figures 2H to 2L: shapes of cells in two shells, and the plane that they are in.
pub fn over_confinement(lab: &Lab<'_>, statements: &[Statement]) -> Result<Found, LabError> {
    let mut found = Found::default();
    let shapes: Vec<Statement> =
        statements.iter().filter(|statement| statement.id != "confinement_pitchfork").cloned().collect();
    answered(lab, &shapes, 30.0, "2H-L", &mut found)?;
    let cell = lab.cell(2.22, 0.895);
    let starts = [0.895, 0.85, 0.76];
    found.say(match critical_value(&cell, &lab.numerics(), Parameter::Epsilon, &starts) {
        Ok((_, point)) => Finding::number("confinement_pitchfork", point.value),
        Err(error) => Finding::not_computed("confinement_pitchfork", error),
    });
    let (across, up) = (spaced(0.54, 0.92, 20), spaced(3.0, 27.0, 9));
    let plane = PhasePlane { cell, numerics: lab.numerics(), parameter: Parameter::Epsilon, across, up, seed: 0 };
    let diagram = lab.plane("2H-L", plane, &mut found)?;
    found.say(Finding::open("confinement_plane", outcomes(&diagram)));
    Ok(found)
}

/// Figure S4: the folds of shapes in loose shells.
pub fn folds(lab: &Lab<'_>, statements: &[Statement]) -> Result<Found, LabError> {
    let mut found = Found::default();
    answered(lab, statements, 30.0, "S4", &mut found)?;
    Ok(found)
}

/// Range of R0 of the curves.
const RADII: [f64; 2] = [1.6, 2.4];

/// Figure S3: what bounds division over R0.
pub fn over_radius(lab: &Lab<'_>, _: &[Statement]) -> Result<Found, LabError> {
    let mut found = Found::default();
    let (cell, numerics) = (lab.cell(2.0, 0.87), lab.numerics());
    let both = curves::pitchfork_curve(&cell, &numerics, Parameter::R0, RADII)
        .and_then(|pitchforks| Ok((pitchforks, curves::fold_curves(&cell, &numerics, Parameter::R0, RADII)?)));
    match both {
        Ok((pitchforks, folds)) => {
            let ends = pitchforks.points.first().zip(pitchforks.points.last());
            let range = ends.map_or(String::new(), |(a, b)| format!("ξ_s* = {:.2} to {:.2}", a.xi_s, b.xi_s));
            let changes: Vec<String> = pitchforks.degenerate.iter().map(|p| format!("{:.3}", p.r0)).collect();
            let changes = match changes.is_empty() {
                true => "one kind throughout".to_owned(),
                false => format!("the kind changes at R0 = {}", changes.join(", ")),
            };
            found.say(Finding::open("curves", format!("{range}; {changes}")));
            found.show("S3", Shown::Boundary(cell, RADII, pitchforks, folds));
        }
        Err(error) => found.say(Finding::open("curves", format!("not computed: {error}"))),
    }
    Ok(found)
}
