//! One cell: its division, its stationary shapes, its threshold.

use furrow_analysis::Diagram;
use furrow_analysis::bent::diagram_with_bent;
use furrow_analysis::diagram;
use furrow_formats::frames::{COLUMNS, check_step, row, stills};
use furrow_lineage::batch::checks::{Checked, checked};
use furrow_lineage::batch::{Replicates, SchedulerOptions, replicates};
use furrow_mechanics::cortex::Wall;
use furrow_mechanics::cortex::forces::{Place, profile};
use furrow_mechanics::division::{Snapshot, Trajectory};
use furrow_mechanics::equilibria::{BranchEnd, BranchOptions, ShapePoint, pitchfork as pitchforks, stationary};
use furrow_report::surfaces::bent_report;
use furrow_report::{
    AzimuthalStability, checks_report, crossing_report, event_report, hopf_report, stationary_report, threshold_report,
};
use furrow_surface::bent::BentBranch;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;

use crate::document::Document;
use crate::errors::{ARGUMENTS, Error};
use crate::inputs::{ABOVE_0, Columns, Inputs, arrays, fixed, positive};
use crate::memo::Memo;
use crate::supervise::{Interrupt, supervised};

/// Divisions of one cell with the seeds from `seed` on, the divisions with their seeds, and the failures with their seeds.
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
) -> Result<Document, Error> {
    let input = inputs.division(seed)?;
    let (of_call, memo) = (memo, memo.solved()?);
    // A known division needs no thread.
    if count == 1
        && let Some(division) = py.detach(|| memo.known(&input))
    {
        let found: (_, [(u64, String); 0]) = ([(seed, division)], []);
        return of_call.warned(py, Document::of(&found));
    }
    // A single division leaves nothing to keep before it ends; it goes on to the memo by itself.
    let interrupt = if count == 1 { Interrupt::Abandons } else { Interrupt::Finishes };
    let found = supervised(py, interrupt, progress, move |watch| {
        let Replicates { divisions, mut undecided, .. } = watch.scheduled(threads, |options| {
            let interrupt = options.interrupt.filter(|_| count > 1);
            replicates(&input, count, &memo, &SchedulerOptions { interrupt, ..*options })
        })?;
        if divisions.len() + undecided.len() < count {
            return Err(Error::Interrupted(0));
        }
        if divisions.is_empty()
            && let Some(first) = undecided.pop()
        {
            return Err(first.failure.into());
        }
        let undecided = undecided.iter().map(|job| (seed.wrapping_add(job.id as u64), job.failure.to_string()));
        Document::of(&(divisions, undecided.collect::<Vec<(u64, String)>>()))
    });
    of_call.warned(py, found)
}

/// Checks a division by another seed on half the mesh, and if this differs, by the effects of noise and mesh separately.
#[pyfunction]
pub fn checks(py: Python<'_>, inputs: &Inputs, memo: &Memo, seed: u64, threads: usize) -> Result<Document, Error> {
    let input = inputs.division(seed)?;
    if input.numerics.modes > 0 {
        return Err(Error::not_allowed(
            "modes",
            input.numerics.modes,
            "0: the checks are of divisions with axial symmetry",
        ));
    }
    let (of_call, memo) = (memo, memo.solved()?);
    let found = supervised(py, Interrupt::Abandons, None, move |watch| {
        let found = watch.scheduled(threads, |options| checked(&input, &memo, options))?;
        let Checked { effects, .. } = found.ok_or(Error::Interrupted(0))?;
        Ok(checks_report(&effects).into())
    });
    of_call.warned(py, found)
}

/// A division with its shapes: its outcome, the columns of frames, where the places of each frame end in the columns of all places, and
/// its shell.
type Filmed<'py> = (Document, Bound<'py, PyDict>, Bound<'py, PyArray1<i64>>, Bound<'py, PyDict>, WallParts);

/// The half axes of a shell along x, y and z, and its section as (r, z) from pole to pole.
pub type WallParts = ([f64; 3], Vec<[f64; 2]>);

/// A shell as Python has it.
pub fn wall_parts(wall: &Wall) -> WallParts {
    (wall.axes, wall.contour())
}

