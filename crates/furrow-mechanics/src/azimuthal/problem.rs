//! The boundary-value problem of a perturbation, and one implicit step of its growth.

use furrow_bvp::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, Dimensions, Gauss, Kernels, PointJacobian, Solution,
};

use super::base::BaseConstants;
use super::equations::{
    ARC, COMPONENTS, GRADIENT, LENGTH, MOMENT, Motion, PRESSURE, REGULATED, REGULATOR, SHEAR, T11, T12, TILT, V1, V2,
    W, rates,
};
use crate::cortex::Cortex;

/// M and a, which come first, depend on the other components only; so does P, which comes last.
const QUADRATURES: usize = 2;
/// Conditions at a pole; a regulator adds one.
const CONDITIONS: usize = 5;
/// Scalar unknowns: changes of L and p.
const SCALARS: usize = 2;

/// Perturbations of one azimuthal number about one shape, changing at a given rate.
#[derive(Clone, Debug)]
pub(crate) struct Disturbance {
    m: usize,
    components: usize,
    /// The rate s of an implicit step: the surface moves by s(w − w_past).
    pub rate: f64,
    /// ∂(rates)/∂(state) of a surface at rest, at every collocation point.
    by_state: Vec<f64>,
    /// ∂(rates)/∂(L, p).
    by_scalars: Vec<f64>,
    /// ∂(rates)/∂(normal velocity, change of the regulator).
    pub by_motion: Vec<[f64; 2]>,
    /// r of the shape.
    radius: Vec<f64>,
}

impl Disturbance {
    /// Perturbations of the whole contour `y` of a cortex, at rest or in motion.
    pub fn new(cortex: &Cortex, gauss: &Gauss, y: &Solution, m: usize) -> Disturbance {
        let components = if cortex.is_regulated() { REGULATED } else { COMPONENTS };
        let mut out = Disturbance {
            m,
            components,
            rate: 0.0,
            by_state: Vec::new(),
            by_scalars: Vec::new(),
            by_motion: Vec::new(),
            radius: Vec::new(),
        };
        if components == REGULATED {
            out.tabulate::<REGULATED>(cortex, gauss, y);
        } else {
            out.tabulate::<COMPONENTS>(cortex, gauss, y);
        }
        out
    }

    fn tabulate<const N: usize>(&mut self, cortex: &Cortex, gauss: &Gauss, y: &Solution) {
        let (constants, m) = (BaseConstants::of(cortex), self.m as f64);
        for index in 0..y.intervals() * y.m {
            let (i, j) = (index / y.m, index % y.m);
            let x = y.stage_x(gauss, i, j);
            let base = constants.at(x, y.stage(i, j), &y.scalars, cortex.motion(CollocationPoint { x, index }));
            self.radius.push(base.r);
            let columns: [[f64; N]; N] = std::array::from_fn(|k| {
                let state = std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
                rates(&base, m, &state, [0.0; 2], Motion::default())
            });
            let zero = [0.0; N];
            let scalars = [[1.0, 0.0], [0.0, 1.0]].map(|p| rates(&base, m, &zero, p, Motion::default()));
            let motions = [[1.0, 0.0], [0.0, 1.0]]
                .map(|[normal, regulator]| rates(&base, m, &zero, [0.0; 2], Motion { normal, regulator }));
            for row in 0..N {
                self.by_state.extend(columns.iter().map(|column| column[row]));
                self.by_scalars.extend(scalars.iter().map(|column| column[row]));
                self.by_motion.push([motions[0][row], motions[1][row]]);
            }
        }
    }

    /// Number of components of a perturbation.
    pub fn components(&self) -> usize {
        self.components
    }

    /// Components that vanish at a pole; otherwise the solution would not be smooth there.
    fn conditions(&self) -> [&'static [usize]; 2] {
        match self.m {
            // Torsion is left out: its equations are zero.
            0 => [&[ARC, TILT, SHEAR, V1, V2, GRADIENT], &[ARC, TILT, SHEAR, V1, T12, GRADIENT]],
            // In a translation the velocity does not vanish: v1 and v2 combine to it.
            1 => [&[ARC, W, MOMENT, V1, T11, REGULATOR]; 2],
            _ => [&[ARC, W, MOMENT, V1, V2, REGULATOR]; 2],
        }
    }

