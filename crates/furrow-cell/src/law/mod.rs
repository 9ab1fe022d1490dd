//! Laws of active stress as data: expressions of the local quantities of the cortex.
//!
//! | file | contents |
//! |---|---|
//! | `text` | the grammar of expressions |
//! | `program` | expressions as a list of operations, for any number type |
//! | `names` | the names that expressions may use |
//! | `file` | laws in RON and JSON |
//! | `check` | conditions on a law |
//! | `finite` | checks on the initial sphere of cells |
//! | `stated` | laws as functions of Rust |

mod check;
mod file;
mod finite;
mod names;
mod program;
mod stated;
mod text;

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::{Cell, Number, Parameter};
pub use finite::{NotFinite, REGULATOR};
use furrow_input::InputError;
pub use names::{ConstantName, LONGEST_NAME, Variable};
use program::Program;
pub use program::{Algebra, Function};
pub use stated::Stated;
pub use text::ExpressionError;

/// An expression of a law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expression {
    /// The isotropic active moment.
    Moment,
    /// The meridional active stress T_uu.
    StressUu,
    /// The azimuthal active stress T_φφ.
    StressPhiphi,
    /// The active force along the outward normal.
    NormalForce,
}

impl Expression {
    /// Every expression, in the order in which they are computed.
    pub const ALL: [Expression; 4] = {
        use Expression::*;
        [Moment, StressUu, StressPhiphi, NormalForce]
    };

    /// Its field in files.
    pub fn name(self) -> &'static str {
        ["moment", "stress_uu", "stress_phiphi", "normal_force"][self as usize]
    }
}

/// A constant of a law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Constant {
    /// Its value, in units of κ0, L_h and τ.
    pub value: f64,
    /// Its unit, for readers only; it is not used in the computation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
}

/// A law of active stress as expressions of [`Variable`]s, parameters and its own constants.
///
/// It replaces the active stress T_uu = g\[½ξ_s(c1 − c2) + ξ_b C\], T_φφ = g\[−½ξ_s(c1 − c2) + ξ_b C\] of the equations and leaves
/// all else unchanged. At ξ_s = 0 it gives the passive cell, from which divisions and branches start.
///
/// ```
/// use furrow_cell::law::Law;
/// use furrow_cell::{Cell, Parameter};
///
/// let text = r#"Law(
///     name: "saturating",
///     constants: { "half": (value: 2.0, unit: "1/L_h") },
///     stress_uu: "gain*xi_s*C/(1 + (C/half)^2)",
///     stress_phiphi: "gain*xi_s*C/(1 + (C/half)^2)",
/// )"#;
/// let law = Law::parse(text, "saturating.ron")?;
/// let mut cell = Cell::new(2.0).with_law(law);
/// let half: Parameter = "law.half".parse().unwrap();
/// assert_eq!(half.get(&cell), 2.0);
/// half.set(&mut cell, 3.0);
/// assert_eq!(half.get(&cell), 3.0);
/// // An unknown name is an error with its place.
/// let error = Law::parse(&text.replace("gain*", "gian*"), "saturating.ron").unwrap_err();
/// assert!(error.to_string().starts_with("saturating.ron:4:17: stress_uu: unknown name \"gian\""), "{error}");
/// # Ok::<(), furrow_input::InputError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "file::Document", into = "file::Document")]
pub struct Law {
    /// Its name, for pictures and reports.
    name: String,
    /// Its constants by name.
    constants: BTreeMap<String, Constant>,
    /// The texts of the expressions.
    texts: [Option<String>; 4],
    /// Whether it applies from the other pole, u → 1 − u.
    reversed: bool,
    program: Arc<Program>,
}

impl Law {
    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its constants, with their names, in the order of their names.
    pub fn constants(&self) -> impl Iterator<Item = (&str, &Constant)> {
        self.constants.iter().map(|(name, constant)| (name.as_str(), constant))
    }

