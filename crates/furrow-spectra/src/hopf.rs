//! Hopf points of equilibria, their first Lyapunov coefficients, and the branches of cycles that begin there.
//!
//! With A = ∂v/∂y, Aq = iωq, Aᵀp = −iωp, ‖q‖ = 1, ⟨p, q⟩ = 1 and the multilinear forms B and C of the second and third derivatives,
//!
//! * ℓ₁ = Re(⟨p, C(q, q, q̄)⟩ − 2⟨p, B(q, A⁻¹B(q, q̄))⟩ + ⟨p, B(q̄, (2iω − A)⁻¹B(q, q))⟩)/(2ω)
//!
//! tells by its sign whether the cycles are stable on the centre manifold: ℓ₁ < 0.
//!
//! # References
//! Kuznetsov, *Elements of Applied Bifurcation Theory*, 3rd ed., Springer 2004, § 5.4 (first Lyapunov coefficient).

use std::f64::consts::TAU;

use furrow_bvp::continuation::{Advance, State};
use furrow_bvp::{
    Auto, BranchPoint, Continuation, ContinuationError, ContinuationSettings, Dimensions, Direction, Equations, Gauss,
    InvalidInput, Jet, Metric, Number, PeriodicOrbit, Solution, VectorField, mesh,
};
use nalgebra::{Complex, DMatrix, DVector};

use crate::cycles::CycleBranch;
use crate::floquet;
use crate::root::{self, Root};

/// Equilibria v(y, p) = 0 of a vector field as a problem for [`Continuation`]: the scalar unknowns are y and p, and the one component is
/// 0. With one parameter the problem lacks one condition.
#[derive(Clone, Debug)]
pub struct Equilibria<V> {
    /// The vector field.
    pub field: V,
}

/// A branch of equilibria.
pub type EquilibriumBranch<V> = Continuation<Auto<Equilibria<V>>>;

impl<V: VectorField> Equilibria<V> {
    /// The problem, and a guess from values y and parameters p.
    ///
    /// # Examples
    /// The equilibrium (1, b) of the Brusselator with a = 1 is unstable from b = 2 on, with ω = 1:
    ///
    /// ```
    /// use furrow_bvp::{Continuation, Metric, Number, VectorField};
    /// use furrow_spectra::hopf::{self, Equilibria, HopfWatch};
    ///
    /// #[derive(Clone)]
    /// struct Brusselator;
    ///
    /// impl VectorField for Brusselator {
    ///     fn components(&self) -> usize {
    ///         2
    ///     }
    ///     fn parameters(&self) -> usize {
    ///         1
    ///     }
    ///     fn velocity<D: Number>(&self, y: &[D], p: &[D], v: &mut [D]) {
    ///         let square = y[0].powi(2) * y[1];
    ///         v[0] = square - y[0] * (p[0] + 1.0) + 1.0;
    ///         v[1] = p[0] * y[0] - square;
    ///     }
    /// }
    ///
    /// let (problem, guess) = Equilibria::near(Brusselator, &[1.0, 1.0], &[1.0]);
    /// let metric = Metric::unit(1, 3);
    /// let mut branch = Continuation::start(problem, guess, metric, Default::default(), true)?;
    /// let (mut watch, mut found) = (HopfWatch::start(&branch)?, Vec::new());
    /// branch.follow([0.0, 4.0], 100, |branch, advance| {
    ///     found.push(watch.look(branch, advance));
    ///     true
    /// })?;
    /// let points = found.into_iter().collect::<Result<Vec<_>, _>>()?.concat();
    /// assert!((points[0].parameter() - 2.0).abs() < 1e-9 && (points[0].frequency - 1.0).abs() < 1e-9);
    /// assert!(points[0].lyapunov < 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn near(field: V, y: &[f64], p: &[f64]) -> (Auto<Equilibria<V>>, Solution) {
        let guess = Solution::constant(1, &mesh::uniform(0.0, 1.0, 1), &[0.0], &[y, p].concat());
        (Auto(Equilibria { field }), guess)
    }

    /// ∂v/∂y at an equilibrium, n × n, row-major.
    ///
    /// # Errors
    /// [`InvalidInput`] if the equilibrium has another number of scalar unknowns.
    pub fn jacobian(&self, equilibrium: &Solution) -> Result<Vec<f64>, InvalidInput> {
        Ok(Forms::at(&self.field, &equilibrium.scalars)?.jacobian().transpose().as_slice().to_vec())
    }
}

