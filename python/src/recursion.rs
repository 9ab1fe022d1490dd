//! A tree with each cell's parameters from a Python function.

use std::sync::Arc;

use furrow_cell::profile::ELLIPSOID;
use furrow_cell::{Cell, Cue, Parameter};
use furrow_lineage::batch::scheduler::{Solved, Summary, solve_all};
use furrow_lineage::grow::oriented;
use furrow_lineage::{CellId, Fate, FounderPhysics, Lineage, Side, TerminalReason, Tree, TreeCell, TreeSettings};
use furrow_mechanics::division::{Division, divide};
use pyo3::prelude::*;
use serde_json::json;

use crate::document::Document;
use crate::errors::{ARGUMENTS, Error};
use crate::inputs::Inputs;
use crate::memo::{Memo, run_warnings};
use crate::supervise::{Interrupt, supervised};
use crate::trees::GrownTree;

/// A cell that is born.
struct Born {
    name: String,
    r0: f64,
    volume_fraction: f64,
    /// Its mother and which daughter it is; `None` for the first cell.
    from: Option<(CellId, Side)>,
}

/// A tree as it grows.
struct Growing<'py> {
    /// The function that gives a cell its parameters; it returns `None` for a cell that does not divide.
    rule: &'py Bound<'py, PyAny>,
    tree: Option<Tree>,
    seed: u64,
    /// The memo's step of rounded radii.
    r0_step: f64,
    /// The first cell without its cue. Other cells are described by their differences from it.
    first: Cell,
}

impl Growing<'_> {
    /// Asks for the parameters of a cell.
    fn asked(&self, generation: u32, born: &Born) -> Result<Option<Inputs>, Error> {
        let side = born.from.map(|(_, side)| if side == Side::Anterior { "anterior" } else { "posterior" });
        let mother = born.from.and_then(|(id, _)| Some(self.tree.as_ref()?.cell(id)));
        let division = mother.and_then(|mother| mother.fate.division()).map(Document::of).transpose()?;
        let mother = mother.map(|mother| mother.name.as_str());
        let told = (born.name.as_str(), born.r0, born.volume_fraction, generation, side, mother, division);
        let answer = self.rule.call1(told)?;
        Ok(answer.extract::<Option<PyRef<'_, Inputs>>>().map_err(PyErr::from)?.map(|inputs| inputs.clone()))
    }

    /// Adds a cell with its fate.
    fn add(
        &mut self,
        generation: u32,
        born: Born,
        of: &Cell,
        fate: Fate,
        numerics: furrow_cell::Numerics,
    ) -> Result<CellId, Error> {
        let mut physics = FounderPhysics::default();
        for parameter in Parameter::ALL {
            let value = parameter.get(of);
            if value != parameter.get(&self.first) {
                physics.set(parameter, value);
            }
        }
        let physics = (!physics.is_empty()).then(|| Box::new(physics));
        let volume_fraction = self.volume_fraction(&born, of);
        let Born { name, from, .. } = born;
        let cue = of.cue.clone();
        let cell = TreeCell { name, founder: 0, generation, r0: of.r0, volume_fraction, cue, physics, fate };
        Ok(match (&mut self.tree, from) {
            (Some(tree), Some((mother, side))) => tree.add(mother, side, cell, false),
            (tree, _) => {
                let text = format!("(name: {0:?}, founders: [(name: {0:?})])", cell.name);
                let settings =
                    TreeSettings { seed: self.seed, r0_step: self.r0_step, cell: self.first.clone(), numerics };
                tree.insert(Tree::new(Lineage::parse(&text, ARGUMENTS)?, settings, cell)).first()
            }
        })
    }

    /// A cell's volume as a fraction of the first cell's. A radius that the function gives changes it.
    fn volume_fraction(&self, born: &Born, of: &Cell) -> f64 {
        if of.r0 == born.r0 { born.volume_fraction } else { (of.r0 / self.first.r0).powi(3) }
    }

    /// The daughters of a cell, the anterior one first.
    fn daughters(&self, id: CellId) -> Option<[Born; 2]> {
        let mother = self.tree.as_ref()?.cell(id);
        let volumes = mother.fate.daughter_volumes(mother.volume_fraction)?;
        Some([(Side::Anterior, 'a', 0), (Side::Posterior, 'p', 1)].map(|(side, letter, k)| Born {
            name: format!("{}{letter}", mother.name),
            r0: mother.r0 * (volumes[k] / mother.volume_fraction).cbrt(),
            volume_fraction: volumes[k],
            from: Some((id, side)),
        }))
    }
}

