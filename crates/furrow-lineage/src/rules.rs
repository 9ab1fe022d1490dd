//! Rules that set a parameter of cells by generation, by size, or by their mother.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::definition::Lineage;
use super::founder::Daughter;
use super::physics::FounderPhysics;
use furrow_cell::{Cell, Cue, Parameter};
use furrow_input::{did_you_mean, shown};
use furrow_mechanics::division::{Division, Outcome};

/// The properties of a cell in its lineage on which its cue may depend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The nearest founder that it is or descends from (an index into the lineage's founders).
    pub founder: usize,
    /// Number of divisions from that founder.
    pub round: u32,
    /// Number of divisions from the first cell.
    pub generation: u32,
    /// Radius R0, in L_h.
    pub r0: f64,
    /// Number of divisions since a sister inherited the founder's cue instead of its line; 0 while it has the cue.
    pub apart: u32,
}

/// The cells to which a rule applies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// First generation.
    pub from_generation: u32,
    /// Last generation, if there is one.
    pub to_generation: Option<u32>,
    /// Cells of a smaller radius R0 than this, in L_h.
    pub below_r0: Option<f64>,
    /// Cells of a larger radius R0 than this, in L_h.
    pub above_r0: Option<f64>,
}

impl Span {
    /// All cells.
    const ALL: Span = Span { from_generation: 0, to_generation: None, below_r0: None, above_r0: None };

    /// Whether it includes all cells of another span.
    pub(crate) fn covers(&self, other: &Span) -> bool {
        let within = |limit: Option<f64>, of_other: Option<f64>, fits: fn(f64, f64) -> bool| {
            limit.is_none_or(|limit| of_other.is_some_and(|of_other| fits(of_other, limit)))
        };
        self.from_generation <= other.from_generation
            && self.to_generation.is_none_or(|last| other.to_generation.is_some_and(|of_other| of_other <= last))
            && within(self.below_r0, other.below_r0, |of_other, limit| of_other <= limit)
            && within(self.above_r0, other.above_r0, |of_other, limit| of_other >= limit)
    }

    /// Whether it includes a cell of a generation and radius.
    pub(crate) fn includes(&self, generation: u32, r0: f64) -> bool {
        generation >= self.from_generation
            && self.to_generation.is_none_or(|last| generation <= last)
            && self.below_r0.is_none_or(|limit| r0 < limit)
            && self.above_r0.is_none_or(|limit| r0 > limit)
    }
}

/// The quantity n of a rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Per {
    /// The cell's generation, counted like the rule's `from_generation`.
    Generation,
    /// The cell's radius R0, in L_h.
    R0,
    /// χ of its mother's division, 0 where the daughters are equal.
    MotherChi,
}

/// The value of a parameter in some cells: start × factor^n + add × n, where n is the count given by `per`, or 1.
///
/// ```
/// use furrow_cell::Cell;
/// use furrow_lineage::{Lineage, Place};
///
/// // ξ_s falls by 3 % a generation.
/// let file = r#"Lineage(name: "x", physics_rules: [(parameter: "xi_s", factor: 0.97, per: generation)], founders: [(name: "Q")])"#;
/// let lineage = Lineage::parse(file, "x.ron")?;
/// let mut cell = Cell::new(3.0);
/// lineage.set_physics(Place { founder: 0, round: 2, generation: 2, r0: 3.0, apart: 0 }, &mut cell, None).unwrap();
/// assert!((cell.xi_s - 25.0 * 0.97 * 0.97).abs() < 1e-12);
/// # Ok::<(), furrow_input::InputError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PhysicsRule {
    /// The parameter: any but R0, also a number of the cue.
    #[serde(with = "parameter_name")]
    pub parameter: Parameter,
    /// The start; if not given, the cell's own value, from the founder or otherwise from the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// It starts from the mother's value instead. The first cell keeps its own.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub from_mother: bool,
    /// The factor; 1 if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub factor: Option<f64>,
    /// The increment; 0 if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub add: Option<f64>,
    /// The quantity n; n = 1 if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub per: Option<Per>,
    /// First generation it applies to; 0 if not given.
    #[serde(default)]
    pub from_generation: u32,
    /// Last generation it applies to; no last one if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_generation: Option<u32>,
    /// It applies to cells of a smaller radius R0 than this, in L_h.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub below_r0: Option<f64>,
    /// It applies to cells of a larger radius R0 than this, in L_h.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub above_r0: Option<f64>,
}

