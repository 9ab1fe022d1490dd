//! The balance at a point of a general surface against the axisymmetric balance of forces.
//!
//! On any smooth axisymmetric surface with any flow, at rest or not, the virtual power on a motion W is −∫ (F_t W_t + F_n W_n) dA, where
//! F_t and F_n are the residuals of the tangential and the normal balance, evaluated as the paper prints them, with stresses that are
//! differentiated along the contour. `law` gets the surface in skew coordinates: lines of constant φ wind around the
//! axis, so that no component of the metric or the curvature vanishes.

use std::array::from_fn;
use std::f64::consts::PI;

use furrow_cell::{Cell, Cue, Law, Numerics, RigidityGradient};
use furrow_mechanics::cortex::equations::{Constants, LocalCoefficients};
use furrow_surface::division::start;
use furrow_surface::embed::project;
use furrow_surface::law::{Contact, Flow, Place, Shape, Vector, balance, wall_force};
use furrow_surface::own::Own;
use furrow_surface::plane::Plates;
use furrow_surface::problem::Problem;
use furrow_surface::space::{Harmonic, Space};
use furrow_verification::balance::stress;
use furrow_verification::coefficients::{shell_axes, shell_force};
use furrow_verification::report::{near, within};

/// Places on the contour, θ = πu at the nodes of Chebyshev.
const PLACES: usize = 72;

fn angle(k: usize) -> f64 {
    PI * (k as f64 + 0.5) / PLACES as f64
}

/// A function of θ by its values.
type Values = [f64; PLACES];

/// Whether a function continues beyond the poles as an even or an odd one.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Even,
    Odd,
}

/// The derivative by u, of its Fourier series.
fn slope(values: &Values, kind: Kind) -> Values {
    let wave =
        |n: usize, k: usize| if kind == Kind::Even { (n as f64 * angle(k)).cos() } else { (n as f64 * angle(k)).sin() };
    let turned = |n: usize, k: usize| {
        if kind == Kind::Even { -(n as f64 * angle(k)).sin() } else { (n as f64 * angle(k)).cos() }
    };
    let mut out = [0.0; PLACES];
    // Fields are smooth: higher harmonics are rounding.
    for n in 1..PLACES * 3 / 4 {
        let share = (0..PLACES).map(|k| values[k] * wave(n, k)).sum::<f64>() * 2.0 / PLACES as f64;
        (0..PLACES).for_each(|k| out[k] += share * n as f64 * PI * turned(n, k));
    }
    out
}

/// Weights of Fejér's rule for du.
fn weights() -> Values {
    from_fn(|k| {
        let sum: f64 = (1..=PLACES / 2).map(|j| (2.0 * j as f64 * angle(k)).cos() / (4 * j * j - 1) as f64).sum();
        2.0 / PLACES as f64 * (1.0 - 2.0 * sum) / (PI * angle(k).sin())
    })
}

/// An axisymmetric vector field outwards from the axis, around it and along it.
#[derive(Clone)]
struct Field([Values; 3]);

/// How the coordinate φ winds: φ + TWIST cos θ is the angle in space.
const TWIST: f64 = 0.4;
/// The line φ that is looked at.
const LINE: f64 = 0.7;

