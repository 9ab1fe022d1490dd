//! Growth rates of a sphere in a spherical shell: closed form, eigenvalue problem of the stationary shape, and time steps.
//!
//! On a sphere of radius R the displacement w P_ℓ(cosθ) outwards and the velocity β ∂_θP_ℓ along it separate. With λ = ℓ(ℓ+1),
//! δC = (λ−2)w/R² P_ℓ and ∂_θD + 2cotθ D = (2−λ)∂_θP_ℓ for D = (∂_θ² − cotθ ∂_θ)P_ℓ, the balance of forces to first order is
//!
//! * \[normal\] τ = −Kw − ½RΓ_nẇ, K = (R/2)\[(γ + ½κC0² − 2κC0/R + 2gξ_b/R)(λ−2)/R² + κλ(λ−2)/R⁴ − f′\], f′ = ∂f_c/∂ρ of the shell at ρ = R,
//! * \[tangential\] τ − (λ−2)(η_sβ/R − ½gξ_s w/R²) = ΓRβ,
//! * \[stress\] τ = η_b(2ẇ − λβ)/R + gξ_b(λ−2)w/R²,
//!
//! τ P_ℓ being the isotropic part of the stress. Elimination of τ and β leaves ẇ = σw.

use furrow_bvp::newton::NewtonScratch;
use furrow_bvp::{BoundaryValueProblem, Gauss, Newton, Solution, System};
use furrow_cell::{Cell, Numerics, Shell};
use furrow_mechanics::azimuthal::Azimuthal;
use furrow_mechanics::azimuthal::equations::W;
use furrow_mechanics::azimuthal::mode::{Mode, Rigid};
use furrow_mechanics::cortex::equations::{COMPONENTS, M, PSI, Q, R, V, Z};
use furrow_mechanics::cortex::symmetry::unfold;
use furrow_mechanics::cortex::{Cortex, Domain};
use furrow_mechanics::division::stepper::Stepper;
use furrow_mechanics::stability::{Parity, Stability};
use furrow_verification::report::{near, within};
use furrow_verification::states::{passive_shape, uneven_cell};

/// A cell that is a sphere at any activity.
fn sphere(r0: f64, xi_s: f64) -> Cell {
    Cell {
        epsilon: 0.7,
        shell: Shell { aspect: 1.0, p0: 0.2, w: 0.4, ..Shell::GAO2026 },
        ..uneven_cell(r0, xi_s, "none").unwrap()
    }
}

/// σ of mode ℓ.
fn exact(cell: &Cell, l: f64) -> f64 {
    let (radius, material, shell) = (cell.r0, &cell.material, &cell.shell);
    let [xi_s, xi_b] = [1.0, material.xi_ratio].map(|ratio| material.gain * cell.xi_s * ratio);
    let lambda = l * (l + 1.0);
    // f_c(ρ) = −(2P0/w²) ρ/b² exp[(ρ²/b² − 1)/w²].
    let (b2, w2) = ((radius.powi(3) / cell.epsilon).powf(2.0 / 3.0), shell.w * shell.w);
    let pushed = -(2.0 * shell.p0 / w2) * radius / b2 * ((radius * radius / b2 - 1.0) / w2).exp();
    let slope = pushed * (1.0 / radius + 2.0 * radius / (b2 * w2));
    let spontaneous = material.spontaneous_curvature;
    let curled = material.kappa * spontaneous * (0.5 * spontaneous - 2.0 / radius);
    let tension = material.tension + curled + 2.0 * xi_b / radius;
    let bending = material.kappa * lambda * (lambda - 2.0) / radius.powi(4);
    let k = 0.5 * radius * (tension * (lambda - 2.0) / radius.powi(2) + bending - slope);
    let resistance = material.friction * radius + (lambda - 2.0) * material.eta_s / radius;
    let isotropic = xi_b * (lambda - 2.0) / radius.powi(2);
    let driven = 0.5 * (lambda - 2.0) * xi_s / radius.powi(2) - k;
    let drag = 0.5 * radius * material.normal_friction;
    let spread = material.eta_b * lambda / (radius * resistance);
    (spread * driven - k - isotropic) / (drag * (1.0 + spread) + 2.0 * material.eta_b / radius)
}