/// The properties of a mother on which rules depend.
#[derive(Clone, Copy, Debug)]
pub struct Mother<'a> {
    /// Her parameters.
    pub cell: &'a Cell,
    /// χ of her division, 0 where the daughters are equal.
    pub chi: f64,
}

impl<'a> Mother<'a> {
    /// The properties of a cell with its division.
    pub fn of(cell: &'a Cell, division: Option<&Division>) -> Mother<'a> {
        // χ of equal daughters is only rounding error.
        let unequal = division.filter(|division| division.outcome() == Outcome::Asymmetric);
        Mother { cell, chi: unequal.and_then(Division::chi).unwrap_or(0.0) }
    }
}

/// The effect of rules on a cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ruled {
    /// The parameters that rules set, except numbers of the cue.
    pub physics: FounderPhysics,
    /// Whether its parameters are unlikely to occur in other cells, because they depend on its size or its mother.
    pub is_single: bool,
}

impl PhysicsRule {
    /// The cells to which it applies.
    pub fn span(&self) -> Span {
        let PhysicsRule { from_generation, to_generation, below_r0, above_r0, .. } = *self;
        Span { from_generation, to_generation, below_r0, above_r0 }
    }

    /// Whether the first cell, which has no mother, keeps its own value.
    fn depends_on_mother(&self) -> bool {
        self.from_mother || self.per == Some(Per::MotherChi)
    }

    /// The value for a cell; `None` if the cell keeps its own value, for example the first cell if the rule needs a mother.
    fn value(&self, own: f64, generation: u32, r0: f64, mother: Option<Mother<'_>>) -> Option<f64> {
        let start = if self.from_mother { self.parameter.get(mother?.cell) } else { self.value.unwrap_or(own) };
        let (factor, add) = (self.factor.unwrap_or(1.0), self.add.unwrap_or(0.0));
        let times = |n: f64| start * factor.powf(n) + add * n;
        Some(match self.per {
            None => times(1.0),
            Some(Per::Generation) => {
                start * factor.powi(generation.try_into().unwrap_or(i32::MAX)) + add * f64::from(generation)
            }
            Some(Per::R0) => times(r0),
            Some(Per::MotherChi) => times(mother?.chi),
        })
    }

    /// The value for every cell to which it applies; `None` if the value depends on the cell.
    pub(super) fn fixed_value(&self) -> Option<f64> {
        let start = self.value.filter(|_| self.per.is_none())?;
        Some(start * self.factor.unwrap_or(1.0) + self.add.unwrap_or(0.0))
    }

    /// The first invalid field: its name, its value and the allowed values.
    pub(super) fn complaint(&self) -> Option<(&'static str, String, String)> {
        let PhysicsRule { parameter, value, from_mother, factor, add, per, .. } = *self;
        if let Some((value, allowed)) = value.and_then(|value| Some((value, parameter.validate(value).err()?))) {
            return Some(("value", value.to_string(), allowed.to_owned()));
        }
        if let Some(value) = value.filter(|_| from_mother) {
            return Some(("value", value.to_string(), "left out where from_mother is true".to_owned()));
        }
        if let Some(factor) = factor.filter(|factor| !(factor.is_finite() && *factor > 0.0)) {
            return Some(("factor", factor.to_string(), "a finite number above 0".to_owned()));
        }
        if let Some(add) = add.filter(|add| !add.is_finite()) {
            return Some(("add", add.to_string(), "a finite number".to_owned()));
        }
        if per.is_some() && factor.is_none() && add.is_none() {
            return Some(("per", "(given)".to_owned(), "given with factor or add".to_owned()));
        }
        let idle = value.is_none() && !from_mother && factor.is_none() && add.is_none();
        idle.then(|| ("value", "(not given)".to_owned(), "given, or one of from_mother, factor and add".to_owned()))
    }
}

impl Lineage {
    /// [`Place::apart`] of the larger or the smaller daughter of a cell of a founder.
    pub fn apart(&self, founder: usize, of_mother: u32, is_larger: bool) -> u32 {
        let inherits = |heir| (heir == Daughter::Larger) == is_larger;
        match self.founders[founder].cue_passes_to {
            None => 0,
            Some(heir) if of_mother == 0 && inherits(heir) => 0,
            Some(_) => of_mother + 1,
        }
    }

    /// The limit on rounds of division that a cell has reached.
    pub(super) fn most_rounds(&self, place: Place) -> Option<u32> {
        let founder = &self.founders[place.founder];
        let without = founder.rounds_without_cue.filter(|most| place.apart > *most);
        without.or(founder.most_rounds.filter(|most| place.round >= *most))
    }

