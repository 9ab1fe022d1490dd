//! Checks of a law on the initial sphere of cells: finite values, and a regulator if the law uses one.

use std::f64::consts::PI;
use std::fmt;

use super::{Active, Expression, Law, LawValues, VARIABLES, Variable};
use crate::{Cell, Cue};

/// An expression of a law without a finite value at a point of the initial shape of a cell.
#[derive(Clone, Debug, PartialEq)]
pub struct NotFinite {
    /// The expression.
    pub expression: Expression,
    /// The position u, 0 or 1 at a pole.
    pub u: f64,
    /// The curvatures c1 and c2, in 1/L_h.
    pub curvatures: [f64; 2],
    /// Distance from the axis, in L_h.
    pub r: f64,
    /// The activity ξ_s, 0 where a division starts.
    pub xi_s: f64,
    /// Value of the expression.
    pub value: f64,
}

impl NotFinite {
    /// The condition that it violates, for errors.
    pub(super) fn allowed(&self) -> String {
        format!("finite where cells start: {self}")
    }
}

impl fmt::Display for NotFinite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let NotFinite { u, curvatures: [c1, c2], r, xi_s, value, .. } = self;
        let pole = if *u == 0.0 || *u == 1.0 { ", a pole" } else { "" };
        let passive = if *xi_s == 0.0 { " and xi_s = 0" } else { "" };
        write!(f, "at u = {u:.3}{pole}, where c1 = {c1:.3}, c2 = {c2:.3}, r = {r:.3}{passive}, it is {value}")
    }
}

/// Positions u that are checked. The poles come first, since most laws that diverge anywhere diverge there.
const PLACES: [f64; 5] = [0.0, 1.0, 0.5, 0.25, 0.75];

/// Distances from a point, relative to the radius. If an expression is undefined at the point, its values at these distances show
/// whether it has a limit, as sin(r)/r has at a pole.
const NEAR: [f64; 2] = [1e-4, 1e-6];

/// Largest factor between the values at the two distances for an expression with a limit; for 1/r it is 100.
const GROWTH: f64 = 10.0;

impl Law {
    /// The point of the initial sphere at which an expression is not finite, without flow and with φ = 0, at the cell's activity or
    /// without activity.
    pub fn not_finite(&self, cell: &Cell) -> Option<NotFinite> {
        // Without activity a divergent law may give 0 times infinity, which is less informative than the infinite value.
        let active = if cell.xi_s == 0.0 { 1.0 } else { cell.xi_s };
        let places = [active, 0.0].into_iter().flat_map(|xi_s| PLACES.map(|u| (xi_s, u)));
        let values = LawValues::new(self, cell, |_, v| v);
        places.into_iter().find_map(|(xi_s, u)| self.not_finite_at(cell, &values, xi_s, u))
    }

    fn not_finite_at(&self, cell: &Cell, values: &LawValues<f64>, xi_s: f64, u: f64) -> Option<NotFinite> {
        let mut memory = Vec::new();
        let mut at = |away: f64| numbers(&values.at(&on_sphere(cell, values, xi_s, u, away), &mut memory));
        let here = at(0.0);
        let [far, near] = NEAR.map(at);
        let lacks_limit = |k: usize| {
            let [here, far, near] = [here, far, near].map(|numbers| numbers[k]);
            let settles = far.is_finite() && near.is_finite() && near.abs() <= GROWTH * far.abs();
            here.is_infinite() || here.is_nan() && !settles
        };
        let expression = Expression::ALL.into_iter().find(|which| lacks_limit(*which as usize))?;
        let value = here[expression as usize];
        let r = cell.r0 * sine(u);
        Some(NotFinite { expression, u, curvatures: [1.0 / cell.r0; 2], r, xi_s, value })
    }

    /// Whether it uses the regulator φ.
    pub fn reads_regulator(&self) -> bool {
        self.names(Variable::Phi)
    }
}

impl Cell {
    /// Whether its law uses the regulator φ.
    pub fn law_reads_regulator(&self) -> bool {
        self.law.as_ref().is_some_and(|law| law.reads_regulator())
    }

    /// Whether its cue has an effect; a regulator without fields has one if the law uses it.
    pub fn has_cue(&self) -> bool {
        self.simplified_cue() != Cue::none()
    }

    /// The warning for a law that uses φ in a cell without a regulator.
    pub fn lacks_regulator(&self) -> Option<String> {
        let law = self.law.as_ref().filter(|law| law.reads_regulator() && self.cue.regulator().is_none())?;
        Some(format!(
            "the law {:?} names phi, but the cell has no regulator, so phi is 0 everywhere. Add one to the cue, for example {REGULATOR}",
            law.name()
        ))
    }
}

/// The notation of a regulator that acts only through a law.
pub const REGULATOR: &str = "regulator:none,turnover=10,diffusion=1,activity=0";

/// sin πu, exactly 0 at both poles.
fn sine(u: f64) -> f64 {
    if u == 1.0 { 0.0 } else { (PI * u).sin() }
}

/// The values of the expressions in the order of [`Expression::ALL`].
fn numbers(of: &Active<f64>) -> [f64; 4] {
    [of.moment, of.stress[0], of.stress[1], of.normal_force]
}

