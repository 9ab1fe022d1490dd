//! Counts of work.

use std::ops::AddAssign;

use serde::{Deserialize, Serialize};

use super::iteration::NewtonReport;

/// Work of a whole run: of a continuation, a curve in two parameters, or steps in time.
///
/// ```
/// use furrow_bvp::{NewtonReport, Work};
/// let mut work = Work { steps: 1, ..Work::default() };
/// work += NewtonReport { iterations: 3, factorisations: 1, ..NewtonReport::default() };
/// work += work;
/// assert_eq!((work.steps, work.iterations, work.factorisations), (2, 6, 2));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Work {
    /// Steps accepted.
    pub steps: usize,
    /// Steps rejected.
    pub rejected: usize,
    /// Newton iterations, counting every linear solve.
    #[serde(rename = "newton_iterations")]
    pub iterations: usize,
    /// Factorisations of the Jacobian.
    pub factorisations: usize,
    /// Times the mesh was moved.
    pub remeshings: usize,
}

impl AddAssign for Work {
    fn add_assign(&mut self, other: Work) {
        self.steps += other.steps;
        self.rejected += other.rejected;
        self.iterations += other.iterations;
        self.factorisations += other.factorisations;
        self.remeshings += other.remeshings;
    }
}

impl AddAssign<NewtonReport> for Work {
    fn add_assign(&mut self, report: NewtonReport) {
        self.iterations += report.iterations;
        self.factorisations += report.factorisations;
    }
}
