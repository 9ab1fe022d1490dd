//! Divisions of named cells, each as large as her mother's division makes her, over values of unknowns; their derivatives.
//!
//! Cells are founders of the lineage or descend from them. Only they and their ancestors are computed, not the whole tree; cells of a
//! generation are divided in parallel.

use furrow_cell::{Cell, Cue, Parameter};
use furrow_lineage::batch::{Memo, solve};
use furrow_lineage::grow::oriented;
use furrow_lineage::{Daughter, Lineage, Mother, Place};
use furrow_mechanics::division::{Division, DivisionInput, DivisionOptions, Outcome, divide_with};
use rayon::prelude::*;
use std::collections::BTreeMap;

use super::search::FitRun;
use super::unknowns::Unknown;
use crate::compare::names_of;

/// Factor on the time tolerance for sensitivities, and the least tolerance: derivatives show errors that χ does not.
pub(super) const FINER: f64 = 1e-2;
const FINEST: f64 = 1e-8;

/// Which daughter a cell is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Born {
    /// A founder: by size.
    BySize(Daughter),
    /// A cell below a founder: by side.
    Anterior,
    Posterior,
}

/// A cell and its mother among the others.
#[derive(Clone, Debug)]
struct Relative {
    name: String,
    founder: usize,
    round: u32,
    generation: u32,
    /// Its mother's place and which daughter it is; `None` for a cell of given radius.
    mother: Option<(usize, Born)>,
}

/// Some cells of a lineage and their ancestors, mothers before daughters.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kin {
    cells: Vec<Relative>,
}

impl Kin {
    /// The cells with these names and their ancestors. Names that no cell of the lineage has are left out.
    pub fn of<'n>(lineage: &Lineage, names: impl IntoIterator<Item = &'n str>) -> Kin {
        let (mut kin, known) = (Kin::default(), names_of(lineage));
        let birth = |name: &str| known.birth(name).map(|(mother, _, first)| (mother.to_owned(), first));
        for name in names {
            kin.add(lineage, name, &birth);
        }
        // A cell refers to its mother by her place.
        let mut order: Vec<usize> = (0..kin.cells.len()).collect();
        order.sort_by_key(|&k| kin.cells[k].generation);
        let mut at = vec![0; order.len()];
        order.iter().enumerate().for_each(|(new, &old)| at[old] = new);
        let moved = |old: usize| {
            let cell = kin.cells[old].clone();
            Relative { mother: cell.mother.map(|(mother, born)| (at[mother], born)), ..cell }
        };
        Kin { cells: order.into_iter().map(moved).collect() }
    }

    fn add(&mut self, lineage: &Lineage, name: &str, birth: &dyn Fn(&str) -> Option<(String, bool)>) -> Option<usize> {
        if let Some(known) = self.place(name) {
            return Some(known);
        }
        let relative = match lineage.founder_named(name) {
            Some(founder) => {
                let has_given = lineage.given_r0(founder).is_some() && !lineage.has_physics_rules();
                let mother = lineage.mother(founder).filter(|_| !has_given);
                let daughter = lineage.founders[founder].daughter.unwrap_or(Daughter::Larger);
                let mother = mother.and_then(|mother| {
                    Some((self.add(lineage, &lineage.founders[mother].name, birth)?, Born::BySize(daughter)))
                });
                let generation = lineage.generation(founder);
                Relative { name: name.to_owned(), founder, round: 0, generation, mother }
            }
            None => {
                let (mother, _) = birth(name)?;
                let at = self.add(lineage, &mother, birth)?;
                let Relative { founder, round, generation, .. } = self.cells[at];
                let (anterior, posterior) = lineage.letters(founder, round as usize + 1);
                let born = match name.strip_prefix(mother.as_str())?.chars().next()? {
                    letter if letter == anterior => Born::Anterior,
                    letter if letter == posterior => Born::Posterior,
                    _ => return None,
                };
                let (round, generation) = (round + 1, generation + 1);
                Relative { name: name.to_owned(), founder, round, generation, mother: Some((at, born)) }
            }
        };
        self.cells.push(relative);
        Some(self.cells.len() - 1)
    }

    /// The place of a cell.
    pub fn place(&self, name: &str) -> Option<usize> {
        self.cells.iter().position(|cell| cell.name == name)
    }

    /// Places of one generation after the other.
    fn generations(&self) -> Vec<std::ops::Range<usize>> {
        let mut start = 0;
        let of = |cells: &[Relative]| {
            start += cells.len();
            start - cells.len()..start
        };
        self.cells.chunk_by(|a, b| a.generation == b.generation).map(of).collect()
    }
}