/// The sphere at its activity, on the whole contour or half of it.
fn at_rest(cell: &Cell, domain: Domain, numerics: &Numerics) -> (Cortex, Solution) {
    let mut y = match domain {
        Domain::Full => passive_shape(cell, numerics).unwrap(),
        Domain::Half => furrow_mechanics::equilibria::passive(cell, numerics).unwrap().0,
    };
    let mut cortex = Cortex::new(cell, domain, &[]);
    let mut system = System::new(cortex.dimensions(), y.m);
    let newton = Newton { tolerance: 1e-12, ..Newton::default() };
    newton.solve(&mut system, &mut NewtonScratch::default(), &mut cortex, &mut y, &[], false).unwrap();
    (cortex, y)
}

#[test]
fn modes_of_a_sphere_grow_at_the_rates_of_theory() {
    for (r0, xi_s) in [(1.0, 0.0), (2.0, 6.0), (2.0, 14.0), (3.0, 20.0), (3.0, 40.0)] {
        let cell = sphere(r0, xi_s);
        let (cortex, y) = at_rest(&cell, Domain::Half, &Numerics::default());
        let spectrum = Stability::new(y.m).leading(&cortex, &y).unwrap();
        let mut of_parity = [Vec::new(), Vec::new()];
        for l in 1..40 {
            of_parity[l % 2].push(exact(&cell, l as f64));
        }
        of_parity.iter_mut().for_each(|rates| rates.sort_by(|a, b| b.total_cmp(a)));
        for (parity, expected) in [(Parity::Even, &of_parity[0]), (Parity::Odd, &of_parity[1])] {
            let found = spectrum.values.iter().filter(|rate| rate.parity == parity);
            for (found, expected) in found.zip(expected).take(3) {
                near(&format!("R0 = {r0}, ξ_s = {xi_s}, {parity:?}"), found.re, *expected, 1e-6);
            }
        }
    }
}

/// P_2 or P_3 with its slope.
fn legendre(l: i32, x: f64) -> [f64; 2] {
    match l {
        2 => [1.5 * x * x - 0.5, 3.0 * x],
        _ => [2.5 * x.powi(3) - 1.5 * x, 7.5 * x * x - 1.5],
    }
}

/// The sphere with a little of mode ℓ on it, as a guess of that shape.
fn bulged(gauss: &Gauss, cell: &Cell, rest: &Solution, amplitude: f64, l: i32) -> Solution {
    let r0 = cell.r0;
    Solution::from_fn(gauss, &rest.mesh, COMPONENTS, &rest.scalars, |u, y| {
        rest.eval(gauss, u, y);
        let theta = std::f64::consts::PI * u;
        let (sin, cos) = theta.sin_cos();
        let [p, slope] = legendre(l, cos);
        let (w, slope) = (amplitude * p, -amplitude * slope * sin);
        y[R] += w * sin;
        y[Z] += w * cos;
        y[PSI] -= slope / r0;
        y[M] += cell.material.kappa * (f64::from(l * (l + 1)) - 2.0) * w / (r0 * r0);
        y[Q] += cell.material.kappa * (f64::from(l * (l + 1)) - 2.0) * slope / r0.powi(3);
    })
    .unwrap()
}

/// Amplitude of mode ℓ in a shape: the projection of its distance from the middle on P_ℓ.
fn amplitude(gauss: &Gauss, y: &Solution, r0: f64, l: i32) -> f64 {
    let mut sum = 0.0;
    for i in 0..y.intervals() {
        for j in 0..y.m {
            let s = y.stage(i, j);
            let rho = s[R].hypot(s[Z]);
            let x = s[Z] / rho;
            let weight = (y.mesh[i + 1] - y.mesh[i]) * gauss.b[j] * std::f64::consts::PI * s[R] / rho;
            sum += weight * (rho - r0) * legendre(l, x)[0];
        }
    }
    sum * 0.5 * (2.0 * f64::from(l) + 1.0)
}

