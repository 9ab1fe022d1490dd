//! Compares derivatives written by hand with differences.

use crate::dimensions::{Dimensions, TooLarge};
use crate::solution::Solution;

use super::differences::{slope, slopes_at_ends, slopes_displaced};
use super::directional::{Directional, EndDerivatives, EndValues, PointDirection};
use super::statement::{BoundaryValueProblem, CollocationPoints, End, PointJacobian, conditions_at};

/// A derivative that disagrees with the values.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{entry} at x = {x}: {given:e} is given, {expected:e} expected from differences")]
pub struct Mismatch {
    /// The derivative, as `∂f[1]/∂y[0]`; indices count from 0.
    pub entry: String,
    /// Where.
    pub x: f64,
    /// The value given.
    pub given: f64,
    /// The value by differences.
    pub expected: f64,
}

/// Why derivatives did not pass.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckError {
    /// The problem does not fit the kernels.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// The values to check at have other sizes than the problem.
    #[error("values of {components} components and {scalars} scalars for a problem of other sizes")]
    Guess {
        /// Components of the values.
        components: usize,
        /// Scalars of the values.
        scalars: usize,
    },
    /// Derivatives that are wrong, in the order of their places.
    #[error("{} wrong derivatives; the first: {}", .0.len(), .0.first().map(Mismatch::to_string).unwrap_or_default())]
    Wrong(Vec<Mismatch>),
}

/// Most collocation points looked at.
const POINTS: usize = 8;

/// The step, relative to 1 + |unknown|.
const STEP: f64 = 3e-4;

/// Tolerances relative to a derivative, to the largest one of the same equation, and to the change of a difference when its
/// step is halved.
const RELATIVE: f64 = 1e-6;
const OF_ROW: f64 = 1e-8;
const OF_CHANGE: f64 = 20.0;

/// Compares the first derivatives of a problem with differences of its values at several points of `y`: of the right-hand side,
/// the integrands, the boundary conditions and the parts h(p) of integral conditions. Also that quadrature components do
/// not depend on one another.
///
/// Values that are zero, or equal, can hide a wrong term: give values without a pattern.
///
/// # Errors
/// [`CheckError::Wrong`] names every wrong entry once.
///
/// # Examples
/// ```
/// use furrow_bvp::{
///     BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, Gauss, PointJacobian, Solution,
///     check_derivatives, mesh,
/// };
///
/// struct Pendulum;
///
/// impl BoundaryValueProblem for Pendulum {
///     fn dimensions(&self) -> Dimensions {
///         Dimensions { components: 2, left: 1, right: 1, ..Dimensions::default() }
///     }
///     fn rhs(&self, _: CollocationPoint, y: &[f64], _: &[f64], f: &mut [f64], _: &mut [f64]) {
///         f.copy_from_slice(&[y[1], -y[0].sin()]);
///     }
///     fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
///         self.rhs(at, y, p, out.f, out.g);
///         // The derivative of −sin is −cos.
///         out.fy.copy_from_slice(&[0.0, 1.0, y[0].cos(), 0.0]);
///     }
///     fn left(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
///         (out.r[0], out.ry[0]) = (y[0], 1.0);
///     }
///     fn right(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
///         (out.r[0], out.ry[0]) = (y[0] - 1.0, 1.0);
///     }
/// }
///
/// let wave = |x: f64, y: &mut [f64]| y.copy_from_slice(&[0.3 + x.sin(), 0.7 * x.cos()]);
/// let y = Solution::from_fn(&Gauss::default(), &mesh::uniform(0.0, 2.0, 5), 2, &[], wave)?;
/// let error = check_derivatives(&mut Pendulum, &y).unwrap_err().to_string();
/// assert!(error.starts_with("1 wrong derivatives; the first: ∂f[1]/∂y[0] at x = "), "{error}");
/// # Ok::<(), furrow_bvp::InvalidInput>(())
/// ```
pub fn check_derivatives(problem: &mut dyn BoundaryValueProblem, y: &Solution) -> Result<(), CheckError> {
    let places = Places::of(problem, y)?;
    let mut found = Vec::new();
    for &i in &places.chosen {
        found.extend(check_point(problem, &places, i));
    }
    found.extend(check_ends(problem, &places));
    finish(found)
}

