//! Laws of active stress as text: the paper's law against the built-in one, other laws against equal changes of the cell, and
//! random expressions.

use furrow_cell::law::Law;
use furrow_cell::{Cell, Numerics, Parameter};
use furrow_mechanics::cortex::forces;
use furrow_mechanics::critical::critical_radius;
use furrow_mechanics::division::{Division, DivisionError, DivisionInput, DivisionOptions, divide, divide_with};
use furrow_mechanics::equilibria::curves::boundary_and_folds;
use furrow_mechanics::equilibria::{BranchOptions, ShapeError, StationaryError, pitchfork, primary, stationary};
use furrow_mechanics::law::LawError;

const PAPER: &str = include_str!("../../../examples/laws/paper.ron");

/// Deviation of numbers by another order of operations.
const SAME: f64 = 1e-8;

fn paper() -> Law {
    Law::parse(PAPER, "paper.ron").unwrap()
}

/// A law from its constants and expressions.
fn law(constants: &str, stress: [&str; 2], more: &str) -> Law {
    let [uu, phiphi] = stress;
    let constants = format!("constants: {{ {constants} }}, ");
    Law::parse(
        &format!("Law(name: \"t\", {constants}stress_uu: \"{uu}\", stress_phiphi: \"{phiphi}\", {more})"),
        "t.ron",
    )
    .unwrap()
}

/// The paper's stress with something added to both components.
fn paper_and(added: &str, constants: &str, more: &str) -> Law {
    let of = |sign: &str| format!("gain*(xi_b*C {sign} xi_s*(c1 - c2)/2) + {added}");
    law(constants, [&of("+"), &of("-")], more)
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * (1.0 + expected.abs()), "{found} is not {expected}");
}

fn numbers(of: &Division) -> [f64; 5] {
    let [a, b] = of.daughters().unwrap_or_default();
    [of.chi().unwrap_or(-1.0), of.u_furrow().unwrap_or(-1.0), of.t_end, a, b]
}

#[track_caller]
fn same_division(found: &Division, expected: &Division, tolerance: f64) {
    assert_eq!(found.outcome(), expected.outcome());
    numbers(found).into_iter().zip(numbers(expected)).for_each(|(a, b)| near(a, b, tolerance));
}

fn solve(cell: Cell) -> Result<Division, DivisionError> {
    divide(&DivisionInput::new(cell))
}

const GERMLINE: &str = "kappa:u0=0.465,omega=0.0577,amplitude=0.1";
const CARRIED: &str = "regulator:band,u0=0.465,omega=0.0577,amplitude=0.1,turnover=25,diffusion=1,activity=1,kappa=1";

#[test]
fn the_papers_law_as_text_divides_as_the_built_in_one() {
    for (r0, cue) in [(2.5, "none"), (2.0, "none"), (1.6, "none"), (5.4, GERMLINE), (5.4, CARRIED)] {
        let cell = Cell::new(r0).with_cue(cue.parse().unwrap());
        let [built_in, own] = [cell.clone(), cell.with_law(paper())].map(|cell| solve(cell).unwrap());
        same_division(&own, &built_in, SAME);
        assert_eq!(own.work.steps, built_in.work.steps, "{r0} {cue}");
    }
}

#[test]
fn thresholds_branches_and_curves_of_the_papers_law_as_text() {
    let (numerics, options) = (Numerics::default(), BranchOptions::default());
    for r0 in [1.64, 2.0] {
        let cells = [Cell::new(r0), Cell::new(r0).with_law(paper())];
        let [built_in, own] = cells.each_ref().map(|cell| pitchfork::first(cell, &numerics, &options).unwrap());
        near(own.point.xi_s, built_in.point.xi_s, SAME);
        near(own.coefficient, built_in.coefficient, SAME);
        let [built_in, own] = cells.map(|cell| primary::follow(&cell, &numerics, &options, |_| true).unwrap());
        assert_eq!(own.events.len(), built_in.events.len());
        for (own, built_in) in own.events.iter().zip(&built_in.events) {
            assert_eq!(own.kind(), built_in.kind());
            near(own.point().xi_s, built_in.point().xi_s, SAME);
            near(own.point().elongation, built_in.point().elongation, SAME);
        }
    }
    let cells = [Cell::new(1.9), Cell::new(1.9).with_law(paper())];
    let curves = |cell: &Cell| boundary_and_folds(cell, &numerics, Parameter::R0, [1.9, 2.0], None).unwrap();
    let [built_in, own] = cells.each_ref().map(curves);
    let pairs = own.pitchforks.iter().chain(&own.folds).zip(built_in.pitchforks.iter().chain(&built_in.folds));
    let mut seen = 0;
    for (own, built_in) in pairs {
        let [own, built_in] = [own, built_in].map(|curve| *curve.points.last().unwrap());
        near(own.xi_s, built_in.xi_s, SAME);
        near(own.coefficient.unwrap_or(0.0), built_in.coefficient.unwrap_or(0.0), SAME);
        seen += 1;
    }
    assert!(seen >= 2, "a pitchfork and a fold");
    let [built_in, own] = cells.each_ref().map(|cell| critical_radius(cell, &numerics).unwrap());
    near(own.r0, built_in.r0, SAME);
}

