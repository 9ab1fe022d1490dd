//! Boundary-value problems of Python functions, solved by collocation.

use std::cell::RefCell;

use furrow_bvp::{
    CollocationPoints, Deflation, DeflationError, Gauss, Interrupt, PointJacobian, Settings, Solution, SolveError,
    Solved, TwoPoint, TwoPointJacobian, solve_two_point, solve_two_point_besides,
};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArrayDyn};
use pyo3::prelude::*;

use crate::errors::Error;

/// Change of an unknown for differences, relative to its size: the third root of the accuracy of numbers.
const STEP: f64 = 6e-6;

/// The functions of a problem, and the first error of one of them.
struct Functions<'a, 'py> {
    py: Python<'py>,
    rhs: &'a Bound<'py, PyAny>,
    conditions: &'a Bound<'py, PyAny>,
    rhs_jacobian: Option<&'a Bound<'py, PyAny>>,
    conditions_jacobian: Option<&'a Bound<'py, PyAny>>,
    sizes: [usize; 2],
    /// Whether the functions take p.
    takes_p: bool,
    failed: RefCell<Option<PyErr>>,
    interrupt: Interrupt,
}

/// A number moved up and down, and the distance of the two.
fn around(value: f64) -> [f64; 3] {
    let step = STEP * (1.0 + value.abs());
    let (up, down) = (value + step, value - step);
    [up, down, up - down]
}

impl<'py> Functions<'_, 'py> {
    /// Calls a function with arrays, and reads an array of the given shape, flattened; NaN once a call has failed.
    fn call<const N: usize>(
        &self,
        (name, function): (&'static str, &Bound<'py, PyAny>),
        arguments: Vec<Bound<'py, PyAny>>,
        p: &[f64],
        shapes: [&[usize]; N],
    ) -> [Vec<f64>; N] {
        let empty = || shapes.map(|shape| vec![f64::NAN; shape.iter().product()]);
        if self.failed.borrow().is_some() {
            return empty();
        }
        self.answer(name, function, arguments, p, shapes).unwrap_or_else(|error| {
            *self.failed.borrow_mut() = Some(error);
            self.interrupt.set();
            empty()
        })
    }

    fn answer<const N: usize>(
        &self,
        name: &'static str,
        function: &Bound<'py, PyAny>,
        mut arguments: Vec<Bound<'py, PyAny>>,
        p: &[f64],
        shapes: [&[usize]; N],
    ) -> PyResult<[Vec<f64>; N]> {
        if self.takes_p {
            arguments.push(PyArray1::from_slice(self.py, p).into_any());
        }
        let answer = function.call1(pyo3::types::PyTuple::new(self.py, arguments)?)?;
        let numpy = self.py.import("numpy")?;
        let mut out = shapes.map(|_| Vec::new());
        for (k, shape) in shapes.into_iter().enumerate() {
            let part = if N == 1 { answer.clone() } else { answer.get_item(k)? };
            let array = numpy.call_method1("asarray", (part, "float64"))?;
            let array: PyReadonlyArrayDyn<'_, f64> = array.extract()?;
            let found = array.as_array();
            if found.shape() != shape {
                let allowed = format!("a function that returns an array of shape {shape:?}");
                return Err(Error::not_allowed(name, format!("an array of shape {:?}", found.shape()), allowed).into());
            }
            out[k] = found.iter().copied().collect();
        }
        Ok(out)
    }

    /// Points × n as an array of n × points.
    fn columns(&self, y: &[f64]) -> Vec<Bound<'py, PyAny>> {
        let [n, _] = self.sizes;
        let points = y.len() / n;
        let turned: Vec<f64> = (0..n).flat_map(|c| (0..points).map(move |i| y[i * n + c])).collect();
        PyArray1::from_vec(self.py, turned).reshape([n, points]).into_iter().map(Bound::into_any).collect()
    }

    /// f at points, n × points.
    fn slopes(&self, x: &[f64], y: &[f64], p: &[f64]) -> Vec<f64> {
        let arguments = [vec![PyArray1::from_slice(self.py, x).into_any()], self.columns(y)].concat();
        let [f] = self.call(("fun", self.rhs), arguments, p, [&[self.sizes[0], x.len()]]);
        f
    }

    fn residuals(&self, [left, right]: [&[f64]; 2], p: &[f64]) -> Vec<f64> {
        let arguments = [left, right].map(|y| PyArray1::from_slice(self.py, y).into_any()).to_vec();
        let [r] = self.call(("bc", self.conditions), arguments, p, [&[self.sizes.iter().sum()]]);
        r
    }
}