/// Compares second derivatives along two directions without a pattern with differences of first derivatives, and third
/// derivatives with differences of second ones. See [`check_derivatives`], which comes first.
///
/// # Errors
/// [`CheckError::Wrong`] names every wrong component once.
pub fn check_directional(problem: &mut dyn Directional, y: &Solution) -> Result<(), CheckError> {
    let places = Places::of(problem, y)?;
    let mut found = Vec::new();
    for &i in &places.chosen {
        found.extend(check_point_along(problem, &places, i));
    }
    found.extend(check_ends_along(problem, &places));
    finish(found)
}

/// The same entry at several places is wrong once.
fn finish(found: Vec<Mismatch>) -> Result<(), CheckError> {
    let mut once: Vec<Mismatch> = Vec::new();
    for mismatch in found {
        if once.iter().all(|known| known.entry != mismatch.entry) {
            once.push(mismatch);
        }
    }
    if once.is_empty() { Ok(()) } else { Err(CheckError::Wrong(once)) }
}

/// Where derivatives are compared.
struct Places<'a> {
    dims: Dimensions,
    y: &'a Solution,
    x: Vec<f64>,
    chosen: Vec<usize>,
}

impl<'a> Places<'a> {
    fn of(problem: &dyn BoundaryValueProblem, y: &'a Solution) -> Result<Places<'a>, CheckError> {
        let dims = problem.dimensions();
        dims.check(y.m)?;
        if y.fits(dims).is_err() {
            return Err(CheckError::Guess { components: y.components, scalars: y.scalars.len() });
        }
        let (gauss, points) = (y.gauss(), y.intervals() * y.m);
        let x: Vec<f64> = (0..points).map(|i| y.stage_x(&gauss, i / y.m, i % y.m)).collect();
        let count = POINTS.min(points);
        Ok(Places { dims, y, x, chosen: (0..count).map(|k| k * points / count).collect() })
    }

    /// All unknowns at point i.
    fn unknowns(&self, i: usize) -> Vec<f64> {
        let n = self.dims.components;
        [&self.y.stages[i * n..(i + 1) * n], &self.y.scalars].concat()
    }

    fn point<'b>(&'b self, i: usize, y: &'b [f64]) -> CollocationPoints<'b> {
        CollocationPoints { first: i, x: &self.x[i..=i], y }
    }

    /// A direction without a pattern.
    fn direction(&self, seed: f64) -> Vec<f64> {
        (1..=self.dims.components + self.dims.scalars).map(|k| (seed * k as f64).sin() + 0.2).collect()
    }

    /// Prepares the problem for scalar unknowns.
    fn prepare(&self, problem: &mut dyn BoundaryValueProblem, p: &[f64]) {
        problem.prepare(p);
        problem.prepare_points(&self.x, p);
    }

    /// Names of f and g, in one vector.
    fn names(&self) -> Vec<String> {
        let f = (0..self.dims.components).map(|k| format!("f[{k}]"));
        f.chain((0..self.dims.integrals).map(|k| format!("g[{k}]"))).collect()
    }

    /// Names of the conditions and of h.
    fn end_names(&self) -> Vec<(String, f64)> {
        let Dimensions { left, right, integrals, .. } = self.dims;
        let ends = [self.y.mesh[0], self.y.mesh[self.y.mesh.len() - 1]];
        let named = |name: &'static str, count: usize, x: f64| (0..count).map(move |k| (format!("{name}[{k}]"), x));
        named("left", left, ends[0])
            .chain(named("right", right, ends[1]))
            .chain(named("h", integrals, ends[0]))
            .collect()
    }
}

/// Derivatives by differences of steps t and t/2.
struct Estimate {
    value: Vec<f64>,
    change: Vec<f64>,
}

impl Estimate {
    fn of(t: f64, mut values: impl FnMut(f64) -> Vec<f64>) -> Estimate {
        let (value, wide) = (slope(0.5 * t, &mut values), slope(t, &mut values));
        let change = value.iter().zip(&wide).map(|(a, b)| (a - b).abs()).collect();
        Estimate { value, change }
    }
}

/// Whether a value differs from an estimate beyond what differences can tell. Where the estimate is no number nothing is said.
fn differs(given: f64, expected: f64, change: f64, largest: f64) -> bool {
    let tolerance = RELATIVE * expected.abs().max(given.abs()) + OF_ROW * largest + OF_CHANGE * change;
    expected.is_finite() && (!given.is_finite() || (given - expected).abs() > tolerance)
}

/// Rows of first derivatives by y and by p, given, against columns by differences.
fn compare(rows: &[Vec<f64>], columns: &[Estimate], named: impl Fn(usize, usize) -> (String, f64)) -> Vec<Mismatch> {
    let mut found = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        let largest = columns.iter().fold(0.0f64, |largest, column| largest.max(column.value[i].abs()));
        for (k, (&given, column)) in row.iter().zip(columns).enumerate() {
            if differs(given, column.value[i], column.change[i], largest) {
                let (entry, x) = named(i, k);
                found.push(Mismatch { entry, x, given, expected: column.value[i] });
            }
        }
    }
    found
}