impl Field {
    /// The field and its derivatives in skew coordinates, in the order of a [`Shape`].
    fn skew(&self) -> Vec<Shape<f64>> {
        let [first, second] = [0, 1].map(|order| -> [Values; 3] {
            from_fn(|component| {
                let kind = if component == 2 { Kind::Even } else { Kind::Odd };
                let by_u = slope(&self.0[component], kind);
                if order == 0 { by_u } else { slope(&by_u, if kind == Kind::Even { Kind::Odd } else { Kind::Even }) }
            })
        });
        let at = |k: usize| {
            let (sin, cos) = angle(k).sin_cos();
            let (twist, twist_u, twist_uu) = (TWIST * cos, -TWIST * PI * sin, -TWIST * PI * PI * cos);
            let (sin, cos) = (LINE + twist).sin_cos();
            let place = |[out, around, along]: [f64; 3]| [out * cos - around * sin, out * sin + around * cos, along];
            let value = |of: &[Values; 3]| -> [f64; 3] { from_fn(|component| of[component][k]) };
            // The derivative by the angle in space.
            let turn = |[out, around, _]: [f64; 3]| [-around, out, 0.0];
            let (f, f_u, f_uu) = (value(&self.0), value(&first), value(&second));
            let f_p = turn(f);
            let f_up = turn(f_u);
            let f_pp = turn(f_p);
            let by_u = from_fn(|i| f_u[i] + twist_u * f_p[i]);
            let by_uu =
                from_fn(|i| f_uu[i] + 2.0 * twist_u * f_up[i] + twist_uu * f_p[i] + twist_u * twist_u * f_pp[i]);
            let by_up = from_fn(|i| f_up[i] + twist_u * f_pp[i]);
            [f, by_u, f_p, by_uu, by_up, f_pp].map(place)
        };
        (0..PLACES).map(at).collect()
    }
}

/// A surface that is not at rest, with coefficients that vary.
struct Surface {
    cell: Cell,
    /// r, z and their slopes by arclength cosψ, −sinψ.
    r: Values,
    z: Values,
    cos: Values,
    sin: Values,
    /// s_u.
    speed: Values,
    /// Tangential and normal velocity.
    v: [Values; 2],
    pressure: f64,
    /// Whether [`OWN`] gives the stress.
    own: bool,
    noise: Values,
    local: Vec<LocalCoefficients<f64>>,
}

/// A0 (1 + A1 cos θ + A2 cos 2θ).
fn even([size, first, second]: [f64; 3]) -> Values {
    from_fn(|k| size * (1.0 + first * angle(k).cos() + second * (2.0 * angle(k)).cos()))
}

/// A law with all that a surface may have, as text; [`Surface::own_law`] states it again.
const OWN: &str = r#"Law(
    name: "own",
    stress_uu: "gain*(xi_s*(c1 - c2)/2/(1 + (c1 - c2)^2/9) + xi_b*C) + 0.3*eta_b*cos(r)",
    stress_phiphi: "gain*(xi_b*C - xi_s*(c1 - c2)/2/(1 + (c1 - c2)^2/9)) + 0.3*eta_b*cos(r)",
    moment: "0.2*tanh(C) - 0.1*c1*c2",
    normal_force: "0.3*friction*cos(r + 2*z) + 0.1*C",
)"#;

/// T_uu, T_φφ, moment and normal force of a law at a place.
struct Active {
    stress: [f64; 2],
    moment: f64,
    force: f64,
}

impl Surface {
    /// [`OWN`] at a place with these curvatures, without its noise.
    fn own_law(&self, k: usize, [c1, c2]: [f64; 2]) -> Active {
        let LocalCoefficients { eta_sum, eta_difference, xi_s, xi_b, friction, .. } = self.local[k];
        let d = c1 - c2;
        let (shear, even) = (0.5 * xi_s * d / (1.0 + d * d / 9.0), xi_b * (c1 + c2));
        let passive = 0.15 * (eta_sum + eta_difference) * self.r[k].cos();
        Active {
            stress: [even + shear + passive, even - shear + passive],
            moment: 0.2 * (c1 + c2).tanh() - 0.1 * c1 * c2,
            force: 0.3 * friction * (self.r[k] + 2.0 * self.z[k]).cos() + 0.1 * (c1 + c2),
        }
    }