/// Grows a tree from a cell of this name, generation by generation; `rule` gives each cell its parameters. Returns it with the run's work.
#[pyfunction]
#[pyo3(signature = (name, first_r0, rule, memo, seed, limits, threads, progress=None))]
pub fn grow_by(
    py: Python<'_>,
    name: &str,
    first_r0: f64,
    rule: &Bound<'_, PyAny>,
    memo: &Memo,
    seed: u64,
    limits: (u32, usize),
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> Result<(GrownTree, Document), Error> {
    let (max_depth, max_cells) = limits;
    let known = memo.solved()?;
    let mut growing =
        Growing { rule, tree: None, seed, r0_step: known.quantisation().relative_step(), first: Cell::new(first_r0) };
    let mut born = vec![Born { name: name.to_owned(), r0: first_r0, volume_fraction: 1.0, from: None }];
    let (mut summary, mut generation) = (Summary::default(), 0);
    while !born.is_empty() {
        let cells: Vec<Option<Inputs>> =
            born.iter().map(|one| growing.asked(generation, one)).collect::<Result<_, _>>()?;
        if let (0, Some(Some(first))) = (generation, cells.first()) {
            growing.first = first.cell.clone().with_cue(Cue::none());
        }
        let shell = |inputs: &&Inputs| inputs.cell.shell_profile != growing.first.shell_profile;
        if let Some(other) = cells.iter().flatten().find(shell) {
            let given =
                other.cell.shell_profile.as_ref().map_or_else(|| ELLIPSOID.to_owned(), |profile| profile.described());
            let allowed = "that of the first cell: shells of other profiles are for founders of a lineage file";
            return Err(Error::not_allowed("shell_profile", given, allowed));
        }
        let numerics = cells.iter().flatten().next().map_or_else(Default::default, |inputs| inputs.numerics);
        let count = growing.tree.as_ref().map_or(0, Tree::len) + born.len();
        let fates = if generation >= max_depth {
            born.iter().map(|_| TerminalReason::MaxDepth { max_depth }.into()).collect()
        } else if count + 2 * born.len() > max_cells {
            born.iter().map(|_| TerminalReason::MaxCells { max_cells }.into()).collect()
        } else {
            let inputs = cells.iter().flatten().map(|inputs| inputs.division(seed)).collect::<Result<Vec<_>, _>>()?;
            let memo = Arc::clone(&known);
            let solved = supervised(py, Interrupt::Finishes, progress, move |watch| {
                let solved = watch.scheduled(threads, |options| solve_all(inputs, &memo, options, divide))?;
                if solved.summary.interrupted { Err(Error::Interrupted(0)) } else { Ok(solved) }
            })?;
            fates(generation, seed, (&born, &cells), solved, &mut summary)
        };
        let like = growing.first.clone();
        let mut next = Vec::new();
        for ((one, inputs), fate) in born.into_iter().zip(cells).zip(fates) {
            let cell = inputs.map_or_else(|| Cell { r0: one.r0, ..like.clone() }, |inputs| inputs.cell);
            let id = growing.add(generation, one, &cell, fate, numerics)?;
            next.extend(growing.daughters(id).into_iter().flatten());
        }
        (born, generation) = (next, generation + 1);
    }
    let tree = growing.tree.ok_or_else(|| Error::not_allowed("name", name, "the name of a cell"))?;
    let warnings: Vec<String> = run_warnings(&summary, &known).into_iter().chain(tree.doubts()).collect();
    let work = json!({ "divisions_solved": summary.solved, "memo_hits": summary.memo_hits, "warnings": warnings });
    Ok((GrownTree { tree: Arc::new(tree) }, work.into()))
}

/// The fates of a generation's cells: those without parameters do not divide. Where the poles of a cell are alike, its smaller daughter is
/// on the side that the seed and its name draw, as in trees of a lineage file.
fn fates(
    generation: u32,
    seed: u64,
    (born, cells): (&[Born], &[Option<Inputs>]),
    solved: Solved,
    summary: &mut Summary,
) -> Vec<Fate> {
    let Solved { divisions, unsolved, summary: run } = solved;
    summary.add(run);
    let mut divisions = divisions.into_iter().enumerate();
    let mut fate = |born: &Born, inputs: &Inputs| -> Option<Fate> {
        let (id, division): (usize, Option<Division>) = divisions.next()?;
        let why = || unsolved.iter().find(|job| job.id == id).map_or(String::new(), |job| job.failure.to_string());
        let turned = division.map(|division| oriented(&division, &inputs.cell, &born.name, seed));
        Some(turned.map_or_else(|| TerminalReason::Undecided { why: why() }.into(), Fate::from))
    };
    let ended = || TerminalReason::MaxDepth { max_depth: generation }.into();
    let of = |(born, inputs): (&Born, &Option<Inputs>)| {
        inputs.as_ref().and_then(|inputs| fate(born, inputs)).unwrap_or_else(ended)
    };
    born.iter().zip(cells).map(of).collect()
}