impl<V: VectorField> Equations for Equilibria<V> {
    fn dimensions(&self) -> Dimensions {
        let n = self.field.components();
        let scalars = n + self.field.parameters();
        Dimensions { components: 1, quadratures: 1, scalars, left: 1, integrals: n, ..Dimensions::default() }
    }

    fn rhs<D: Number>(&self, _: f64, _: &[D], _: &[D], _: &mut [D]) {}

    fn left<D: Number>(&self, y: &[D], _: &[D], r: &mut [D]) {
        r[0] = y[0];
    }

    fn right<D: Number>(&self, _: &[D], _: &[D], _: &mut [D]) {}

    fn offsets<D: Number>(&self, p: &[D], h: &mut [D]) {
        let (y, p) = p.split_at(h.len());
        self.field.velocity(y, p, h);
    }
}

/// Why Hopf points were not found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HopfError {
    /// The equilibrium does not fit the vector field.
    #[error(transparent)]
    Invalid(#[from] InvalidInput),
    /// The Jacobian is not finite, or its eigenvalues could not be computed.
    #[error("the Jacobian at parameter {parameter} has no computable eigenvalues")]
    Eigenvalues {
        /// The parameter.
        parameter: f64,
    },
    /// There is a Hopf point between two equilibria, but no equilibrium between them could be computed.
    #[error("the branch is lost between parameters {} and {}", .parameters[0], .parameters[1])]
    Lost {
        /// Parameters of the two.
        parameters: [f64; 2],
    },
    /// The cycle next to the Hopf point was not found.
    #[error(transparent)]
    Branch(#[from] ContinuationError),
}

/// A Hopf point.
#[derive(Clone, Debug, PartialEq)]
pub struct HopfPoint {
    /// The equilibrium; its scalar unknowns are y and p.
    pub solution: Solution,
    /// Its arclength along the branch.
    pub arclength: f64,
    /// ω: cycles begin with the period 2π/ω.
    pub frequency: f64,
    /// ℓ₁ for ‖q‖ = 1: cycles are stable on the centre manifold if it is negative.
    pub lyapunov: f64,
    /// Re q and Im q.
    pub mode: [Vec<f64>; 2],
}

/// A vector field's derivatives at a point.
struct Forms<'a, V> {
    field: &'a V,
    y: &'a [f64],
    p: &'a [f64],
}

type ComplexVector = DVector<Complex<f64>>;

