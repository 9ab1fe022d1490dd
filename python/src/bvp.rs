//! Boundary-value problems of Python functions, solved by collocation.

use std::cell::RefCell;

use furrow_bvp::{
    CollocationPoints, Deflation, DeflationError, Interrupt, InvalidInput, PointJacobian, Settings, Solution,
    SolveError, Solved, TwoPoint, TwoPointJacobian, solve_two_point, solve_two_point_besides,
};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArrayDyn};
use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::collocation::Collocation;
use crate::errors::Error;

/// Change of an unknown for differences, relative to its size: the third root of the accuracy of numbers.
const STEP: f64 = 6e-6;

/// The functions of a problem, and the first error of one of them.
pub(crate) struct Functions<'a, 'py> {
    py: Python<'py>,
    rhs: &'a Bound<'py, PyAny>,
    conditions: &'a Bound<'py, PyAny>,
    rhs_jacobian: Option<&'a Bound<'py, PyAny>>,
    conditions_jacobian: Option<&'a Bound<'py, PyAny>>,
    sizes: [usize; 2],
    singular: Option<Singular>,
    /// Whether the functions take p.
    takes_p: bool,
    failed: RefCell<Option<PyErr>>,
    interrupt: Interrupt,
}

/// The step of a difference, from the value and the size of its component.
fn step(size: f64, value: f64) -> f64 {
    STEP * (size + value.abs())
}

/// Single values that are smaller may be zeros with rounding, such as the sine of π.
const ROUNDED: f64 = 1e-9;

/// The size of numbers that are at most 1; 1 for larger ones, and for numbers that are at most `zero`.
fn size_of<'v>(values: impl Iterator<Item = &'v f64>, zero: f64) -> f64 {
    let largest = values.fold(0.0, |largest: f64, value| largest.max(value.abs()));
    if largest <= zero { 1.0 } else { largest.min(1.0) }
}

/// Values of a function where one of its arguments is moved up and down, and the size that gives the distance.
type Sides = (f64, [Vec<f64>; 2]);

/// Values at the usual distance and, if some of them are not finite, at a nearer one, for functions that are not defined there, as y^(2/3)
/// left of 0. `at` computes them from a function that moves a number; `size` is the size of its component.
fn sides(size: f64, mut at: impl FnMut(&dyn Fn(f64) -> f64) -> Vec<f64>) -> Vec<Sides> {
    let mut tried = Vec::new();
    for size in [size, 0.0] {
        let both = [1.0, -1.0].map(|sign| at(&|value| value + sign * step(size, value)));
        let defined = both.iter().flatten().all(|value| value.is_finite());
        tried.push((size, both));
        if defined {
            break;
        }
    }
    tried
}

/// The derivative of one of the values by an argument, with the value itself and the place of the argument. Where no distance has values on
/// both sides, the difference is that to one side; it is NaN where neither side has one.
fn difference(tried: &[Sides], value: usize, base: f64, place: f64) -> f64 {
    let both = |(size, values): &Sides| {
        let step = step(*size, place);
        [(place + step, values[0][value]), (place - step, values[1][value])]
    };
    let defined = |(at, value): &(f64, f64)| *at != place && value.is_finite();
    let slope = |[(above, up), (below, down)]: [(f64, f64); 2]| (up - down) / (above - below);
    let central = tried.iter().map(both).find(|both| both.iter().all(defined));
    let one_sided = || tried.iter().rev().flat_map(both).find(defined).map(|side| [side, (place, base)]);
    central.or_else(one_sided).map_or(f64::NAN, slope)
}

/// The term S y/(x − a) of the slopes.
struct Singular {
    /// S; n × n, row-major.
    matrix: Vec<f64>,
    /// (I − S)⁻¹: where S y(a) = 0, the slopes at a are y′(a) = f + S y′(a).
    at_end: Vec<f64>,
    /// a.
    end: f64,
}

impl Singular {
    /// Adds the term at x to f.
    fn add(&self, x: f64, y: &[f64], f: &mut [f64]) {
        if x <= self.end {
            return self.turn(f);
        }
        for (f, row) in f.iter_mut().zip(self.matrix.chunks_exact(y.len())) {
            *f += row.iter().zip(y).map(|(s, y)| s * y).sum::<f64>() / (x - self.end);
        }
    }

