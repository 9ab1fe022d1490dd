//! The balance of forces in its weak form on a surface that is not axisymmetric: a shape with a little ε of a mode w cos mφ on it.
//!
//! The surface is a map X(s, φ) into space. Its metric and curvature, the rates of strain and the stresses are tensors in these
//! coordinates, computed at every point as numbers that carry their derivative by ε. What the model says of a mode, how curvature,
//! stress or the lines of the surface change, does not occur. The power of all forces on any virtual motion vanishes for every ε,
//! and so does its derivative. Bending enters as in [`virtual_power`](crate::virtual_power).

use std::f64::consts::PI;

use furrow_bvp::{Gauss, Solution};
use furrow_cell::RigidityGradient;
use furrow_mechanics::azimuthal::equations::{ARC, LENGTH, PRESSURE, REGULATOR, V1, V2, W};
use furrow_mechanics::azimuthal::mode::Mode;
use furrow_mechanics::cortex::equations as base;
use num_dual::{Dual64, DualNum, HyperDual64};

use crate::coefficients::{coefficients, shell_gradient};
use crate::contour::Computed;

/// A number and its derivative by ε.
type D = Dual64;
/// Components outwards from the axis, around it and along it.
type Vector = [D; 3];
/// Components in the coordinates (s, φ).
type Tensor = [[D; 2]; 2];

/// A function f(s) cos mφ of the surface, or sin mφ: value and derivatives by s.
type Profile = [f64; 3];

/// A virtual motion, smooth at the poles: outwards by f cos mφ, along the gradient of f cos mφ, or along the gradient of f sin mφ turned by a
/// right angle, with f = r^m cos kπu.
#[derive(Clone, Copy, Debug)]
pub enum Virtual {
    /// Along the normal.
    Outwards(u8),
    /// Along the gradient.
    Gradient(u8),
    /// Along the gradient turned by a right angle.
    Turned(u8),
}

impl Virtual {
    /// Motions for k = 0 … 4.
    pub fn all() -> Vec<Virtual> {
        (0..5).flat_map(|k| [Virtual::Outwards(k), Virtual::Gradient(k), Virtual::Turned(k)]).collect()
    }

    fn order(self) -> u8 {
        let (Virtual::Outwards(k) | Virtual::Gradient(k) | Virtual::Turned(k)) = self;
        k
    }
}

/// The virtual motion at one point: δn with first and second derivatives by (s, φ), and the components of δv with their derivatives.
#[derive(Clone, Copy, Debug, Default)]
struct Moved {
    n: f64,
    by: [f64; 2],
    by_by: [[f64; 2]; 2],
    /// δv^i.
    along: [f64; 2],
    /// ∂_jδv^i, as \[i\]\[j\].
    slope: [[f64; 2]; 2],
}

/// Powers of the forces on a virtual motion, by origin, to first order in ε, and the balance of a regulator; each sums to 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct Power {
    /// Bending, tension, viscosity, activity, friction, pressure and shell.
    pub forces: [f64; 7],
    /// The change of a regulator by rate, flow, strain, turnover and diffusion, weighted by f cos mφ.
    pub regulator: [f64; 5],
}

impl Power {
    /// The largest part.
    pub fn largest(&self) -> f64 {
        self.forces.iter().chain(&self.regulator).fold(0.0, |most, part| most.max(part.abs()))
    }

    /// The larger of both imbalances.
    pub fn imbalance(&self) -> f64 {
        self.forces.iter().sum::<f64>().abs().max(self.regulator.iter().sum::<f64>().abs())
    }
}

/// A shape at rest or in motion, and a mode of it.
#[derive(Debug)]
pub struct Displaced<'a> {
    /// The shape, the whole contour.
    pub state: &'a Computed,
    /// The mode, on the same mesh.
    pub mode: &'a Mode,
}