/// Computes a division and keeps its shapes, after every step or every `every` τ.
#[pyfunction]
#[pyo3(signature = (inputs, seed, every=None, places=None))]
pub fn film<'py>(
    py: Python<'py>,
    inputs: &Inputs,
    seed: u64,
    every: Option<f64>,
    places: Option<usize>,
) -> Result<Filmed<'py>, Error> {
    let input = inputs.division(seed)?;
    every.map(|step| positive("frames", step, "True, False or a finite number of τ above 0")).transpose()?;
    let (text, frames, ends, places, shell) = supervised(py, Interrupt::Abandons, None, move |_| {
        let film = Trajectory::compute(&input)?;
        let film = match places {
            Some(count) => film.with_places(count),
            None => film,
        };
        check_step(ARGUMENTS, film.division.t_end, every)?;
        let stills = stills(&film, every);
        // The first frame begins at 0.
        let ends = stills.iter().scan(0, |end, still| {
            *end += still.places.len() as i64;
            Some(*end)
        });
        let places = place_columns(stills.iter().flat_map(|still| &still.places));
        let text = Document::of(&film.division)?;
        Ok((text, frame_columns(&stills), ends.collect(), places, wall_parts(&film.wall())))
    })?;
    Ok((text, arrays(py, frames)?, fixed(PyArray1::from_vec(py, ends))?, arrays(py, places)?, shell))
}

/// The columns of frames.
fn frame_columns(stills: &[Snapshot]) -> Columns {
    let column = |of: fn(&Snapshot) -> Option<f64>| stills.iter().map(|still| of(still).unwrap_or(f64::NAN)).collect();
    vec![
        ("t", column(|still| Some(still.t))),
        ("neck_radius", column(|still| Some(still.neck?.radius))),
        ("neck_u", column(|still| Some(still.neck?.u))),
        ("length", column(|still| Some(still.length))),
        ("pressure", column(|still| Some(still.pressure))),
        ("chi", column(|still| still.neck.map(|_| still.asymmetry.abs()))),
    ]
}

/// Places as columns, with the names of the files of frames.
fn place_columns<'a>(places: impl Iterator<Item = &'a Place>) -> Columns {
    let mut columns: Columns = COLUMNS.split(' ').map(|name| (name, Vec::new())).collect();
    for p in places {
        columns.iter_mut().zip(row(p)).for_each(|((_, column), number)| column.push(number));
    }
    // φ, without a regulator.
    columns.retain(|(_, column)| !column.is_empty());
    columns
}

/// The stationary shape at one activity, on the branch of the passive shape, and its growth rates. With `azimuthal` also the growth
/// rates of disturbances cos mφ up to this m, and the places of its contour.
#[pyfunction]
#[pyo3(signature = (inputs, azimuthal=None))]
pub fn steady<'py>(
    py: Python<'py>,
    inputs: &Inputs,
    azimuthal: Option<usize>,
) -> Result<(Document, Bound<'py, PyDict>), Error> {
    inputs.settings().check_activity(ARGUMENTS)?;
    let Inputs { cell, numerics } = inputs.axisymmetric()?;
    let (found, places) = supervised(py, Interrupt::Abandons, None, move |_| {
        let shape = stationary(&cell, &numerics).map_err(Error::no_outcome)?;
        let spectrum = shape.spectrum().map_err(Error::no_outcome)?;
        let places = profile(&shape.cortex, &shape.solution.gauss(), &shape.solution);
        let mut report = stationary_report(&shape, &spectrum, shape.growth_rate_error(&spectrum));
        if let Some(most) = azimuthal {
            let found = AzimuthalStability::up_to(most, &shape, &spectrum).map_err(Error::no_outcome)?;
            report["azimuthal"] = found.iter().map(AzimuthalStability::report).collect();
        }
        Ok((report.into(), place_columns(places.iter())))
    })?;
    Ok((found, arrays(py, places)?))
}

/// The first pitchfork of the mirror-symmetric shapes.
#[pyfunction]
pub fn pitchfork(py: Python<'_>, inputs: &Inputs, xi_max: f64) -> Result<Document, Error> {
    let options = BranchOptions { xi: [0.0, positive("xi_max", xi_max, ABOVE_0)?], ..BranchOptions::default() };
    let Inputs { cell, numerics } = inputs.axisymmetric()?;
    supervised(py, Interrupt::Abandons, None, move |_| {
        let found = pitchforks::first(&cell, &numerics, &options).map_err(Error::no_outcome)?;
        Ok(threshold_report(&found).into())
    })
}