    /// Adds the derivatives of the term at x to the derivatives of f by y and p.
    fn add_derivatives(&self, x: f64, fy: &mut [f64], fp: &mut [f64]) {
        if x <= self.end {
            self.turn(fy);
            return self.turn(fp);
        }
        fy.iter_mut().zip(&self.matrix).for_each(|(fy, s)| *fy += s / (x - self.end));
    }

    /// Multiplies a matrix of n rows by (I − S)⁻¹.
    fn turn(&self, values: &mut [f64]) {
        let n = self.matrix.len().isqrt();
        let (columns, from) = (values.len() / n, values.to_vec());
        for (k, value) in values.iter_mut().enumerate() {
            let (row, column) = (k / columns, k % columns);
            *value = (0..n).map(|c| self.at_end[row * n + c] * from[c * columns + column]).sum();
        }
    }
}

/// Converts the result of a function to an array of real numbers.
fn real_array<'py>(name: &'static str, part: &Bound<'py, PyAny>) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    if let Ok(array) = part.extract() {
        return Ok(array);
    }
    let numpy = part.py().import("numpy")?;
    let read = || -> PyResult<_> {
        let array = numpy.call_method1("asarray", (part,))?;
        if numpy.call_method1("iscomplexobj", (&array,))?.is_truthy()? {
            return Ok(None);
        }
        Ok(Some(numpy.call_method1("asarray", (array, "float64"))?.extract()?))
    };
    let allowed = "a function that returns real values: state real and imaginary parts as components";
    match read() {
        Ok(Some(array)) => Ok(array),
        Ok(None) => Err(Error::not_allowed(name, "complex numbers", allowed).into()),
        Err(error) if is_of_values(&error, part.py()) => {
            let found = format!("values that are not numbers ({error})");
            Err(Error::not_allowed(name, found, "a function that returns an array of real numbers").into())
        }
        Err(error) => Err(error),
    }
}

