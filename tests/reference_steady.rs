//! Stationary shapes against independent reference values.

use bvp::newton::{Newton, NewtonScratch};
use bvp::{Gauss, System};
use furrow::cortex::{Cortex, Cue, Domain, Numerics, Physics, shape};

#[test]
fn passive_shapes_exist_for_every_confinement() {
    for r0 in [0.3, 1.0, 2.0, 5.4, 12.0] {
        for k in 0..=13 {
            let epsilon = 0.3 + 0.05 * k as f64;
            let physics = Physics { epsilon, ..Physics::GAO2026 };
            let (y, report) = shape::passive(&physics, &Numerics::default(), r0)
                .unwrap_or_else(|e| panic!("R0 = {r0}, epsilon = {epsilon}: {e}"));
            let volume = 2.0 * shape::volume_until(&Gauss::new(4), &y, 0.5);
            let exact = 4.0 / 3.0 * std::f64::consts::PI * r0 * r0 * r0;
            assert!((volume / exact - 1.0).abs() < 1e-10, "{volume} {exact} {report:?}");
        }
    }
}

#[test]
fn passive_shapes_match_the_reference() {
    for (r0, epsilon, length, p, h, r_eq) in
        [(2.0, 0.87, 6.722513, 0.301232, 2.426667, 0.891849), (2.22, 0.64, 7.046685, 0.036317, 2.076229, 0.978297)]
    {
        let physics = Physics { epsilon, ..Physics::GAO2026 };
        let numerics = Numerics::default();
        let (y, _) = shape::passive(&physics, &numerics, r0).unwrap();
        let gauss = Gauss::new(numerics.stages);
        assert!((y.scalars[0] - length).abs() < 2e-6);
        assert!((y.scalars[1] - p).abs() < 2e-6);
        assert!((shape::elongation(&y, Domain::Half, r0) - h).abs() < 1e-6);
        assert!((shape::equator_radius(&gauss, &y) / r0 - r_eq).abs() < 1e-6);
    }
}

/// At R0 = 2, ε = 0.87 the symmetric branch passes ξ_s = 20.7468 with H = 2.736436 and p = 0.56647.
#[test]
fn an_active_symmetric_shape_matches_the_reference() {
    let numerics = Numerics::default();
    let (mut y, _) = shape::passive(&Physics::GAO2026, &numerics, 2.0).unwrap();
    let mut system = System::new(Cortex::dimensions_for(0), numerics.stages);
    let mut scratch = NewtonScratch::default();
    for xi_s in [5.0, 10.0, 15.0, 18.0, 20.7468] {
        let physics = Physics { xi_s, ..Physics::GAO2026 };
        let mut cortex = Cortex::new(&physics, 2.0, &Cue::None, Domain::Half, &[]);
        Newton::default().solve(&mut system, &mut scratch, &mut cortex, &mut y, &[], false).unwrap();
    }
    assert!((shape::elongation(&y, Domain::Half, 2.0) - 2.736436).abs() < 2e-6);
    assert!((y.scalars[0] / 2.0 - 3.5787).abs() < 1e-4);
    assert!((y.scalars[1] - 0.56647).abs() < 2e-4);
}
