//! What results are computed with, and what comes of it.

use std::sync::atomic::{AtomicBool, Ordering};

use serde::Serialize;

use super::paper::Statement;
use crate::batch::{Memo, PhaseDiagram, PhasePlane, SchedulerError, SchedulerOptions, StoreWarning, scheduler};
use crate::cell::{Cell, Cue, Numerics, Scheme};
use crate::division::{Division, DivisionInput, Film, divide};
use crate::input::InputError;
use crate::lineage::{GrowError, Tree, tree::ZYGOTE};
use crate::perturbation::Perturbation;
use crate::settings::Settings;
use crate::shapes::Branch;
use crate::shapes::curves::{self, Curve};
use crate::study::{Row, Run, Sweep};

/// What results are computed with. They depend on the settings alone, whatever the threads and what the memo knows.
pub struct Lab<'a> {
    /// Constants and discretisation. Sizes, confinement and activity of single cells are the paper's, those of lineages the
    /// settings'.
    pub settings: &'a Settings,
    /// Remembers divisions.
    pub memo: &'a Memo,
    /// Threads; 0 is one for each core.
    pub threads: usize,
    /// Set to true to stop.
    pub interrupt: &'static AtomicBool,
    /// Told what is being computed.
    pub progress: &'a (dyn Fn(&str) + Sync),
}

/// Why nothing can be told at all.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LabError {
    /// Something that is shipped or was asked for cannot be read.
    #[error(transparent)]
    Input(#[from] InputError),
    /// No workers can be started.
    #[error(transparent)]
    Workers(#[from] SchedulerError),
    /// It was stopped.
    #[error("interrupted")]
    Interrupted,
}

impl From<GrowError> for LabError {
    fn from(error: GrowError) -> LabError {
        match error {
            GrowError::Workers(error) => LabError::Workers(error),
            GrowError::Interrupted { .. } => LabError::Interrupted,
        }
    }
}

/// What is computed of a statement: a number, or words.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A number.
    Number(f64),
    /// Words.
    Words(String),
}

impl From<f64> for Value {
    fn from(number: f64) -> Value {
        Value::Number(number)
    }
}

impl From<String> for Value {
    fn from(words: String) -> Value {
        Value::Words(words)
    }
}

/// What was found of one statement.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Which.
    pub id: String,
    /// What is computed.
    pub computed: Value,
    /// The same with the published scheme, where that was looked at.
    pub published_scheme: Option<Value>,
    /// Whether that meets the criterion.
    pub published_holds: Option<bool>,
    /// Whether the criterion is met; none where the printed number tells, or where nothing is judged.
    pub holds: Option<bool>,
    /// What else is to be said.
    pub note: Option<String>,
}

impl Finding {
    /// A number.
    pub fn number(id: &str, computed: f64) -> Finding {
        Finding {
            id: id.to_owned(),
            computed: computed.into(),
            published_scheme: None,
            published_holds: None,
            holds: None,
            note: None,
        }
    }

    /// Words, and whether the criterion is met.
    pub fn words(id: &str, holds: bool, computed: String) -> Finding {
        Finding { holds: Some(holds), computed: computed.into(), ..Finding::number(id, 0.0) }
    }

    /// Words of which nothing is judged.
    pub fn open(id: &str, computed: String) -> Finding {
        Finding { computed: computed.into(), ..Finding::number(id, 0.0) }
    }

    /// What could not be computed, which does not agree.
    pub fn not_computed(id: &str, why: impl std::fmt::Display) -> Finding {
        Finding::words(id, false, format!("not computed: {why}"))
    }

    /// The same with what the published scheme gives.
    pub fn beside(self, published: impl Into<Value>) -> Finding {
        Finding { published_scheme: Some(published.into()), ..self }
    }

    /// The same with what the published scheme gives, and whether that meets the criterion.
    pub fn beside_judged(self, holds: bool, published: impl Into<Value>) -> Finding {
        Finding { published_holds: Some(holds), ..self.beside(published) }
    }

    /// The same with a note.
    pub fn noting(self, note: impl Into<String>) -> Finding {
        Finding { note: Some(note.into()), ..self }
    }
}

/// Outcomes over a plane.
#[derive(Clone, Debug)]
pub struct Map {
    /// Of what.
    pub plane: PhasePlane,
    /// How divisions end.
    pub diagram: PhaseDiagram,
    /// The curve of pitchforks in it, if it could be followed.
    pub pitchforks: Vec<Curve>,
    /// Those of folds.
    pub folds: Vec<Curve>,
}

