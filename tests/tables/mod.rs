//! Reference tables and helpers shared by tests.
#![allow(dead_code)]

use std::collections::HashMap;
use std::path::PathBuf;

use furrow::cortex::Cortex;
use furrow::numerics::newton::{Newton, NewtonScratch};
use furrow::numerics::{LinearCondition, Solution};
use furrow::steady::continuation::Continuation;
use furrow::steady::path;

/// One row of a table, by column name.
#[derive(Clone, Debug)]
pub struct Row(HashMap<String, String>);

impl Row {
    /// A column as text.
    pub fn text(&self, column: &str) -> &str {
        &self.0[column]
    }

    /// A column as a number.
    pub fn number(&self, column: &str) -> f64 {
        self.0[column].parse().unwrap_or_else(|_| panic!("{column} is not a number in {self:?}"))
    }
}

/// Rows of `../shared/reference/<name>`; `None`, with a printed reason, if the folder is absent.
pub fn reference(name: &str) -> Option<Vec<Row>> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/reference").join(name);
    let Ok(text) = std::fs::read_to_string(&path) else {
        println!("skipped: {} is not here", path.display());
        return None;
    };
    let mut lines = text.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty());
    let header: Vec<&str> = lines.next()?.split(',').collect();
    Some(
        lines
            .map(|line| Row(header.iter().map(|h| h.to_string()).zip(line.split(',').map(str::to_string)).collect()))
            .collect(),
    )
}

/// The point near the newest of a branch where scalar unknown `index` has a value.
pub fn at_scalar(branch: &mut Continuation<Cortex>, index: usize, value: f64) -> Solution {
    let mut y = branch.state.solution.clone();
    let mut condition = LinearCondition::default();
    path::scalar_condition(&y, index, value, &mut condition);
    let mut cortex = branch.problem.clone();
    let mut system = furrow::numerics::System::new(furrow::numerics::BoundaryValueProblem::dimensions(&cortex), y.m);
    let newton = Newton { tolerance: 1e-11, ..Newton::default() };
    newton.solve(&mut system, &mut NewtonScratch::default(), &mut cortex, &mut y, &[condition], false).unwrap();
    y
}