    /// The text of an expression; `None` if the law lacks it.
    pub fn text(&self, which: Expression) -> Option<&str> {
        self.texts[which as usize].as_deref()
    }

    /// An expression as shown in messages.
    fn shown(&self, which: Expression) -> String {
        furrow_input::shown(self.text(which).unwrap_or_default())
    }

    /// Whether it applies from the other pole.
    pub fn is_reversed(&self) -> bool {
        self.reversed
    }

    /// The value of a constant.
    pub fn constant(&self, name: ConstantName) -> Option<f64> {
        self.constants.get(name.bare()).map(|constant| constant.value)
    }

    /// Mutable access to the value of a constant.
    pub(crate) fn constant_mut(&mut self, name: ConstantName) -> Option<&mut f64> {
        self.constants.get_mut(name.bare()).map(|constant| &mut constant.value)
    }

    /// The names of its constants as [`Parameter`]s.
    pub fn parameters(&self) -> impl Iterator<Item = Parameter> {
        self.constants.keys().filter_map(|name| ConstantName::new(name)).map(Parameter::Law)
    }

    /// The law in one line: its name, expressions and constants.
    pub fn described(&self) -> String {
        let expressions =
            Expression::ALL.into_iter().filter_map(|which| Some((which.name(), self.text(which)?.to_owned())));
        let constants = self.constants().map(|(name, constant)| (name, constant.value.to_string()));
        let parts = expressions.chain(constants).map(|(name, value)| format!("{name} = {value}"));
        format!("{:?} ({})", self.name, parts.collect::<Vec<_>>().join(", "))
    }

    /// Whether an expression uses a local quantity.
    pub fn uses(&self, which: Expression, variable: Variable) -> bool {
        self.program.uses(which as usize).contains(&(variable as u16))
    }

    /// Whether any expression uses a local quantity.
    pub fn names(&self, variable: Variable) -> bool {
        Expression::ALL.into_iter().any(|which| self.uses(which, variable))
    }

    /// Whether an expression uses a quantity that distinguishes the poles.
    pub(crate) fn is_placed(&self) -> bool {
        [Variable::U, Variable::S, Variable::Z].into_iter().any(|variable| self.names(variable))
    }

    /// The mirror image of the law, u → 1 − u.
    pub fn mirrored(&self) -> Law {
        Law { reversed: self.reversed ^ self.is_placed(), ..self.clone() }
    }
}

/// A law with the numbers of a cell, ready to be evaluated.
#[derive(Clone, Debug)]
pub struct LawValues<D> {
    program: Arc<Program>,
    /// The parameters [`names::UNIFORM`], then the law's constants.
    uniform: Vec<D>,
    reversed: bool,
    /// Whether the stress depends on the rates of strain.
    pub viscous: bool,
    /// Whether there is a moment.
    pub bends: bool,
    /// Whether u or s is used.
    pub placed: bool,
    /// Whether the moment depends on c1 or C, and whether on any quantity along the contour.
    pub moment: [bool; 2],
}

/// The values of a law at a point, in κ0 and L_h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Active<D> {
    /// T_uu and T_φφ, in κ0/L_h².
    pub stress: [D; 2],
    /// The isotropic moment, in κ0/L_h.
    pub moment: D,
    /// The force along the outward normal, in κ0/L_h³.
    pub normal_force: D,
}

/// Number of local quantities.
pub const VARIABLES: usize = Variable::ALL.len();