/// What divisions follow from: a lineage with its parameters, a cue in place of the one that cells carry, and unknown numbers.
pub(crate) struct Model<'a> {
    pub run: FitRun<'a>,
    /// The cue, where the lineage gives a cell one.
    pub template: &'a Cue,
    pub unknowns: Vec<Unknown>,
    pub kin: Kin,
    /// Divisions already solved; `None` solves each.
    pub memo: Option<&'a Memo>,
}

impl Model<'_> {
    /// The cue with these values of the unknowns that all cells share.
    pub fn cue(&self, values: &[f64]) -> Cue {
        let mut cell = Cell::new(1.0).with_cue(self.template.clone());
        for (unknown, value) in self.unknowns.iter().zip(values).filter(|(unknown, _)| unknown.founders.is_none()) {
            unknown.parameter.set(&mut cell, *value);
        }
        cell.cue
    }

    /// The values at a place of the unit cube.
    pub fn values(&self, place: &[f64]) -> Vec<f64> {
        self.unknowns.iter().zip(place).map(|(unknown, share)| unknown.value(*share)).collect()
    }

    fn divide(&self, input: &DivisionInput) -> Option<Division> {
        match self.memo {
            Some(memo) => memo.solve(input, solve).ok(),
            None => solve(input).ok(),
        }
    }

    /// χ of cells at values of the unknowns.
    pub fn chi(&self, values: &[f64], cells: &[String]) -> Vec<Option<f64>> {
        let volumes = BTreeMap::new();
        let chain = Chain::of(self, values, &volumes);
        cells.iter().map(|cell| chain.chi(cell)).collect()
    }

    /// χ of a cell over its own radius; `None` if it does not divide.
    pub fn chi_over_r0(&self, values: &[f64], name: &str, r0: f64) -> Option<f64> {
        let volumes = BTreeMap::new();
        let mut chain = Chain::unsolved(self, values, &volumes);
        if self.run.lineage.has_physics_rules() {
            chain.solve();
        }
        self.divide(&chain.input(self.kin.place(name)?, r0)?)?.chi()
    }
}

/// How a division changes with the unknowns.
#[derive(Clone)]
struct Slopes {
    r0: f64,
    division: Division,
    /// ∂R0/∂(unknown) of the cell.
    radius: Vec<f64>,
    /// ∂χ/∂(unknown) of its division.
    chi: Vec<f64>,
}

impl Slopes {
    /// ∂R0/∂(unknown) of a daughter. Her R0 is the cell's times the third root of her share (1 ± χ)/2.
    fn radius(&self, is_larger: bool) -> Vec<f64> {
        let way = if is_larger { 1.0 } else { -1.0 };
        let asymmetric = self.division.outcome() == Outcome::Asymmetric;
        let chi = self.division.chi().filter(|_| asymmetric).unwrap_or(0.0);
        let share = 0.5 * (1.0 + way * chi);
        let of = |(radius, slope): (&f64, &f64)| {
            let change = if asymmetric { 0.5 * way * slope } else { 0.0 };
            radius * share.cbrt() + self.r0 * share.cbrt() / (3.0 * share) * change
        };
        self.radius.iter().zip(&self.chi).map(of).collect()
    }
}

/// Divisions of cells, each from its mother's.
pub(crate) struct Chain<'a> {
    model: &'a Model<'a>,
    values: &'a [f64],
    cue: Cue,
    /// Given volumes, as shares of the first cell's.
    volumes: &'a BTreeMap<String, f64>,
    radii: Vec<Option<f64>>,
    divisions: Vec<Option<Division>>,
}

