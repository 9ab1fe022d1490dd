//! Floquet multipliers of cycles.

use furrow_bvp::{Gauss, Number, PeriodicOrbit, Settings, Solution, VectorField, mesh, solve};
use furrow_spectra::cycles;
use furrow_spectra::floquet::{CycleBifurcation, Multipliers};
use std::f64::consts::TAU;

/// Rössler's equations with a = b = 1/5.
#[derive(Clone)]
struct Rossler {
    c: f64,
}

impl VectorField for Rossler {
    fn components(&self) -> usize {
        3
    }
    fn parameters(&self) -> usize {
        0
    }
    fn velocity<D: Number>(&self, y: &[D], _: &[D], v: &mut [D]) {
        v[0] = -y[1] - y[2];
        v[1] = y[0] + y[1] * 0.2;
        v[2] = y[2] * (y[0] - self.c) + 0.2;
    }
}

#[derive(Clone)]
struct VanDerPol;

impl VectorField for VanDerPol {
    fn components(&self) -> usize {
        2
    }
    fn parameters(&self) -> usize {
        0
    }
    fn velocity<D: Number>(&self, y: &[D], _: &[D], v: &mut [D]) {
        v[0] = y[1];
        v[1] = (-y[0].powi(2) + 1.0) * y[1] - y[0];
    }
}

/// Steps of Runge and Kutta over a time.
fn integrated(field: &impl VectorField, y: &mut [f64], time: f64, steps: usize) {
    let h = time / steps as f64;
    let slope = |y: &[f64]| {
        let mut v = vec![0.0; y.len()];
        field.velocity(y, &[], &mut v);
        v
    };
    for _ in 0..steps {
        let at = |k: &[f64], share: f64| -> Vec<f64> { y.iter().zip(k).map(|(y, k)| y + share * h * k).collect() };
        let k1 = slope(y);
        let k2 = slope(&at(&k1, 0.5));
        let k3 = slope(&at(&k2, 0.5));
        let k4 = slope(&at(&k3, 1.0));
        for c in 0..y.len() {
            y[c] += h / 6.0 * (k1[c] + 2.0 * k2[c] + 2.0 * k3[c] + k4[c]);
        }
    }
}

/// The cycle near the one that the field reaches from a point, with its multipliers.
fn cycle(field: impl VectorField + Clone, start: &[f64], period: f64) -> (Solution, Multipliers) {
    let gauss = Gauss::new(4).unwrap();
    let orbit = |x: f64, y: &mut [f64]| {
        y.copy_from_slice(start);
        integrated(&field, y, x * period, 1 + (x * 2000.0) as usize);
    };
    let grid = mesh::uniform(0.0, 1.0, 40);
    let (mut problem, guess) = PeriodicOrbit::near(field.clone(), &gauss, &grid, period, &[], orbit).unwrap();
    let found = solve(&mut problem, &guess, &Settings { tolerance: 1e-9, ..Settings::default() }).unwrap().solution;
    let multipliers = Multipliers::of(&problem.monodromy(&found).unwrap()).unwrap();
    (found, multipliers)
}

/// Liouville: the multipliers' product is exp ∫ div v dt. Here div v = 1 − u².
#[test]
fn the_multiplier_of_van_der_pol_is_liouvilles() {
    let (found, multipliers) = cycle(VanDerPol, &[2.00862, 0.0], 6.66329);
    let gauss = Gauss::new(4).unwrap();
    let period = PeriodicOrbit::<VanDerPol>::period(&found);
    let mut exponent = 0.0;
    for i in 0..found.intervals() {
        let h = found.mesh[i + 1] - found.mesh[i];
        for j in 0..4 {
            exponent += period * h * gauss.b[j] * (1.0 - found.stage(i, j)[0].powi(2));
        }
    }
    assert!((multipliers.trivial - 1.0).norm_sqr() < 1e-14, "{multipliers:?}");
    assert!((multipliers.others[0].re - exponent.exp()).abs() < 1e-8 && multipliers.is_stable());
}