/// Growth rates, forces along the contour, and derivatives of an outcome.
#[test]
fn all_that_is_told_of_a_shape_is_the_same_by_the_text() {
    let cue = "activity:step,u0=0.4,omega=0.2,amplitude=0.2+kappa:gradient,amplitude=0.1";
    let cells = [Cell::new(1.6), Cell::new(1.6).with_law(paper())];
    let cells = cells.map(|cell| Cell { xi_s: 15.0, ..cell.with_cue(cue.parse().unwrap()) });
    let [built_in, own] = cells.each_ref().map(|cell| stationary(cell, &Numerics::default()).unwrap());
    near(own.spectrum().unwrap().growth_rate(), built_in.spectrum().unwrap().growth_rate(), SAME);
    let places = |shape: &furrow_mechanics::equilibria::StationaryShape| {
        forces::profile(&shape.cortex, &shape.solution.gauss(), &shape.solution)
    };
    let places: Vec<_> = places(&own).into_iter().zip(places(&built_in)).collect();
    for (k, (a, b)) in places.iter().enumerate() {
        let inside = k > 0 && k + 1 < places.len();
        for (a, b) in a.normal.parts().into_iter().zip(b.normal.parts()) {
            near(a, b, if inside { SAME } else { 1e-3 });
        }
        near(a.t_pp, b.t_pp, if inside { SAME } else { 1e-3 });
        // By a difference along the contour.
        near(a.active_tangential, b.active_tangential, 1e-4);
    }
    let parameters = [Parameter::R0, Parameter::XiS, "cue.amplitude".parse().unwrap()];
    let of = |law: Option<Law>| {
        let cell = Cell { law: law.map(Box::new), ..Cell::new(3.3).with_cue(GERMLINE.parse().unwrap()) };
        let options = DivisionOptions { parameters: &parameters, ..DivisionOptions::default() };
        divide_with(&DivisionInput::new(cell), options).unwrap().1.unwrap()
    };
    for (own, built_in) in of(Some(paper())).iter().zip(of(None)) {
        near(own.chi_signed, built_in.chi_signed, 1e-6);
    }
}

/// The same change of a cell by its law and by its constants.
#[test]
fn laws_do_what_an_equal_change_of_the_cell_does() {
    let cell = || Cell::new(2.5);
    // By their thresholds: the noise of a division multiplies all that a law gives, not the activity alone.
    let same = |law: Law, other: Cell| {
        let threshold = |cell: Cell| {
            pitchfork::first(&Cell { r0: 2.0, ..cell }, &Numerics::default(), &BranchOptions::default()).unwrap()
        };
        let [found, expected] = [cell().with_law(law), other].map(threshold);
        near(found.point.xi_s, expected.point.xi_s, SAME);
        near(found.coefficient, expected.coefficient, 1e-6);
    };
    // A viscosity against a change of area.
    let viscous = paper_and("more*(S_uu + S_phiphi)", "\"more\": (value: 0.5)", "");
    let mut other = cell();
    other.material.eta_b += 0.5;
    same(viscous, other);
    // Passive tension.
    let mut other = cell();
    other.material.tension = 0.4;
    same(paper_and("0.4", "", ""), other);
    // A pressure from outside changes nothing but p.
    same(paper_and("0", "", "normal_force: \"-0.7\""), cell());
    // A moment that is κ's own: rigidity κ + 0.3, with the tension −0.3 C²/2 that goes with its energy.
    let mut other = cell();
    other.material.kappa += 0.3;
    same(paper_and("0.15*C^2", "", "moment: \"0.3*C\""), other);
    // Activity that falls from pole to pole.
    let falling = "gain*(1 + 0.2*(1 - 2*u))*";
    let [uu, phiphi] = ["+", "-"].map(|sign| format!("{falling}(xi_b*C {sign} xi_s*(c1 - c2)/2)"));
    let falling = law("", [&uu, &phiphi], "");
    let cue = "activity:gradient,amplitude=0.2".parse().unwrap();
    let [own, painted] = [cell().with_law(falling.clone()), cell().with_cue(cue)].map(|cell| solve(cell).unwrap());
    same_division(&own, &painted, 2e-4);
    // From the other pole it is the mirror image.
    let [here, there] = [falling.clone(), falling.mirrored()].map(|law| solve(cell().with_law(law)).unwrap());
    near(here.chi_signed().unwrap(), -there.chi_signed().unwrap(), 2e-4);
    assert!(!cell().with_law(falling).is_mirror_symmetric() && cell().with_law(paper()).is_mirror_symmetric());
}