    fn new(full: bool) -> Surface {
        let mut cell = Cell::new(1.9);
        (cell.material.spontaneous_curvature, cell.material.normal_friction) = (0.3, 0.8);
        if !full {
            cell.material.rigidity_gradient = RigidityGradient::Dropped;
        }
        let bulge = even([1.5, 0.1, -0.15]);
        let r: Values = from_fn(|k| bulge[k] * angle(k).sin());
        let z: Values =
            from_fn(|k| 1.8 * angle(k).cos() + 0.1 * (2.0 * angle(k)).cos() + 0.05 * (3.0 * angle(k)).cos());
        let (r_u, z_u) = (slope(&r, Kind::Odd), slope(&z, Kind::Even));
        let speed: Values = from_fn(|k| r_u[k].hypot(z_u[k]));
        let along = even([0.7, 0.3, -0.4]);
        let fields = [[1.2, 0.3, 0.1], [0.9, -0.2, 0.1], [0.6, 0.25, -0.1], [1.3, 0.4, 0.2], [0.4, 0.5, 0.3]];
        let [kappa, eta_b, eta_s, friction, tension] = fields.map(even);
        let [xi_s, xi_b] = [[6.0, 0.2, 0.3], [-0.8, 0.1, -0.2]].map(even);
        let kappa_u = slope(&kappa, Kind::Even);
        let local = |k: usize| LocalCoefficients {
            kappa: kappa[k],
            kappa_u: kappa_u[k],
            eta_sum: eta_b[k] + eta_s[k],
            eta_difference: eta_b[k] - eta_s[k],
            friction: friction[k],
            tension: tension[k],
            xi_s: xi_s[k],
            xi_b: xi_b[k],
            ..Constants::<f64>::new(&cell, |_, value| value).uniform
        };
        let local = (0..PLACES).map(local).collect();
        Surface {
            cos: from_fn(|k| r_u[k] / speed[k]),
            sin: from_fn(|k| -z_u[k] / speed[k]),
            v: [from_fn(|k| along[k] * angle(k).sin()), even([0.5, -0.3, 0.6])],
            pressure: 1.7,
            own: false,
            noise: even([1.1, 0.2, 0.1]),
            local,
            cell,
            r,
            z,
            speed,
        }
    }

    /// By arclength.
    fn along(&self, values: &Values, kind: Kind) -> Values {
        let by_u = slope(values, kind);
        from_fn(|k| by_u[k] / self.speed[k])
    }

    /// A field with tangential, azimuthal and normal components.
    fn field(&self, tangential: &Values, azimuthal: &Values, normal: &Values) -> Field {
        let out = from_fn(|k| tangential[k] * self.cos[k] + normal[k] * self.sin[k]);
        let along = from_fn(|k| -tangential[k] * self.sin[k] + normal[k] * self.cos[k]);
        Field([out, *azimuthal, along])
    }

    /// A wall before the point, and its pressure as S.6 has it.
    fn wall(&self, k: usize) -> (Contact, f64) {
        let (decay, distance, pressure) = (3.0, 0.15, 0.8);
        let (sin, cos) = (LINE + TWIST * angle(k).cos()).sin_cos();
        // From another place along another direction: the point has moved by (0.02, 0.01, −0.03).
        let origin = [self.r[k] * cos - 0.02, self.r[k] * sin - 0.01, self.z[k] + 0.03];
        let contact = Contact { pressure, decay, origin, normal: [0.6, 0.0, -0.8], distance };
        (contact, pressure * (decay * (2.0 * (0.02 * 0.6 + 0.03 * 0.8) - distance)).exp())
    }

