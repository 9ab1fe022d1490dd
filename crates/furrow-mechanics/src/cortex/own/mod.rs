//! The force balance of a cell with a law of active stress of its own, for any number type.
//!
//! A law gives the active stress T^a, an isotropic active moment M^a and a force f^a along the outward normal. With
//! m = κ(C − C0) + M^a and T the whole dissipative tension, the equations are those of [`equations`](mod@super::equations) without activity
//! for m − M^a and T − T^a_uu, and
//!
//! * \[M.28 own law, normal\] q_s gains c1 T^a_uu + c2 T^a_φφ − M^a (c1² + c2²) − f^a
//! * \[M.29 own law, tangential\] T_s gains −(cosψ/r)(T^a_uu − T^a_φφ) + M^a ∂_sC
//!
//! The power of the moment is M^a times the rate of C, from which the tension −M^a C^ij follows; M.28 and M.29 include it.
//!
//! The stress may depend on the rates of strain. S_uu then solves (η_b + η_s) S_uu + (η_b − η_s) S_φφ + T^a_uu = T at each
//! place, by Newton's method in numbers that carry the derivatives asked for.

pub(crate) mod points;
pub(crate) mod shell;

use furrow_cell::law::{Active, Algebra, LawValues, VARIABLES, Variable};

use super::equations::{self, Balance, BdfTerm, COMPONENTS, LocalCoefficients, Q, ShellCoefficients, T};
use super::jets::Jet;
use super::lanes::{Arithmetic, Lane};

/// Numbers in which cells with a law of their own are evaluated.
pub(crate) trait Lawful: Arithmetic + Algebra {}

impl<D: Arithmetic + Algebra> Lawful for D {}

/// A law for derivatives along one quantity, with all other derivatives and without.
type Jets<D> = (LawValues<Jet<D>>, LawValues<Jet<Lane>>);

/// A law, its form for derivatives along one quantity, and working memory.
pub(crate) struct Prepared<D> {
    law: LawValues<D>,
    /// Only of laws that depend on the rates of strain, or have a moment: for slopes, and without other derivatives.
    jets: Option<Jets<D>>,
    /// The highest derivatives that the numbers carry.
    order: usize,
    memory: Vec<D>,
    jet_memory: (Vec<Jet<D>>, Vec<Jet<Lane>>),
}

impl<D: Lawful> Prepared<D> {
    /// A law in numbers with derivatives up to an order.
    pub fn of(law: &LawValues<D>, order: usize) -> Prepared<D> {
        let jets = (law.viscous || law.bends).then(|| (law.map(still), law.map(|value| still(Lane(value.real())))));
        Prepared { law: law.clone(), jets, order, memory: Vec::new(), jet_memory: Default::default() }
    }
}

/// The inputs of the balance at one place besides its state.
#[derive(Clone, Copy)]
pub(crate) struct Spot<D> {
    /// The place u.
    pub u: f64,
    /// The regulator φ and its gradient j; 0 without one.
    pub carried: [D; 2],
    /// Factor on stress and normal force.
    pub noise: D,
}

/// Most iterations for a quantity that a law gives implicitly.
const ITERATIONS: usize = 40;

/// Solves for a quantity by the value and the slope of its equation; NaN where the slope is not positive.
fn solved(mut x: f64, scale: f64, mut equation: impl FnMut(Lane) -> Jet<Lane>) -> f64 {
    for _ in 0..ITERATIONS {
        let Jet { value, slope } = equation(Lane(x));
        let step = value.0 / slope.0;
        x -= step;
        // With the wrong sign there is no shape; NaN stops the solver.
        if slope.0 <= 0.0 || !step.is_finite() {
            return f64::NAN;
        }
        if step.abs() <= 1e-13 * (scale + x.abs()) {
            return x;
        }
    }
    f64::NAN
}