/// C − C0 in place of C in the energy of bending: forces of the elastic surface alone drive no flow.
#[test]
fn a_surface_with_a_curvature_of_its_own_rests() {
    let law = Law::parse(include_str!("../../../examples/laws/spontaneous_curvature.ron"), "spontaneous_curvature.ron")
        .unwrap();
    let shape = stationary(&Cell { xi_s: 0.0, ..Cell::new(2.0).with_law(law) }, &Numerics::default()).unwrap();
    let places = forces::profile(&shape.cortex, &shape.solution.gauss(), &shape.solution);
    let inside = &places[1..places.len() - 1];
    let speed = inside.iter().fold(0.0f64, |most, place| most.max(place.v.abs()));
    assert!(speed < 1e-8, "{speed}");
    assert!(inside.iter().all(|place| place.normal.residual().abs() < 1e-6));
}

#[test]
fn laws_that_cannot_hold_are_said_to_be_that() {
    let softer = paper_and("0", "\"a\": (value: 0.06)", "moment: \"-a*xi_s*C\"");
    let thinner = paper_and("-3*(S_uu + S_phiphi)", "", "");
    for (law, modulus) in [(&softer, "rigidity"), (&thinner, "viscosity")] {
        let error = solve(Cell::new(2.5).with_law(law.clone())).unwrap_err();
        assert!(matches!(error, DivisionError::Law { source: LawError::ShortWaves { .. }, .. }), "{error}");
        assert!(error.to_string().contains(modulus) && error.to_string().contains("\"t\""), "{error}");
    }
    let error = stationary(&Cell::new(1.6).with_law(thinner.clone()), &Numerics::default()).unwrap_err();
    assert!(matches!(error, StationaryError::Branch(ShapeError::Law { .. })), "{error}");
    let found = pitchfork::first(&Cell::new(2.0).with_law(thinner), &Numerics::default(), &BranchOptions::default());
    assert!(matches!(found, Err(ShapeError::Law { .. })));
}

#[test]
fn cues_that_a_law_does_not_use_are_refused() {
    let law = law("", ["gain*xi_s*C", "gain*xi_s*C"], "moment: \"xi_s*C\"");
    for (cue, named) in [("xi_b:gradient,amplitude=0.2", "xi_b acts only"), ("xi_s:gradient,amplitude=0.2", "moment")] {
        let cell = Cell::new(2.0).with_law(law.clone()).with_cue(cue.parse().unwrap());
        let error = solve(cell.clone()).unwrap_err();
        assert!(matches!(error, DivisionError::Law { source: LawError::Cue { .. }, .. }), "{error}");
        assert!(error.to_string().contains(named), "{error}");
        assert!(stationary(&cell, &Numerics::default()).unwrap_err().to_string().contains(named));
        assert!(cell.check_law("x").unwrap_err().to_string().contains(named));
    }
    // Passive fields act as they do without a law.
    let cue = "friction:gradient,amplitude=0.5";
    let cells = [Cell::new(2.5), Cell::new(2.5).with_law(paper())].map(|cell| cell.with_cue(cue.parse().unwrap()));
    let [built_in, own] = cells.map(|cell| solve(cell).unwrap());
    same_division(&own, &built_in, SAME);
}

/// A sequence of numbers, Steele's splitmix64.
struct Draws(u64);

impl Draws {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % count as u64) as usize
    }

    fn expression(&mut self, depth: usize) -> String {
        const NAMES: [&str; 14] =
            ["c1", "c2", "C", "u", "s", "r", "S_uu", "S_phiphi", "phi", "xi_s", "kappa", "eta_b", "a", "r0"];
        if depth == 0 || self.below(6) == 0 {
            return match self.below(4) {
                0 => format!("{}", self.below(50) as f64 / 10.0),
                _ => NAMES[self.below(NAMES.len())].to_owned(),
            };
        }
        let mut part = || self.expression(depth - 1);
        let (a, b) = (part(), part());
        match self.below(8) {
            0 => format!("({a} + {b})"),
            1 => format!("({a} - {b})"),
            2 | 3 => format!("{a}*{b}"),
            4 => format!("{a}/(1 + abs({b}))"),
            5 => format!("{a}^{}", self.below(4)),
            6 => format!("{}({a})", ["tanh", "sin", "sqrt", "ln", "exp", "atan"][self.below(6)]),
            _ => format!("min({a}, {b})"),
        }
    }
}

