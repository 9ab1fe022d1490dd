// The test problems 1 to 33 of J. R. Cash and F. Mazzia, stated from the equations in their report. Shared by an example,
// a bench and tests.

use std::f64::consts::PI;

use furrow_bvp::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, Gauss, PointJacobian, Solution, Solved, mesh,
};

/// A value of one component at an end.
type Given = (usize, f64);

/// f(x, y) into the first array and, if it is not empty, ∂f/∂y into the second.
type Rhs = Box<dyn Fn(f64, &[f64], &mut [f64], &mut [f64])>;

/// One problem for one value of ε.
pub struct TestProblem {
    /// Its number in the collection.
    pub number: usize,
    /// The small parameter.
    pub epsilon: f64,
    /// The interval.
    pub range: [f64; 2],
    /// The exact first component, where it is known.
    pub exact: Option<fn(f64, f64) -> f64>,
    components: usize,
    rhs: Rhs,
    left: Vec<Given>,
    right: Vec<Given>,
}

impl TestProblem {
    /// The guess: a straight line between given values of the first component, with its slope in the second where that is
    /// its derivative; all others zero.
    pub fn line(&self, stages: usize, intervals: usize) -> Solution {
        let [a, b] = self.range;
        let ends = [&self.left, &self.right].map(|given| given.iter().find(|g| g.0 == 0).map_or(0.0, |g| g.1));
        let slope = (ends[1] - ends[0]) / (b - a);
        let line = |x: f64, y: &mut [f64]| {
            y[0] = ends[0] + slope * (x - a);
            if self.number != 31 {
                y[1] = slope;
            }
        };
        Solution::from_fn(
            &Gauss::new(stages).expect("stages from 1 to 5"),
            &mesh::uniform(a, b, intervals),
            self.components,
            &[],
            line,
        )
        .expect("a mesh")
    }

    /// Largest difference of the first component from the exact one over 1 + |value|, sampled between the nodes too.
    pub fn error(&self, y: &Solved) -> Option<f64> {
        let exact = self.exact?;
        Some(largest_difference(y, |x| exact(x, self.epsilon)))
    }
}

/// Largest difference of the first component from a function over 1 + |value|, at nine points of every interval.
pub fn largest_difference(solved: &Solved, mut exact: impl FnMut(f64) -> f64) -> f64 {
    let y = &solved.solution;
    let (gauss, mut value, mut largest) = (y.gauss(), vec![0.0; y.components], 0.0f64);
    for i in 0..y.intervals() {
        for k in 0..=8 {
            let x = y.mesh[i] + k as f64 / 8.0 * (y.mesh[i + 1] - y.mesh[i]);
            let expected = exact(x);
            solved.eval(&gauss, x, &mut value);
            let difference = (value[0] - expected).abs() / (1.0 + expected.abs());
            largest = if difference.is_nan() { f64::INFINITY } else { largest.max(difference) };
        }
    }
    largest
}

impl BoundaryValueProblem for TestProblem {
    fn dimensions(&self) -> Dimensions {
        let (left, right) = (self.left.len(), self.right.len());
        // The first derivative never depends on the first component.
        Dimensions { components: self.components, quadratures: 1, left, right, ..Dimensions::default() }
    }

    fn rhs(&self, at: CollocationPoint, y: &[f64], _: &[f64], f: &mut [f64], _: &mut [f64]) {
        (self.rhs)(at.x, y, f, &mut []);
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], _: &[f64], out: &mut PointJacobian<'_>) {
        (self.rhs)(at.x, y, out.f, out.fy);
    }

    fn left(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        conditions(&self.left, y, out);
    }

    fn right(&self, y: &[f64], _: &[f64], out: &mut BoundaryJacobian<'_>) {
        conditions(&self.right, y, out);
    }
}

fn conditions(given: &[Given], y: &[f64], out: &mut BoundaryJacobian<'_>) {
    for (k, &(component, value)) in given.iter().enumerate() {
        out.r[k] = y[component] - value;
        out.ry[k * y.len() + component] = 1.0;
    }
}