/// The quantities at u of a sphere with the cell's volume, or of a slightly different surface, as passive cells have: near a
/// pole the difference of its curvatures increases with the square of the distance.
fn on_sphere(cell: &Cell, values: &LawValues<f64>, xi_s: f64, u: f64, away: f64) -> [f64; VARIABLES] {
    let (r0, material) = (cell.r0, &cell.material);
    let bend = away * away;
    let [c1, c2] = [1.0 + bend, 1.0 - bend].map(|share| share / r0);
    let place = if u < 1.0 { u + away } else { 1.0 - away };
    let (r, z) = (r0 * sine(place), values.height(r0 * (PI * place).cos()));
    let [u, s] = values.along(place, PI * r0);
    let fields = [material.kappa, material.eta_b, material.eta_s, material.friction, material.tension];
    let [kappa, eta_b, eta_s, friction, tension] = fields;
    let xi_b = xi_s * material.xi_ratio;
    [c1, c2, c1 + c2, u, s, r, 0.0, 0.0, 0.0, kappa, eta_b, eta_s, friction, tension, xi_s, xi_b, z]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(stress: &str, constants: &str) -> Result<Law, String> {
        let text = format!(
            "Law(name: \"own\", constants: {{{constants}}}, stress_uu: \"{stress}\", stress_phiphi: \"{stress}\")"
        );
        Law::parse(&text, "own.ron").map_err(|error| error.to_string())
    }

    #[test]
    fn a_law_that_is_infinite_where_cells_start_is_refused_with_field_place_and_value() {
        let pole = "at u = 0.000, a pole, where c1 = 0.500, c2 = 0.500, r = 0.000";
        for (stress, place, value) in [
            ("xi_s/r", pole, "inf"),
            ("xi_s/r^2", pole, "inf"),
            ("xi_s*ln(r)", pole, "-inf"),
            ("xi_s*(c1 - c2)^-0.5", pole, "inf"),
            ("xi_s*ln(phi)", pole, "-inf"),
            ("xi_s/(u - 0.5)", "at u = 0.500, where c1 = 0.500, c2 = 0.500, r = 2.000", "inf"),
            ("1/xi_s", "at u = 0.000, a pole, where c1 = 0.500, c2 = 0.500, r = 0.000 and xi_s = 0", "inf"),
            ("xi_s*S_uu/S_phiphi", pole, "NaN"),
        ] {
            let error = law(stress, "").unwrap_err();
            let expected =
                format!("own.ron: stress_uu = \"{stress}\": must be finite where cells start: {place}, it is {value}");
            assert_eq!(error, expected);
        }
        let error = law("xi_s/a", "\"a\": (value: 0.0)").unwrap_err();
        assert!(error.contains("stress_uu = \"xi_s/a\"") && error.ends_with("it is inf"), "{error}");
    }

    #[test]
    fn a_law_with_a_limit_at_the_pole_is_kept() {
        for stress in [
            "xi_s*sin(r)/r",
            "xi_s*(c1 - c2)/r^2",
            "xi_s*abs(c1 - c2)^0.5",
            "xi_s*r*ln(r)",
            "xi_s*tanh(r)/r",
            "xi_s*s/u",
        ] {
            assert!(law(stress, "").is_ok(), "{stress}: {:?}", law(stress, ""));
        }
    }

    #[test]
    fn a_constant_that_is_set_to_zero_is_refused_beside_its_cell() {
        let mut cell = Cell::new(2.0).with_law(law("xi_s/a", "\"a\": (value: 2.0)").unwrap());
        assert!(cell.check_law("x").is_ok());
        let a: crate::Parameter = "law.a".parse().unwrap();
        a.set(&mut cell, 0.0);
        let error = cell.check_law("--set").unwrap_err().to_string();
        assert!(error.starts_with("--set: law.stress_uu = \"xi_s/a\": must be finite"), "{error}");
    }

    #[test]
    fn a_constant_that_no_expression_names_is_refused() {
        let error = law("xi_s*C", "\"a\": (value: 2.0)").unwrap_err();
        let expected =
            "own.ron: constants = \"a\": must be named by an expression: a constant that none names changes nothing";
        assert_eq!(error, expected);
    }

    #[test]
    fn a_constant_that_is_given_twice_is_refused() {
        let error = law("a*xi_s", r#""a": (value: 1.0), "a": (value: 2.0)"#).unwrap_err();
        assert!(error.ends_with(r#"constants["a"]: the constant "a" stands twice"#), "{error}");
    }

    #[test]
    fn a_law_that_reads_the_regulator_makes_a_cue_of_it() {
        let carried: Cue = REGULATOR.parse().unwrap();
        let plain = Cell::new(2.0).with_cue(carried);
        assert!(plain.cue.is_none() && !plain.has_cue() && plain.lacks_regulator().is_none());
        let reading = plain.with_law(law("xi_s*C*(1 + phi)", "").unwrap());
        assert!(reading.has_cue() && reading.lacks_regulator().is_none());
        let told = reading.with_cue(Cue::none()).lacks_regulator().unwrap();
        assert!(told.contains("\"own\" names phi") && told.ends_with(REGULATOR), "{told}");
    }
}
