//! Conditions on a law: it depends on ξ_s, is isotropic at the poles, and uses the fields that a cue modulates.

use super::names::UNIFORM;
use super::{Expression, Law, LawValues, VARIABLES, Variable};
use crate::cue::Field;
use crate::{Cell, Cue};

/// A sequence of numbers between −1 and 1 that fills the interval evenly.
fn spread(k: usize, dimension: usize) -> f64 {
    // The fractional parts of multiples of irrational numbers.
    let step = (2.0 + dimension as f64 * 3.0).sqrt().fract();
    2.0 * ((k + 1) as f64 * step).fract() - 1.0
}

/// Number of points at which a law is evaluated.
const PLACES: usize = 24;

/// Largest relative difference of numbers that count as equal.
const SAME: f64 = 1e-9;

fn differ(a: f64, b: f64) -> bool {
    // A value that is not finite is reported during the computation, if a cell reaches it.
    (a - b).abs() > SAME * (1.0 + a.abs().max(b.abs()))
}

impl Law {
    /// Checks the conditions that do not depend on a cell. The error has field, value and allowed values.
    pub(super) fn check(&self) -> Result<(), (String, String, String)> {
        if !self.names(Variable::XiS) && !self.names(Variable::XiB) {
            let field = Expression::StressUu.name();
            let allowed = "an expression with xi_s (or xi_b = xi_ratio*xi_s), the strength of the activity: cells start from rest at xi_s = 0, and thresholds are sought in it";
            return Err((field.to_owned(), self.shown(Expression::StressUu), allowed.to_owned()));
        }
        for variable in [Variable::Suu, Variable::Sphiphi] {
            if self.uses(Expression::Moment, variable) {
                let field = Expression::Moment.name();
                let allowed =
                    format!("an expression without {}: a moment may depend on shape and fields", variable.name());
                return Err((field.to_owned(), self.shown(Expression::Moment), allowed));
            }
        }
        if let Some(name) = self.constants.keys().enumerate().find_map(|(k, name)| self.is_idle(k).then_some(name)) {
            let allowed = "named by an expression: a constant that none names changes nothing".to_owned();
            return Err(("constants".to_owned(), furrow_input::shown(name), allowed));
        }
        let cell = Cell::new(2.0);
        match self.not_finite(&cell) {
            Some(found) => Err((found.expression.name().to_owned(), self.shown(found.expression), found.allowed())),
            None => self.check_poles(&cell),
        }
    }

    /// Whether no expression uses the constant with this index.
    fn is_idle(&self, number: usize) -> bool {
        !self.program.names_uniform(UNIFORM.len() + number)
    }

    /// Quantities at sample k: arbitrary curvatures, rates and φ, and the fields of a cell.
    fn sample(&self, cell: &Cell, values: &LawValues<f64>, k: usize, u: f64) -> [f64; VARIABLES] {
        let length = 3.0 * cell.r0;
        let z = values.height(cell.r0 * (std::f64::consts::PI * u).cos());
        let [u, s] = values.along(u, length);
        let curvature = |dimension| (1.0 + 0.8 * spread(k, dimension)) / cell.r0;
        let (c1, c2) = (curvature(0), curvature(1));
        let (rate, other, phi) = (spread(k, 2), spread(k, 3), 0.5 * spread(k, 4));
        let r = cell.r0 * (0.5 + 0.4 * spread(k, 5));
        let material = &cell.material;
        let xi_b = cell.xi_s * material.xi_ratio;
        let fields = [material.kappa, material.eta_b, material.eta_s, material.friction, material.tension];
        let [kappa, eta_b, eta_s, friction, tension] = fields;
        [c1, c2, c1 + c2, u, s, r, rate, other, phi, kappa, eta_b, eta_s, friction, tension, cell.xi_s, xi_b, z]
    }

    /// Rejects stresses that differ at a pole, where all directions are equivalent.
    fn check_poles(&self, cell: &Cell) -> Result<(), (String, String, String)> {
        let (values, mut memory) = (LawValues::new(self, cell, |_, v| v), Vec::new());
        for k in 0..PLACES {
            let mut place = self.sample(cell, &values, k, (k % 2) as f64);
            place[Variable::C2 as usize] = place[Variable::C1 as usize];
            place[Variable::C as usize] = 2.0 * place[Variable::C1 as usize];
            place[Variable::Sphiphi as usize] = place[Variable::Suu as usize];
            place[Variable::R as usize] = 1e-9;
            let [a, b] = values.at(&place, &mut memory).stress;
            if differ(a, b) {
                let [c, rate] = [Variable::C1, Variable::Suu].map(|variable| place[variable as usize]);
                let allowed = format!(
                    "equal to stress_uu at a pole, where c1 = c2, S_uu = S_phiphi and r = 0: at c1 = {c:.3}, S_uu = {rate:.3} it is {b:.6}, and stress_uu is {a:.6}"
                );
                return Err((
                    Expression::StressPhiphi.name().to_owned(),
                    self.shown(Expression::StressPhiphi),
                    allowed,
                ));
            }
        }
        Ok(())
    }