/// Time steps follow e^(σt), growing and decaying.
#[test]
fn small_disturbances_of_a_sphere_follow_the_exponential_of_theory() {
    for (xi_s, l) in [(3.0, 2), (40.0, 2), (40.0, 3)] {
        let cell = sphere(2.0, xi_s);
        let sigma = exact(&cell, f64::from(l));
        let numerics = Numerics { intervals: 16, ..Numerics::default() };
        let (cortex, rest) = at_rest(&cell, Domain::Full, &numerics);
        let gauss = rest.gauss();
        let start = bulged(&gauss, &cell, &rest, 1e-5, l);
        let mut stepper = Stepper::new(cortex, rest.m, 16, start);
        let dt = 0.02 / sigma.abs();
        // The first steps are short and of low order: skip them.
        for (dt, count) in [(0.1 * dt, 20), (dt, 5)] {
            for _ in 0..count {
                stepper.attempt(dt, 4).unwrap();
                stepper.accept();
            }
        }
        let size = |stepper: &Stepper| amplitude(&gauss, &stepper.history[0].y, cell.r0, l);
        let before = size(&stepper);
        for _ in 0..50 {
            stepper.attempt(dt, 4).unwrap();
            stepper.accept();
        }
        let rate = (size(&stepper) / before).ln() / (50.0 * dt);
        println!("σ = {sigma}, amplitudes {before:e} {:e}", size(&stepper));
        near(&format!("ξ_s = {xi_s}, ℓ = {l}: rate of growth over σ"), rate / sigma, 1.0, 1e-3);
    }
}

/// On a sphere a disturbance of azimuthal number m has the rates of all ℓ ≥ m, for every m. Without activity they are the rates of
/// Helfrich's modes of a vesicle, (ℓ − 1)(ℓ + 2)\[γ + ½κC0² − 2κC0/R + κℓ(ℓ + 1)/R²\]/R² over what resists.
#[test]
fn on_a_sphere_rates_depend_on_the_degree_alone() {
    let numerics = Numerics { intervals: 160, ..Numerics::default() };
    for (r0, xi_s, p0) in [(1.0, 0.0, 0.2), (1.5, 0.0, 0.0), (2.0, 14.0, 0.2), (3.0, 40.0, 0.2)] {
        let mut cell = sphere(r0, xi_s);
        cell.shell.p0 = p0;
        let (cortex, y) = at_rest(&cell, Domain::Half, &numerics);
        for m in 0..5 {
            let spectrum = Azimuthal::new(&cortex, &y, m).leading().unwrap();
            // A volume that is kept has no mode ℓ = 0.
            let mut expected: Vec<f64> = (m.max(1)..40).map(|l| exact(&cell, l as f64)).collect();
            expected.sort_by(|a, b| b.total_cmp(a));
            for (found, expected) in spectrum.values.iter().zip(&expected).take(2) {
                near(&format!("R0 = {r0}, ξ_s = {xi_s}, m = {m}"), found.re, *expected, 1e-9);
            }
        }
    }
}

/// For m = 0 the rates equal the rates of axisymmetric disturbances, which come from other equations.
#[test]
fn without_an_azimuthal_number_rates_are_those_of_axisymmetric_disturbances() {
    let regulator = "regulator:none,turnover=10,diffusion=1,activity=0.3";
    for cue in [
        "none",
        "kappa:band,u0=0.465,omega=0.0577,amplitude=0.1",
        "activity:step,u0=0.4,omega=0.3Lh,amplitude=0.2",
        regulator,
    ] {
        for (r0, xi_s) in [(1.65, 20.0), (2.2, 16.0)] {
            let cell = Cell { xi_s, ..Cell::new(r0) }.with_cue(cue.parse().unwrap());
            let shape = furrow_mechanics::equilibria::stationary(&cell, &Numerics::default()).unwrap();
            let today = shape.spectrum().unwrap();
            let found = Azimuthal::new(&shape.cortex, &shape.solution, 0).leading().unwrap();
            for (found, today) in found.values.iter().zip(&today.values).take(2) {
                near(cue, found.re, today.re, 1e-8);
                near(cue, found.im.abs(), today.im.abs(), 1e-8);
            }
        }
    }
}

