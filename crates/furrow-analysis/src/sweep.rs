//! The sweep file: of what kind, over which axes, from what cell.

use super::points::{Axes, AxisValue, Point, Target};
use furrow_cell::settings::{SHELL_PROFILE, Settings};
use furrow_cell::{Cell, Cue, Numerics, Scheme};
use furrow_input::InputError;
use furrow_lineage::Lineage;
use furrow_mechanics::division::DivisionInput;
use serde::{Deserialize, Serialize};

/// The computation at every point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// One division, or several with noise of different seeds.
    Division,
    /// A lineage, and the rounds of its founders.
    Tree,
    /// The threshold at which the mirror-symmetric shape loses its stability.
    Pitchfork,
    /// The critical radius, below which a cell does not divide.
    Critical,
}

impl Kind {
    /// Every kind by its name.
    pub const NAMED: [(&str, Kind); 4] = [
        ("division", Kind::Division),
        ("tree", Kind::Tree),
        ("pitchfork", Kind::Pitchfork),
        ("critical", Kind::Critical),
    ];
}

/// A sweep as its file gives it, checked: [`Sweep::parse`] has found every value allowed by itself.
///
/// ```
/// use furrow_cell::settings::{Overrides, Settings};
/// use furrow_analysis::Sweep;
///
/// let text = r#"Sweep(kind: division, axes: [
///     (parameter: "r0", range: (from: 2, to: 3, count: 5)),
///     (parameter: "scheme", list: ["converged", "published"]),
/// ])"#;
/// let sweep = Sweep::parse(text, "sizes.ron", &Settings::default(), &Overrides::default())?;
/// assert_eq!(sweep.points(), 10);
/// assert_eq!(sweep.point(2).input.cell.r0, 2.25);
/// # Ok::<(), furrow_input::InputError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The file's name in errors.
    pub file: String,
    /// The kind of computation.
    pub kind: Kind,
    /// Over what.
    pub axes: Axes,
    /// Settings that no axis changes.
    pub settings: Settings,
    /// The cue of every cell where no axis says otherwise; of a tree, in place of those that the lineage gives. None leaves a
    /// tree its lineage's cues, and other cells without one.
    pub cue: Option<Cue>,
    /// Divisions at each point.
    pub replicates: u32,
    /// Seed of the first of them, and of samples.
    pub seed: u64,
    /// The lineage of trees, and the names of cues.
    pub lineage: Lineage,
}

impl Sweep {
    /// The lineage of a tree with this first cell: with another first radius where the sweep gives one, and with the cell's
    /// cue in place of its own where the sweep names cues.
    pub(super) fn lineage_at(&self, cell: &Cell) -> Lineage {
        let mut lineage = self.lineage.clone();
        if self.axes.0.iter().any(|axis| axis.target == Target::Field("r0")) {
            lineage.forget_first_radius();
        }
        if !self.names_cues() {
            return lineage;
        }
        lineage.with_cue_in_cells(if cell.has_cue() { "given" } else { "none" }, &cell.cue, cell)
    }

    fn names_cues(&self) -> bool {
        self.cue.is_some() || self.axes.0.iter().any(|axis| axis.target == Target::Cue)
    }

    /// Whether it grows trees with cues that replace the lineage's.
    pub fn sets_cues_of_trees(&self) -> bool {
        self.kind == Kind::Tree && self.names_cues()
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        // Counted when it was checked.
        self.axes.points().unwrap_or(0)
    }

    /// The point of a number below [`Sweep::points`].
    pub fn point(&self, index: usize) -> Point {
        let (input, checked) = self.checked(index);
        Point { index, input, invalid: checked.err().map(|error| error.to_string()) }
    }

    /// The input at a point, and whether its values are allowed together.
    pub(super) fn checked(&self, index: usize) -> (DivisionInput, Result<(), InputError>) {
        let places = self.axes.0.iter().zip(self.axes.places(index));
        let mut settings = self.settings.clone();
        let mut cue = self.cue.clone().unwrap_or_default();
        let (mut pairs, mut seed) = (Vec::new(), self.seed);
        for (axis, place) in places.clone() {
            match axis.target {
                Target::Field(name) => pairs.push((name, axis.values[place].clone())),
                Target::Cue => cue = axis.cues[place].clone(),
                Target::CueNumber(_) => {}
                // A whole number: the file was checked.
                Target::Seed => seed = axis.values[place].number().map_or(seed, |number| number as u64),
            }
        }
        // A table sets the aspect ratio, which an axis of its own then replaces.
        pairs.sort_by_key(|(name, _)| *name != SHELL_PROFILE);
        let set = settings.assign(&self.file, &pairs);
        // An axis of what this point's solver does not use is one of the other points: this one divides alike at all its values.
        let varies = |names: &[&str]| pairs.iter().any(|(name, _)| names.contains(name));
        let usual = Numerics::default();
        if settings.numerics.scheme == Scheme::Converged && varies(&["scheme", "dt"]) {
            settings.numerics.dt = usual.dt;
        }
        if settings.numerics.modes == 0 && varies(&["modes", "elements", "contact"]) {
            settings.numerics.elements = usual.elements;
            settings.numerics.contact = usual.contact;
        }
        let mut cell = settings.cell.clone().with_cue(cue);
        for (axis, place) in places {
            if let (Target::CueNumber(parameter), AxisValue::Number(value)) = (axis.target, &axis.values[place]) {
                parameter.set(&mut cell, *value);
            }
        }
        // Each value is allowed by itself; whether they are together is seen here.
        let mut checked = set.and_then(|()| settings.check(&self.file));
        if matches!(self.kind, Kind::Division | Kind::Tree) {
            checked = checked
                .and_then(|()| settings.check_divisions(&self.file))
                .and_then(|()| settings.check_activity(&self.file))
                .and_then(|()| settings.check_cue(&self.file, &cell.cue));
        }
        let checked = checked.and_then(|()| {
            cell.cue.check().map_err(|e| InputError::not_allowed(&self.file, e.field, e.value, e.allowed))?;
            match self.kind {
                Kind::Tree => self.lineage_at(&cell).check_cells(&cell, &settings.numerics, &self.file),
                _ => cell.check_law(&self.file),
            }
        });
        (DivisionInput { cell, numerics: settings.numerics, seed }, checked)
    }
}