impl TwoPoint for Functions<'_, '_> {
    fn sizes(&self) -> [usize; 2] {
        self.sizes
    }

    fn rhs(&self, points: CollocationPoints<'_>, p: &[f64], f: &mut [f64]) {
        let (n, count) = (self.sizes[0], points.x.len());
        let found = self.slopes(points.x, points.y, p);
        for (i, f) in f.chunks_exact_mut(n).enumerate() {
            f.iter_mut().enumerate().for_each(|(c, f)| *f = found[c * count + i]);
        }
    }

    fn rhs_jacobian(&self, points: CollocationPoints<'_>, p: &[f64], out: &mut PointJacobian<'_>) {
        let ([n, np], count) = (self.sizes, points.x.len());
        self.rhs(points, p, out.f);
        if let Some(function) = self.rhs_jacobian {
            let arguments = [vec![PyArray1::from_slice(self.py, points.x).into_any()], self.columns(points.y)].concat();
            let shapes: [&[usize]; 2] = [&[n, n, count], &[n, np, count]];
            let [by_y, by_p] = match self.takes_p {
                true => self.call(("fun_jac", function), arguments, p, shapes),
                false => {
                    let [by_y] = self.call(("fun_jac", function), arguments, p, [shapes[0]]);
                    [by_y, Vec::new()]
                }
            };
            for i in 0..count {
                (0..n * n).for_each(|k| out.fy[i * n * n + k] = by_y[k * count + i]);
                (0..n * np).for_each(|k| out.fp[i * n * np + k] = by_p[k * count + i]);
            }
            return;
        }
        let [mut y, mut p] = [points.y.to_vec(), p.to_vec()];
        for c in 0..n {
            let widths: Vec<f64> = points.y.chunks_exact(n).map(|y| around(y[c])[2]).collect();
            let [up, down] = [0, 1].map(|side| {
                (0..count).for_each(|i| y[i * n + c] = around(points.y[i * n + c])[side]);
                self.slopes(points.x, &y, &p)
            });
            for i in 0..count {
                y[i * n + c] = points.y[i * n + c];
                for row in 0..n {
                    out.fy[i * n * n + row * n + c] = (up[row * count + i] - down[row * count + i]) / widths[i];
                }
            }
        }
        for c in 0..np {
            let value = p[c];
            let [up, down] = [0, 1].map(|side| {
                p[c] = around(value)[side];
                self.slopes(points.x, &y, &p)
            });
            p[c] = value;
            for i in 0..count {
                for row in 0..n {
                    out.fp[i * n * np + row * np + c] =
                        (up[row * count + i] - down[row * count + i]) / around(value)[2];
                }
            }
        }
    }