/// The unknown that column k belongs to.
fn unknown(k: usize, n: usize) -> String {
    if k < n { format!("y[{k}]") } else { format!("p[{}]", k - n) }
}

/// f and g, and their rows of derivatives.
fn jacobian(problem: &dyn BoundaryValueProblem, places: &Places, i: usize, u: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
    let Dimensions { components: n, scalars: np, integrals: ni, .. } = places.dims;
    let (mut f, mut fy, mut fp) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n * np]);
    let (mut g, mut gy, mut gp) = (vec![0.0; ni], vec![0.0; ni * n], vec![0.0; ni * np]);
    let (y, p) = u.split_at(n);
    let mut out = PointJacobian { f: &mut f, fy: &mut fy, fp: &mut fp, g: &mut g, gy: &mut gy, gp: &mut gp };
    problem.rhs_jacobian_many(places.point(i, y), p, &mut out);
    let row = |by_y: &[f64], by_p: &[f64], k: usize| [&by_y[k * n..(k + 1) * n], &by_p[k * np..(k + 1) * np]].concat();
    let rows = (0..n).map(|k| row(&fy, &fp, k)).chain((0..ni).map(|k| row(&gy, &gp, k))).collect();
    f.extend(g);
    (f, rows)
}

/// f and g at unknowns u.
fn values(problem: &mut dyn BoundaryValueProblem, places: &Places, i: usize, u: &[f64]) -> Vec<f64> {
    let Dimensions { components: n, integrals: ni, .. } = places.dims;
    let (y, p) = u.split_at(n);
    places.prepare(problem, p);
    let (mut f, mut g) = (vec![0.0; n], vec![0.0; ni]);
    problem.rhs_many(places.point(i, y), p, &mut f, &mut g);
    f.extend(g);
    f
}

fn check_point(problem: &mut dyn BoundaryValueProblem, places: &Places, i: usize) -> Vec<Mismatch> {
    let (u, n, x, names) = (places.unknowns(i), places.dims.components, places.x[i], places.names());
    let columns: Vec<Estimate> = (0..u.len())
        .map(|k| {
            Estimate::of(STEP * (1.0 + u[k].abs()), |t| {
                let mut moved = u.clone();
                moved[k] += t;
                values(problem, places, i, &moved)
            })
        })
        .collect();
    let plain = values(problem, places, i, &u);
    let (given, rows) = jacobian(problem, places, i, &u);
    let mut found = Vec::new();
    for (k, (&given, &expected)) in given.iter().zip(&plain).enumerate() {
        if differs(given, expected, 0.0, 0.0) {
            found.push(Mismatch { entry: format!("{} with derivatives", names[k]), x, given, expected });
        }
    }
    found.extend(compare(&rows, &columns, |i, k| (format!("∂{}/∂{}", names[i], unknown(k, n)), x)));
    let Dimensions { quadratures, trailing_quadratures, .. } = places.dims;
    let is_quadrature = |k: usize| k < quadratures || (n - trailing_quadratures..n).contains(&k);
    for (row, column) in (0..n).flat_map(|row| (0..n).map(move |column| (row, column))) {
        let Estimate { value, change } = &columns[column];
        if is_quadrature(row) && is_quadrature(column) && differs(0.0, value[row], change[row], 0.0) {
            let entry = format!("∂f[{row}]/∂y[{column}] of two quadratures");
            found.push(Mismatch { entry, x, given: 0.0, expected: value[row] });
        }
    }
    found
}