/// Whether NumPy raised this because of the values that it was given.
fn is_of_values(error: &PyErr, py: Python<'_>) -> bool {
    error.is_instance_of::<PyValueError>(py)
        || error.is_instance_of::<PyTypeError>(py)
        || error.is_instance_of::<PyOverflowError>(py)
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
        if N > 1 && answer.len()? != N {
            let found = format!("{} arrays", answer.len()?);
            return Err(Error::not_allowed(name, found, format!("a function that returns {N} arrays")).into());
        }
        let mut out = shapes.map(|_| Vec::new());
        for (k, shape) in shapes.into_iter().enumerate() {
            let part = if N == 1 { answer.clone() } else { answer.get_item(k)? };
            let array = real_array(name, &part)?;
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

/// The parts of a problem without its singular term, and derivatives by differences.
impl Functions<'_, '_> {
    /// f at points; points × n.
    fn rhs_of_function(&self, points: CollocationPoints<'_>, p: &[f64], f: &mut [f64]) {
        let (n, count) = (self.sizes[0], points.x.len());
        let found = self.slopes(points.x, points.y, p);
        for (i, f) in f.chunks_exact_mut(n).enumerate() {
            f.iter_mut().enumerate().for_each(|(c, f)| *f = found[c * count + i]);
        }
    }

    /// The derivatives that `fun_jac` gives.
    fn given_derivatives(
        &self,
        function: &Bound<'_, PyAny>,
        points: CollocationPoints<'_>,
        p: &[f64],
        out: &mut PointJacobian<'_>,
    ) {
        let ([n, np], count) = (self.sizes, points.x.len());
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
    }

    /// Differences of f by y, with f itself in `out`.
    fn differences_by_y(&self, points: CollocationPoints<'_>, p: &[f64], out: &mut PointJacobian<'_>) {
        let (n, count) = (self.sizes[0], points.x.len());
        let mut y = points.y.to_vec();
        for c in 0..n {
            let size = size_of(points.y.iter().skip(c).step_by(n), 0.0);
            let tried = sides(size, |moved| {
                (0..count).for_each(|i| y[i * n + c] = moved(points.y[i * n + c]));
                self.slopes(points.x, &y, p)
            });
            for i in 0..count {
                let place = points.y[i * n + c];
                y[i * n + c] = place;
                for row in 0..n {
                    let slope = difference(&tried, row * count + i, out.f[i * n + row], place);
                    out.fy[i * n * n + row * n + c] = slope;
                }
            }
        }
    }

    /// Differences of f by p, with f itself in `out`.
    fn differences_by_p(&self, points: CollocationPoints<'_>, p: &[f64], out: &mut PointJacobian<'_>) {
        let ([n, np], count) = (self.sizes, points.x.len());
        let mut p = p.to_vec();
        for c in 0..np {
            let place = p[c];
            let tried = sides(size_of([place].iter(), ROUNDED), |moved| {
                p[c] = moved(place);
                self.slopes(points.x, points.y, &p)
            });
            p[c] = place;
            for i in 0..count {
                for row in 0..n {
                    let slope = difference(&tried, row * count + i, out.f[i * n + row], place);
                    out.fp[i * n * np + row * np + c] = slope;
                }
            }
        }
    }

    /// The derivatives that `bc_jac` gives.
    fn given_of_conditions(
        &self,
        function: &Bound<'_, PyAny>,
        ends: [&[f64]; 2],
        p: &[f64],
        out: TwoPointJacobian<'_>,
    ) {
        let [n, np] = self.sizes;
        let arguments = ends.map(|y| PyArray1::from_slice(self.py, y).into_any()).to_vec();
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
    }
}

impl TwoPoint for Functions<'_, '_> {
    fn sizes(&self) -> [usize; 2] {
        self.sizes
    }

    fn rhs(&self, points: CollocationPoints<'_>, p: &[f64], f: &mut [f64]) {
        let n = self.sizes[0];
        self.rhs_of_function(points, p, f);
        if let Some(singular) = &self.singular {
            let each = points.x.iter().zip(points.y.chunks_exact(n));
            each.zip(f.chunks_exact_mut(n)).for_each(|((x, y), f)| singular.add(*x, y, f));
        }
    }

    fn rhs_jacobian(&self, points: CollocationPoints<'_>, p: &[f64], out: &mut PointJacobian<'_>) {
        let [n, np] = self.sizes;
        self.rhs_of_function(points, p, out.f);
        match self.rhs_jacobian {
            Some(function) => self.given_derivatives(function, points, p, out),
            None => {
                self.differences_by_y(points, p, out);
                self.differences_by_p(points, p, out);
            }
        }
        let Some(singular) = &self.singular else { return };
        for (i, (x, y)) in points.x.iter().zip(points.y.chunks_exact(n)).enumerate() {
            singular.add(*x, y, &mut out.f[i * n..(i + 1) * n]);
            let (fy, fp) = (&mut out.fy[i * n * n..(i + 1) * n * n], &mut out.fp[i * n * np..(i + 1) * n * np]);
            singular.add_derivatives(*x, fy, fp);
        }
    }

    fn conditions(&self, ends: [&[f64]; 2], p: &[f64], out: TwoPointJacobian<'_>) {
        let [n, np] = self.sizes;
        out.r.copy_from_slice(&self.residuals(ends, p));
        if let Some(function) = self.conditions_jacobian {
            return self.given_of_conditions(function, ends, p, out);
        }
        let [left, right] = ends;
        let mut all = [left, right, p].map(<[f64]>::to_vec);
        for (part, derivatives) in [out.by_left, out.by_right, out.by_p].into_iter().enumerate() {
            let columns = all[part].len();
            for c in 0..columns {
                let place = all[part][c];
                let size = match part {
                    0 | 1 => size_of([left[c], right[c]].iter(), ROUNDED),
                    _ => size_of([place].iter(), ROUNDED),
                };
                let tried = sides(size, |moved| {
                    all[part][c] = moved(place);
                    self.residuals([&all[0], &all[1]], &all[2])
                });
                all[part][c] = place;
                for row in 0..n + np {
                    derivatives[row * columns + c] = difference(&tried, row, out.r[row], place);
                }
            }
        }
    }
}

/// A problem that the solver refuses.
pub(crate) fn unfit(error: InvalidInput) -> Error {
    match error {
        InvalidInput::TooLarge(limit) => {
            let found = format!("a guess of too many components ({limit})");
            Error::not_allowed("y", found, "a guess of fewer components, with fewer scalar unknowns")
        }
        error => Error::not_allowed("problem", error, "a problem that fits its mesh"),
    }
}

/// A message of the solver, which writes numbers in all their digits.
fn shortened(message: &str) -> String {
    let word = |word: &str| match word.parse::<f64>() {
        Ok(number) if word.len() > 12 => format!("{number:.6e}"),
        _ => word.to_owned(),
    };
    message.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// Defect, condition, error.
type Quality = (f64, f64, Option<f64>);

/// The mesh, p, the polynomials, their quality, the residuals of the intervals, and the number of Newton iterations.
type Found<'py> =
    (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Collocation, Quality, Bound<'py, PyArray1<f64>>, usize);

/// S and (I − S)⁻¹ of a singular term.
type Matrices<'py> = [PyReadonlyArray2<'py, f64>; 2];

/// Solves a problem of functions as `scipy.integrate.solve_bvp` takes them, besides known solutions.
#[pyfunction]
#[pyo3(signature = (functions, jacobians, mesh, guess, p, singular, known, tolerances, max_intervals))]
pub fn solve_bvp<'py>(
    py: Python<'py>,
    functions: [Bound<'py, PyAny>; 2],
    jacobians: [Option<Bound<'py, PyAny>>; 2],
    mesh: PyReadonlyArray1<'py, f64>,
    guess: &Bound<'py, PyArray2<f64>>,
    p: Option<PyReadonlyArray1<'py, f64>>,
    singular: Option<Matrices<'py>>,
    known: Vec<PyRef<'py, Collocation>>,
    tolerances: (f64, Option<f64>),
    max_intervals: usize,
) -> Result<Found<'py>, Error> {
    let mesh: Vec<f64> = mesh.as_array().to_vec();
    let takes_p = p.is_some();
    let p = p.map(|p| p.as_array().to_vec()).unwrap_or_default();
    let rows: Vec<Vec<f64>> = guess.readonly().as_array().rows().into_iter().map(|row| row.to_vec()).collect();
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    let (tolerance, error) = tolerances;
    let settings = Settings { tolerance, error, max_intervals, ..Settings::default() };
    let ([rhs, conditions], [rhs_jacobian, conditions_jacobian]) = (&functions, &jacobians);
    let singular = singular.map(|matrices| {
        let [matrix, at_end] = matrices.map(|matrix| matrix.as_array().iter().copied().collect());
        Singular { matrix, at_end, end: mesh.first().copied().unwrap_or(f64::NAN) }
    });
    let problem = Functions {
        py,
        rhs,
        conditions,
        rhs_jacobian: rhs_jacobian.as_ref(),
        conditions_jacobian: conditions_jacobian.as_ref(),
        sizes: [rows.len(), p.len()],
        singular,
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
    result(py, problem, found)
}

/// What to try after an error.
fn advice(error: &DeflationError) -> &'static str {
    use SolveError::{ErrorLimit, MeshLimit, Newton, Stopped};
    match error {
        DeflationError::Unsolved(MeshLimit { .. } | ErrorLimit { .. }) => "; max_nodes can allow more",
        DeflationError::Unsolved(Stopped { .. }) => "; a better guess or a larger max_nodes may help",
        DeflationError::Unsolved(Newton { .. }) => "; a better guess may help",
        _ => "",
    }
}

/// The result for Python, or the first error that a function of the user raised, or the error of the solver.
fn result<'py>(
    py: Python<'py>,
    problem: Functions<'_, 'py>,
    found: Result<Solved, DeflationError>,
) -> Result<Found<'py>, Error> {
    let raised = |problem: &Functions<'_, 'py>| problem.failed.borrow_mut().take().map_or(Ok(()), Err);
    raised(&problem)?;
    let solved = found.map_err(|error| match error {
        DeflationError::Invalid(error) | DeflationError::Unsolved(SolveError::Invalid(error)) => unfit(error),
        error => Error::no_outcome(shortened(&error.to_string()) + advice(&error)),
    })?;
    let (quality, iterations) = ((solved.defect, solved.condition, solved.error), solved.work.iterations);
    let collocation = Collocation::new(solved);
    let residuals = PyArray1::from_vec(py, collocation.residuals(&problem)?);
    raised(&problem)?;
    let Solution { mesh, scalars, .. } = &collocation.solved.solution;
    let [nodes, p] = [mesh, scalars].map(|x| PyArray1::from_slice(py, x));
    Ok((nodes, p, collocation, quality, residuals, iterations))
}
