//! One cell: its division, its stationary shapes, its threshold.

use std::sync::Arc;

use furrow_analysis::{Diagram, diagram};
use furrow_formats::frames::{COLUMNS, check_step, stills};
use furrow_input::InputError;
use furrow_lineage::batch::{Replicates, SchedulerOptions, replicates};
use furrow_mechanics::cortex::forces::Place;
use furrow_mechanics::division::{Division, Snapshot, Trajectory};
use furrow_mechanics::equilibria::{BranchEnd, BranchOptions, pitchfork as pitchforks, stationary};
use furrow_report::{event_report, stationary_report, threshold_report};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;

use crate::columns::{columns, or_nan};
use crate::errors::{Error, raised, unwritable};
use crate::inputs::{ARGUMENTS, Inputs};
use crate::memo::Memo;
use crate::supervise::{Interrupt, supervised};

/// Divisions of one cell with the seeds from `seed` on, as JSON: the divisions with their seeds, and the failures with their seeds.
#[pyfunction]
#[pyo3(signature = (inputs, memo, seed, count, threads, progress=None))]
pub fn divide(
    py: Python<'_>,
    inputs: &Inputs,
    memo: &Memo,
    seed: u64,
    count: usize,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    let input = inputs.division(seed).map_err(|error| raised(py, error, 0))?;
    let memo = Arc::clone(&memo.solved);
    // A known division needs no thread.
    if count == 1
        && let Some(division) = py.detach(|| memo.known(&input))
    {
        let found: (_, [(u64, String); 0]) = ([(seed, division)], []);
        return serde_json::to_string(&found).map_err(unwritable);
    }
    // A single division leaves nothing to keep before it ends; it goes on to the memo by itself.
    let interrupt = if count == 1 { Interrupt::Abandons } else { Interrupt::Finishes };
    let found = supervised(py, interrupt, progress, move |watch| {
        let show = |progress| watch.divisions(progress);
        let stop = Some(watch.stop()).filter(|_| count > 1);
        let options =
            SchedulerOptions { threads, interrupt: stop, progress: Some(&show), ..SchedulerOptions::default() };
        let Replicates { divisions, mut undecided, .. } = replicates(&input, count, &memo, &options)?;
        if divisions.len() + undecided.len() < count {
            return Err(Error::Interrupted);
        }
        if divisions.is_empty()
            && let Some(first) = undecided.pop()
        {
            return Err(first.failure.into());
        }
        let undecided = undecided.iter().map(|job| (seed.wrapping_add(job.id as u64), job.failure.to_string()));
        Ok((divisions, undecided.collect::<Vec<(u64, String)>>()))
    })?;
    serde_json::to_string(&found).map_err(unwritable)
}

/// A division with its shapes: its outcome as JSON, the columns of frames, and where the places of each frame end in the columns of
/// all places.
type Filmed<'py> = (String, Bound<'py, PyDict>, Bound<'py, PyArray1<i64>>, Bound<'py, PyDict>, [f64; 2]);

/// Computes a division and keeps its shapes, after every step or every so many τ.
#[pyfunction]
#[pyo3(signature = (inputs, seed, every=None, places=None))]
pub fn film<'py>(
    py: Python<'py>,
    inputs: &Inputs,
    seed: u64,
    every: Option<f64>,
    places: Option<usize>,
) -> PyResult<Filmed<'py>> {
    let input = inputs.division(seed).map_err(|error| raised(py, error, 0))?;
    if let Some(step) = every.filter(|step| !(step.is_finite() && *step > 0.0)) {
        let error = InputError::not_allowed(ARGUMENTS, "frames", step, "True, False or a finite number of τ above 0");
        return Err(raised(py, error.into(), 0));
    }
    let (division, stills, shell) = supervised(py, Interrupt::Abandons, None, move |_| {
        let film = Trajectory::compute(&input)?;
        let film = match places {
            Some(count) => film.with_places(count),
            None => film,
        };
        check_step(ARGUMENTS, &film, every)?;
        Ok((film.division.clone(), stills(&film, every), film.shell()))
    })?;
    let (of_frames, ends, places) = py.detach(|| {
        (frame_columns(&stills), ends(&stills), place_columns(stills.iter().flat_map(|still| &still.places)))
    });
    let text = division_json(&division)?;
    Ok((text, columns(py, of_frames)?, PyArray1::from_vec(py, ends), columns(py, places)?, shell))
}

fn division_json(division: &Division) -> PyResult<String> {
    serde_json::to_string(division).map_err(unwritable)
}

/// The columns of frames.
fn frame_columns(stills: &[Snapshot]) -> Vec<(&'static str, Vec<f64>)> {
    let column = |of: fn(&Snapshot) -> f64| stills.iter().map(of).collect();
    vec![
        ("t", column(|still| still.t)),
        ("neck_radius", column(|still| or_nan(still.neck.map(|neck| neck.radius)))),
        ("neck_u", column(|still| or_nan(still.neck.map(|neck| neck.u)))),
        ("length", column(|still| still.length)),
        ("pressure", column(|still| still.pressure)),
        ("chi", column(|still| or_nan(still.neck.map(|_| still.asymmetry.abs())))),
    ]
}

/// Where the places of each frame end, the first beginning at 0.
fn ends(stills: &[Snapshot]) -> Vec<i64> {
    let mut end = 0;
    let behind = stills.iter().map(|still| {
        end += still.places.len() as i64;
        end
    });
    behind.collect()
}