/// y″ = w(x, y, y′), where w comes with its derivatives by y and y′.
fn second_order(force: impl Fn(f64, f64, f64) -> [f64; 3] + 'static) -> Rhs {
    Box::new(move |x, y, f, fy| {
        let [w, by_y, by_slope] = force(x, y[0], y[1]);
        f.copy_from_slice(&[y[1], w]);
        if !fy.is_empty() {
            fy.copy_from_slice(&[0.0, 1.0, by_y, by_slope]);
        }
    })
}

/// y″ = a y + b y′ + c with coefficients that depend on x.
fn linear(coefficients: impl Fn(f64) -> [f64; 3] + 'static) -> Rhs {
    second_order(move |x, y, slope| {
        let [a, b, c] = coefficients(x);
        [a * y + b * slope + c, a, b]
    })
}

/// A problem of second order with y given at both ends.
fn with_ends(number: usize, epsilon: f64, range: [f64; 2], ends: [f64; 2], rhs: Rhs) -> TestProblem {
    let [left, right] = ends.map(|value| vec![(0, value)]);
    TestProblem { number, epsilon, range, exact: None, components: 2, rhs, left, right }
}

/// ln cosh x without overflow.
fn ln_cosh(x: f64) -> f64 {
    x.abs() + (-2.0 * x.abs()).exp().ln_1p() - 2f64.ln()
}

/// The error function, to rounding: its series, and for large arguments the continued fraction of 1 − erf.
fn erf(x: f64) -> f64 {
    let a = x.abs();
    let value = if a < 2.5 {
        let (mut term, mut sum) = (a, a);
        for k in 1..80 {
            let k = k as f64;
            term *= 2.0 * a * a / (2.0 * k + 1.0);
            sum += term;
        }
        2.0 / PI.sqrt() * (-a * a).exp() * sum
    } else {
        let tail = (1..=60).rev().fold(0.0, |tail, k| 0.5 * k as f64 / (a + tail));
        1.0 - (-a * a).exp() / (PI.sqrt() * (a + tail))
    };
    value.copysign(x)
}

/// Problems with oscillating solutions have ε at the next 1/(odd number): at 1e-1 … 1e-4 itself the sixteenth has a
/// one-parameter family of solutions.
fn next_odd(epsilon: f64) -> f64 {
    1.0 / ((1.0 / epsilon).round() + 1.0)
}

/// The problem of the given number, 1 to 33; `None` if ε has no meaning for it.
pub fn problem(number: usize, epsilon: f64) -> Option<TestProblem> {
    match number {
        1..=10 => Some(linear_first(number, epsilon)),
        11..=18 => Some(linear_second(number, epsilon)),
        // The slope at the end is 2 sinh(1/2ε)/ε.
        23 if epsilon < 1e-2 => None,
        19..=24 => Some(nonlinear(number, epsilon)),
        25..=30 => Some(lagerstrom_cole(number, epsilon)),
        31..=33 => Some(system(number, epsilon)),
        _ => None,
    }
}