/// The solution with its derivatives, from its number: each step of Newton's method in numbers that carry derivatives at least
/// doubles the order of those that are right.
fn lifted<D: Lawful>(x: f64, order: usize, mut equation: impl FnMut(D) -> Jet<D>) -> D {
    let mut lifted = D::from(x);
    let mut right = 0;
    while right < order {
        let Jet { value, slope } = equation(lifted);
        lifted = lifted - value / slope;
        right = 2 * right + 1;
    }
    lifted
}

/// The quantities of a place that a law may use, with the curvature C still 0 and S_uu too.
fn quantities<D: Lawful>(
    law: &LawValues<D>,
    here: &LocalCoefficients<D>,
    spot: &Spot<D>,
    [r, z, c2, s_phi]: [D; 4],
    length: D,
) -> [D; VARIABLES] {
    let half = |a: D| a * 0.5;
    let [u, s] = law.along(spot.u, length);
    let zero = D::from(0.0);
    let [eta_b, eta_s] = [half(here.eta_sum + here.eta_difference), half(here.eta_sum - here.eta_difference)];
    let [xi_s, xi_b] = [here.xi_s, here.xi_b].map(|x| x / law.gain());
    let phi = spot.carried[1];
    let (kappa, friction, tension) = (here.kappa, here.friction, here.tension);
    [zero, c2, zero, u, s, r, zero, s_phi, phi, kappa, eta_b, eta_s, friction, tension, xi_s, xi_b, law.height(z)]
}

/// A number with the slope 0.
fn still<D: Lawful>(value: D) -> Jet<D> {
    Jet { value, slope: D::from(0.0) }
}

/// The index of a quantity.
const fn at(variable: Variable) -> usize {
    variable as usize
}

/// Sets C, and c1 with it.
fn bend<D: Lawful>(place: &mut [D; VARIABLES], mean: D) {
    place[at(Variable::C)] = mean;
    place[at(Variable::C1)] = mean - place[at(Variable::C2)];
}

/// The slopes of C and c1 by C.
fn bending<D: Lawful>() -> [(Variable, D); 2] {
    [Variable::C1, Variable::C].map(|variable| (variable, D::from(1.0)))
}

/// The slope of S_uu.
fn along<D>(slope: D) -> (Variable, D) {
    (Variable::Suu, slope)
}

/// Quantities with slopes, 0 of those that are not listed.
fn with_slopes<D: Lawful>(place: &[D; VARIABLES], of: &[(Variable, D)]) -> [Jet<D>; VARIABLES] {
    let mut jets = place.map(still);
    for (variable, slope) in of {
        jets[at(*variable)].slope = *slope;
    }
    jets
}

impl<D: Lawful> Prepared<D> {
    /// Finds C = (m − M^a)/κ + C0, sets it, and returns M^a and ∂_sC.
    fn moment(
        &mut self,
        place: &mut [D; VARIABLES],
        here: &LocalCoefficients<D>,
        [m, q, sin, cos, j]: [D; 5],
        length: D,
    ) -> [D; 2] {
        let zero = D::from(0.0);
        bend(place, here.mean(m));
        let Some((jets, plain)) = self.jets.as_ref().filter(|_| self.law.bends) else { return [zero; 2] };
        let (memory, plain_memory) = (&mut self.jet_memory.0, &mut self.jet_memory.1);
        let [by_bend, varies] = self.law.moment;
        let (moment, by_mean) = if by_bend {
            let scale = place[at(Variable::C)].real().abs() + 1e-3;
            let (mut trial, mut real) = (*place, place.map(|x| Lane(x.real())));
            let flat = m + here.kappa * here.spontaneous;
            let (kappa, of_moment) = (Lane(here.kappa.real()), Lane(flat.real()));
            let mean = solved(place[at(Variable::C)].real(), scale, |mean| {
                bend(&mut real, mean);
                let Jet { value, slope } = plain.moment(&with_slopes(&real, &bending()), plain_memory);
                Jet { value: kappa * mean + value - of_moment, slope: kappa + slope }
            });
            let mean = lifted(mean, self.order, |mean| {
                bend(&mut trial, mean);
                let Jet { value, slope } = jets.moment(&with_slopes(&trial, &bending()), memory);
                Jet { value: here.kappa * mean + value - flat, slope: here.kappa + slope }
            });
            bend(place, mean);
            let Jet { value, slope } = jets.moment(&with_slopes(place, &bending()), memory);
            (value, slope)
        } else {
            let moment = self.law.moment(place, &mut self.memory);
            bend(place, here.mean(m - moment));
            (moment, zero)
        };
        let bent = place[at(Variable::C)] - here.spontaneous;
        if !varies {
            return [moment, (q - here.kappa_u / length * bent) / here.kappa];
        }
        // ∂_sM^a if C stayed the same, and from q = ∂_s[κ(C − C0) + M^a] the slope of C.
        let cot = cos / place[at(Variable::R)];
        let turned = cot * (place[at(Variable::C1)] - place[at(Variable::C2)]);
        let ahead = self.law.direction();
        let slopes = [
            (Variable::C1, -turned),
            (Variable::C2, turned),
            (Variable::U, D::from(ahead) / length),
            (Variable::S, D::from(ahead)),
            (Variable::R, cos),
            (Variable::Z, -sin * ahead),
            (Variable::Phi, j),
        ];
        let unbent = jets.moment(&with_slopes(place, &slopes), memory).slope;
        let mean_s = (q - here.kappa_u / length * bent - unbent) / (here.kappa + by_mean);
        [moment, mean_s]
    }