    /// Whether it is invariant under exchange of the poles.
    pub fn is_mirror_symmetric(&self, cell: &Cell) -> bool {
        if !self.is_placed() {
            return true;
        }
        let (values, mut memory) = (LawValues::new(self, cell, |_, v| v), Vec::new());
        (0..PLACES).all(|k| {
            let u = 0.25 * (1.0 + 0.98 * spread(k, 6));
            let [here, there] = [u, 1.0 - u].map(|u| values.at(&self.sample(cell, &values, k, u), &mut memory));
            let numbers = |of: &super::Active<f64>| [of.stress[0], of.stress[1], of.moment, of.normal_force];
            numbers(&here).into_iter().zip(numbers(&there)).all(|(a, b)| !differ(a, b))
        })
    }

    /// The reason why the law cannot be used without axial symmetry: a surface has two principal directions, but no direction around an
    /// axis, and no regulator.
    pub fn needs_axis(&self, cell: &Cell) -> Option<String> {
        if self.names(Variable::Phi) {
            return Some("it uses phi, and a regulator has equations with axial symmetry alone".to_owned());
        }
        if let Some(rate) = [Variable::Suu, Variable::Sphiphi].into_iter().find(|rate| self.names(*rate)) {
            let name = rate.name();
            return Some(format!("it uses {name}, which leaves out the shear of directions that are not principal"));
        }
        let (values, mut memory) = (LawValues::new(self, cell, |_, v| v), Vec::new());
        for k in 0..PLACES {
            let here = self.sample(cell, &values, k, 0.5 * (1.0 + 0.98 * spread(k, 6)));
            let [c1, c2] = [Variable::C1, Variable::C2].map(|variable| here[variable as usize]);
            let mut turned = here;
            (turned[Variable::C1 as usize], turned[Variable::C2 as usize]) = (c2, c1);
            let [a, b] = [here, turned].map(|place| values.at(&place, &mut memory));
            let pairs = [
                (a.stress[0], b.stress[1]),
                (a.stress[1], b.stress[0]),
                (a.moment, b.moment),
                (a.normal_force, b.normal_force),
            ];
            if let Some((found, other)) = pairs.into_iter().find(|(a, b)| differ(*a, *b)) {
                return Some(format!(
                    "it tells the direction around the axis from the other: at c1 = {c1:.3}, c2 = {c2:.3} it gives {found:.6}, and {other:.6} for the same principal direction with c1 and c2 exchanged"
                ));
            }
        }
        None
    }

    /// The reason why a cue is incompatible with the law: it modulates an activity that no expression uses, or a field that the moment
    /// uses, because the equations would require its slope along the contour.
    pub fn misfit(&self, cue: &Cue) -> Option<String> {
        let coupled = cue.regulator().into_iter().flat_map(|regulator| &regulator.couplings);
        let strong = coupled.filter(|coupling| coupling.strength != 0.0).map(|coupling| coupling.field);
        let painted = cue.terms().iter().filter(|term| term.amplitude != 0.0).map(|term| term.field);
        painted.chain(strong).find_map(|field| {
            let name = field.name();
            let coefficients = Variable::ALL.into_iter().filter(|variable| {
                Field::ALL.into_iter().any(|own| own.name() == variable.name() && field.modulates(own))
            });
            let mut coefficients = coefficients.collect::<Vec<_>>().into_iter();
            let acts_by_law = matches!(field, Field::XiS | Field::XiB | Field::Activity);
            if acts_by_law && !coefficients.clone().any(|variable| self.names(variable)) {
                return Some(format!("{name} acts only where an expression of the law names it, and none does"));
            }
            let bent = coefficients.find(|variable| self.uses(Expression::Moment, *variable))?;
            Some(format!("a moment cannot use {}, which varies along the contour by {name}", bent.name()))
        })
    }
}