/// 300 random laws: an outcome, or a reason with words.
#[test]
fn any_expression_ends_in_an_outcome_or_a_reason() {
    let numerics = Numerics { t_max: 0.3, intervals: 32, stages: 3, ..Numerics::default() };
    let (mut draws, mut ended, mut refused) = (Draws(7), [0usize; 2], 0);
    for k in 0..300 {
        let stress = draws.expression(3);
        // Weak enough in every other law for the cell to live on.
        let weak = if k % 2 == 0 { "0.02*xi_s*" } else { "xi_s*" };
        // A constant that no expression names is refused.
        let uu = format!("{weak}tanh({stress}) + 0*a");
        let phiphi = if k % 10 == 9 { draws.expression(2) } else { uu.clone() };
        let moment = if k % 7 == 0 { format!(", moment: \"0.01*{}\"", draws.expression(2)) } else { String::new() };
        let text = format!(
            "Law(name: \"random\", constants: {{ \"a\": (value: 0.7) }}, stress_uu: \"{uu}\", stress_phiphi: \"{phiphi}\"{moment})"
        );
        let law = match Law::parse(&text, "random.ron") {
            Ok(law) => law,
            Err(error) => {
                assert!(error.to_string().contains("random.ron"), "{text}: {error}");
                refused += 1;
                continue;
            }
        };
        let cell = Cell::new(2.5).with_law(law);
        match divide(&DivisionInput { cell, numerics, seed: 0 }) {
            Ok(_) => ended[0] += 1,
            Err(error) => {
                assert!(error.to_string().contains("2.5"), "{text}: {error}");
                ended[1] += 1;
            }
        }
    }
    println!("{ended:?} {refused}");
    assert!(ended.into_iter().all(|count| count > 20) && refused > 10, "{ended:?} {refused}");
}

/// A cell with a spontaneous curvature divides like a cell whose law states it as a stress and a moment. Noise, which multiplies all stress
/// of a law, is left out.
#[test]
fn a_spontaneous_curvature_as_a_law_is_the_built_in_one() {
    let stated = include_str!("../../../examples/laws/spontaneous_curvature.ron");
    let stated = Law::parse(stated, "spontaneous_curvature.ron").unwrap();
    let pair = |cell: Cell| {
        let mut plain = cell.clone();
        plain.material.spontaneous_curvature = 0.3;
        [plain, cell.with_law(stated.clone())]
    };
    let numerics = Numerics { noise: 0.0, ..Numerics::default() };
    let [plain, own] = pair(Cell::new(2.4).with_cue("friction:gradient,amplitude=0.3".parse().unwrap()))
        .map(|cell| divide(&DivisionInput { numerics, ..DivisionInput::new(cell) }).unwrap());
    same_division(&own, &plain, 1e-6);
    let [plain, own] =
        pair(Cell::new(2.0)).map(|cell| pitchfork::first(&cell, &numerics, &BranchOptions::default()).unwrap());
    near(own.point.xi_s, plain.point.xi_s, SAME);
    near(own.coefficient, plain.coefficient, 1e-6);
    // It matters.
    let without = pitchfork::first(&Cell::new(2.0), &numerics, &BranchOptions::default()).unwrap();
    assert!((without.point.xi_s - plain.point.xi_s).abs() > 0.1, "{}", plain.point.xi_s);
}

/// A regulator may act through the law alone.
#[test]
fn a_regulator_without_couplings_is_carried_for_a_law_that_names_it() {
    let regulator = "regulator:band,u0=0.465,omega=0.0577,amplitude=0.1,turnover=25,diffusion=1,activity=";
    let cell = |strength: &str| Cell::new(3.0).with_cue(format!("{regulator}{strength}").parse().unwrap());
    let stress = |sign: &str| format!("gain*(1 + phi)*(xi_b*C {sign} xi_s*(c1 - c2)/2)");
    let named = law("", [&stress("+"), &stress("-")], "");
    let [own, built_in, idle] = [cell("0").with_law(named), cell("1"), cell("0")].map(|cell| solve(cell).unwrap());
    same_division(&own, &built_in, 1e-6);
    assert_ne!(numbers(&idle), numbers(&built_in));
}