    /// Everything else that the law gives; of a law with rates of strain, S_uu is found first.
    fn stress(&mut self, place: &mut [D; VARIABLES], here: &LocalCoefficients<D>, noise: D, tension: D) -> Active<D> {
        if self.law.viscous
            && let Some((jets, plain)) = &self.jets
        {
            let s_phi = place[at(Variable::Sphiphi)];
            let start = (tension - here.eta_difference * s_phi) / here.eta_sum;
            let (memory, plain_memory) = (&mut self.jet_memory.0, &mut self.jet_memory.1);
            let (mut trial, mut real) = (*place, place.map(|x| Lane(x.real())));
            let [sum, rest, factor] =
                [here.eta_sum, here.eta_difference * s_phi - tension, noise].map(|x| Lane(x.real()));
            let s_u = solved(start.real(), start.real().abs() + 1e-3, |s_u| {
                real[at(Variable::Suu)] = s_u;
                let Jet { value, slope } = plain.stress_uu(&with_slopes(&real, &[along(Lane(1.0))]), plain_memory);
                Jet { value: sum * s_u + rest + value * factor, slope: sum + slope * factor }
            });
            place[at(Variable::Suu)] = lifted(s_u, self.order, |s_u| {
                trial[at(Variable::Suu)] = s_u;
                let Jet { value, slope } = jets.stress_uu(&with_slopes(&trial, &[along(D::from(1.0))]), memory);
                let value = here.eta_sum * s_u + here.eta_difference * s_phi + value * noise - tension;
                Jet { value, slope: here.eta_sum + slope * noise }
            });
        }
        self.law.at(place, &mut self.memory)
    }