impl<D: Number> LawValues<D> {
    /// The law of a cell; `vary` may replace any named parameter by a number with derivatives.
    pub fn new(law: &Law, cell: &Cell, vary: impl Fn(Parameter, f64) -> D) -> LawValues<D> {
        let of_cell = names::UNIFORM.into_iter().map(|parameter| vary(parameter, parameter.get(cell)));
        let own = law.constants.iter().map(|(name, constant)| match ConstantName::new(name) {
            Some(name) => vary(Parameter::Law(name), constant.value),
            None => D::from(constant.value),
        });
        LawValues {
            program: law.program.clone(),
            uniform: of_cell.chain(own).collect(),
            reversed: law.reversed,
            viscous: law.names(Variable::Suu) || law.names(Variable::Sphiphi),
            bends: law.program.results[0].is_some(),
            placed: law.names(Variable::U) || law.names(Variable::S),
            moment: {
                let of =
                    |variables: &[Variable]| variables.iter().any(|variable| law.uses(Expression::Moment, *variable));
                use Variable::{C, C1, C2, Phi, R, S, U, Z};
                [of(&[C1, C]), of(&[C1, C, C2, U, S, R, Z, Phi])]
            },
        }
    }
}

impl<D: Algebra> LawValues<D> {
    /// The same with another number type.
    pub fn map<E>(&self, number: impl Fn(D) -> E) -> LawValues<E> {
        let LawValues { reversed, viscous, bends, placed, moment, .. } = *self;
        LawValues {
            program: self.program.clone(),
            uniform: self.uniform.iter().map(|value| number(*value)).collect(),
            reversed,
            viscous,
            bends,
            placed,
            moment,
        }
    }

    /// The gain g.
    pub fn gain(&self) -> D {
        self.uniform[0]
    }

    /// u and s in the orientation of the law, on a contour of length `length`.
    pub fn along(&self, u: f64, length: D) -> [D; 2] {
        let u = if self.reversed { 1.0 - u } else { u };
        [D::from(u), length * u]
    }

    /// z in the orientation of the law.
    pub fn height(&self, z: D) -> D {
        if self.reversed { -z } else { z }
    }

    /// The derivative of the law's u with respect to u, and likewise for s and z: 1, or −1 if it applies from the other pole.
    pub fn direction(&self) -> f64 {
        if self.reversed { -1.0 } else { 1.0 }
    }

    /// The moment at a point with the given quantities, in the order of [`Variable::ALL`]; `values` is working memory.
    pub fn moment(&self, place: &[D; VARIABLES], values: &mut Vec<D>) -> D {
        values.clear();
        self.program.run(Some(self.program.parts()[0]), place, &self.uniform, values);
        self.program.result(0, values)
    }

    /// Only the stress T_uu.
    pub fn stress_uu(&self, place: &[D; VARIABLES], values: &mut Vec<D>) -> D {
        values.clear();
        self.program.run(Some(self.program.parts()[1]), place, &self.uniform, values);
        self.program.result(1, values)
    }

    /// All values of the law at a point.
    pub fn at(&self, place: &[D; VARIABLES], values: &mut Vec<D>) -> Active<D> {
        let moment = self.moment(place, values);
        self.program.run(None, place, &self.uniform, values);
        let [first, second, normal_force] = [1, 2, 3].map(|which| self.program.result(which, values));
        Active { stress: [first, second], moment, normal_force }
    }
}

impl Cell {
    /// Checks whether its cue is compatible with its law, and whether the law is finite on the initial shape; errors name the source
    /// `source_name`.
    ///
    /// # Errors
    /// Names the cue and the reason, or the expression, the position and the value.
    pub fn check_law(&self, source_name: &str) -> Result<(), InputError> {
        let Some(law) = &self.law else { return Ok(()) };
        if let Some(found) = law.not_finite(self) {
            let field = format!("law.{}", found.expression.name());
            return Err(InputError::not_allowed(source_name, field, law.shown(found.expression), found.allowed()));
        }
        let Some(reason) = law.misfit(&self.cue) else { return Ok(()) };
        let allowed = format!("a cue for the law {:?}: {reason}", law.name());
        Err(InputError::not_allowed(source_name, "cue", &self.cue, allowed))
    }

    /// The same cell with another law of active stress.
    pub fn with_law(self, law: Law) -> Cell {
        Cell { law: Some(Box::new(law)), ..self }
    }
}