/// One collocation point: the shape and the mode there, with their derivatives by s.
struct Point {
    u: f64,
    /// Weight of ds.
    ds: f64,
    shape: Vec<f64>,
    shape_s: Vec<f64>,
    mode: Vec<f64>,
    mode_s: Vec<f64>,
    v_n: f64,
    /// c1 and its derivative.
    bend: [f64; 2],
    /// w_ss.
    w_ss: f64,
}

/// The displaced surface at one point.
struct Surface {
    first: [Vector; 2],
    metric: Tensor,
    inverse: Tensor,
    /// √g.
    area: D,
    normal: Vector,
    /// C_ij.
    curvature: Tensor,
    /// ∂_k g_ij as \[i\]\[j\]\[k\].
    metric_by: [[[D; 2]; 2]; 2],
    second: [[Vector; 2]; 2],
}

fn dot(a: &Vector, b: &Vector) -> D {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn pairs(f: impl Fn(usize, usize) -> D) -> Tensor {
    std::array::from_fn(|i| std::array::from_fn(|j| f(i, j)))
}

/// a^ij b_ij.
fn contracted(a: &Tensor, b: &Tensor) -> D {
    (0..4).map(|k| a[k / 2][k % 2] * b[k / 2][k % 2]).sum()
}

impl Surface {
    /// From the distance R from the axis and the height Z: value and derivatives by s, φ, ss, sφ, φφ.
    fn new(r: [D; 6], z: [D; 6]) -> Surface {
        let zero = D::from(0.0);
        let first = [[r[1], zero, z[1]], [r[2], r[0], z[2]]];
        let across = [r[4], r[1], z[4]];
        let second = [[[r[3], zero, z[3]], across], [across, [r[5] - r[0], r[2] * 2.0, z[5]]]];
        let metric = pairs(|i, j| dot(&first[i], &first[j]));
        let determinant = metric[0][0] * metric[1][1] - metric[0][1] * metric[1][0];
        let inverse = [
            [metric[1][1] / determinant, -metric[0][1] / determinant],
            [-metric[1][0] / determinant, metric[0][0] / determinant],
        ];
        let area = determinant.sqrt();
        let normal = cross(&first[0], &first[1]).map(|part| part / area);
        let curvature = pairs(|i, j| -dot(&normal, &second[i][j]));
        let by = |i: usize, j: usize, k: usize| dot(&second[i][k], &first[j]) + dot(&first[i], &second[j][k]);
        let metric_by = std::array::from_fn(|i| std::array::from_fn(|j| std::array::from_fn(|k| by(i, j, k))));
        Surface { first, metric, inverse, area, normal, curvature, metric_by, second }
    }

    /// t^ij of t_ij.
    fn raised(&self, t: &Tensor) -> Tensor {
        let g = &self.inverse;
        pairs(|i, j| (0..4).map(|k| g[i][k / 2] * g[j][k % 2] * t[k / 2][k % 2]).sum())
    }

    /// The rate of strain of a flow v^i with derivatives \[i\]\[j\], and of the normal velocity v_n.
    fn strain(&self, v: [D; 2], slope: [[D; 2]; 2], v_n: D) -> Tensor {
        pairs(|i, j| {
            let carried: D = (0..2).map(|k| v[k] * self.metric_by[i][j][k]).sum();
            let stretched: D = (0..2).map(|k| self.metric[k][j] * slope[k][i] + self.metric[i][k] * slope[k][j]).sum();
            (carried + stretched) * 0.5 + self.curvature[i][j] * v_n
        })
    }

    /// The Laplacian of a function with given derivatives.
    fn laplacian(&self, by: [f64; 2], by_by: [[f64; 2]; 2]) -> D {
        let along: Tensor = pairs(|i, j| {
            let bent: D = (0..4)
                .map(|k| self.inverse[k / 2][k % 2] * dot(&self.second[i][j], &self.first[k % 2]) * by[k / 2])
                .sum();
            -bent + by_by[i][j]
        });
        contracted(&self.inverse, &along)
    }

    /// Length of a line of coordinate i, and its derivatives.
    fn length(&self, i: usize) -> (D, [D; 2]) {
        let length = self.metric[i][i].sqrt();
        (length, [0, 1].map(|k| self.metric_by[i][i][k] / (length * 2.0)))
    }
}

impl Displaced<'_> {
    /// The power of all forces on each virtual motion.
    pub fn powers(&self, motions: &[Virtual]) -> Vec<Power> {
        let gauss = self.state.shape.gauss();
        let mut out = vec![Power::default(); motions.len()];
        let angles = 2 * self.mode.m + 3;
        for k in 0..self.state.shape.intervals() * self.state.shape.m {
            let point = self.point(&gauss, k);
            for angle in 0..angles {
                let phi = (angle as f64 + 0.3) * 2.0 * PI / angles as f64;
                self.add(&point, phi, 2.0 * PI / angles as f64, motions, &mut out);
            }
        }
        out
    }

    /// How far a_s is from the stretching of the meridian, at the worst place.
    pub fn arclength_error(&self) -> f64 {
        let gauss = self.state.shape.gauss();
        let points = (0..self.state.shape.intervals() * self.state.shape.m).map(|k| self.point(&gauss, k));
        let error = |point: Point| (point.mode_s[ARC] - self.surface(&point, 0.0, 1.0).length(0).0.eps).abs();
        points.map(error).fold(0.0, f64::max)
    }

    fn point(&self, gauss: &Gauss, k: usize) -> Point {
        let (y, x) = (&self.state.shape, &self.mode.disturbance);
        let (i, j, length) = (k / y.m, k % y.m, self.state.length());
        let slope = |y: &Solution| {
            let mut slope = vec![0.0; y.components];
            y.slope_in(gauss, i, gauss.c[j], &mut slope);
            slope.iter_mut().for_each(|by_u| *by_u /= length);
            slope
        };
        let (shape, shape_s, mode, mode_s) = (y.stage(i, j).to_vec(), slope(y), x.stage(i, j).to_vec(), slope(x));
        let u = y.stage_x(gauss, i, j);
        let carried = (y.components > base::COMPONENTS).then(|| [shape[base::PHI], shape[base::J] * length]);
        let here = coefficients(&self.state.cell, u, length, carried);
        let (sin, cos) = shape[base::PSI].sin_cos();
        let [c1, c2] = [shape_s[base::PSI], sin / shape[base::R]];
        // From κ(C − C0) = m.
        let c1_s = (shape_s[base::M] - (c1 + c2 - here.spontaneous) * here.kappa_s) / here.kappa
            - cos / shape[base::R] * (c1 - c2);
        let [r_t, z_t] = self.state.motion.get(k).copied().unwrap_or_default();
        Point {
            u,
            ds: length * (y.mesh[i + 1] - y.mesh[i]) * gauss.b[j],
            w_ss: mode_s[furrow_mechanics::azimuthal::equations::TILT],
            v_n: sin * r_t + cos * z_t,
            bend: [c1, c1_s],
            shape,
            shape_s,
            mode,
            mode_s,
        }
    }

    fn add(&self, point: &Point, phi: f64, dphi: f64, motions: &[Virtual], out: &mut [Power]) {
        let m = self.mode.m as f64;
        let (sin_m, cos_m) = (m * phi).sin_cos();
        let surface = self.surface(point, sin_m, cos_m);
        let epsilon = D::new(0.0, 1.0);
        let (x, x_s) = (&point.mode, &point.mode_s);
        // Velocities along the lines of the surface, as components in its coordinates.
        let ((a, a_by), (b, b_by)) = (surface.length(0), surface.length(1));
        let v1 = epsilon * (x[V1] * cos_m) + point.shape[base::V];
        let v1_by = [epsilon * (x_s[V1] * cos_m) + point.shape_s[base::V], epsilon * (-m * x[V1] * sin_m)];
        let v2 = epsilon * (x[V2] * sin_m);
        let v2_by = [epsilon * (x_s[V2] * sin_m), epsilon * (m * x[V2] * cos_m)];
        let v = [v1 / a, v2 / b];
        let slope = [[0, 1].map(|k| (v1_by[k] - v[0] * a_by[k]) / a), [0, 1].map(|k| (v2_by[k] - v[1] * b_by[k]) / b)];
        let v_n = epsilon * (self.mode.rate * x[W] * cos_m) + point.v_n;
        let strain = surface.strain(v, slope, v_n);
        let local = self.local(point, sin_m, cos_m);
        let forces = Forces { surface: &surface, strain, v, v_n, local };
        let weight = point.ds * dphi;
        for (motion, out) in motions.iter().zip(out) {
            let moved = virtual_motion(point, *motion, m, [sin_m, cos_m], self.state.length());
            for (sum, part) in out.forces.iter_mut().zip(forces.powers(self, &moved, cos_m, point)) {
                *sum += weight * (part * surface.area).eps;
            }
            if let (Some(regulator), Virtual::Outwards(_)) = (self.state.cell.cue.regulator(), motion) {
                let constants = [regulator.diffusion, regulator.turnover, if regulator.diluted { 1.0 } else { 0.0 }];
                let parts = forces.regulator(point, &moved, [sin_m, cos_m], [m, self.mode.rate], constants);
                for (sum, part) in out.regulator.iter_mut().zip(parts) {
                    *sum += weight * (part * surface.area).eps;
                }
            }
        }
    }

    /// The surface, each point moved along the normal of the shape.
    fn surface(&self, point: &Point, sin_m: f64, cos_m: f64) -> Surface {
        let (y, m) = (&point.shape, self.mode.m as f64);
        let (sin, cos) = y[base::PSI].sin_cos();
        let ([c1, c1_s], [w, w_s, w_ss]) = (point.bend, [point.mode[W], point.mode_s[W], point.w_ss]);
        // The shape, and w n, for the parts (outwards, up): (e_s, n) = ((cos, sin), (−sin, cos)).
        let part = |value: f64, e: f64, n: f64| {
            let moved = w * n;
            let moved_s = w_s * n + w * c1 * e;
            let moved_ss = w_ss * n + 2.0 * w_s * c1 * e + w * (c1_s * e - c1 * c1 * n);
            let small = |value: f64, change: f64| D::new(value, change);
            [
                small(value, moved * cos_m),
                small(e, moved_s * cos_m),
                small(0.0, -m * moved * sin_m),
                small(-c1 * n, moved_ss * cos_m),
                small(0.0, -m * moved_s * sin_m),
                small(0.0, -m * m * moved * cos_m),
            ]
        };
        Surface::new(part(y[base::R], cos, sin), part(y[base::Z], -sin, cos))
    }

    /// The coefficients there, and κ and γ with their derivatives by s and φ.
    fn local(&self, point: &Point, sin_m: f64, cos_m: f64) -> Local {
        let (m, length) = (self.mode.m as f64, self.state.length());
        let longer = self.mode.disturbance.scalars[LENGTH];
        let (x, x_s, y) = (&point.mode, &point.mode_s, &point.shape);
        let along = [0, 1].map(|k| {
            // A small step in s or in φ.
            let number = |value: f64, step: [f64; 2], change: f64, step_of_change: [f64; 2]| {
                HyperDual64::new(value, change, step[k], step_of_change[k])
            };
            let of_mode = |value: f64, slope: f64| (value * cos_m, [slope * cos_m, -m * value * sin_m]);
            let (arc, arc_by) = of_mode(x[ARC], x_s[ARC]);
            let (whole, whole_by) = of_mode(longer, 0.0);
            let whole = number(length, [0.0; 2], whole, whole_by);
            let u = number(point.u * length, [1.0, 0.0], arc, arc_by) / whole;
            let carried = (y.len() > base::COMPONENTS).then(|| {
                let (change, change_by) = of_mode(x[REGULATOR], x_s[REGULATOR]);
                // The gradient enters no coefficient, only their derivatives, which are taken here.
                [number(y[base::PHI], [y[base::J], 0.0], change, change_by), HyperDual64::from(0.0)]
            });
            coefficients(&self.state.cell, u, whole, carried)
        });
        let value = |h: HyperDual64| D::new(h.re, h.eps1);
        let by = |h: [HyperDual64; 2]| h.map(|h| D::new(h.eps2, h.eps1eps2));
        let here = &along[0];
        Local {
            kappa: value(here.kappa),
            kappa_by: by([along[0].kappa, along[1].kappa]),
            eta_b: value(here.eta_b),
            eta_s: value(here.eta_s),
            friction: value(here.friction),
            tension: value(here.tension),
            xi_s: value(here.xi_s),
            xi_b: value(here.xi_b),
            source: value(here.source),
            spontaneous: value(here.spontaneous),
        }
    }
}