    fn put_conditions(&self, right: bool, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        let n = self.components;
        let conditions = self.conditions()[usize::from(right)].iter().filter(|component| **component < n);
        for (k, &component) in conditions.enumerate() {
            out.r[k] = y[component];
            out.ry[k * n + component] = 1.0;
            if self.m == 1 && component == V1 {
                let sign = if right { -1.0 } else { 1.0 };
                out.r[k] += sign * y[V2];
                out.ry[k * n + V2] = sign;
            }
            if right && component == ARC {
                out.r[k] -= p[LENGTH];
                out.rp[k * SCALARS + LENGTH] = -1.0;
            }
        }
    }

    /// The derivatives by the state at a collocation point, for a surface that moves at the rate of the step.
    fn moving(&self, index: usize, fy: &mut [f64]) {
        let n = self.components;
        fy.copy_from_slice(&self.by_state[index * n * n..(index + 1) * n * n]);
        for (row, motion) in fy.chunks_exact_mut(n).zip(&self.by_motion[index * n..]) {
            row[W] += self.rate * motion[0];
            if let Some(by_regulator) = row.get_mut(REGULATOR) {
                *by_regulator += self.rate * motion[1];
            }
        }
    }
}

impl BoundaryValueProblem for Disturbance {
    fn dimensions(&self) -> Dimensions {
        let regulator = usize::from(self.components == REGULATED);
        Dimensions {
            components: self.components,
            quadratures: QUADRATURES,
            trailing_quadratures: regulator,
            scalars: SCALARS,
            left: CONDITIONS + regulator,
            right: CONDITIONS + regulator,
            integrals: 1,
        }
    }

    #[inline(never)]
    fn kernels(&self, stages: usize) -> Kernels {
        match (self.components, stages) {
            (COMPONENTS, 4) => Kernels::sized::<COMPONENTS, QUADRATURES, 0, 4, CONDITIONS, SCALARS, 1>(),
            _ => Kernels::general(),
        }
    }

    fn rhs(&self, at: CollocationPoint, y: &[f64], p: &[f64], f: &mut [f64], g: &mut [f64]) {
        let n = self.components;
        let (mut fy, mut fp) = ([0.0; REGULATED * REGULATED], [0.0; REGULATED * SCALARS]);
        let mut out = PointJacobian {
            f,
            fy: &mut fy[..n * n],
            fp: &mut fp[..n * SCALARS],
            g,
            gy: &mut [0.0; REGULATED][..n],
            gp: &mut [0.0; SCALARS],
        };
        self.rhs_jacobian(at, y, p, &mut out);
    }

    fn rhs_jacobian(&self, at: CollocationPoint, y: &[f64], p: &[f64], out: &mut PointJacobian<'_>) {
        let n = self.components;
        self.moving(at.index, out.fy);
        out.fp.copy_from_slice(&self.by_scalars[at.index * n * SCALARS..(at.index + 1) * n * SCALARS]);
        let rows = out.fy.chunks_exact(n).zip(out.fp.chunks_exact(SCALARS));
        for (f, (by_state, by_scalars)) in out.f.iter_mut().zip(rows) {
            *f = by_state.iter().zip(y).chain(by_scalars.iter().zip(p)).map(|(a, b)| a * b).sum();
        }
        if self.m == 0 {
            out.gy[W] = self.radius[at.index];
            out.g[0] = out.gy[W] * y[W];
        }
    }

    fn left(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        self.put_conditions(false, y, p, out);
    }

    fn right(&self, y: &[f64], p: &[f64], out: &mut BoundaryJacobian<'_>) {
        self.put_conditions(true, y, p, out);
    }

    /// For m = 0 the volume does not change; for other m the pressure does not.
    fn integral_offset(&self, _k: usize, p: &[f64], hp: &mut [f64]) -> f64 {
        if self.m == 0 {
            return 0.0;
        }
        hp[PRESSURE] = 1.0;
        p[PRESSURE]
    }
}
