//! The context of all figures, and their results: findings and artifacts.

use super::paper::Statement;
use crate::boundary::edges;
use crate::diagram::Edges;
use crate::{Row, Run, Sweep};
use furrow_cell::settings::{Overrides, Settings};
use furrow_cell::{Cell, Cue, Numerics, Scheme, ZYGOTE};
use furrow_input::InputError;
use furrow_lineage::batch::{
    self, Memo, PhaseDiagram, PhasePlane, SchedulerError, SchedulerOptions, StoreWarning, scheduler,
};
use furrow_lineage::{GrowError, Tree};
use furrow_mechanics::division::{Division, DivisionInput, Trajectory};
use furrow_mechanics::equilibria::Branch;
use furrow_mechanics::perturbation::Perturbation;
use serde_json::Value;
use std::sync::atomic::{AtomicBool, Ordering};

/// ξ_s of the paper's cells (Table S3).
pub(crate) const PUBLISHED_ACTIVITY: f64 = 25.0;
/// Time steps of the published scheme, in τ: the paper does not print its own.
pub const PUBLISHED_STEPS: [f64; 2] = [0.1, 0.01];
/// ε of the paper's cells.
pub(crate) const PUBLISHED_CONFINEMENT: f64 = 0.87;

/// Settings and resources for figures. Results depend only on the settings, not on threads or the memo.
pub struct Context<'a> {
    /// Constants and discretisation. Single cells take size, confinement and activity from the paper, lineages from these
    /// settings.
    pub settings: &'a Settings,
    /// Remembers divisions.
    pub memo: &'a Memo,
    /// Threads; 0 is one for each core.
    pub threads: usize,
    /// Set to true to stop.
    pub cancel: &'a AtomicBool,
    /// Measured divisions, if there are any, with the name of their table.
    pub measured: Option<(&'a str, &'a [furrow_measured::events::Division])>,
    /// Called before each figure with its name, the number of figures done and the number of all figures.
    pub progress: &'a (dyn Fn(&str, usize, usize) + Sync),
}

/// The reason why no figure is reproduced.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReproduceError {
    /// A file that ships, or an argument, cannot be read.
    #[error(transparent)]
    Input(#[from] InputError),
    /// No workers can be started.
    #[error(transparent)]
    Workers(#[from] SchedulerError),
    /// It was cancelled.
    #[error("interrupted")]
    Interrupted,
}

impl From<GrowError> for ReproduceError {
    fn from(error: GrowError) -> ReproduceError {
        match error {
            GrowError::Workers(error) => ReproduceError::Workers(error),
            GrowError::Interrupted { .. } => ReproduceError::Interrupted,
        }
    }
}

/// What was found for one statement.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The statement's id.
    pub id: String,
    /// The computed result: a number, or words.
    pub computed: Value,
    /// The same with the published scheme at each of [`PUBLISHED_STEPS`], where that was computed, and whether it meets the
    /// criterion.
    pub published: Vec<(bool, String)>,
    /// Whether the criterion is met; `None` if the printed number decides, or if there is no verdict.
    pub holds: Option<bool>,
    /// A remark.
    pub note: Option<String>,
}

impl Finding {
    /// A value that is compared with the printed number, or with nothing.
    pub fn new(id: &str, computed: impl Into<Value>) -> Finding {
        let (id, computed) = (id.to_owned(), computed.into());
        Finding { id, computed, published: Vec::new(), holds: None, note: None }
    }

    /// Words, and whether the criterion is met.
    pub fn judged(id: &str, (holds, computed): (bool, String)) -> Finding {
        Finding { holds: Some(holds), ..Finding::new(id, computed) }
    }

    /// What could not be computed, which does not agree.
    pub(crate) fn not_computed(id: &str, why: impl std::fmt::Display) -> Finding {
        Finding::judged(id, (false, format!("not computed: {why}")))
    }

    /// The same with a note.
    pub(crate) fn noting(self, note: impl Into<String>) -> Finding {
        Finding { note: Some(note.into()), ..self }
    }
}

/// Outcomes over a plane.
#[derive(Clone, Debug)]
pub struct Map {
    /// The plane.
    pub plane: PhasePlane,
    /// How divisions end.
    pub diagram: PhaseDiagram,
    /// The curves of pitchforks and folds in it.
    pub edges: Edges,
}

/// A result that can be drawn or written as a table.
#[derive(Debug)]
pub enum Artifact {
    /// A sweep.
    Sweep(Box<Sweep>, Vec<Row>),
    /// Outcomes over a plane.
    Map(Box<Map>),
    /// Branches of a cell, with their names.
    Branches(Cell, Vec<(&'static str, Branch)>),
    /// A division.
    Film(Cell, Box<Trajectory>),
    /// Disturbed shapes of one cell at several activities, with their names.
    Perturbations(Cell, Vec<(String, Perturbation)>),
    /// A lineage.
    Tree(Box<Tree>),
}

/// An artifact under the name of its file.
#[derive(Debug)]
pub struct NamedArtifact {
    /// The name of its file, without the extension.
    pub name: String,
    /// The contents.
    pub artifact: Artifact,
}

/// One figure under way: its statements, and what was found for them.
pub struct Figure<'a> {
    /// Settings and resources of the computation.
    pub context: &'a Context<'a>,
    /// The statements of the figure, one at least.
    pub statements: &'a [Statement],
    /// What was found.
    pub findings: Vec<Finding>,
    /// Its artifacts.
    pub panels: Vec<NamedArtifact>,
    /// Warnings about the store.
    pub warnings: Vec<StoreWarning>,
}

impl Context<'_> {
    /// A cell of the paper: of this size in this shell, at ξ_s = 25 and without a cue.
    pub fn cell(&self, r0: f64, epsilon: f64) -> Cell {
        Cell { r0, epsilon, xi_s: PUBLISHED_ACTIVITY, cue: Cue::none(), ..self.settings.cell.clone() }
    }

