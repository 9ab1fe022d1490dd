//! Reference tables and helpers shared by tests.

use std::collections::HashMap;
use std::path::PathBuf;

use furrow_bvp::newton::NewtonScratch;
use furrow_bvp::{Continuation, LinearCondition, Newton, Solution, metric};
use furrow_mechanics::cortex::Cortex;

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

/// The fields of a line; one between quotes may have commas.
fn fields(line: &str) -> impl Iterator<Item = String> {
    let mut quoted = false;
    let comma = move |c: char| {
        quoted ^= c == '"';
        c == ',' && !quoted
    };
    line.split(comma).map(|field| field.trim_matches('"').to_owned())
}

/// Rows of `tests/reference/<name>`.
pub fn reference(name: &str) -> Vec<Row> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/reference").join(name);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut lines = text.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty());
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let row = |line: &str| Row(header.iter().map(|h| h.to_string()).zip(fields(line)).collect());
    lines.map(row).collect()
}

/// The point near the newest of a branch where scalar unknown `index` has a value.
pub fn at_scalar(branch: &mut Continuation<Cortex>, index: usize, value: f64) -> Solution {
    let mut y = branch.state.solution.clone();
    let mut condition = LinearCondition::default();
    metric::scalar_condition(&y, index, value, &mut condition);
    let mut cortex = branch.problem.clone();
    let mut system = furrow_bvp::System::new(furrow_bvp::BoundaryValueProblem::dimensions(&cortex), y.m);
    let newton = Newton { tolerance: 1e-11, ..Newton::default() };
    newton.solve(&mut system, &mut NewtonScratch::default(), &mut cortex, &mut y, &[condition], false).unwrap();
    y
}