/// Something that can be drawn or written as a table.
#[derive(Debug)]
pub enum Shown {
    /// A sweep.
    Sweep(Box<Sweep>, Vec<Row>),
    /// Outcomes over a plane.
    Map(Box<Map>),
    /// Branches of a cell, each with its name.
    Branches(Cell, Vec<(&'static str, Branch)>),
    /// What bounds division over R0.
    Boundary(Cell, [f64; 2], Curve, Vec<Curve>),
    /// A division.
    Film(Cell, Box<Film>),
    /// Disturbed shapes of one cell at several activities, each with its name.
    Perturbations(Cell, Vec<(String, Perturbation)>),
    /// A lineage.
    Tree(Box<Tree>),
}

/// A picture to be drawn.
#[derive(Debug)]
pub struct Panel {
    /// The name of its file, without the extension.
    pub name: String,
    /// What it shows.
    pub shown: Shown,
}

/// What a group of figures comes to.
#[derive(Debug, Default)]
pub struct Found {
    /// What was found.
    pub findings: Vec<Finding>,
    /// What it can be seen in.
    pub panels: Vec<Panel>,
    /// What the user should know of the store.
    pub warnings: Vec<StoreWarning>,
}

impl Found {
    /// Adds a finding.
    pub fn say(&mut self, finding: Finding) {
        self.findings.push(finding);
    }

    /// Adds a picture.
    pub fn show(&mut self, name: &str, shown: Shown) {
        self.panels.push(Panel { name: name.to_owned(), shown });
    }
}

impl Lab<'_> {
    /// A cell of the paper: of this size in this shell, at ξ_s = 25 and without a cue.
    pub fn cell(&self, r0: f64, epsilon: f64) -> Cell {
        Cell { r0, epsilon, xi_s: PUBLISHED_ACTIVITY, cue: Cue::none(), ..self.settings.cell.clone() }
    }

    /// The cell of a statement; the paper's zygote where it names none.
    pub fn cell_of(&self, statement: &Statement) -> Cell {
        statement.cell.map_or(self.cell(ZYGOTE, PUBLISHED_CONFINEMENT), |of| self.cell(of.r0, of.epsilon))
    }

    /// The discretisation, converged.
    pub fn numerics(&self) -> Numerics {
        Numerics { scheme: Scheme::Converged, ..self.settings.numerics }
    }

    /// The discretisation of the published scheme.
    pub fn published(&self) -> Numerics {
        Numerics { scheme: Scheme::Published, ..self.settings.numerics }
    }

    /// How divisions are scheduled.
    pub fn options(&self) -> SchedulerOptions<'_> {
        SchedulerOptions { threads: self.threads, interrupt: Some(self.interrupt), ..SchedulerOptions::default() }
    }

    /// Whether it is to stop.
    ///
    /// # Errors
    /// It is.
    pub fn go_on(&self) -> Result<(), LabError> {
        if self.interrupt.load(Ordering::SeqCst) { Err(LabError::Interrupted) } else { Ok(()) }
    }

    /// Divisions, in the order of the inputs; none for one that could not be computed.
    ///
    /// # Errors
    /// [`LabError`].
    pub fn divisions(&self, inputs: Vec<DivisionInput>, found: &mut Found) -> Result<Vec<Option<Division>>, LabError> {
        let solved = scheduler::solve_all(inputs, self.memo, &self.options(), divide)?;
        found.warnings.extend(solved.summary.warnings);
        self.go_on()?;
        Ok(solved.divisions)
    }

    /// A sweep that ships, solved.
    ///
    /// # Errors
    /// [`LabError`].
    pub fn sweep(&self, text: &str, file: &str, found: &mut Found) -> Result<(Sweep, Vec<Row>), LabError> {
        // What the sweep does not name is that of the paper's zygote.
        let base = Settings { cell: self.cell(ZYGOTE, PUBLISHED_CONFINEMENT), ..self.settings.clone() };
        let sweep = Sweep::parse(text, file, &base, &[])?;
        let progress = |_| ();
        let (memo, threads, interrupt) = (self.memo, self.threads, self.interrupt);
        let run = Run { sweep: &sweep, shard: None, memo, threads, interrupt, progress: &progress };
        let done = run.solve()?;
        found.warnings.extend(done.warnings);
        if done.interrupted {
            return Err(LabError::Interrupted);
        }
        Ok((sweep, done.rows))
    }

    /// A phase diagram, which is shown under this name.
    ///
    /// # Errors
    /// [`LabError`].
    pub fn plane(&self, name: &str, plane: PhasePlane, found: &mut Found) -> Result<PhaseDiagram, LabError> {
        let diagram = plane.compute(self.memo, &self.options())?;
        found.warnings.extend(diagram.summary.warnings.clone());
        if diagram.summary.interrupted {
            return Err(LabError::Interrupted);
        }
        // Without the curves the picture has the edges at each value across.
        let (cell, numerics) = (&plane.cell, &plane.numerics);
        let ends = plane.across.first().zip(plane.across.last());
        let range = ends.map_or([0.0; 2], |(first, last)| [*first, *last]);
        let pitchforks = curves::pitchfork_curve(cell, numerics, plane.parameter, range).into_iter().collect();
        let folds = curves::fold_curves(cell, numerics, plane.parameter, range).unwrap_or_default();
        found.show(name, Shown::Map(Box::new(Map { plane, diagram: diagram.clone(), pitchforks, folds })));
        Ok(diagram)
    }
}

/// ξ_s of the paper's cells (Table S3).
pub const PUBLISHED_ACTIVITY: f64 = 25.0;
/// ε of the paper's cells (Table S3).
pub const PUBLISHED_CONFINEMENT: f64 = 0.87;
