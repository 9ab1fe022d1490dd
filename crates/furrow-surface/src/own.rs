//! User-defined laws of active stress and shell profiles on a surface without axial symmetry.
//!
//! With the mean curvature m = ½C, the deviator D_ij = C_ij − m g_ij and its norm δ = √(½ D^ij D_ij), the principal curvatures are
//! m ± δ. A law gives the stresses T₊ and T₋ along the two principal directions:
//!
//! * \[S.9 own law\] T^ij = ½(T₊ + T₋) g^ij + (T₊ − T₋)/(2δ) D^ij.
//!
//! If the law is symmetric in c1 and c2, the tensor does not depend on the order of the directions and is smooth at δ = 0. There the
//! quotient is evaluated at a small δ; the error of T^ij is of second order in it. The moment M^a is added to κ(C − C0), the factor of
//! the rate of C, as in M.28 and M.29, and the normal force to the shell's.

use furrow_cell::law::{Algebra, Function, LawValues, VARIABLES, Variable};
use furrow_cell::profile::Factor;
use furrow_mechanics::cortex::equations::Constants;

use crate::law::{Geometry, Place, Symmetric, Vector, mix, raise};
use crate::number::Number;

/// The smallest δ, relative to 1/R0.
const LEAST: f64 = 1e-5;

/// A law, a shell profile, or both, with working memory.
#[derive(Clone, Debug)]
pub struct Own<D> {
    law: Option<LawValues<D>>,
    profile: Option<Factor>,
    /// The square of the smallest δ.
    least: f64,
    memory: Vec<D>,
}

/// The values of a law at a point.
#[derive(Clone, Copy, Debug)]
pub struct Active<D> {
    /// T^ij.
    pub stress: Symmetric<D>,
    /// The moment, in κ0/L_h.
    pub moment: D,
    /// The force along the outward normal, in κ0/L_h³.
    pub normal_force: D,
}

impl<D: Number + Algebra> Own<D> {
    /// The law and the shell profile of a cell; `None` if both are the paper's.
    pub fn of(constants: &Constants<f64>) -> Option<Own<D>> {
        let radius = (constants.volume * 0.75 / std::f64::consts::PI).cbrt();
        let law = constants.law.as_ref().map(|law| law.map(|value| D::from(value)));
        let profile = constants.shell_factor.clone();
        constants.is_own().then(|| Own { law, profile, least: (LEAST / radius).powi(2), memory: Vec::new() })
    }

    /// The shell's profile, unless it is an ellipse.
    pub fn profile(&self) -> Option<&Factor> {
        self.profile.as_ref()
    }

    /// The law at a point x of a surface; `None` if it is the paper's.
    pub fn at(&mut self, place: &Place, geometry: &Geometry<D>, x: &Vector<D>) -> Option<Active<D>> {
        let law = self.law.as_ref()?;
        let Geometry { area, inverse_metric: g, curvature, mean, .. } = geometry;
        let half = *mean * 0.5;
        let square = *area * *area;
        let metric = [g[2] * square, -(g[1] * square), g[0] * square];
        let deviator = mix(*curvature, metric, D::from(1.0), -half);
        let size = (deviator[1] * deviator[1] - deviator[0] * deviator[2]) / square;
        let delta = (size + self.least).call(Function::Sqrt);
        let at = quantities(law, place, [half + delta, half - delta], x);
        let active = law.at(&at, &mut self.memory);
        let [along, across] = active.stress.map(|stress| stress * place.noise);
        let difference = (along - across) / (delta * 2.0);
        Some(Active {
            stress: mix(*g, raise(g, &deviator), (along + across) * 0.5, difference),
            moment: active.moment,
            normal_force: active.normal_force * place.noise,
        })
    }
}

/// The local quantities for these principal curvatures.
fn quantities<D: Number + Algebra>(
    law: &LawValues<D>,
    place: &Place,
    [c1, c2]: [D; 2],
    x: &Vector<D>,
) -> [D; VARIABLES] {
    let local = &place.local;
    let mut out = [D::from(0.0); VARIABLES];
    let mut set = |variable: Variable, value: D| out[variable as usize] = value;
    set(Variable::C1, c1);
    set(Variable::C2, c2);
    set(Variable::C, c1 + c2);
    let [u, s] = place.along.map(D::from);
    set(Variable::U, u);
    set(Variable::S, s);
    set(Variable::R, (x[0] * x[0] + x[1] * x[1]).call(Function::Sqrt));
    set(Variable::Z, law.height(x[2]));
    let half = |a: f64| D::from(0.5 * a);
    set(Variable::Kappa, D::from(local.kappa));
    set(Variable::EtaB, half(local.eta_sum + local.eta_difference));
    set(Variable::EtaS, half(local.eta_sum - local.eta_difference));
    set(Variable::Friction, D::from(local.friction));
    set(Variable::Tension, D::from(local.tension));
    let gain = law.gain();
    set(Variable::XiS, D::from(local.xi_s) / gain);
    set(Variable::XiB, D::from(local.xi_b) / gain);
    out
}