/// Residuals of the conditions and h(p), in one vector.
fn conditions(problem: &mut dyn BoundaryValueProblem, dims: Dimensions, at: EndValues) -> Vec<f64> {
    problem.prepare(at.p);
    let Dimensions { scalars: np, integrals, .. } = dims;
    let [mut residuals, right] = [(End::Left, at.left), (End::Right, at.right)].map(|(end, y)| {
        let [r, ..] = conditions_at(problem, end, y, at.p);
        r
    });
    residuals.extend(right);
    residuals.extend((0..integrals).map(|k| problem.integral_offset(k, at.p, &mut vec![0.0; np])));
    residuals
}

/// The unknowns of all conditions, y at both ends and p, taken apart.
fn at_ends(u: &[f64], n: usize) -> EndValues<'_> {
    EndValues { left: &u[..n], right: &u[n..2 * n], p: &u[2 * n..] }
}

fn check_ends(problem: &mut dyn BoundaryValueProblem, places: &Places) -> Vec<Mismatch> {
    let (dims, n, y) = (places.dims, places.dims.components, places.y);
    let u = [y.node(0), y.node(y.intervals()), &y.scalars].concat();
    let unit = |k: usize| (0..u.len()).map(|i| f64::from(i == k)).collect::<Vec<_>>();
    let columns: Vec<Estimate> = (0..u.len())
        .map(|k| {
            Estimate::of(STEP * (1.0 + u[k].abs()), |t| {
                let mut moved = u.clone();
                moved[k] += t;
                conditions(problem, dims, at_ends(&moved, n))
            })
        })
        .collect();
    problem.prepare(&y.scalars);
    let given: Vec<Vec<f64>> =
        (0..u.len()).map(|k| slopes_at_ends(problem, at_ends(&u, n), at_ends(&unit(k), n))).collect();
    let names = places.end_names();
    let rows: Vec<Vec<f64>> = (0..names.len()).map(|i| given.iter().map(|column| column[i]).collect()).collect();
    compare(&rows, &columns, |i, k| {
        let column = if k < n { k } else { k - n };
        (format!("∂{}/∂{}", names[i].0, unknown(column, n)), names[i].1)
    })
}

/// Derivatives along directions, given, against differences.
fn compare_along(
    order: &str,
    given: &[f64],
    expected: &Estimate,
    named: impl Fn(usize) -> (String, f64),
) -> Vec<Mismatch> {
    let largest = expected.value.iter().fold(0.0f64, |largest, v| largest.max(v.abs()));
    let wrong = |i: &usize| differs(given[*i], expected.value[*i], expected.change[*i], largest);
    let mismatch = |i: usize| {
        let (name, x) = named(i);
        Mismatch { entry: format!("{order}{name}"), x, given: given[i], expected: expected.value[i] }
    };
    (0..given.len()).filter(wrong).map(mismatch).collect()
}