    /// The force balances at one place.
    pub fn balances(
        &mut self,
        c: &ShellCoefficients<D>,
        here: &LocalCoefficients<D>,
        spot: &Spot<D>,
        motion: BdfTerm<D>,
        y: &[D; COMPONENTS],
        length: D,
        pressure: D,
    ) -> Balance<D> {
        let [r, z, m, psi, q, v, t] = *y;
        let (sin, cos) = psi.sin_cos();
        let inverse_r = r.recip();
        let (c2, cot) = (sin * inverse_r, cos * inverse_r);
        let v_n = (sin * (r - motion.r_past) + cos * (z - motion.z_past)) * motion.rate;
        let s_phi = cot * v + c2 * v_n;
        let mut place = quantities(&self.law, here, spot, [r, z, c2, s_phi], length);
        let [moment, mean_s] = self.moment(&mut place, here, [m, q, sin, cos, spot.carried[0]], length);
        let Active { stress, normal_force, .. } = self.stress(&mut place, here, spot.noise, t);
        let [t_uu, t_phi] = stress.map(|stress| stress * spot.noise);
        let zero = D::from(0.0);
        let passive = LocalCoefficients { xi_s: zero, xi_b: zero, ..*here };
        let state = [r, z, m - moment, psi, q, v, t - t_uu];
        let mut balance = equations::balances(c, &passive, motion, D::from(1.0), &state, length, pressure);
        let (c1, c2) = (balance.place.c1, balance.place.c2);
        let pushed = c1 * t_uu + c2 * t_phi - moment * (c1 * c1 + c2 * c2) - normal_force * spot.noise;
        balance.f[Q] = balance.f[Q] + length * pushed;
        balance.f[T] = balance.f[T] + length * (moment * mean_s - cot * (t_uu - t_phi));
        balance.place.t_phi = balance.place.t_phi + t_phi;
        balance
    }

    /// The law's values in a state away from the axis, with C and ∂_sC; stress and force include the noise.
    pub fn active(
        &mut self,
        here: &LocalCoefficients<D>,
        spot: &Spot<D>,
        y: &[D; COMPONENTS],
        [v_n, length]: [D; 2],
    ) -> (Active<D>, [D; 2]) {
        let [r, z, m, psi, q, v, t] = *y;
        let (sin, cos) = psi.sin_cos();
        let c2 = sin / r;
        let mut place = quantities(&self.law, here, spot, [r, z, c2, cos / r * v + c2 * v_n], length);
        let [moment, mean_s] = self.moment(&mut place, here, [m, q, sin, cos, spot.carried[0]], length);
        let Active { stress, normal_force, .. } = self.stress(&mut place, here, spot.noise, t);
        let stress = stress.map(|stress| stress * spot.noise);
        (Active { stress, moment, normal_force: normal_force * spot.noise }, [place[at(Variable::C)], mean_s])
    }

    /// What decides whether the shortest waves decay: κ + ∂M^a/∂C, and the viscosities along and, at given T_uu, around the contour,
    /// 1 and the material's own coefficients without a law.
    pub fn moduli(
        &mut self,
        here: &LocalCoefficients<D>,
        spot: &Spot<D>,
        y: &[D; COMPONENTS],
        [v_n, length]: [D; 2],
    ) -> [D; 3] {
        let [r, z, m, psi, q, v, t] = *y;
        let (sin, cos) = psi.sin_cos();
        let c2 = sin / r;
        let s_phi = cos / r * v + c2 * v_n;
        let mut place = quantities(&self.law, here, spot, [r, z, c2, s_phi], length);
        self.moment(&mut place, here, [m, q, sin, cos, spot.carried[0]], length);
        self.stress(&mut place, here, spot.noise, t);
        let Some((jets, _)) = &self.jets else { return [here.kappa, here.eta_sum, here.eta_sum] };
        let one = D::from(1.0);
        // Where no rate of strain gives this tension, the law is looked at without flow.
        if !place[at(Variable::Suu)].real().is_finite() {
            place[at(Variable::Suu)] = D::from(0.0);
        }
        if !place[at(Variable::C)].real().is_finite() {
            bend(&mut place, here.mean(m));
        }
        let memory = &mut self.jet_memory.0;
        let mut slopes = |of: &[Variable]| {
            let of: Vec<(Variable, D)> = of.iter().map(|variable| (*variable, one)).collect();
            jets.at(&with_slopes(&place, &of), memory)
        };
        let bent = slopes(&[Variable::C1, Variable::C]).moment.slope;
        let [along, across] =
            [Variable::Suu, Variable::Sphiphi].map(|rate| slopes(&[rate]).stress.map(|stress| stress.slope));
        let first = here.eta_sum + along[0];
        let second =
            here.eta_sum + across[1] - (here.eta_difference + across[0]) * (here.eta_difference + along[1]) / first;
        [here.kappa + bent, first, second]
    }
}