    /// The residuals of the tangential and the normal balance, [tangential] and [normal] of the paper.
    fn unbalanced(&self) -> [Values; 2] {
        let [v, v_n] = &self.v;
        let c2: Values = from_fn(|k| self.sin[k] / self.r[k]);
        let cot: Values = from_fn(|k| self.cos[k] / self.r[k]);
        // ψ_s from the slopes of both sinψ and cosψ.
        let (sin_s, cos_s) = (self.along(&self.sin, Kind::Odd), self.along(&self.cos, Kind::Even));
        let c1: Values = from_fn(|k| sin_s[k] * self.cos[k] - cos_s[k] * self.sin[k]);
        let v_s = self.along(v, Kind::Odd);
        let tension = |k: usize| {
            let LocalCoefficients { eta_sum, eta_difference, xi_s, xi_b, .. } = self.local[k];
            let own = if self.own { self.own_law(k, [c1[k], c2[k]]).stress } else { [0.0; 2] };
            let built_in = if self.own { 0.0 } else { 1.0 };
            let law = [
                0.5 * (eta_sum + eta_difference),
                0.5 * (eta_sum - eta_difference),
                xi_s * self.noise[k] * built_in,
                xi_b * self.noise[k] * built_in,
            ];
            let rates = [v_s[k] + c1[k] * v_n[k], cot[k] * v[k] + c2[k] * v_n[k]];
            let rest = stress(law, rates, [c1[k], c2[k]]);
            [0, 1].map(|direction| rest[direction] + own[direction] * self.noise[k])
        };
        let [t_uu, t_pp]: [Values; 2] = [0, 1].map(|component| from_fn(|k| tension(k)[component]));
        let moment = |k: usize| if self.own { self.own_law(k, [c1[k], c2[k]]).moment } else { 0.0 };
        let bending = |k: usize| self.local[k].kappa * (c1[k] + c2[k] - self.local[k].spontaneous) + moment(k);
        let q = self.along(&from_fn(bending), Kind::Even);
        let mean_s = self.along(&from_fn(|k| c1[k] + c2[k]), Kind::Even);
        let q_s = self.along(&q, Kind::Odd);
        let t_s = self.along(&t_uu, Kind::Even);
        let [kappa_s, tension_s] = [
            self.along(&from_fn(|k| self.local[k].kappa), Kind::Even),
            self.along(&from_fn(|k| self.local[k].tension), Kind::Even),
        ];
        let gradient = if self.cell.material.rigidity_gradient == RigidityGradient::Full { 0.5 } else { 0.0 };
        let tangential = |k: usize| {
            let here = &self.local[k];
            let bending = gradient * (c1[k] + c2[k] - here.spontaneous).powi(2) * kappa_s[k];
            let own = moment(k) * mean_s[k];
            t_s[k] + cot[k] * (t_uu[k] - t_pp[k]) + bending - own + tension_s[k] - here.friction * v[k]
        };
        let normal = |k: usize| {
            let here = &self.local[k];
            let bent = c1[k] + c2[k] - here.spontaneous;
            let energy = 0.5 * here.kappa * bent * bent + here.tension;
            let elastic = |c: f64| energy - (here.kappa * bent + moment(k)) * c;
            let along = c1[k] * (elastic(c1[k]) + t_uu[k]) + c2[k] * (elastic(c2[k]) + t_pp[k]);
            let outside =
                shell_force(&self.cell, self.r[k], self.z[k], self.sin[k].atan2(self.cos[k])) - self.wall(k).1;
            let own = if self.own { self.own_law(k, [c1[k], c2[k]]).force * self.noise[k] } else { 0.0 };
            q_s[k] + cot[k] * q[k] - along + self.pressure + outside + own - self.cell.material.normal_friction * v_n[k]
        };
        [from_fn(tangential), from_fn(normal)]
    }

    /// The shape and the flow in skew coordinates, and all else at each place.
    fn told(&self) -> Vec<(Place, Shape<f64>, Flow<f64>)> {
        let zero = [0.0; PLACES];
        let shape = Field([self.r, zero, self.z]).skew();
        let flow = self.field(&self.v[0], &zero, &self.v[1]).skew();
        let shell = Constants::<f64>::new(&self.cell, |_, value| value).shell;
        let at = |(k, (x, v)): (usize, (Shape<f64>, Shape<f64>))| {
            let place = Place {
                local: self.local[k],
                shell,
                inverse_axes2: [shell.inverse_b2, shell.inverse_b2, shell.inverse_a2],
                along: [0.0; 2],
                noise: self.noise[k],
                rate: 1.7,
                past: [0.3, -0.2, 0.5],
                mesh: [0.8, -0.3, 0.6, 0.9],
                drag: 0.07,
                contact: self.wall(k).0,
            };
            (place, x, [v[0], v[1], v[2]])
        };
        shape.into_iter().zip(flow).enumerate().map(at).collect()
    }
}