impl<'a> Chain<'a> {
    fn unsolved(model: &'a Model<'a>, values: &'a [f64], volumes: &'a BTreeMap<String, f64>) -> Chain<'a> {
        let count = model.kin.cells.len();
        let (radii, divisions) = (vec![None; count], vec![None; count]);
        Chain { model, values, cue: model.cue(values), volumes, radii, divisions }
    }

    /// The divisions of all cells at these values; some volumes may be given, as shares of the first cell's.
    pub fn of(model: &'a Model<'a>, values: &'a [f64], volumes: &'a BTreeMap<String, f64>) -> Chain<'a> {
        let mut chain = Chain::unsolved(model, values, volumes);
        chain.solve();
        chain
    }

    fn solve(&mut self) {
        for places in self.model.kin.generations() {
            let solved: Vec<_> = places.clone().into_par_iter().map(|k| self.born(k)).collect();
            for (k, (r0, division)) in places.zip(solved) {
                (self.radii[k], self.divisions[k]) = (r0, division);
            }
        }
    }

    fn born(&self, k: usize) -> (Option<f64>, Option<Division>) {
        let r0 = self.radius(k);
        (r0, r0.and_then(|r0| self.model.divide(&self.input(k, r0)?)))
    }

    /// The radius of a cell; `None` if it is never born.
    pub fn r0(&self, name: &str) -> Option<f64> {
        self.radii[self.model.kin.place(name)?]
    }

    /// χ of a cell; `None` if it does not divide.
    pub fn chi(&self, name: &str) -> Option<f64> {
        self.divisions[self.model.kin.place(name)?].as_ref()?.chi()
    }

    fn radius(&self, k: usize) -> Option<f64> {
        let FitRun { lineage, settings, .. } = self.model.run;
        let cell = &self.model.kin.cells[k];
        let given = |founder: usize| lineage.given_r0(founder);
        if let Some(share) = self.volumes.get(&cell.name) {
            return Some(given(lineage.first()).unwrap_or(settings.cell.r0) * share.cbrt());
        }
        let own = given(cell.founder).filter(|_| cell.round == 0);
        let Some((mother, born)) = cell.mother.filter(|_| own.is_none()) else {
            return own.or(Some(settings.cell.r0));
        };
        let [posterior, anterior] = self.daughters(mother)?;
        let born_with = match born {
            Born::BySize(Daughter::Larger) => anterior.max(posterior),
            Born::BySize(Daughter::Smaller) => anterior.min(posterior),
            Born::Anterior => anterior,
            Born::Posterior => posterior,
        };
        Some(born_with * lineage.growth(cell.founder).cbrt())
    }

    /// The radii of a cell's daughters, the posterior one first.
    fn daughters(&self, k: usize) -> Option<[f64; 2]> {
        let division = self.divisions[k].as_ref()?;
        let cell = &self.model.kin.cells[k];
        let parameters = self.input(k, self.radii[k]?)?.cell;
        oriented(division, &parameters, &cell.name, self.model.run.settings.seed).daughters()
    }

    /// The division of a cell of that radius; `None` if rules give it a value that is not allowed.
    fn input(&self, k: usize, r0: f64) -> Option<DivisionInput> {
        let FitRun { lineage, settings, .. } = self.model.run;
        let Relative { founder, round, generation, mother, .. } = self.model.kin.cells[k];
        let place = Place { founder, round, generation, r0 };
        let own = lineage.cue_at(place);
        let cue = if own.is_none() { own } else { self.cue.clone() };
        let mut cell = Cell { r0, cue, ..settings.cell.clone() };
        let mother = mother.filter(|_| lineage.has_physics_rules());
        let mother = mother.and_then(|(mother, _)| {
            let r0 = self.radii[mother]?;
            Some((self.input(mother, r0)?.cell, self.divisions[mother].as_ref()))
        });
        let mother = mother.as_ref().map(|(cell, division)| Mother::of(cell, *division));
        lineage.set_physics(place, &mut cell, mother).ok()?;
        for (unknown, value) in self.model.unknowns.iter().zip(self.values) {
            // A number of the cue that all cells share is in the cue already.
            if unknown.is_of(founder) && !(unknown.founders.is_none() && unknown.parameter.is_of_cue()) {
                unknown.parameter.set(&mut cell, *value);
            }
        }
        Some(DivisionInput { cell, numerics: settings.numerics, seed: settings.seed })
    }

    /// ∂χ/∂(unknown) of each of these cells; `None` for a cell that does not divide, or if its outcome is not smooth.
    pub fn sensitivities<'n>(&self, names: impl IntoIterator<Item = &'n str>) -> Vec<Option<Vec<f64>>> {
        let mut slopes: Vec<Option<Slopes>> = vec![None; self.radii.len()];
        for places in self.model.kin.generations() {
            let found: Vec<_> = places.clone().into_par_iter().map(|k| self.follow(k, &slopes)).collect();
            for (k, found) in places.zip(found) {
                slopes[k] = found;
            }
        }
        let of = |name: &str| Some(slopes[self.model.kin.place(name)?].as_ref()?.chi.clone());
        names.into_iter().map(of).collect()
    }

    /// How a cell's division changes with the unknowns: by itself, and with the radius that its mother leaves it.
    fn follow(&self, k: usize, before: &[Option<Slopes>]) -> Option<Slopes> {
        let (unknowns, lineage) = (&self.model.unknowns, self.model.run.lineage);
        let cell = &self.model.kin.cells[k];
        let r0 = self.radii[k]?;
        let mut input = self.input(k, r0)?;
        input.numerics.time_tolerance = (FINER * input.numerics.time_tolerance).max(FINEST);
        let acts = |unknown: &&Unknown| unknown.is_of(cell.founder) && unknown.parameter.is_of(&input.cell);
        let own: Vec<Parameter> = unknowns.iter().filter(acts).map(|unknown| unknown.parameter).collect();
        let parameters: Vec<Parameter> = [Parameter::R0].into_iter().chain(own.iter().copied()).collect();
        let options = DivisionOptions { parameters: &parameters, ..DivisionOptions::default() };
        let (division, by) = divide_with(&input, options).ok()?;
        let (by, sign) = (by?, division.chi_signed()?.signum());
        let is_given =
            self.volumes.contains_key(&cell.name) || cell.round == 0 && lineage.given_r0(cell.founder).is_some();
        let radius = match cell.mother.filter(|_| !is_given) {
            Some((mother, born)) => {
                let [posterior, anterior] = self.daughters(mother)?;
                let is_larger = match born {
                    Born::BySize(daughter) => daughter == Daughter::Larger,
                    Born::Anterior => anterior > posterior,
                    Born::Posterior => posterior > anterior,
                };
                let grown = lineage.growth(cell.founder).cbrt();
                before[mother].as_ref()?.radius(is_larger).into_iter().map(|slope| grown * slope).collect()
            }
            None => vec![0.0; unknowns.len()],
        };
        let of = |(unknown, radius): (&Unknown, &f64)| {
            let place = own.iter().position(|number| *number == unknown.parameter).filter(|_| acts(&unknown));
            sign * (place.map_or(0.0, |i| by[i + 1].chi_signed) + by[0].chi_signed * radius)
        };
        let chi = unknowns.iter().zip(&radius).map(of).collect();
        Some(Slopes { r0, division, radius, chi })
    }
}