impl<'a, V: VectorField> Forms<'a, V> {
    fn at(field: &'a V, scalars: &'a [f64]) -> Result<Forms<'a, V>, InvalidInput> {
        let (n, expected) = (field.components(), field.components() + field.parameters());
        if scalars.len() != expected {
            return Err(InvalidInput::Length { name: "scalars of the equilibrium", length: scalars.len(), expected });
        }
        let (y, p) = scalars.split_at(n);
        Ok(Forms { field, y, p })
    }

    /// v along up to three directions in y.
    fn jets(&self, along: [&[f64]; 3]) -> Vec<Jet> {
        let [a, b, c] = along.map(|d| move |k: usize| d.get(k).copied().unwrap_or(0.0));
        let jet = |(k, y): (usize, &f64)| Jet { eps1: a(k), eps2: b(k), eps3: c(k), ..Jet::from(*y) };
        let y: Vec<Jet> = self.y.iter().enumerate().map(jet).collect();
        let p: Vec<Jet> = self.p.iter().map(|p| Jet::from(*p)).collect();
        let mut v = vec![Jet::from(0.0); y.len()];
        self.field.velocity(&y, &p, &mut v);
        v
    }

    fn jacobian(&self) -> DMatrix<f64> {
        let n = self.y.len();
        let mut columns = DMatrix::zeros(n, n);
        for k in 0..n {
            let mut unit = vec![0.0; n];
            unit[k] = 1.0;
            self.jets([&unit, &[], &[]]).iter().enumerate().for_each(|(row, v)| columns[(row, k)] = v.eps1);
        }
        columns
    }

    /// The multilinear form of the given complex vectors, two or three of them, from its values for their real and imaginary parts.
    fn form(&self, vectors: &[&ComplexVector]) -> ComplexVector {
        let mut sum = ComplexVector::zeros(self.y.len());
        for parts in 0..1usize << vectors.len() {
            let is_imaginary = |k: usize| parts >> k & 1 == 1;
            let part = |k: usize| -> Vec<f64> {
                let of = |z: &Complex<f64>| if is_imaginary(k) { z.im } else { z.re };
                vectors.get(k).map(|v| v.iter().map(of).collect()).unwrap_or_default()
            };
            let (a, b, c) = (part(0), part(1), part(2));
            let unit = Complex::new(0.0, 1.0).powu(parts.count_ones());
            for (sum, v) in sum.iter_mut().zip(self.jets([&a, &b, &c])) {
                *sum += unit * if vectors.len() == 3 { v.eps1eps2eps3 } else { v.eps1eps2 };
            }
        }
        sum
    }
}

/// The unit vector next to the kernel of a matrix, by inverse iteration from all ones.
fn null_vector(matrix: &DMatrix<Complex<f64>>) -> Option<ComplexVector> {
    let scale = matrix.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt().max(1.0);
    // Off the eigenvalue by rounding, so that the factors exist.
    let n = matrix.nrows();
    let shifted = matrix + DMatrix::identity(n, n) * Complex::new(1e-14 * scale, 0.0);
    let factors = shifted.lu();
    let start = |k: usize| Complex::new(1.0 + 0.1 * k as f64, 0.3);
    let mut v = ComplexVector::from_fn(n, |k, _| start(k));
    for _ in 0..4 {
        v = factors.solve(&v)?;
        v.unscale_mut(v.norm());
    }
    v.iter().all(|z| z.re.is_finite() && z.im.is_finite()).then_some(v)
}

/// ℓ₁ and q at an equilibrium with eigenvalues ±iω.
fn lyapunov<V: VectorField>(forms: &Forms<'_, V>, omega: f64) -> Option<(f64, ComplexVector)> {
    let (n, rotation) = (forms.y.len(), Complex::new(0.0, omega));
    let real = forms.jacobian();
    let a = real.map(|x| Complex::new(x, 0.0));
    let identity = DMatrix::<Complex<f64>>::identity(n, n);
    let q = null_vector(&(&a - &identity * rotation))?;
    let mut p = null_vector(&(a.transpose() + &identity * rotation))?;
    // ⟨p, q⟩ = Σ p̄ q = 1.
    let product = p.dotc(&q);
    p.apply(|z| *z /= product.conj());
    let conjugate = q.conjugate();
    let static_response = a.clone().lu().solve(&forms.form(&[&q, &conjugate]))?;
    let second_response = (identity * (rotation * 2.0) - a).lu().solve(&forms.form(&[&q, &q]))?;
    let cubic = forms.form(&[&q, &q, &conjugate]) - forms.form(&[&q, &static_response]) * Complex::new(2.0, 0.0)
        + forms.form(&[&conjugate, &second_response]);
    Some((p.dotc(&cubic).re / (2.0 * omega), q))
}

