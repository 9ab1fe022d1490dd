//! Solutions of boundary-value problems between their nodes.

use furrow_bvp::{CollocationPoints, Gauss, Solved, TwoPoint, mesh};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::bvp::Functions;
use crate::errors::Error;

/// Gauss points of each half of an interval at which residuals are averaged.
const POINTS: usize = 5;

/// The polynomials of a solution.
#[pyclass(frozen, module = "furrow._furrow")]
pub struct Collocation {
    pub(crate) solved: Solved,
    gauss: Gauss,
}

impl Collocation {
    pub(crate) fn new(solved: Solved) -> Collocation {
        let gauss = solved.solution.gauss();
        Collocation { solved, gauss }
    }

    /// The root of the mean square of (y′ − f)/(1 + |f|) on every interval, summed over the components.
    pub(crate) fn residuals(&self, problem: &Functions<'_, '_>) -> Result<Vec<f64>, Error> {
        let (solution, Gauss { c, b, .. }) = (&self.solved.solution, Gauss::new(POINTS).map_err(crate::bvp::unfit)?);
        let n = solution.components;
        // Halves of the intervals: on whole ones the points are too few for the squares.
        let halves = mesh::halved(&solution.mesh);
        let x: Vec<f64> =
            halves.windows(2).flat_map(|half| c.iter().map(move |c| half[0] + c * (half[1] - half[0]))).collect();
        let [mut y, mut slopes, mut f] = [(); 3].map(|()| vec![0.0; n * x.len()]);
        for (x, (y, slopes)) in x.iter().zip(y.chunks_exact_mut(n).zip(slopes.chunks_exact_mut(n))) {
            self.solved.eval(&self.gauss, *x, y);
            self.solved.slope(&self.gauss, *x, slopes);
        }
        problem.rhs(CollocationPoints { first: 0, x: &x, y: &y }, &solution.scalars, &mut f);
        let squares: Vec<f64> = slopes.iter().zip(&f).map(|(y, f)| ((y - f) / (1.0 + f.abs())).powi(2)).collect();
        let weighted = |(at, b): (&[f64], &f64)| 0.5 * b * at.iter().sum::<f64>();
        let intervals = squares.chunks_exact(2 * n * POINTS);
        Ok(intervals.map(|at| at.chunks_exact(n).zip(b.iter().cycle()).map(weighted).sum::<f64>().sqrt()).collect())
    }
}

#[pymethods]
impl Collocation {
    /// Values or slopes at x; points × components, flattened.
    fn at<'py>(&self, py: Python<'py>, x: PyReadonlyArray1<'py, f64>, slope: bool) -> Bound<'py, PyArray1<f64>> {
        let n = self.solved.solution.components;
        let mut out = vec![0.0; x.as_array().len() * n];
        for (x, out) in x.as_array().iter().zip(out.chunks_exact_mut(n)) {
            match slope {
                true => self.solved.slope(&self.gauss, *x, out),
                false => self.solved.eval(&self.gauss, *x, out),
            }
        }
        PyArray1::from_vec(py, out)
    }

    /// Reads what was pickled.
    #[classmethod]
    fn _restored(_: &Bound<'_, PyType>, text: &str) -> Result<Collocation, Error> {
        let refused = |error: String| Error::not_allowed("solution", error, "a pickle of this version of furrow");
        let solved: Solved = serde_json::from_str(text).map_err(|error| refused(error.to_string()))?;
        solved.solution.check().map_err(|error| refused(error.to_string()))?;
        Ok(Collocation::new(solved))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Collocation>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let text = serde_json::to_string(&slf.get().solved)
            .map_err(|error| PyErr::from(Error::not_allowed("solution", error, "one that can be written")))?;
        Ok((slf.get_type().getattr("_restored")?, (text,)))
    }
}