fn dot(a: &Vector<f64>, b: &Vector<f64>) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Virtual motions: tangential, around the axis, and normal.
fn motions() -> Vec<[Values; 3]> {
    let zero = [0.0; PLACES];
    let sin = |n: usize| from_fn(|k| (n as f64 * angle(k)).sin());
    let cos = |n: usize| from_fn(|k| (n as f64 * angle(k)).cos());
    let of = |n: usize| [[sin(n + 1), zero, zero], [zero, sin(n + 1), zero], [zero, zero, cos(n)]];
    (0..5).flat_map(of).collect()
}

#[test]
fn the_power_of_a_general_surface_is_that_of_the_axisymmetric_balance() {
    for full in [true, false] {
        within("power", power_off(&Surface::new(full), None), 1e-9);
    }
}

/// With a law of the cell's own in place of the built-in stress, S.9.
#[test]
fn the_power_of_a_law_is_that_of_the_axisymmetric_balance() {
    let surface = Surface { own: true, ..Surface::new(true) };
    let cell = surface.cell.clone().with_law(Law::parse(OWN, "own").unwrap());
    let own = Own::of(&Constants::new(&cell, |_, value| value));
    assert!(own.is_some());
    within("power", power_off(&surface, own), 1e-9);
}

/// The largest difference of the powers of both statements.
fn power_off(surface: &Surface, own: Option<Own<f64>>) -> f64 {
    let [tangential, normal] = surface.unbalanced();
    let weights = weights();
    let area: Values = from_fn(|k| weights[k] * surface.r[k] * surface.speed[k]);
    let told = surface.told();
    let size = (0..PLACES).map(|k| area[k] * tangential[k].hypot(normal[k])).sum::<f64>();
    let mut worst: f64 = 0.0;
    for [along, around, out] in motions() {
        let moved = surface.field(&along, &around, &out).skew();
        let power = |k: usize| {
            let (place, x, v) = &told[k];
            let balance = balance(place, x, v, surface.pressure, [0.4, -0.3], own.clone().as_mut());
            weights[k] * (0..6).map(|row| dot(&balance[row], &moved[k][row])).sum::<f64>()
        };
        let expected: f64 = (0..PLACES).map(|k| -area[k] * (tangential[k] * along[k] + normal[k] * out[k])).sum();
        let found: f64 = (0..PLACES).map(power).sum();
        worst = worst.max((found - expected).abs() / size);
    }
    worst
}

/// S.4 and S.5: the normal part of the mesh's balance is (∂_tX − v)·n, the tangential part spreads the mesh.
#[test]
fn the_mesh_moves_with_the_normal_velocity_alone() {
    let surface = Surface::new(true);
    let centre = [0.4, -0.3];
    let mut worst: f64 = 0.0;
    for (k, (place, x, v)) in surface.told().iter().enumerate() {
        let balance = balance(place, x, v, surface.pressure, centre, None);
        let (sin, cos) = (LINE + TWIST * angle(k).cos()).sin_cos();
        let normal = [surface.sin[k] * cos, surface.sin[k] * sin, surface.cos[k]];
        let area = surface.r[k] * surface.speed[k];
        let moved: Vector<f64> = from_fn(|i| place.rate * x[0][i] + place.past[i]);
        let (out, [a, a_u, b, c]) = (&balance[6], place.mesh);
        worst = worst.max((dot(out, &normal) - area * (dot(&moved, &normal) - surface.v[1][k])).abs());
        let from_centre = [x[0][0] - centre[0], x[0][1], x[0][2] - centre[1]];
        let held = [c * centre[0], 0.0, 0.0];
        let spread: Vector<f64> = from_fn(|i| {
            a * x[3][i] + a_u * x[1][i] + b * (x[5][i] + from_centre[i]) - held[i] - place.drag * area * moved[i]
        });
        for tangent in &x[1..3] {
            worst = worst.max((dot(out, tangent) + dot(&spread, tangent)).abs());
        }
    }
    within("the mesh's balance", worst, 1e-9);
}