    /// The converged discretisation.
    pub fn converged(&self) -> Numerics {
        Numerics { scheme: Scheme::Converged, ..self.settings.numerics }
    }

    /// The discretisation of the paper's kind, with a time step in τ.
    pub fn published(&self, dt: f64) -> Numerics {
        Numerics { scheme: Scheme::Published, dt, ..self.settings.numerics }
    }

    /// The division of a cell, converged.
    pub fn input(&self, cell: Cell) -> DivisionInput {
        DivisionInput { numerics: self.converged(), ..DivisionInput::new(cell) }
    }

    /// How divisions are scheduled.
    pub fn options(&self) -> SchedulerOptions<'_> {
        SchedulerOptions { threads: self.threads, interrupt: Some(self.cancel), ..SchedulerOptions::default() }
    }

    /// # Errors
    /// [`ReproduceError::Interrupted`] if it was cancelled.
    pub(crate) fn check_cancelled(&self) -> Result<(), ReproduceError> {
        if self.cancel.load(Ordering::SeqCst) { Err(ReproduceError::Interrupted) } else { Ok(()) }
    }
}

impl<'a> Figure<'a> {
    /// Its name.
    pub fn name(&self) -> &'a str {
        &self.statements[0].figure
    }

    /// Adds words, and whether the criterion is met.
    pub(crate) fn judge(&mut self, id: &str, holds: bool, computed: String) {
        self.findings.push(Finding::judged(id, (holds, computed)));
    }

    /// The same, or why it is not computed.
    pub(crate) fn judge_found(&mut self, id: &str, found: Result<(bool, String), impl std::fmt::Display>) {
        self.findings.push(match found {
            Ok(judged) => Finding::judged(id, judged),
            Err(why) => Finding::not_computed(id, why),
        });
    }

    /// Adds a number, or why it is missing.
    pub fn number(&mut self, id: &str, computed: Result<f64, impl std::fmt::Display>) {
        self.findings.push(match computed {
            Ok(number) => Finding::new(id, number),
            Err(why) => Finding::not_computed(id, why),
        });
    }

    /// Adds a picture.
    pub fn show(&mut self, name: &str, artifact: Artifact) {
        self.panels.push(NamedArtifact { name: name.to_owned(), artifact });
    }

    /// The cell of a statement; the paper's zygote by default.
    pub(crate) fn cell_of(&self, statement: &Statement) -> Cell {
        let of = statement.cell.map_or((ZYGOTE, PUBLISHED_CONFINEMENT), |of| (of.r0, of.epsilon));
        self.context.cell(of.0, of.1)
    }

    /// Divisions, in the order of the inputs; `None` for one that could not be computed.
    ///
    /// # Errors
    /// [`ReproduceError`].
    pub fn divisions(&mut self, inputs: Vec<DivisionInput>) -> Result<Vec<Option<Division>>, ReproduceError> {
        let solved = scheduler::solve_all(inputs, self.context.memo, &self.context.options(), batch::solve)?;
        self.warnings.extend(solved.summary.warnings);
        self.context.check_cancelled()?;
        Ok(solved.divisions)
    }

    /// A sweep that ships, solved.
    ///
    /// # Errors
    /// [`ReproduceError`].
    pub fn sweep(&mut self, text: &str, file: &str) -> Result<(Sweep, Vec<Row>), ReproduceError> {
        let context = self.context;
        // Keys that the sweep does not set keep the values of the paper's zygote.
        let base = Settings { cell: context.cell(ZYGOTE, PUBLISHED_CONFINEMENT), ..context.settings.clone() };
        let sweep = Sweep::parse(text, file, &base, &Overrides::default())?;
        let solved = Run { threads: context.threads, ..Run::new(&sweep, context.memo, context.cancel) }.solve()?;
        self.warnings.extend(solved.summary.warnings);
        if solved.summary.interrupted {
            return Err(ReproduceError::Interrupted);
        }
        Ok((sweep, solved.rows))
    }

    /// A phase diagram, which is shown under the figure's name.
    ///
    /// # Errors
    /// [`ReproduceError`].
    pub fn plane(&mut self, plane: PhasePlane) -> Result<(), ReproduceError> {
        let diagram = plane.compute(self.context.memo, &self.context.options())?;
        self.warnings.extend_from_slice(&diagram.summary.warnings);
        if diagram.summary.interrupted {
            return Err(ReproduceError::Interrupted);
        }
        // Without the curves the picture has the edges at each value across.
        let (edges, _) = edges(&plane, 0);
        self.show(self.name(), Artifact::Map(Box::new(Map { plane, diagram, edges })));
        Ok(())
    }
}