fn linear_first(number: usize, e: f64) -> TestProblem {
    let (unit, both) = ([0.0, 1.0], [-1.0, 1.0]);
    let (cos, sin) = (|x: f64| (PI * x).cos(), |x: f64| (PI * x).sin());
    let (range, ends, rhs): (_, _, Rhs) = match number {
        1 => (unit, [1.0, 0.0], linear(move |_| [1.0 / e, 0.0, 0.0])),
        2 => (unit, [1.0, 0.0], linear(move |_| [0.0, 1.0 / e, 0.0])),
        3 => (
            both,
            [-1.0; 2],
            linear(move |x| {
                let wind = 2.0 + cos(x);
                [1.0 / e, -wind / e, -((1.0 + e * PI * PI) * cos(x) + wind * PI * sin(x)) / e]
            }),
        ),
        4 => {
            let ends = [1.0 + (-2f64).exp(), 1.0 + (-2.0 * (1.0 + e) / e).exp()];
            (both, ends, linear(move |_| [(1.0 + e) / e, -1.0 / e, 0.0]))
        }
        5 => {
            (both, [-1.0; 2], linear(move |x| [1.0 / e, x / e, -((1.0 + e * PI * PI) * cos(x) - PI * x * sin(x)) / e]))
        }
        6 => (both, [-2.0, 0.0], linear(move |x| [0.0, -x / e, -(e * PI * PI * cos(x) + PI * x * sin(x)) / e])),
        7 => (
            both,
            [-1.0, 1.0],
            linear(move |x| [1.0 / e, -x / e, -((1.0 + e * PI * PI) * cos(x) + PI * x * sin(x)) / e]),
        ),
        8 => (unit, [1.0, 2.0], linear(move |_| [0.0, -1.0 / e, 0.0])),
        9 => {
            let width = move |x: f64| e + x * x;
            (both, [1.0 / (1.0 + e); 2], linear(move |x| [-2.0 / width(x), -4.0 * x / width(x), 0.0]))
        }
        _ => (both, [0.0, 2.0], linear(move |x| [0.0, -x / e, 0.0])),
    };
    let exact: fn(f64, f64) -> f64 = match number {
        1 => |x, e| {
            let r = e.sqrt();
            ((-x / r).exp() - ((x - 2.0) / r).exp()) / (1.0 - (-2.0 / r).exp())
        },
        2 => |x, e| (1.0 - ((x - 1.0) / e).exp()) / (1.0 - (-1.0 / e).exp()),
        3 | 5 => |x, _| (PI * x).cos(),
        4 => |x, e| (x - 1.0).exp() + (-(1.0 + e) * (1.0 + x) / e).exp(),
        6 => |x, e| (PI * x).cos() + erf(x / (2.0 * e).sqrt()) / erf(1.0 / (2.0 * e).sqrt()),
        7 => |x, e| {
            let (r, peak) = ((2.0 * e).sqrt(), |x: f64| (2.0 * e / PI).sqrt() * (-x * x / (2.0 * e)).exp());
            (PI * x).cos() + x + (x * erf(x / r) + peak(x)) / (erf(1.0 / r) + peak(1.0))
        },
        8 => |x, e| (2.0 - (-1.0 / e).exp() - (-x / e).exp()) / (1.0 - (-1.0 / e).exp()),
        9 => |x, e| 1.0 / (e + x * x),
        _ => |x, e| 1.0 + erf(x / (2.0 * e).sqrt()) / erf(1.0 / (2.0 * e).sqrt()),
    };
    TestProblem { exact: Some(exact), ..with_ends(number, e, range, ends, rhs) }
}

fn linear_second(number: usize, e: f64) -> TestProblem {
    let both = [-1.0, 1.0];
    let driven = || linear(move |x| [1.0 / e, 0.0, -(e * PI * PI + 1.0) * (PI * x).cos() / e]);
    // A layer of width √ε at the right end.
    let decay: fn(f64, f64) -> f64 = |x, e| ((x - 1.0) / e.sqrt()).exp();
    let far = decay(-1.0, e);
    match number {
        11 => {
            let exact: fn(f64, f64) -> f64 = |x, _| (PI * x).cos();
            TestProblem { exact: Some(exact), ..with_ends(number, e, both, [-1.0; 2], driven()) }
        }
        12 => {
            let exact: fn(f64, f64) -> f64 = |x, e| (PI * x).cos() + sinh_ratio(x + 1.0, e);
            TestProblem { exact: Some(exact), ..with_ends(number, e, both, [-1.0, 0.0], driven()) }
        }
        13 => {
            let exact: fn(f64, f64) -> f64 = |x, e| (PI * x).cos() + sinh_ratio(1.0 - x, e);
            TestProblem { exact: Some(exact), ..with_ends(number, e, both, [0.0, -1.0], driven()) }
        }
        14 => {
            let exact: fn(f64, f64) -> f64 =
                |x, e| (PI * x).cos() + ((x - 1.0) / e.sqrt()).exp() + ((-x - 1.0) / e.sqrt()).exp();
            TestProblem { exact: Some(exact), ..with_ends(number, e, both, [far; 2], driven()) }
        }
        15 => with_ends(number, e, both, [1.0; 2], linear(move |x| [x / e, 0.0, 0.0])),
        16 => {
            let e = next_odd(e);
            let rate = PI / (2.0 * e);
            let exact: fn(f64, f64) -> f64 = |x, e| (PI * x / (2.0 * e)).sin();
            let rhs = linear(move |_| [-rate * rate, 0.0, 0.0]);
            TestProblem { exact: Some(exact), ..with_ends(number, e, [0.0, 1.0], [0.0, rate.sin()], rhs) }
        }
        // For ε = 0.01 it has infinitely many solutions: (ε − x²)/√(ε + x²) solves the equation and vanishes at both ends.
        17 => {
            let exact: fn(f64, f64) -> f64 = |x, e| x / (e + x * x).sqrt();
            let ends = [-0.1, 0.1].map(|x| exact(x, e));
            let rhs = linear(move |x| [-3.0 * e / (e + x * x).powi(2), 0.0, 0.0]);
            TestProblem { exact: Some(exact), ..with_ends(number, e, [-0.1, 0.1], ends, rhs) }
        }
        _ => {
            let exact: fn(f64, f64) -> f64 = |x, e| (-x / e).exp();
            let rhs = linear(move |_| [0.0, -1.0 / e, 0.0]);
            TestProblem { exact: Some(exact), ..with_ends(number, e, [0.0, 1.0], [1.0, exact(1.0, e)], rhs) }
        }
    }
}