#[cfg(test)]
mod tests {
    use furrow_cell::Numerics;
    use furrow_lineage::TreeSettings;

    use super::super::search::moved;
    use super::*;

    /// A number of one class of cells changes the divisions of this class and, through the radius, of its descendants.
    #[test]
    fn numbers_of_a_class_of_cells_act_on_their_descendants_by_the_radius_alone() {
        let preset = Numerics::default();
        let numerics = Numerics { time_tolerance: FINER * preset.time_tolerance, noise: 0.0, ..preset };
        let (lineage, settings) = (Lineage::c_elegans().unwrap(), TreeSettings { numerics, ..TreeSettings::default() });
        let (template, cancel) = (Cue::published(), false.into());
        let epsilon = |founder: &str| Unknown {
            parameter: Parameter::Epsilon,
            limits: [0.6, 0.95],
            logarithmic: false,
            sign: 1.0,
            founders: Some((founder.to_owned(), vec![lineage.founder_named(founder).unwrap()])),
            except: Vec::new(),
        };
        let unknowns = vec![epsilon("P0"), epsilon("P1")];
        let names = ["P0", "P1"];
        let kin = Kin::of(&lineage, names.into_iter().chain(["ABa", "Q9", "ABx", "EMSa"]));
        assert_eq!(kin.cells.iter().map(|cell| cell.name.as_str()).collect::<Vec<_>>(), ["P0", "P1", "AB", "ABa"]);
        let run = FitRun::new(&lineage, &settings, 1, &cancel);
        let model = Model { run, template: &template, unknowns, kin, memo: None };
        let (values, volumes) = ([0.87, 0.86], BTreeMap::new());
        let exact = Chain::of(&model, &values, &volumes).sensitivities(names);
        let exact: Vec<Vec<f64>> = exact.into_iter().map(Option::unwrap).collect();
        for k in 0..2 {
            let chi = |step: f64| {
                let values = moved(&values, k, values[k] + step);
                let chain = Chain::of(&model, &values, &volumes);
                names.map(|name| chain.chi(name).unwrap())
            };
            let (above, below) = (chi(1e-3), chi(-1e-3));
            for (i, name) in names.into_iter().enumerate() {
                let expected = (above[i] - below[i]) / 2e-3;
                assert!(
                    (exact[i][k] - expected).abs() < 0.02 * expected.abs() + 2e-3,
                    "{name} by {k}: {exact:?} {expected}"
                );
            }
        }
        assert!(exact[0][1] == 0.0 && exact[0][0].abs() > 0.1 && exact[1][0].abs() > 1e-3, "{exact:?}");
    }
}
