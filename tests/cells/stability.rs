//! Growth rates compared with the dynamics: the paper's dis(t) = ‖r − r₀‖ + ‖z − z₀‖ over 40 τ.

use furrow_bvp::newton::NewtonScratch;
use furrow_bvp::{Newton, Solution, System};
use furrow_cell::{Cell, Numerics, Parameter};
use furrow_mechanics::cortex::equations::{R, Z};
use furrow_mechanics::cortex::observables::positions;
use furrow_mechanics::cortex::symmetry::unfold;
use furrow_mechanics::cortex::{Cortex, Domain};
use furrow_mechanics::equilibria::passive;
use furrow_mechanics::stability::Stability;

const R0: f64 = 2.0;

/// The mirror-symmetric stationary state at ξ_s, on the full domain.
fn stationary(xi: f64) -> (Cortex, Solution) {
    let numerics = Numerics { intervals: 32, ..Numerics::default() };
    let cell = Cell::new(R0);
    let (mut y, _) = passive(&cell, &numerics).unwrap();
    let mut half = Cortex::new(&cell, Domain::Half, &[]);
    let mut system = System::new(Cortex::dimensions_for(0), numerics.stages);
    let newton = Newton { tolerance: 1e-11, ..Newton::default() };
    for step in 1..=40 {
        half.set(Parameter::XiS, xi * f64::from(step) / 40.0);
        newton.solve(&mut system, &mut NewtonScratch::default(), &mut half, &mut y, &[], false).unwrap();
    }
    (Cortex::new(&half.cell, Domain::Full, &[]), unfold(&y))
}

/// dis(t) every τ after a disturbance of the activity in the first step, with second-order backward differences.
fn distances(cortex: &Cortex, rest: &Solution) -> Vec<f64> {
    let mut cortex = cortex.clone();
    let mut system = System::new(Cortex::dimensions_for(0), rest.m);
    let mut scratch = NewtonScratch::default();
    let newton = Newton { tolerance: 1e-12, ..Newton::default() };
    let (dt, per_tau) = (0.05, 20);
    let mut y = rest.clone();
    let (mut before, mut now) = (Vec::new(), Vec::new());
    positions(rest, &mut now);
    let mut out = Vec::new();
    for step in 0..40 * per_tau {
        if step == 0 {
            let points = rest.intervals() * rest.m;
            cortex.noise = (0..points).map(|k| 1.0 + 1e-5 * (7.0 * k as f64 / points as f64).cos()).collect();
            (cortex.rate, cortex.past) = (1.0 / dt, now.clone());
        } else {
            cortex.noise.clear();
            cortex.rate = 1.5 / dt;
            cortex.past = now
                .iter()
                .zip(&before)
                .map(|(a, b): (&[f64; 2], &[f64; 2])| [(4.0 * a[0] - b[0]) / 3.0, (4.0 * a[1] - b[1]) / 3.0])
                .collect();
        }
        newton.solve(&mut system, &mut scratch, &mut cortex, &mut y, &[], step > 1).unwrap();
        before = std::mem::take(&mut now);
        positions(&y, &mut now);
        if (step + 1) % per_tau == 0 {
            let part = |component: usize| {
                let mut sum = 0.0;
                for i in 0..y.intervals() {
                    for j in 0..y.m {
                        let d = y.stage(i, j)[component] - rest.stage(i, j)[component];
                        sum += (y.mesh[i + 1] - y.mesh[i]) * system.gauss.b[j] * d * d;
                    }
                }
                sum.sqrt()
            };
            out.push(part(R) + part(Z));
        }
    }
    out
}

/// Below and above the pitchfork at ξ_s = 22.057 the leading eigenvalue and dis(t) give the same verdict and rate.
#[test]
fn eigenvalues_predict_how_a_disturbance_evolves() {
    for xi in [21.5, 22.4] {
        let (cortex, rest) = stationary(xi);
        let sigma = Stability::new(rest.m).growth_rate(&cortex, &rest).unwrap();
        let dis = distances(&cortex, &rest);
        assert_eq!(sigma > 0.0, dis[39] > dis[4], "ξ_s = {xi}: σ = {sigma}, dis = {dis:?}");
        // Between 10 and 20 τ only the leading mode is left, and the disturbance is still small.
        let slope = (dis[19] / dis[9]).ln() / 10.0;
        assert!((slope - sigma).abs() < 5e-3 * sigma.abs(), "ξ_s = {xi}: slope {slope}, σ = {sigma}");
    }
}