struct Local {
    kappa: D,
    kappa_by: [D; 2],
    eta_b: D,
    eta_s: D,
    friction: D,
    tension: D,
    xi_s: D,
    xi_b: D,
    source: D,
    spontaneous: D,
}

struct Forces<'a> {
    surface: &'a Surface,
    strain: Tensor,
    v: [D; 2],
    v_n: D,
    local: Local,
}

impl Forces<'_> {
    /// Per area: bending, tension, viscosity, activity, friction, pressure and shell.
    fn powers(&self, of: &Displaced<'_>, moved: &Moved, cos_m: f64, point: &Point) -> [D; 7] {
        let Forces { surface, strain, v, local, .. } = self;
        let number = |x: f64| D::from(x);
        let virtual_strain =
            surface.strain(moved.along.map(number), moved.slope.map(|row| row.map(number)), number(moved.n));
        let traced = |t: &Tensor| contracted(&surface.inverse, t);
        let mean = traced(&surface.curvature);
        let bent = mean - local.spontaneous;
        let squared = contracted(&surface.raised(&surface.curvature), &surface.curvature);
        let laplacian = surface.laplacian(moved.by, moved.by_by);
        let mut bending =
            local.kappa * bent * (-laplacian - squared * moved.n) + local.kappa * bent * bent * mean * 0.5 * moved.n;
        if of.state.cell.material.rigidity_gradient == RigidityGradient::Full {
            let carried: D = (0..2).map(|k| local.kappa_by[k] * moved.along[k]).sum();
            bending -= bent * bent * carried * 0.5;
        }
        let stretched = traced(&virtual_strain);
        let tension = local.tension * stretched;
        let on = |t: Tensor| contracted(&surface.raised(&t), &virtual_strain);
        let rate = traced(strain);
        let viscous = on(pairs(|i, j| {
            (local.eta_b - local.eta_s) * rate * surface.metric[i][j] + local.eta_s * strain[i][j] * 2.0
        }));
        let active = on(pairs(|i, j| {
            let deviator = surface.curvature[i][j] - mean * surface.metric[i][j] * 0.5;
            local.xi_s * deviator + local.xi_b * mean * surface.metric[i][j]
        }));
        let slipped: D = (0..4).map(|k| surface.metric[k / 2][k % 2] * v[k / 2] * moved.along[k % 2]).sum();
        let pressure = D::new(of.state.pressure(), of.mode.disturbance.scalars[PRESSURE] * cos_m);
        let shell = self.shell(of, point, cos_m) * moved.n;
        let friction = local.friction * slipped + self.v_n * (of.state.cell.material.normal_friction * moved.n);
        [bending, tension, viscous, active, friction, -pressure * moved.n, shell]
    }

    /// n·∇U at the displaced point.
    fn shell(&self, of: &Displaced<'_>, point: &Point, cos_m: f64) -> D {
        let cell = &of.state.cell;
        let (sin, cos) = point.shape[base::PSI].sin_cos();
        let moved = point.mode[W] * cos_m;
        let r = D::new(point.shape[base::R], moved * sin);
        let z = D::new(point.shape[base::Z], moved * cos);
        let [by_r, by_z] = shell_gradient(cell, r, z);
        let [outwards, _, up] = self.surface.normal;
        by_r * outwards + by_z * up
    }

    /// Per area, weighed by δn: rate, flow, strain, turnover, diffusion.
    fn regulator(
        &self,
        point: &Point,
        moved: &Moved,
        [sin_m, cos_m]: [f64; 2],
        [m, sigma]: [f64; 2],
        [diffusion, turnover, dilution]: [f64; 3],
    ) -> [D; 5] {
        let change = point.mode[REGULATOR];
        let phi = D::new(point.shape[base::PHI], change * cos_m);
        let by = [D::new(point.shape[base::J], point.mode_s[REGULATOR] * cos_m), D::new(0.0, -m * change * sin_m)];
        let flow: D = (0..2).map(|k| self.v[k] * by[k]).sum();
        let strain = contracted(&self.surface.inverse, &self.strain);
        let spread: D = (0..4).map(|k| self.surface.inverse[k / 2][k % 2] * by[k / 2] * moved.by[k % 2]).sum();
        [
            D::new(0.0, sigma * change * cos_m) * moved.n,
            flow * moved.n,
            (phi + 1.0) * strain * dilution * moved.n,
            (phi - self.local.source) * turnover * moved.n,
            spread * diffusion,
        ]
    }
}

