//! Divisions of named cells, each as large as her mother's division makes her, over values of unknowns; their derivatives.
//!
//! Cells are founders of the lineage or descend from them. Only they and their ancestors are computed, not the whole tree; cells of a
//! generation are divided in parallel.

use furrow_cell::cue::{Profile, Quantity, Term};
use furrow_cell::{Cell, Cue, Parameter};
use furrow_lineage::batch::scheduler;
use furrow_lineage::batch::{Memo, solve};
use furrow_lineage::grow::oriented;
use furrow_lineage::{Daughter, Lineage, Mother, Place};
use furrow_mechanics::division::{Division, DivisionInput, DivisionOptions, Outcome, divide_with};
use std::collections::BTreeMap;

use super::search::FitRun;
use super::unknowns::Unknown;
use crate::compare::names_of;
use crate::constants::ConstantKind;

/// The radius of the first cell.
const R0: ConstantKind = ConstantKind::Parameter(Parameter::R0);

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

impl Born {
    /// Whether it is the larger daughter of two with these radii, the posterior one first. Of equal ones the anterior counts as larger.
    fn is_larger(self, [posterior, anterior]: [f64; 2]) -> bool {
        match self {
            Born::BySize(daughter) => daughter == Daughter::Larger,
            Born::Anterior => anterior >= posterior,
            Born::Posterior => posterior > anterior,
        }
    }
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
        order.sort_by_cached_key(|&k| kin.cells[k].generation);
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
            if let ConstantKind::Parameter(parameter) = unknown.kind {
                parameter.set(&mut cell, *value);
            }
        }
        cell.cue
    }

    /// The mirror image of the cue with these values, by bands at 1 − u0; `None` if it is the cue itself, has another kind of term, or
    /// is out of the ranges.
    pub fn mirror_image(&self, values: &[f64]) -> Option<String> {
        let is_place = |kind| matches!(kind, ConstantKind::Parameter(Parameter::Cue { quantity: Quantity::U0, .. }));
        let mirrored = |(unknown, value): (&Unknown, &f64)| match is_place(unknown.kind) {
            true => unknown.share(1.0 - value).filter(|_| unknown.founders.is_none()).map(|_| 1.0 - value),
            false => Some(*value),
        };
        let values: Vec<f64> = self.unknowns.iter().zip(values).map(mirrored).collect::<Option<_>>()?;
        let places = |cue: &Cue| {
            let of = |term: &Term| if let Profile::Band { u0, .. } = term.profile { Some(u0) } else { None };
            cue.terms().iter().map(of).collect::<Option<Vec<f64>>>().filter(|_| cue.regulator().is_none())
        };
        let image = self.cue(&values);
        let (image_places, own) = (places(&image)?, places(self.template)?);
        // A place that is not searched has a mirror image in the middle alone.
        let is_free = |term: usize| {
            let kind = ConstantKind::Parameter(Parameter::Cue { term, quantity: Quantity::U0 });
            self.unknowns.iter().any(|unknown| unknown.kind == kind)
        };
        let holds = own.iter().enumerate().all(|(term, u0)| is_free(term) || *u0 == 0.5);
        (holds && image_places.iter().any(|u0| *u0 != 0.5)).then(|| image.to_string())
    }

    /// The values at a place of the unit cube.
    pub fn values(&self, place: &[f64]) -> Vec<f64> {
        self.unknowns.iter().zip(place).map(|(unknown, share)| unknown.value(*share)).collect()
    }

    /// The place in the unit cube of the values that the lineage, the run and the cue give; `None` where one is outside its range.
    pub fn given(&self) -> Option<Vec<f64>> {
        self.unknowns.iter().map(|unknown| unknown.share(self.given_value(unknown)?)).collect()
    }

    fn given_value(&self, unknown: &Unknown) -> Option<f64> {
        let FitRun { lineage, settings, .. } = self.run;
        let founder = self.a_founder_of(unknown)?;
        let ConstantKind::Parameter(parameter) = unknown.kind else { return Some(lineage.growth(founder)) };
        let r0 = self.first_r0();
        let place = Place { founder, round: 0, generation: lineage.generation(founder), r0, apart: 0 };
        let mut cell = Cell { r0, cue: self.template.clone(), ..settings.cell.clone() };
        lineage.set_physics(place, &mut cell, None).ok()?;
        Some(parameter.get(&cell))
    }

    /// The first founder that has an unknown.
    fn a_founder_of(&self, unknown: &Unknown) -> Option<usize> {
        (0..self.run.lineage.founders.len()).find(|founder| unknown.is_of(*founder))
    }

    /// The place in the unit cube of the values of another model of the same cue, which may have fewer unknowns; `None` where one is
    /// outside its range.
    pub fn place_of(&self, unknowns: &[Unknown], values: &[f64]) -> Option<Vec<f64>> {
        let value = |unknown: &Unknown| {
            let founder = self.a_founder_of(unknown)?;
            let same = |(other, _): &(&Unknown, &f64)| other.kind == unknown.kind && other.is_of(founder);
            let known = unknowns.iter().zip(values).find(same).map(|(_, value)| *value);
            unknown.share(known.or_else(|| self.given_value(unknown))?)
        };
        self.unknowns.iter().map(value).collect()
    }

    /// The radius that the lineage or the run gives the first cell.
    fn first_r0(&self) -> f64 {
        let FitRun { lineage, settings, .. } = self.run;
        lineage.given_r0(lineage.first()).unwrap_or(settings.cell.r0)
    }

    /// The factor on all given radii at values of the unknowns, R0 of the first cell among them.
    fn scale(&self, values: &[f64]) -> f64 {
        let found = self.unknowns.iter().zip(values).find(|(unknown, _)| unknown.kind == R0);
        found.map_or(1.0, |(_, r0)| r0 / self.first_r0())
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
        if self.run.lineage.depends_on_mothers() {
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
            let solved = scheduler::in_parallel(places.len(), |k| self.born(places.start + k));
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

    /// Whether a cell carries the cue.
    pub fn has_cue(&self, name: &str) -> bool {
        let input = |k: usize| self.input(k, self.radii[k]?);
        self.model.kin.place(name).and_then(input).is_some_and(|input| input.cell.has_cue())
    }

    /// χ of a cell; `None` if it does not divide.
    pub fn chi(&self, name: &str) -> Option<f64> {
        self.divisions[self.model.kin.place(name)?].as_ref()?.chi()
    }

    fn radius(&self, k: usize) -> Option<f64> {
        let lineage = self.model.run.lineage;
        let cell = &self.model.kin.cells[k];
        let scale = self.model.scale(self.values);
        if let Some(share) = self.volumes.get(&cell.name) {
            return Some(scale * self.model.first_r0() * share.cbrt());
        }
        let own = lineage.given_r0(cell.founder).filter(|_| cell.round == 0);
        let Some((mother, born)) = cell.mother.filter(|_| own.is_none()) else {
            return Some(scale * own.unwrap_or(self.model.first_r0()));
        };
        let [posterior, anterior] = self.daughters(mother)?;
        let born_with = match born {
            Born::BySize(Daughter::Larger) => anterior.max(posterior),
            Born::BySize(Daughter::Smaller) => anterior.min(posterior),
            Born::Anterior => anterior,
            Born::Posterior => posterior,
        };
        Some(born_with * self.growth(cell.founder).cbrt())
    }

    /// The factor on volumes between birth and division of a founder's cells.
    fn growth(&self, founder: usize) -> f64 {
        let own = |(unknown, _): &(&Unknown, &f64)| unknown.kind == ConstantKind::Growth && unknown.is_of(founder);
        let found = self.model.unknowns.iter().zip(self.values).find(own);
        found.map_or_else(|| self.model.run.lineage.growth(founder), |(_, growth)| *growth)
    }

    /// The radii of a cell's daughters, the posterior one first.
    fn daughters(&self, k: usize) -> Option<[f64; 2]> {
        let division = self.divisions[k].as_ref()?;
        let cell = &self.model.kin.cells[k];
        let parameters = self.input(k, self.radii[k]?)?.cell;
        oriented(division, &parameters, &cell.name, self.model.run.settings.seed).daughters()
    }

    /// [`Place::apart`] of a cell.
    fn apart(&self, k: usize) -> u32 {
        let Relative { founder, round, mother, .. } = self.model.kin.cells[k];
        let lineage = self.model.run.lineage;
        if round == 0 || lineage.founders[founder].cue_passes_to.is_none() {
            return 0;
        }
        let Some((mother, born)) = mother else { return 0 };
        let is_larger = self.daughters(mother).is_none_or(|radii| born.is_larger(radii));
        lineage.apart(founder, self.apart(mother), is_larger)
    }

    /// The cue that a cell has in place of its lineage's, with the numbers of this model. If the law reads a regulator, cells without
    /// the cue have its regulator alone.
    fn cue_in_place_of(&self, cell: Cell) -> Cue {
        let alone = || cell.cue.unpolarised().filter(|alone| cell.law_reads_regulator() && *alone == cell.cue);
        match alone().and_then(|_| self.cue.unpolarised()) {
            _ if !cell.has_cue() => cell.cue,
            Some(alone) => alone,
            None => self.cue.clone(),
        }
    }

    /// The division of a cell of that radius; `None` if rules give it a value that is not allowed.
    fn input(&self, k: usize, r0: f64) -> Option<DivisionInput> {
        let FitRun { lineage, settings, .. } = self.model.run;
        let Relative { founder, round, generation, mother, .. } = self.model.kin.cells[k];
        let place = Place { founder, round, generation, r0, apart: self.apart(k) };
        let own = lineage.cue_at(place);
        let cue = self.cue_in_place_of(settings.cell.clone().with_cue(own));
        let mut cell = Cell { r0, cue, ..settings.cell.clone() };
        let mother = mother.filter(|_| lineage.has_physics_rules());
        let mother = mother.and_then(|(mother, _)| {
            let r0 = self.radii[mother]?;
            Some((self.input(mother, r0)?.cell, self.divisions[mother].as_ref()))
        });
        let mother = mother.as_ref().map(|(cell, division)| Mother::of(cell, *division));
        lineage.set_physics(place, &mut cell, mother).ok()?;
        for (unknown, value) in self.model.unknowns.iter().zip(self.values) {
            // A number of the cue that all cells share is in the cue already, and a radius in the cell.
            let is_set = unknown.founders.is_none() && (unknown.kind.is_of_cue() || unknown.kind == R0);
            if let ConstantKind::Parameter(parameter) = unknown.kind
                && unknown.is_of(founder)
                && !is_set
            {
                parameter.set(&mut cell, *value);
            }
        }
        Some(DivisionInput { cell, numerics: settings.numerics, seed: settings.seed })
    }

    /// ∂χ/∂(unknown) of each of these cells; `None` for a cell that does not divide, or if its outcome is not smooth.
    pub fn sensitivities<'n>(&self, names: impl IntoIterator<Item = &'n str>) -> Vec<Option<Vec<f64>>> {
        let mut slopes: Vec<Option<Slopes>> = vec![None; self.radii.len()];
        for places in self.model.kin.generations() {
            let found = scheduler::in_parallel(places.len(), |k| self.follow(places.start + k, &slopes));
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
        let acting = |unknown: &Unknown| {
            let acts = |parameter: &Parameter| parameter.is_of(&input.cell) && *parameter != Parameter::R0;
            unknown.kind.parameter().filter(acts).filter(|_| unknown.is_of(cell.founder))
        };
        let own: Vec<Parameter> = unknowns.iter().filter_map(acting).collect();
        let parameters: Vec<Parameter> = [Parameter::R0].into_iter().chain(own.iter().copied()).collect();
        let options = DivisionOptions { parameters: &parameters, ..DivisionOptions::default() };
        let (division, by) = divide_with(&input, options).ok()?;
        let (by, sign) = (by?, division.chi_signed()?.signum());
        let is_given =
            self.volumes.contains_key(&cell.name) || cell.round == 0 && lineage.given_r0(cell.founder).is_some();
        let radius = match cell.mother.filter(|_| !is_given) {
            Some((mother, born)) => {
                let is_larger = born.is_larger(self.daughters(mother)?);
                let growth = self.growth(cell.founder);
                let of = |((unknown, value), slope): ((&Unknown, &f64), f64)| match unknown.kind {
                    // R0 goes with the third root of growth.
                    ConstantKind::Growth if unknown.is_of(cell.founder) => growth.cbrt() * slope + r0 / (3.0 * value),
                    _ => growth.cbrt() * slope,
                };
                let slopes = before[mother].as_ref()?.radius(is_larger);
                unknowns.iter().zip(self.values).zip(slopes).map(of).collect()
            }
            // A given radius is in proportion to the first cell's.
            None => {
                let by = |(unknown, value): (&Unknown, &f64)| if unknown.kind == R0 { r0 / value } else { 0.0 };
                unknowns.iter().zip(self.values).map(by).collect()
            }
        };
        let of = |(unknown, radius): (&Unknown, &f64)| {
            let place = acting(unknown).and_then(|parameter| own.iter().position(|number| *number == parameter));
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

    /// Where a cue passes to one daughter, cells have the χ that they have in the tree.
    #[test]
    fn a_cue_that_passes_to_one_daughter_does_so_here_too() {
        let text = r#"(name: "x", limits: (max_depth: 3), cues: {"basal": "tension:gradient,amplitude=-0.3"},
            founders: [(name: "N", r0: 5.0, cue: "basal", cue_passes_to: larger)])"#;
        let lineage = Lineage::parse(text, "x.ron").unwrap();
        let (settings, cancel) = (TreeSettings { r0_step: 0.0, ..TreeSettings::default() }, false.into());
        let memo = Memo::new(furrow_lineage::batch::Quantisation::EXACT);
        let options = furrow_lineage::batch::SchedulerOptions::default();
        let ends = furrow_lineage::EndRule::Dynamics;
        let grower =
            furrow_lineage::Grower { lineage: &lineage, settings: settings.clone(), ends, memo: &memo, options };
        let (tree, _) = grower.grow(solve).unwrap();
        let names: Vec<String> = tree.cells().map(|id| tree.cell(id).name.clone()).collect();
        let kin = Kin::of(&lineage, names.iter().map(String::as_str));
        let template = lineage.cues["basal"].clone();
        let run = FitRun::new(&lineage, &settings, 1, &cancel);
        let model = Model { run, template: &template, unknowns: Vec::new(), kin, memo: Some(&memo) };
        let found = model.chi(&[], &names);
        let divided = tree.cells().zip(found).filter(|(id, _)| tree.daughters(*id).is_some());
        let pairs: Vec<_> =
            divided.map(|(id, chi)| (tree.cell(id).fate.chi(), chi, tree.cell(id).cue.is_none())).collect();
        let agrees = |(tree, here, _): &(Option<f64>, Option<f64>, bool)| (tree.unwrap() - here.unwrap()).abs() < 1e-9;
        assert!(pairs.len() == 7 && pairs.iter().all(agrees), "{pairs:?}");
        let unequal: Vec<bool> = pairs.iter().map(|(chi, ..)| chi.unwrap() > 0.1).collect();
        let carrying: Vec<bool> = pairs.iter().map(|(.., is_none)| !is_none).collect();
        assert!(unequal == carrying && unequal.iter().filter(|is| **is).count() == 3, "{pairs:?}");
    }

    /// A number of one class of cells changes the divisions of this class and, through the radius, of its descendants.
    #[test]
    fn numbers_of_a_class_of_cells_act_on_their_descendants_by_the_radius_alone() {
        let preset = Numerics::default();
        let numerics = Numerics { time_tolerance: FINER * preset.time_tolerance, noise: 0.0, ..preset };
        let (lineage, settings) = (Lineage::c_elegans().unwrap(), TreeSettings { numerics, ..TreeSettings::default() });
        let (template, cancel) = (Cue::published(), false.into());
        let epsilon = |founder: &str| Unknown {
            kind: ConstantKind::Parameter(Parameter::Epsilon),
            limits: [0.6, 0.95],
            logarithmic: false,
            sign: 1.0,
            founders: Some((founder.to_owned(), vec![lineage.founder_named(founder).unwrap()])),
            except: Vec::new(),
        };
        let r0 = Unknown { kind: R0, limits: [2.0, 11.0], founders: None, ..epsilon("P0") };
        let growth = Unknown { kind: ConstantKind::Growth, limits: [0.5, 2.0], ..epsilon("P1") };
        let unknowns = vec![epsilon("P0"), epsilon("P1"), r0, growth];
        let names = ["P0", "P1"];
        let kin = Kin::of(&lineage, names.into_iter().chain(["ABa", "Q9", "ABx", "EMSa"]));
        assert_eq!(kin.cells.iter().map(|cell| cell.name.as_str()).collect::<Vec<_>>(), ["P0", "P1", "AB", "ABa"]);
        let run = FitRun::new(&lineage, &settings, 1, &cancel);
        let model = Model { run, template: &template, unknowns, kin, memo: None };
        let (values, volumes) = ([0.87, 0.86, 5.3, 1.1], BTreeMap::new());
        let exact = Chain::of(&model, &values, &volumes).sensitivities(names);
        let exact: Vec<Vec<f64>> = exact.into_iter().map(Option::unwrap).collect();
        assert_eq!(Chain::of(&model, &values, &volumes).r0("P0"), Some(5.3));
        for k in 0..4 {
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
        assert!(exact[0][3] == 0.0 && exact[1][3].abs() > 1e-2, "{exact:?}");
        // Its radius is the one of a daughter that is 1.1 times as large when she divides.
        let radius = |values: &[f64]| Chain::of(&model, values, &volumes).r0("P1").unwrap();
        assert!((radius(&values) / radius(&[0.87, 0.86, 5.3, 1.0]) - 1.1_f64.cbrt()).abs() < 1e-12);
        assert!(exact[0][1] == 0.0 && exact[0][0].abs() > 0.1 && exact[1][0].abs() > 1e-3, "{exact:?}");
    }
}
