//! Guesses of cycles by integration.

use furrow_bvp::VectorField;

/// Moves `y` over a time by steps of Runge and Kutta.
pub fn integrate(field: &impl VectorField, y: &mut [f64], p: &[f64], time: f64, steps: usize) {
    let h = time / steps as f64;
    let slope = |y: &[f64]| {
        let mut v = vec![0.0; y.len()];
        field.velocity(y, p, &mut v);
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