    fn conditions(&self, [left, right]: [&[f64]; 2], p: &[f64], out: TwoPointJacobian<'_>) {
        let [n, np] = self.sizes;
        out.r.copy_from_slice(&self.residuals([left, right], p));
        if let Some(function) = self.conditions_jacobian {
            let arguments = [left, right].map(|y| PyArray1::from_slice(self.py, y).into_any()).to_vec();
            let shapes: [&[usize]; 3] = [&[n + np, n], &[n + np, n], &[n + np, np]];
            let [by_left, by_right, by_p] = match self.takes_p {
                true => self.call(("bc_jac", function), arguments, p, shapes),
                false => {
                    let [by_left, by_right] = self.call(("bc_jac", function), arguments, p, [shapes[0], shapes[1]]);
                    [by_left, by_right, Vec::new()]
                }
            };
            out.by_left.copy_from_slice(&by_left);
            out.by_right.copy_from_slice(&by_right);
            out.by_p.copy_from_slice(&by_p);
            return;
        }
        let mut all = [left, right, p].map(<[f64]>::to_vec);
        for (part, derivatives) in [out.by_left, out.by_right, out.by_p].into_iter().enumerate() {
            let columns = all[part].len();
            for c in 0..columns {
                let value = all[part][c];
                let [up, down] = [0, 1].map(|side| {
                    all[part][c] = around(value)[side];
                    self.residuals([&all[0], &all[1]], &all[2])
                });
                all[part][c] = value;
                for row in 0..n + np {
                    derivatives[row * columns + c] = (up[row] - down[row]) / around(value)[2];
                }
            }
        }
    }
}

/// The polynomials of a solution.
#[pyclass(frozen, module = "furrow._furrow")]
pub struct Collocation {
    solved: Solved,
    gauss: Gauss,
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
}

/// The mesh, p, the polynomials, the defect with the condition, and the number of Newton iterations.
type Found<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Collocation, [f64; 2], usize);

/// Solves a problem of functions as `scipy.integrate.solve_bvp` takes them, besides known solutions.
#[pyfunction]
#[pyo3(signature = (functions, jacobians, mesh, guess, p, known, tolerance, max_intervals))]
pub fn solve_bvp<'py>(
    py: Python<'py>,
    functions: [Bound<'py, PyAny>; 2],
    jacobians: [Option<Bound<'py, PyAny>>; 2],
    mesh: PyReadonlyArray1<'py, f64>,
    guess: &Bound<'py, PyArray2<f64>>,
    p: Option<PyReadonlyArray1<'py, f64>>,
    known: Vec<PyRef<'py, Collocation>>,
    tolerance: f64,
    max_intervals: usize,
) -> Result<Found<'py>, Error> {
    let mesh: Vec<f64> = mesh.as_array().to_vec();
    let takes_p = p.is_some();
    let p = p.map(|p| p.as_array().to_vec()).unwrap_or_default();
    let rows: Vec<Vec<f64>> = guess.readonly().as_array().rows().into_iter().map(|row| row.to_vec()).collect();
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    let settings = Settings { tolerance, max_intervals, ..Settings::default() };
    let ([rhs, conditions], [rhs_jacobian, conditions_jacobian]) = (&functions, &jacobians);
    let problem = Functions {
        py,
        rhs,
        conditions,
        rhs_jacobian: rhs_jacobian.as_ref(),
        conditions_jacobian: conditions_jacobian.as_ref(),
        sizes: [rows.len(), p.len()],
        takes_p,
        failed: RefCell::new(None),
        interrupt: settings.interrupt.clone(),
    };
    let found = if known.is_empty() {
        solve_two_point(&problem, &mesh, &rows, &p, &settings).map_err(DeflationError::from)
    } else {
        let known: Vec<&Solution> = known.iter().map(|known| &known.solved.solution).collect();
        let deflation = Deflation { settings, ..Deflation::default() };
        solve_two_point_besides(&problem, &mesh, &rows, &p, &known, &deflation)
    };
    if let Some(error) = problem.failed.into_inner() {
        return Err(error.into());
    }
    let found = match found {
        Ok(found) => found,
        Err(DeflationError::Invalid(error) | DeflationError::Unsolved(SolveError::Invalid(error))) => {
            return Err(Error::not_allowed("problem", error, "a problem that fits its mesh"));
        }
        Err(error) => return Err(Error::no_outcome(error)),
    };
    let nodes = PyArray1::from_slice(py, &found.solution.mesh);
    let p = PyArray1::from_slice(py, &found.solution.scalars);
    let quality = [found.defect, found.condition];
    let gauss = found.solution.gauss();
    let iterations = found.work.iterations;
    Ok((nodes, p, Collocation { solved: found, gauss }, quality, iterations))
}