/// f = r^m cos kπu and its derivatives by s.
fn profile(point: &Point, k: u8, m: f64, length: f64) -> Profile {
    let (sin, cos) = point.shape[base::PSI].sin_cos();
    let (r, n) = (point.shape[base::R], f64::from(k) * PI / length);
    let (p_sin, p) = (n * length * point.u).sin_cos();
    let [p, p_s, p_ss] = [p, -n * p_sin, -n * n * p];
    let power = [r.powf(m), m * r.powf(m - 1.0), m * (m - 1.0) * r.powf(m - 2.0)];
    let (r_s, r_ss) = (cos, -sin * point.bend[0]);
    [
        power[0] * p,
        power[1] * r_s * p + power[0] * p_s,
        (power[2] * r_s * r_s + power[1] * r_ss) * p + 2.0 * power[1] * r_s * p_s + power[0] * p_ss,
    ]
}

fn virtual_motion(point: &Point, motion: Virtual, m: f64, [sin_m, cos_m]: [f64; 2], length: f64) -> Moved {
    let [f, f_s, f_ss] = profile(point, motion.order(), m, length);
    let (r, r_s) = (point.shape[base::R], point.shape[base::PSI].cos());
    match motion {
        Virtual::Outwards(_) => Moved {
            n: f * cos_m,
            by: [f_s * cos_m, -m * f * sin_m],
            by_by: [[f_ss * cos_m, -m * f_s * sin_m], [-m * f_s * sin_m, -m * m * f * cos_m]],
            ..Moved::default()
        },
        Virtual::Gradient(_) => {
            let around = [-m * f / (r * r), -m * (f_s - 2.0 * r_s * f / r) / (r * r)];
            Moved {
                along: [f_s * cos_m, around[0] * sin_m],
                slope: [[f_ss * cos_m, -m * f_s * sin_m], [around[1] * sin_m, m * around[0] * cos_m]],
                ..Moved::default()
            }
        }
        Virtual::Turned(_) => {
            let along = [m * f / r, m * (f_s - f * r_s / r) / r];
            let around = [-f_s / r, -(f_ss - f_s * r_s / r) / r];
            Moved {
                along: [along[0] * cos_m, around[0] * sin_m],
                slope: [[along[1] * cos_m, -m * along[0] * sin_m], [around[1] * sin_m, m * around[0] * cos_m]],
                ..Moved::default()
            }
        }
    }
}