/// A mesh at rest is spread as its density says, and the weights of S.5 come from one function.
#[test]
fn a_mesh_is_spread_as_its_density_says() {
    let cell = Cell::new(2.5);
    let numerics = Numerics { modes: 1, elements: 40, ..Numerics::default() };
    let (problem, state) = start(&cell, Plates::Beside, &numerics).unwrap();
    let (speeds, length) = problem.speeds(&state.surface);
    let space = &problem.space;
    let shares = problem.mesh.shares(space);
    let found = problem.shares(&speeds, length);
    let off = shares.iter().zip(&found).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
    within("shares", off, 1e-5);
    let least = speeds.iter().copied().fold(f64::INFINITY, f64::min) / length;
    assert!(least < 0.95, "the mesh is not uniform: {least}");
    // The slope of the weight a, by Lagrange's polynomials through the places of an element.
    let stations: Vec<_> = (0..space.stations.len()).map(|q| (space.stations[q].u, problem.mesh.weights[q])).collect();
    let mut worst = 0.0f64;
    for element in stations.chunks_exact(5) {
        for (i, (u, weights)) in element.iter().enumerate() {
            let by = |j: usize| {
                let others = |i: usize| element.iter().enumerate().filter(move |(k, _)| *k != i).map(|(_, (u, _))| *u);
                if i == j {
                    return others(i).map(|other| 1.0 / (u - other)).sum::<f64>();
                }
                let product = |at: f64, of: usize, without: usize| -> f64 {
                    element
                        .iter()
                        .enumerate()
                        .filter(|(k, _)| *k != of && *k != without)
                        .map(|(_, (other, _))| at - other)
                        .product()
                };
                product(*u, i, j) / (product(element[j].0, j, j))
            };
            let slope: f64 = (0..element.len()).map(|j| by(j) * element[j].1[0]).sum();
            worst = worst.max((slope - weights[1]).abs() / (1.0 + slope.abs()));
        }
    }
    within("slope of the weights", worst, 1e-3);
}

/// A tube of radius 0.6 sin πu around an arc of radius 1 about (−1, 0, 0) in the plane y = 0, which comes back to itself but for a gap.
const GAP: f64 = 0.1;

fn tube(u: f64, phi: f64) -> Vector<f64> {
    let along = (PI - GAP) * (PI * u).cos();
    let radius = 0.6 * (PI * u).sin();
    let out = 1.0 + radius * phi.cos();
    [out * along.cos() - 1.0, radius * phi.sin(), out * along.sin()]
}

/// How far a place is from the tube, to first order.
fn from_tube(x: &Vector<f64>) -> f64 {
    let along = x[2].atan2(x[0] + 1.0) / (PI - GAP);
    let radius = 0.6 * (1.0 - along * along).max(0.0).sqrt();
    let out = (x[0] + 1.0).hypot(x[2]) - 1.0;
    out.hypot(x[1]) - radius
}