/// Watches a branch of equilibria: gives the eigenvalues of every one, and the Hopf points in the step to it.
/// [`Equilibria::near`] has an example.
#[derive(Clone, Debug, PartialEq)]
pub struct HopfWatch {
    /// Eigenvalues of the newest equilibrium, by falling real part; complex pairs appear with both signs.
    pub eigenvalues: Vec<Complex<f64>>,
}

/// Eigenvalues of an equilibrium.
fn eigenvalues<V: VectorField>(field: &V, equilibrium: &Solution) -> Result<Vec<Complex<f64>>, HopfError> {
    let jacobian = Forms::at(field, &equilibrium.scalars)?.jacobian();
    let parameter = equilibrium.scalars.last().copied().unwrap_or(f64::NAN);
    if jacobian.iter().any(|x| !x.is_finite()) {
        return Err(HopfError::Eigenvalues { parameter });
    }
    let found = floquet::eigenvalues(&jacobian).ok_or(HopfError::Eigenvalues { parameter })?;
    let mut all: Vec<Complex<f64>> = found.iter().copied().collect();
    all.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
    Ok(all)
}

/// Π (λ_i + λ_j)/(|λ_i| + |λ_j|) over pairs, which changes its sign at Hopf points, and where real eigenvalues have opposite values.
fn hopf_test(eigenvalues: &[Complex<f64>]) -> f64 {
    let size = |z: &Complex<f64>| z.norm_sqr().sqrt();
    let rest = |i: usize| eigenvalues.get(i + 1..).unwrap_or(&[]);
    let pairs =
        eigenvalues.iter().enumerate().flat_map(|(i, a)| rest(i).iter().map(move |b| (a + b) / (size(a) + size(b))));
    pairs.product::<Complex<f64>>().re
}

/// The pair nearest to the imaginary axis that is not real: its ω.
fn frequency(eigenvalues: &[Complex<f64>]) -> Option<f64> {
    let nearest = eigenvalues.iter().min_by(|a, b| {
        let of = |z: &Complex<f64>| z.re.abs() + if z.im > 0.0 { 0.0 } else { f64::INFINITY };
        of(a).total_cmp(&of(b))
    })?;
    (nearest.im > 0.0 && nearest.re.abs() < 1e-3 * nearest.im).then_some(nearest.im)
}

impl HopfWatch {
    /// At the newest equilibrium of a branch.
    ///
    /// # Errors
    /// [`HopfError::Eigenvalues`].
    pub fn start<V: VectorField>(branch: &EquilibriumBranch<V>) -> Result<HopfWatch, HopfError> {
        Ok(HopfWatch { eigenvalues: eigenvalues(&branch.problem.0.field, &branch.state.solution)? })
    }

    /// The Hopf point between the last two equilibria, after every step. Two within one step are not seen.
    ///
    /// # Errors
    /// [`HopfError`].
    pub fn look<V: VectorField>(
        &mut self,
        branch: &mut EquilibriumBranch<V>,
        _: Advance,
    ) -> Result<Vec<HopfPoint>, HopfError> {
        let now = eigenvalues(&branch.problem.0.field, &branch.state.solution)?;
        let before = std::mem::replace(&mut self.eigenvalues, now);
        let values = [&before, &self.eigenvalues].map(|all| hopf_test(all));
        if values[0] * values[1] < 0.0 { Ok(located(branch, values)?.into_iter().collect()) } else { Ok(Vec::new()) }
    }
}