/// Places as columns, with the names of the files of frames.
fn place_columns<'a>(places: impl Iterator<Item = &'a Place>) -> Vec<(&'static str, Vec<f64>)> {
    let names = COLUMNS.map(|(name, _)| name);
    let mut columns = names.map(|_| Vec::with_capacity(places.size_hint().0));
    for p in places {
        let head = [p.u, p.r, p.z, p.psi, p.c_uu, p.c_pp, p.t_uu, p.t_pp, p.v, p.v_n, p.active_tangential];
        let row = head.into_iter().chain(p.normal.parts()).chain([p.normal.residual()]);
        columns.iter_mut().zip(row).for_each(|(column, number)| column.push(number));
    }
    names.into_iter().zip(columns).collect()
}

/// The stationary shape at one activity, on the branch of the passive shape, and its growth rates: JSON, and the places of its
/// contour.
#[pyfunction]
pub fn steady<'py>(py: Python<'py>, inputs: &Inputs) -> PyResult<(String, Bound<'py, PyDict>)> {
    inputs.settings().check_activity(ARGUMENTS).map_err(|error| raised(py, error.into(), 0))?;
    let Inputs { cell, numerics } = inputs.clone();
    let (found, places) = supervised(py, Interrupt::Abandons, None, move |_| {
        let shape = stationary(&cell, &numerics).map_err(Error::no_outcome)?;
        let spectrum = shape.spectrum().map_err(Error::no_outcome)?;
        let found = stationary_report(&shape, &spectrum);
        let gauss = furrow_bvp::Gauss::new(numerics.stages);
        Ok((
            found,
            place_columns(furrow_mechanics::cortex::forces::profile(&shape.cortex, &gauss, &shape.solution).iter()),
        ))
    })?;
    Ok((serde_json::to_string(&found).map_err(unwritable)?, columns(py, places)?))
}

fn range(xi_max: f64) -> Result<[f64; 2], Error> {
    if xi_max.is_finite() && xi_max > 0.0 {
        return Ok([0.0, xi_max]);
    }
    Err(InputError::not_allowed(ARGUMENTS, "xi_max", xi_max, "a finite number above 0").into())
}

/// The first pitchfork of the mirror-symmetric shapes, as JSON.
#[pyfunction]
pub fn pitchfork(py: Python<'_>, inputs: &Inputs, xi_max: f64) -> PyResult<String> {
    let xi = range(xi_max).map_err(|error| raised(py, error, 0))?;
    let Inputs { cell, numerics } = inputs.clone();
    let found = supervised(py, Interrupt::Abandons, None, move |_| {
        let options = BranchOptions { xi, ..BranchOptions::default() };
        let found = pitchforks::first(&cell, &numerics, &options).map_err(Error::no_outcome)?;
        Ok(threshold_report(&found))
    })?;
    serde_json::to_string(&found).map_err(unwritable)
}

/// Where a branch ends and why.
#[derive(Serialize)]
struct End {
    branch: &'static str,
    reason: &'static str,
    why: String,
    neck: Option<f64>,
}

/// Branches without their points, as JSON.
#[derive(Serialize)]
struct Branches {
    events: Vec<serde_json::Value>,
    /// Exponent, prefactor, coefficient and number of points of |Δu| = prefactor |ξ_s − ξ_s*|^exponent.
    scaling: Option<(f64, f64, f64, usize)>,
    ends: Vec<End>,
}

/// The branches of a cell: JSON, and the points of each by its name.
#[pyfunction]
pub fn branch<'py>(
    py: Python<'py>,
    inputs: &Inputs,
    xi_max: f64,
    max_step: f64,
) -> PyResult<(String, Bound<'py, PyDict>)> {
    let xi = range(xi_max).map_err(|error| raised(py, error, 0))?;
    if !(max_step.is_finite() && max_step > 0.0) {
        let error = InputError::not_allowed(ARGUMENTS, "max_step", max_step, "a finite number above 0");
        return Err(raised(py, error.into(), 0));
    }
    let Inputs { cell, numerics } = inputs.clone();
    let found = supervised(py, Interrupt::Abandons, None, move |_| {
        let options = BranchOptions { xi, growth_rates: true, ..BranchOptions::default() }.with_max_step(max_step);
        diagram(&cell, &numerics, &options).map_err(Error::no_outcome)
    })?;
    let points = PyDict::new(py);
    for (name, branch) in &found.branches {
        let column = |of: fn(&furrow_mechanics::equilibria::ShapePoint) -> f64| branch.points.iter().map(of).collect();
        let of = vec![
            ("xi_s", column(|p| p.xi_s)),
            ("H", column(|p| p.elongation)),
            ("L", column(|p| p.length)),
            ("p", column(|p| p.pressure)),
            ("r_eq", column(|p| p.equator_radius)),
            ("growth_rate", column(|p| or_nan(p.growth_rate))),
            ("delta_u", column(|p| p.delta_u)),
        ];
        points.set_item(name, columns(py, of)?)?;
    }
    Ok((serde_json::to_string(&described(&found)).map_err(unwritable)?, points))
}

fn described(found: &Diagram) -> Branches {
    let events =
        found.branches.iter().flat_map(|(name, branch)| branch.events.iter().map(|event| event_report(name, event)));
    let ends = found.branches.iter().map(|(name, branch)| End {
        branch: name,
        reason: branch.ended.name(),
        why: branch.ended.to_string(),
        neck: match branch.ended {
            BranchEnd::Pinched(neck) => Some(neck),
            _ => None,
        },
    });
    let scaling = found.scaling.as_ref().map(|s| (s.exponent, s.prefactor, s.coefficient, s.points));
    Branches { events: events.collect(), scaling, ends: ends.collect() }
}