fn check_point_along(problem: &mut dyn Directional, places: &Places, i: usize) -> Vec<Mismatch> {
    let Dimensions { components: n, integrals: ni, .. } = places.dims;
    let (u, a, b) = (places.unknowns(i), places.direction(1.7), places.direction(2.9));
    let step = STEP * (1.0 + u.iter().fold(0.0f64, |largest, u| largest.max(u.abs())));
    let moved = |t: f64| u.iter().zip(&a).map(|(u, a)| u + t * a).collect::<Vec<_>>();
    let along = |d: &'_ [f64]| -> (Vec<f64>, Vec<f64>) { (d[..n].to_vec(), d[n..].to_vec()) };
    let [(ay, ap), (by, bp)] = [along(&a), along(&b)];
    let [a, b_along] = [PointDirection { y: &ay, p: &ap }, PointDirection { y: &by, p: &bp }];
    let second = |problem: &mut dyn Directional, u: &[f64], b: PointDirection| {
        let (y, p) = u.split_at(n);
        places.prepare(problem, p);
        let (mut f, mut g) = (vec![0.0; n], vec![0.0; ni]);
        problem.second_many(places.point(i, y), p, [a, b], [&mut f, &mut g]);
        f.extend(g);
        f
    };
    let expected = Estimate::of(step, |t| {
        let u = moved(t);
        places.prepare(problem, &u[n..]);
        let product = |row: &Vec<f64>| row.iter().zip(&b).map(|(r, b)| r * b).sum();
        jacobian(problem, places, i, &u).1.iter().map(product).collect()
    });
    let (names, x) = (places.names(), places.x[i]);
    let named = |k: usize| (names[k].clone(), x);
    let mut found = compare_along("D²", &second(problem, &u, b_along), &expected, named);
    let expected = Estimate::of(step, |t| second(problem, &moved(t), a));
    let squares = second(problem, &u, a);
    let [mut f2, mut f3] = [(); 2].map(|()| vec![0.0; n]);
    let [mut g2, mut g3] = [(); 2].map(|()| vec![0.0; ni]);
    let (y, p) = u.split_at(n);
    problem.third_many(places.point(i, y), p, a, [[&mut f2, &mut g2], [&mut f3, &mut g3]]);
    f2.extend(g2);
    f3.extend(g3);
    let exact = Estimate { change: vec![0.0; squares.len()], value: squares };
    found.extend(compare_along("D² of third: ", &f2, &exact, named));
    found.extend(compare_along("D³", &f3, &expected, named));
    found
}

fn check_ends_along(problem: &mut dyn Directional, places: &Places) -> Vec<Mismatch> {
    let Dimensions { components: n, left, right, integrals, .. } = places.dims;
    let y = places.y;
    let at = EndValues { left: y.node(0), right: y.node(y.intervals()), p: &y.scalars };
    let (u, v) = (places.direction(1.7), places.direction(2.9));
    // Both ends move differently.
    let [a, b] = [(&u, &v), (&v, &u)].map(|(d, e)| EndValues { left: &d[..n], right: &e[..n], p: &d[n..] });
    let largest = [at.left, at.right, at.p].concat().iter().fold(0.0f64, |largest, u| largest.max(u.abs()));
    let step = STEP * (1.0 + largest);
    let derivative = |problem: &mut dyn Directional, at: EndValues, along: Option<EndValues>| {
        let [mut l, mut r, mut h] = [left, right, integrals].map(|count| vec![0.0; count]);
        let out = EndDerivatives { left: &mut l, right: &mut r, offsets: &mut h };
        match along {
            Some(b) => problem.second_at_ends(at, [a, b], out),
            None => problem.third_at_ends(at, a, out),
        }
        [l, r, h].concat()
    };
    let names = places.end_names();
    let named = |k: usize| names[k].clone();
    let expected = Estimate::of(step, |t| slopes_displaced(problem, at, [a, b], t));
    problem.prepare(at.p);
    let mut found = compare_along("D²", &derivative(problem, at, Some(b)), &expected, named);
    let expected = Estimate::of(step, |t| {
        let moved = |u: &[f64], d: &[f64]| u.iter().zip(d).map(|(u, d)| u + t * d).collect::<Vec<_>>();
        let (left, right, p) = (moved(at.left, a.left), moved(at.right, a.right), moved(at.p, a.p));
        problem.prepare(&p);
        derivative(problem, EndValues { left: &left, right: &right, p: &p }, Some(a))
    });
    problem.prepare(at.p);
    found.extend(compare_along("D³", &derivative(problem, at, None), &expected, named));
    found
}