/// The root of the test between the last two equilibria. None where two real eigenvalues have opposite values.
fn located<V: VectorField>(
    branch: &mut EquilibriumBranch<V>,
    values: [f64; 2],
) -> Result<Option<HopfPoint>, HopfError> {
    let test = |problem: &mut Auto<Equilibria<V>>, y: &Solution| {
        eigenvalues(&problem.0.field, y).map(|all| (hopf_test(&all), all))
    };
    let lost = |parameters| HopfError::Lost { parameters };
    let Some(Root { solution, arclength, found, .. }) = root::between(branch, values, lost, test)? else {
        return Ok(None);
    };
    let Some(frequency) = frequency(&found) else { return Ok(None) };
    let parameter = solution.scalars.last().copied().unwrap_or(f64::NAN);
    let forms = Forms::at(&branch.problem.0.field, &solution.scalars)?;
    let (lyapunov, q) = lyapunov(&forms, frequency).ok_or(HopfError::Eigenvalues { parameter })?;
    let mode = [q.iter().map(|z| z.re).collect(), q.iter().map(|z| z.im).collect()];
    Ok(Some(HopfPoint { arclength, frequency, lyapunov, mode, solution }))
}

impl HopfPoint {
    /// The parameter there.
    pub fn parameter(&self) -> f64 {
        self.solution.scalars.last().copied().unwrap_or(f64::NAN)
    }

    /// y + Re(q e^{iωt}) times a radius, on one period scaled to 1.
    fn circle(&self, radius: f64) -> impl Fn(f64, &mut [f64]) + '_ {
        let [real, imaginary] = &self.mode;
        move |x: f64, y: &mut [f64]| {
            let (sine, cosine) = (TAU * x).sin_cos();
            for (k, y) in y.iter_mut().enumerate() {
                *y = self.solution.scalars[k] + radius * (real[k] * cosine - imaginary[k] * sine);
            }
        }
    }

    /// The branch of cycles that begins here, at its first cycle: the one at the distance `first_step` of the settings, or a smaller one.
    /// The metric is one for [`PeriodicOrbit`], with n + 2 scalar unknowns.
    ///
    /// # Errors
    /// [`HopfError::Branch`] if there is no such cycle, [`HopfError::Invalid`] for input that is refused.
    pub fn cycles<V: VectorField + Clone>(
        &self,
        field: &V,
        gauss: &Gauss,
        mesh: &[f64],
        metric: Metric,
        settings: ContinuationSettings,
    ) -> Result<CycleBranch<V>, HopfError> {
        let n = field.components();
        let (_, p) = self.solution.scalars.split_at(n.min(self.solution.scalars.len()));
        let orbit =
            |radius| PeriodicOrbit::near(field.clone(), gauss, mesh, TAU / self.frequency, p, self.circle(radius));
        let (_, point) = orbit(0.0)?;
        metric.check(&point)?;
        settings.check()?;
        let (_, unit) = orbit(1.0)?;
        let minus = |b: &[f64], a: &[f64]| b.iter().zip(a).map(|(b, a)| b - a).collect();
        let mut along = Direction {
            nodes: minus(&unit.nodes, &point.nodes),
            stages: minus(&unit.stages, &point.stages),
            scalars: minus(&unit.scalars, &point.scalars),
        };
        metric.normalise(&point.mesh, &mut along);
        // A circle fixes the phase of a cycle; the point itself has no phase.
        let (problem, guess) = orbit(settings.first_step)?;
        // Equilibria are cycles too. Their branch goes in the direction of the parameter, as far as the first cycle's direction matters.
        let mut still = along.clone();
        still.scale(0.0);
        still.scalars[n + 1] = 1.0;
        let start = BranchPoint {
            solution: point,
            arclength: 0.0,
            tangents: [still, along.clone()],
            curvatures: [0.0; 2],
            error: f64::INFINITY,
            gap: 0.0,
        };
        let state = State {
            solution: guess,
            tangent: along,
            arclength: 0.0,
            step: settings.first_step,
            points: 1,
            direction: 0.0,
            orientation: 0.0,
            history: Default::default(),
        };
        let mut branch = Continuation::resume(problem.clone(), state, metric.clone(), settings.clone());
        let first = start.switch(&mut branch, true)?;
        Ok(Continuation::resume(problem, first, metric, settings))
    }
}
