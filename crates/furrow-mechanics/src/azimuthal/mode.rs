//! The displacements of a mode.

use furrow_bvp::Solution;

use super::equations::W;
use crate::cortex::equations::{PSI, R, REGULATED, Z};
use crate::stability::Parity;

/// One eigenmode.
#[derive(Clone, Debug)]
pub struct Mode {
    /// The azimuthal number.
    pub m: usize,
    /// Its growth rate.
    pub rate: f64,
    /// The components of [`equations`](super::equations), with the changes of (L, p), on the mesh of the whole contour.
    pub disturbance: Solution,
    /// The unperturbed shape on the whole contour.
    pub shape: Solution,
}

/// A place of the shape, and its displacement by the mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Displacement {
    /// (r, z).
    pub at: [f64; 2],
    /// The normal, as (r, z).
    pub normal: [f64; 2],
    /// Normal displacement w where cos mφ = 1.
    pub w: f64,
}

/// Shares of a mode m = 1 that move the cell as a whole, in ∫ w² dA.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rigid {
    /// A translation away from the shell's axis.
    pub translation: f64,
    /// A rotation of the cell's axis in the shell.
    pub rotation: f64,
}

impl Mode {
    /// The displacement at `count` + 1 values of u, evenly spaced from pole to pole.
    pub fn meridian(&self, count: usize) -> Vec<Displacement> {
        let gauss = self.shape.gauss();
        let (mut shape, mut mode) = ([0.0; REGULATED], [0.0; super::equations::REGULATED]);
        let mut at = |u: f64| {
            self.shape.eval(&gauss, u, &mut shape[..self.shape.components]);
            self.disturbance.eval(&gauss, u, &mut mode[..self.disturbance.components]);
            let (sin, cos) = shape[PSI].sin_cos();
            Displacement { at: [shape[R], shape[Z]], normal: [sin, cos], w: mode[W] }
        };
        (0..=count).map(|k| at(k as f64 / count as f64)).collect()
    }

    /// ∫ a b dA, up to a factor, where a and b are functions of the state at a collocation point and of w there.
    fn product(&self, a: impl Fn(&[f64], f64) -> f64, b: impl Fn(&[f64], f64) -> f64) -> f64 {
        let gauss = self.shape.gauss();
        let mut sum = 0.0;
        for i in 0..self.shape.intervals() {
            let h = self.shape.mesh[i + 1] - self.shape.mesh[i];
            for j in 0..self.shape.m {
                let (y, w) = (self.shape.stage(i, j), self.disturbance.stage(i, j)[W]);
                sum += h * gauss.b[j] * y[R] * a(y, w) * b(y, w);
            }
        }
        sum
    }

    /// The rigid shares of a mode with m = 1; `None` for other m.
    pub fn rigid(&self) -> Option<Rigid> {
        let w = |_: &[f64], w: f64| w;
        let share = |motion: fn(&[f64], f64) -> f64| {
            self.product(w, motion).powi(2) / (self.product(w, w) * self.product(motion, motion))
        };
        (self.m == 1).then(|| Rigid {
            translation: share(|y, _| y[PSI].sin()),
            rotation: share(|y, _| y[Z] * y[PSI].sin() - y[R] * y[PSI].cos()),
        })
    }

    /// The parity of w under reflection at the equator.
    pub fn parity(&self) -> Parity {
        let points = self.meridian(200);
        let (mut same, mut size) = (0.0, 0.0);
        for (here, there) in points.iter().zip(points.iter().rev()) {
            same += here.w * there.w;
            size += here.w * here.w;
        }
        match same / size {
            share if share > 1.0 - 1e-6 => Parity::Even,
            share if share < -(1.0 - 1e-6) => Parity::Odd,
            _ => Parity::Mixed,
        }
    }
}