    /// Whether a cell's cue or parameters may depend on its mother's division in addition to its size.
    pub fn depends_on_mothers(&self) -> bool {
        self.has_physics_rules() || self.founders.iter().any(|founder| founder.cue_passes_to.is_some())
    }

    /// The rules for the parameters of a cell at a place, and the generation used in them.
    fn physics_rules_at(&self, place: Place) -> (&[PhysicsRule], u32) {
        let are_own = !self.founders[place.founder].physics_rules.is_empty();
        (self.physics_rules_of(place.founder), if are_own { place.round } else { place.generation })
    }

    /// The rules for the parameters of a founder and its descendants: its own, or those of the file.
    fn physics_rules_of(&self, founder: usize) -> &[PhysicsRule] {
        let own = &self.founders[founder].physics_rules;
        if own.is_empty() { &self.physics_rules } else { own }
    }

    /// Whether rules give a parameter of every cell of a founder a value that does not depend on the founder's or the run's.
    pub fn rules_replace(&self, founder: usize, parameter: Parameter) -> bool {
        let of_parameter = self.physics_rules_of(founder).iter().filter(|rule| rule.parameter == parameter);
        let mut replacing = of_parameter.take_while(|rule| rule.value.is_some() && !rule.depends_on_mother());
        replacing.any(|rule| rule.span().covers(&Span::ALL))
    }

    /// Whether there are rules for parameters of any cell.
    pub fn has_physics_rules(&self) -> bool {
        !self.physics_rules.is_empty() || self.founders.iter().any(|founder| !founder.physics_rules.is_empty())
    }

    /// A cell of a founder with the parameters of its division. Rules override the founder's parameters and shell, which override those
    /// of the run.
    pub(super) fn parameters(
        &self,
        (founder, r0, cue): (usize, f64, &Cue),
        ruled: Option<&FounderPhysics>,
        run: &Cell,
    ) -> Cell {
        let mut cell = Cell { r0, cue: cue.clone(), ..run.clone() };
        self.founders[founder].apply(&mut cell);
        ruled.into_iter().for_each(|physics| physics.apply(&mut cell));
        cell
    }

    /// Sets the shell and the parameters of a cell at a place from its founder and the rules; for each parameter the first applicable
    /// rule counts. `cell` has the parameters of the run, and the cue.
    ///
    /// # Errors
    /// If the value of a rule is not allowed, names the parameter, the value and the allowed values.
    pub fn set_physics(&self, place: Place, cell: &mut Cell, mother: Option<Mother<'_>>) -> Result<Ruled, String> {
        self.founders[place.founder].apply(cell);
        let (rules, generation) = self.physics_rules_at(place);
        let (own, mut ruled) = (cell.clone(), Ruled::default());
        let mut done: Vec<Parameter> = Vec::new();
        for (k, rule) in rules.iter().enumerate() {
            let parameter = rule.parameter;
            if done.contains(&parameter) || !parameter.is_of(cell) || !rule.span().includes(generation, place.r0) {
                continue;
            }
            done.push(parameter);
            let Some(value) = rule.value(parameter.get(&own), generation, place.r0, mother) else { continue };
            let refused = |allowed| format!("physics_rules[{k}]: {parameter} = {value}: must be {allowed}");
            parameter.validate(value).map_err(refused)?;
            parameter.set(cell, value);
            ruled.physics.set(parameter, value);
            ruled.is_single |= rule.depends_on_mother() || rule.per == Some(Per::R0);
        }
        if done.iter().any(|parameter| parameter.is_of_cue()) {
            cell.cue.check().map_err(|error| format!("physics_rules: {error}"))?;
        }
        Ok(ruled)
    }
}

/// A parameter by its name in `--set` and sweeps.
mod parameter_name {
    use super::*;

    pub fn serialize<S: Serializer>(parameter: &Parameter, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(parameter)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Parameter, D::Error> {
        let name = String::deserialize(deserializer)?;
        let fits = |parameter: &Parameter| !matches!(parameter, Parameter::R0 | Parameter::Law(_));
        let parameter = name.parse().ok().filter(fits);
        parameter.ok_or_else(|| {
            let names: Vec<_> =
                Parameter::ALL.into_iter().filter(|p| *p != Parameter::R0).map(Parameter::name).collect();
            let nearest = did_you_mean(&name, names.iter().copied());
            let known = names.into_iter().chain(Parameter::OF_CUES).collect::<Vec<_>>().join(", ");
            serde::de::Error::custom(format!("parameter = {}: must be one of {known}{nearest}", shown(&name)))
        })
    }
}