/// A shape without a shell that is no sphere, on the branch that leaves the sphere where mode 2 begins to grow. It moves and turns
/// freely: friction resists flow, not displacement.
fn free_shape(numerics: &Numerics) -> (Cortex, Solution) {
    let at = |xi_s: f64| {
        let mut cell = sphere(2.0, xi_s);
        cell.shell.p0 = 0.0;
        cell
    };
    let (mut low, mut high) = (1.0, 60.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if exact(&at(middle), 2.0) < 0.0 { low = middle } else { high = middle }
    }
    let cell = at(1.05 * low);
    let rest = furrow_mechanics::equilibria::passive(&sphere(2.0, 0.0), numerics).unwrap().0;
    let mut y = bulged(&rest.gauss(), &cell, &rest, -0.2, 2);
    let mut cortex = Cortex::new(&cell, Domain::Half, &[]);
    let mut system = System::new(cortex.dimensions(), y.m);
    let newton = Newton { tolerance: 1e-12, ..Newton::default() };
    newton.solve(&mut system, &mut NewtonScratch::default(), &mut cortex, &mut y, &[], false).unwrap();
    (cortex, y)
}
/// Without a shell, translations (m = 0 and 1) and a rotation (m = 1) neither grow nor decay, although the cortex flows.
#[test]
fn rigid_motions_of_a_free_cell_neither_grow_nor_decay() {
    let (cortex, y) = free_shape(&Numerics::default());
    let flow = y.stages.chunks_exact(COMPONENTS).fold(0.0f64, |most, s| most.max(s[V].abs()));
    assert!(flow > 0.01, "{flow}");
    for (m, motions) in [(0, 1), (1, 2)] {
        let mut disturbances = Azimuthal::new(&cortex, &y, m);
        disturbances.arnoldi.wanted = 6;
        let mut rates: Vec<f64> = disturbances.leading().unwrap().values.iter().map(|v| v.re.hypot(v.im)).collect();
        rates.sort_by(f64::total_cmp);
        for rate in &rates[..motions] {
            within(&format!("rigid motion, m = {m}"), *rate, 1e-8);
        }
        assert!(rates[motions] > 1e-3, "{rates:?}");
    }
}

/// Points of a cell that is shifted across its axis, or turned about a line across it, move as shift and turn say.
#[test]
fn shifts_and_turns_of_the_whole_cell_are_rigid_motions() {
    let (half, _) = furrow_mechanics::equilibria::passive(&Cell::new(2.0), &Numerics::default()).unwrap();
    let shape = unfold(&half);
    let angle = 1e-6f64;
    let shifted = |[x, z]: [f64; 2]| [x + angle, z];
    let turned = |[x, z]: [f64; 2]| [x * angle.cos() + z * angle.sin(), z * angle.cos() - x * angle.sin()];
    for (turns, expected) in [(false, [1.0, 0.0]), (true, [0.0, 1.0])] {
        let motion = |at| if turns { turned(at) } else { shifted(at) };
        let n = furrow_mechanics::azimuthal::equations::COMPONENTS;
        let mut disturbance = shape.resampled(n, &[0.0; 2], |_, _| {});
        for (y, x) in shape.stages.chunks_exact(COMPONENTS).zip(disturbance.stages.chunks_exact_mut(n)) {
            let [r, z] = motion([y[R], y[Z]]);
            x[W] = ((r - y[R]) * y[PSI].sin() + (z - y[Z]) * y[PSI].cos()) / angle;
        }
        let mode = Mode { m: 1, rate: 0.0, disturbance, shape: shape.clone() };
        let Rigid { translation, rotation } = mode.rigid().unwrap();
        near("share of a shift", translation, expected[0], 1e-5);
        near("share of a turn", rotation, expected[1], 1e-5);
    }
}

/// Rates of a furrowed shape from a mesh and from its halves.
#[test]
fn halved_meshes_give_the_same_rates_for_every_azimuthal_number() {
    let cell = Cell { xi_s: 21.0, ..Cell::new(2.0) };
    let rates = [48, 96].map(|intervals| {
        let shape =
            furrow_mechanics::equilibria::stationary(&cell, &Numerics { intervals, ..Numerics::default() }).unwrap();
        [0, 1, 2, 3, 4].map(|m| Azimuthal::new(&shape.cortex, &shape.solution, m).leading().unwrap())
    });
    for (m, (coarse, fine)) in rates[0].iter().zip(&rates[1]).enumerate() {
        for (coarse, fine) in coarse.values.iter().zip(&fine.values).take(2) {
            near(&format!("m = {m}"), coarse.re, fine.re, 1e-8);
        }
    }
}
