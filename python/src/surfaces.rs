//! One cell without axial symmetry: its shapes, its state at rest.

use furrow_formats::frames::check_step;
use furrow_lineage::batch::{Filming, Memo as Solved, Replicates, SchedulerOptions, replicates_by};
use furrow_mechanics::division::{Division, DivisionInput};
use furrow_report::surfaces::{neck_report, rest_report};
use furrow_surface::film::{COLUMNS, Film, Observables, ROWS, Still};
use furrow_surface::sample::Sample;
use furrow_surface::steady::steady;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;

use crate::cells::{WallParts, wall_parts};
use crate::document::Document;
use crate::errors::{ARGUMENTS, Error};
use crate::inputs::{Columns, Inputs, arrays, fixed, positive};
use crate::memo::Memo;
use crate::supervise::{Interrupt, supervised};

/// A division without axial symmetry with its shapes; the memo knows it afterwards.
pub fn filmed(input: &DivisionInput, memo: &Solved) -> Result<(Division, Film), Error> {
    let filming = Filming::of(input.seed);
    let options = SchedulerOptions { threads: 1, ..SchedulerOptions::default() };
    let solver = |one: &DivisionInput| filming.solve(one);
    let Replicates { mut divisions, mut undecided, .. } = replicates_by(solver, input, 1, memo, &options)?;
    if let Some(job) = undecided.pop() {
        return Err(job.failure.into());
    }
    let (_, division) = divisions.pop().ok_or(Error::Interrupted(0))?;
    let film = match filming.into_film() {
        Some(film) => film,
        None => Film::compute(&memo.canonical(input))?,
    };
    Ok((division, film))
}

/// A division with its neck over time, the columns of frames, the surfaces, and the shell.
type Filmed<'py> = (Document, Bound<'py, PyDict>, Bound<'py, PyDict>, WallParts);

/// Divides a cell without axial symmetry and keeps its shapes, after every step or every `every` τ.
#[pyfunction]
#[pyo3(signature = (inputs, memo, seed, every=None))]
pub fn surfaces<'py>(
    py: Python<'py>,
    inputs: &Inputs,
    memo: &Memo,
    seed: u64,
    every: Option<f64>,
) -> Result<Filmed<'py>, Error> {
    let input = inputs.division(seed)?;
    every.map(|step| positive("frames", step, "True, False or a finite number of τ above 0")).transpose()?;
    let memo = memo.solved()?;
    let (found, columns, samples, shell) = supervised(py, Interrupt::Abandons, None, move |_| {
        let (division, film) = filmed(&input, &memo)?;
        check_step(ARGUMENTS, division.t_end, every)?;
        let mut found = neck_report(&film.found);
        found["division"] = json!(division);
        let stills = film.stills(every);
        let columns = columns(&stills);
        let samples: Vec<Sample> = stills.into_iter().flat_map(|still| still.samples).collect();
        Ok((found, columns, samples, wall_parts(&film.wall)))
    })?;
    Ok((found.into(), arrays(py, columns)?, grids(py, &samples)?, shell))
}

/// The columns of frames.
fn columns(stills: &[Still]) -> Columns {
    let column =
        |of: fn(&Observables) -> Option<f64>| stills.iter().map(|still| of(&still.shape).unwrap_or(f64::NAN)).collect();
    vec![
        ("t", column(|shape| Some(shape.t))),
        ("neck_radius", column(|shape| Some(shape.neck?.radius))),
        ("neck_offset", column(|shape| Some(shape.neck?.offset))),
        ("neck_position", column(|shape| Some(shape.neck?.height))),
        ("length", column(|shape| Some(shape.length))),
        ("pressure", column(|shape| Some(shape.pressure))),
        ("chi", column(Observables::chi)),
    ]
}

/// The samples of surfaces as arrays: surfaces × rings × meridians, and the place of each ring.
fn grids<'py>(py: Python<'py>, samples: &[Sample]) -> PyResult<Bound<'py, PyDict>> {
    let count = samples.len() / (ROWS * COLUMNS);
    let vectors = |of: fn(&Sample) -> [f64; 3]| {
        PyArray1::from_vec(py, samples.iter().flat_map(of).collect()).reshape([count, ROWS, COLUMNS, 3])
    };
    let numbers = |of: Vec<f64>| PyArray1::from_vec(py, of);
    let dict = PyDict::new(py);
    let u = numbers(samples.iter().step_by(COLUMNS).map(|at| at.share).collect());
    dict.set_item("u", fixed(u.reshape([count, ROWS])?)?)?;
    dict.set_item("positions", fixed(vectors(|at| at.x)?)?)?;
    dict.set_item("normals", fixed(vectors(|at| at.normal)?)?)?;
    let tension = numbers(samples.iter().map(|at| at.tension).collect());
    dict.set_item("tension", fixed(tension.reshape([count, ROWS, COLUMNS])?)?)?;
    Ok(dict)
}

/// The state at rest without axial symmetry that a cell reaches from its passive shape, its growth rates, and its surface.
#[pyfunction]
pub fn steady_surface<'py>(py: Python<'py>, inputs: &Inputs) -> Result<(Document, Bound<'py, PyDict>), Error> {
    inputs.settings().check_activity(ARGUMENTS)?;
    let input = DivisionInput { numerics: inputs.numerics, ..DivisionInput::new(inputs.cell.clone()) };
    let (report, samples) = supervised(py, Interrupt::Abandons, None, move |_| {
        let found = steady(&input)?;
        let rest = found.at_rest(input.cell.r0).map_err(Error::no_outcome)?;
        Ok((rest_report(&found, rest), rest.samples()))
    })?;
    Ok((report.into(), grids(py, &samples)?))
}