/// SciPy's integration of the variational equations with a tolerance of 1e-12: period doubling at c = 2.832445028.
#[test]
fn rosslers_cycle_doubles_its_period() {
    let test = |c: f64| {
        let (_, multipliers) = cycle(Rossler { c }, &[1.6 * c, 0.0, 0.57 * c], 5.76);
        CycleBifurcation::PeriodDoubling.test(&multipliers)
    };
    let (mut low, mut high) = (2.80, 2.86);
    let (mut below, mut above) = (test(low), test(high));
    assert!(below > 0.0 && above < 0.0);
    for _ in 0..6 {
        let next = low - below * (high - low) / (above - below);
        let value = test(next);
        (low, below, high, above) = (high, above, next, value);
        if value == 0.0 || (high - low).abs() < 1e-10 {
            break;
        }
    }
    assert!((high - 2.832445028).abs() < 1e-7, "{high}");
}

#[test]
fn a_pair_on_the_unit_circle_shows_a_torus() {
    let turned = |radius: f64| {
        let (sin, cos) = (0.1 * TAU).sin_cos();
        let (a, b) = (radius * cos, radius * sin);
        Multipliers::of(&[a, -b, 0.0, b, a, 0.0, 0.0, 0.0, 1.0]).unwrap()
    };
    let [inside, outside] = [0.9, 1.1].map(turned);
    assert!(inside.is_stable() && !outside.is_stable());
    for bifurcation in CycleBifurcation::ALL {
        let changes = bifurcation.test(&inside) * bifurcation.test(&outside) < 0.0;
        assert_eq!(changes, bifurcation == CycleBifurcation::Torus);
    }
    assert!(Multipliers::of(&[1.0, f64::NAN, 0.0, 1.0]).is_err() && Multipliers::of(&[1.0, 2.0]).is_err());
}

/// Seven circular cycles in a ring: at p = 0 all multipliers next to 1 and e^(−4π) meet, with Jordan blocks at both. QR iterations without a
/// limit went on for ever next to it.
#[derive(Clone)]
struct Ring;

impl VectorField for Ring {
    fn components(&self) -> usize {
        14
    }
    fn parameters(&self) -> usize {
        1
    }
    fn velocity<D: Number>(&self, y: &[D], p: &[D], v: &mut [D]) {
        for k in 0..7 {
            let (at, [x, z]) = (|k: usize, c: usize| y[2 * (k % 7) + c], [y[2 * k], y[2 * k + 1]]);
            let square = x * x + z * z;
            let (growth, turn) = (-square + 1.0, square * -2.0 + 3.0);
            v[2 * k] = growth * x - turn * z + p[0] * (at(k + 6, 0) + at(k + 1, 0) - x * 2.0);
            v[2 * k + 1] = growth * z + turn * x + p[0] * (at(k + 6, 1) + at(k + 1, 1) - z * 2.0);
        }
    }
}

#[test]
fn many_equal_multipliers_are_found() {
    let circles = |x: f64, y: &mut [f64]| {
        let (sine, cosine) = (TAU * x).sin_cos();
        y.chunks_mut(2).for_each(|y| y.copy_from_slice(&[cosine, sine]));
    };
    let (gauss, grid) = (Gauss::new(4).unwrap(), mesh::uniform(0.0, 1.0, 20));
    for p in [1e-6, 1e-7, 1e-9, 0.0, -1e-9] {
        let (mut problem, orbit) = PeriodicOrbit::near(Ring, &gauss, &grid, TAU, &[p], circles).unwrap();
        let multipliers = cycles::multipliers(&mut problem, &orbit).unwrap();
        let next_to_one = multipliers.others.iter().filter(|m| (*m - 1.0).norm_sqr() < 1e-4).count();
        assert_eq!(next_to_one, 6, "{p:e}: {multipliers:?}");
    }
}