/// sinh(z/√ε)/sinh(2/√ε) without overflow.
fn sinh_ratio(z: f64, e: f64) -> f64 {
    let r = e.sqrt();
    ((z - 2.0) / r).exp() * (1.0 - (-2.0 * z / r).exp()) / (1.0 - (-4.0 / r).exp())
}

fn nonlinear(number: usize, e: f64) -> TestProblem {
    let unit = [0.0, 1.0];
    match number {
        19 => {
            let force = move |x: f64, y: f64, slope: f64| {
                let (w, drive) = (y.exp(), PI / 2.0 * (PI * x / 2.0).sin());
                [(drive * w * w - w * slope) / e, (2.0 * drive * w * w - w * slope) / e, -w / e]
            };
            with_ends(number, e, unit, [0.0; 2], second_order(force))
        }
        20 => {
            let exact: fn(f64, f64) -> f64 = |x, e| 1.0 + e * ln_cosh((x - 0.745) / e);
            let rhs = second_order(move |_, _, slope| [(1.0 - slope * slope) / e, 0.0, -2.0 * slope / e]);
            let ends = unit.map(|x| exact(x, e));
            TestProblem { exact: Some(exact), ..with_ends(number, e, unit, ends, rhs) }
        }
        21 => {
            let exact: fn(f64, f64) -> f64 = |x, e| (-x / e.sqrt()).exp();
            let force = move |x: f64, y: f64, _| [(y + y * y - exact(2.0 * x, e)) / e, (1.0 + 2.0 * y) / e, 0.0];
            let ends = unit.map(|x| exact(x, e));
            TestProblem { exact: Some(exact), ..with_ends(number, e, unit, ends, second_order(force)) }
        }
        22 => {
            let rhs = second_order(move |_, y, slope| [-(slope + y * y) / e, -2.0 * y / e, -1.0 / e]);
            with_ends(number, e, unit, [0.0, 0.5], rhs)
        }
        23 => {
            let rate = 1.0 / e;
            let rhs = second_order(move |_, y, _| [rate * (rate * y).sinh(), rate * rate * (rate * y).cosh(), 0.0]);
            with_ends(number, e, unit, [0.0, 1.0], rhs)
        }
        _ => with_ends(number, e, unit, [0.9129, 0.375], second_order(move |x, y, slope| nozzle(e, x, y, slope))),
    }
}

/// Flow with a shock through a nozzle of area A = 1 + x²: ε A y y″ = ((1 + γ)/2 − ε A′) y y′ − y′/y − (A′/A)(1 − (γ − 1)/2 y²) with γ = 1.4.
fn nozzle(e: f64, x: f64, y: f64, slope: f64) -> [f64; 3] {
    let (area, grows, half) = (1.0 + x * x, 2.0 * x, 0.2);
    let first = 1.2 - e * grows;
    let widening = grows / area;
    let numerator = first * y * slope - slope / y - widening * (1.0 - half * y * y);
    let by_y = first * slope + slope / (y * y) + 2.0 * widening * half * y;
    let below = e * area * y;
    [numerator / below, (by_y - numerator / y) / below, (first * y - 1.0 / y) / below]
}