/// Walls that face each other are found where they are, with the pressure and the decay of S.6.
#[test]
fn walls_are_where_rays_meet_the_surface() {
    let cell = Cell::new(1.0);
    let space = Space::new(40, 5);
    let mut surface = vec![0.0; space.coefficients()];
    let around = 32;
    for (place, harmonic) in space.harmonics.iter().enumerate() {
        let at = |u: f64| {
            let of = |j: usize| {
                let phi = 2.0 * PI * (j as f64 + 0.5) / around as f64;
                let x = tube(u, phi);
                match *harmonic {
                    Harmonic::Across(k) => x[0] * (f64::from(k) * phi).cos() + x[1] * (f64::from(k) * phi).sin(),
                    Harmonic::Along(0) => x[2],
                    Harmonic::Along(m) => 2.0 * x[2] * (f64::from(m) * phi).cos(),
                }
            };
            [(0..around).map(of).sum::<f64>() / around as f64, 0.0]
        };
        let values: Vec<[f64; 2]> = space.stations.iter().map(|station| at(station.u)).collect();
        for (spline, [value, _]) in project(&space, place, &values).into_iter().enumerate() {
            surface[spline * space.harmonics.len() + place] = value;
        }
    }
    let walls = Problem::new(&cell, space).walls(&surface);
    let [_, b] = shell_axes(&cell);
    let softness = cell.shell.w.powi(2) * b;
    let felt: Vec<&Contact> = walls.iter().filter(|wall| wall.pressure != 0.0).collect();
    assert!(felt.len() > 20, "{} walls", felt.len());
    let mut worst = 0.0f64;
    for Contact { pressure, decay, origin, normal, distance } in &felt {
        near("pressure", *pressure, 2.0 * cell.shell.p0 / softness, 1e-12);
        near("decay", *decay, softness.recip(), 1e-12);
        worst = worst.max(from_tube(&from_fn(|i| origin[i] + distance * normal[i])).abs());
        worst = worst.max(from_tube(origin).abs());
        assert!(*distance > 0.03, "another wall: {distance}");
    }
    println!("{} walls", felt.len());
    within("walls", worst, 1e-5);
}

/// S.7: f_c = −∇(P0 exp((q − 1)/w²))·n with q = Σ x²/axis², for half axes b/√f, bf and a/√f.
#[test]
fn the_force_of_a_flattened_shell_is_the_slope_of_its_wall() {
    let mut cell = Cell::new(2.0);
    cell.shell.flattening = 0.8;
    let problem = Problem::new(&cell, Space::new(12, 2));
    let [x, y, z] = problem.inverse_axes2().map(|inverse| inverse.recip().sqrt());
    within("volume", (x * y * z * cell.epsilon / cell.r0.powi(3) - 1.0).abs(), 1e-12);
    within("thickness", (y / x - 0.8f64.powf(1.5)).abs(), 1e-12);
    within("aspect", (z / x - cell.shell.aspect).abs(), 1e-12);
    let wall = |at: Vector<f64>| {
        let reach: f64 = at.iter().zip([x, y, z]).map(|(at, axis)| (at / axis).powi(2)).sum();
        cell.shell.p0 * ((reach - 1.0) / (cell.shell.w * cell.shell.w)).exp()
    };
    let place = problem.place_at(0.5, 1.0);
    let (at, normal) = ([0.7 * x, 0.5 * y, 0.4 * z], [0.6, 0.64, 0.48]);
    let moved = |h: f64| wall([0, 1, 2].map(|k| at[k] + h * normal[k]));
    let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
    within("force", (wall_force(&place, &normal, &at, None) / -slope - 1.0).abs(), 1e-7);
    let [[x, y, z], turned] = [Plates::Beside, Plates::Across].map(|plates| plates.factors(0.8));
    assert_eq!(turned, [y, x, z]);
}

/// S.8: beside the axis a coefficient is changed as by a cue around it of a smaller amplitude.
#[test]
fn a_cue_at_one_side_is_one_around_the_axis_with_a_share_of_its_amplitude() {
    let coefficients = |amplitude: f64, side: &str| {
        let cue = format!("xi_s:band,u0=0.45,omega=0.1,amplitude={amplitude}{side}");
        let cell = Cell::new(2.0).with_cue(cue.parse::<Cue>().unwrap());
        Constants::<f64>::new(&cell, |_, value| value)
    };
    let one_sided = coefficients(0.3, ",at=0.5,spread=0.8");
    for (u, phi) in [(0.5, 0.5), (0.4, 0.6), (0.35, 1.7), (0.01, 3.0), (0.5, 0.5 + PI)] {
        let share = (2.0 * ((PI * u).sin() * (phi - 0.5f64).cos() - 1.0) / 0.64).exp();
        let found = one_sided.beside(u, phi, 7.0).xi_s;
        near("coefficient", found, coefficients(0.3 * share, "").at(u, 7.0).xi_s, 1e-12);
    }
}