/// The branches of a cell: its events and ends, and the points of each by its name; with `azimuthal` also the growth rates of
/// disturbances cos mφ up to this m, one row a point, and where they change sign.
#[pyfunction]
#[pyo3(signature = (inputs, xi_max, max_step, azimuthal=None, reduced_volume=None))]
pub fn branch<'py>(
    py: Python<'py>,
    inputs: &Inputs,
    xi_max: f64,
    max_step: f64,
    azimuthal: Option<usize>,
    reduced_volume: Option<f64>,
) -> Result<(Document, Bound<'py, PyDict>), Error> {
    let xi = [0.0, positive("xi_max", xi_max, ABOVE_0)?];
    let azimuthal = azimuthal.unwrap_or(0);
    let reduced_volume = diagram::reduced_volume(ARGUMENTS, reduced_volume)?;
    let options = BranchOptions { xi, growth_rates: true, azimuthal, reduced_volume, ..BranchOptions::default() };
    let options = options.with_max_step(positive("max_step", max_step, ABOVE_0)?);
    let Inputs { cell, numerics } = inputs.clone();
    let (found, bent) = supervised(py, Interrupt::Abandons, None, move |_| {
        diagram_with_bent(&cell, &numerics, &options).map_err(Error::no_outcome)
    })?;
    let points = PyDict::new(py);
    for (name, branch) in &found.branches {
        let column = |of: fn(&ShapePoint) -> f64| branch.points.iter().map(of).collect();
        let of = vec![
            ("xi_s", column(|p| p.xi_s)),
            ("H", column(|p| p.elongation)),
            ("L", column(|p| p.length)),
            ("p", column(|p| p.pressure)),
            ("r_eq", column(|p| p.equator_radius)),
            ("growth_rate", column(|p| p.growth_rate.unwrap_or(f64::NAN))),
            ("delta_u", column(|p| p.delta_u.unwrap_or(f64::NAN))),
            ("reduced_volume", column(|p| p.reduced_volume)),
            ("bending_energy", column(|p| p.bending_energy)),
        ];
        let columns = arrays(py, of)?;
        if azimuthal > 0 {
            let rates = branch.azimuthal.rates.iter().flat_map(|rates| rates.iter().take(azimuthal));
            let rates = rates.map(|rate| rate.unwrap_or(f64::NAN)).collect();
            let rows = PyArray1::from_vec(py, rates).reshape([branch.azimuthal.rates.len(), azimuthal])?;
            columns.set_item("azimuthal", fixed(rows)?)?;
        }
        points.set_item(name, columns)?;
    }
    Ok((described(&found, bent.as_ref()), points))
}

/// Events, crossings, Hopf points and ends of branches, warnings, and the exponent, prefactor, coefficient and number of points of
/// |Δu| = prefactor |ξ_s − ξ_s*|^exponent.
fn described(found: &Diagram, bent: Option<&BentBranch>) -> Document {
    let branches = || found.branches.iter();
    let events = branches().flat_map(|(name, branch)| branch.events.iter().map(|event| event_report(name, event)));
    let ends = branches().map(|(name, branch)| {
        let neck = if let BranchEnd::Pinched(neck) = branch.ended { Some(neck) } else { None };
        json!({ "branch": name, "reason": branch.ended.name(), "why": branch.ended.to_string(), "neck": neck })
    });
    let crossings = branches().flat_map(|(name, branch)| {
        branch.azimuthal.crossings.iter().map(move |crossing| crossing_report(name, crossing))
    });
    let hopf = branches().flat_map(|(name, branch)| branch.hopf.iter().map(|hopf| hopf_report(name, hopf)));
    let scaling = found.scaling.as_ref().map(|s| (s.exponent, s.prefactor, s.coefficient, s.points));
    json!({
        "events": events.collect::<Vec<_>>(),
        "crossings": crossings.collect::<Vec<_>>(),
        "hopf": hopf.collect::<Vec<_>>(),
        "warnings": found.all_warnings(),
        "scaling": scaling,
        "ends": ends.collect::<Vec<_>>(),
        "bent": bent.map(bent_report),
    })
    .into()
}