/// ε y″ + y y′ − y = 0 with six pairs of ends.
fn lagerstrom_cole(number: usize, e: f64) -> TestProblem {
    let third = 1.0 / 3.0;
    let ends = [[-third, third], [1.0, -third], [1.0, third], [1.0, 1.5], [0.0, 1.5], [-7.0 / 6.0, 1.5]][number - 25];
    let rhs = second_order(move |_, y, slope| [(y - y * slope) / e, (1.0 - slope) / e, -y / e]);
    with_ends(number, e, [0.0, 1.0], ends, rhs)
}

fn system(number: usize, e: f64) -> TestProblem {
    let (components, rhs, left, right): (_, Rhs, _, _) = match number {
        // Bending of a beam: y, θ, M and Q.
        31 => (4, Box::new(move |_, y, f, fy| beam(e, y, f, fy)), vec![(0, 0.0), (2, 0.0)], vec![(0, 0.0), (2, 0.0)]),
        // Injection of a fluid through a side of a channel: y⁗ = (y′y″ − y y‴)/ε.
        32 => {
            (4, Box::new(move |_, y, f, fy| channel(e, y, f, fy)), vec![(0, 0.0), (1, 0.0)], vec![(0, 1.0), (1, 0.0)])
        }
        // Flow between rotating discs: g, g′, f, f′, f″, f‴.
        _ => {
            let end = |spin| vec![(0, spin), (2, 0.0), (3, 0.0)];
            (6, Box::new(move |_, y, f, fy| discs(e, y, f, fy)), end(-1.0), end(1.0))
        }
    };
    TestProblem { number, epsilon: e, range: [0.0, 1.0], exact: None, components, rhs, left, right }
}

fn beam(e: f64, y: &[f64], f: &mut [f64], fy: &mut [f64]) {
    let (sin, cos) = y[1].sin_cos();
    let (sec, tan) = (1.0 / cos, sin / cos);
    let bend = sec + e * y[3] * tan;
    f.copy_from_slice(&[sin, y[2], -y[3] / e, ((y[0] - 1.0) * cos - y[2] * bend) / e]);
    if !fy.is_empty() {
        fy[1] = cos;
        fy[4 + 2] = 1.0;
        fy[8 + 3] = -1.0 / e;
        let by_angle = -(y[0] - 1.0) * sin - y[2] * (sec * tan + e * y[3] * sec * sec);
        fy[12..].copy_from_slice(&[cos / e, by_angle / e, -bend / e, -y[2] * tan]);
    }
}

fn channel(e: f64, y: &[f64], f: &mut [f64], fy: &mut [f64]) {
    f.copy_from_slice(&[y[1], y[2], y[3], (y[1] * y[2] - y[0] * y[3]) / e]);
    if !fy.is_empty() {
        (fy[1], fy[4 + 2], fy[8 + 3]) = (1.0, 1.0, 1.0);
        fy[12..].copy_from_slice(&[-y[3] / e, y[2] / e, y[1] / e, -y[0] / e]);
    }
}

fn discs(e: f64, y: &[f64], out: &mut [f64], fy: &mut [f64]) {
    let [g, spin, f, f1, _, f3] = [y[0], y[1], y[2], y[3], y[4], y[5]];
    out.copy_from_slice(&[spin, (g * f1 - f * spin) / e, f1, y[4], f3, (-f * f3 - g * spin) / e]);
    if !fy.is_empty() {
        (fy[1], fy[2 * 6 + 3], fy[3 * 6 + 4], fy[4 * 6 + 5]) = (1.0, 1.0, 1.0, 1.0);
        fy[6..12].copy_from_slice(&[f1 / e, -f / e, -spin / e, g / e, 0.0, 0.0]);
        fy[30..].copy_from_slice(&[-spin / e, -g / e, -f3 / e, 0.0, 0.0, -f / e]);
    }
}
