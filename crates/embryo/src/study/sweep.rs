//! The sweep file: of what kind, over which axes, from what cell.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::check::Check;
use super::points::{Axes, AxisValue, Target};
use crate::cell::{Cell, Cue};
use crate::input::{InputError, parse_document, read_text};
use crate::lineage::Lineage;
use crate::settings::{NumericsOverrides, PhysicsOverrides, Settings};

/// What is computed at every point.
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

/// A sweep as its file gives it, checked: [`Sweep::parse`] has found every value allowed by itself.
///
/// ```
/// use furrow::settings::Settings;
/// use furrow::study::Sweep;
///
/// let text = r#"Sweep(kind: division, axes: [
///     (parameter: "r0", range: (from: 2, to: 3, count: 5)),
///     (parameter: "scheme", list: ["converged", "published"]),
/// ])"#;
/// let sweep = Sweep::parse(text, "sizes.ron", &Settings::default(), &[])?;
/// assert_eq!(sweep.points(), 10);
/// assert_eq!(sweep.point(2).input.cell.r0, 2.25);
/// # Ok::<(), furrow::input::InputError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// What errors call the file.
    pub file: String,
    /// What is computed.
    pub kind: Kind,
    /// Over what.
    pub axes: Axes,
    /// What no axis says.
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

/// The file as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "Sweep")]
pub(super) struct Document {
    pub kind: Kind,
    pub axes: Vec<AxisDocument>,
    #[serde(default)]
    pub cue: Option<String>,
    #[serde(default = "one")]
    pub replicates: u32,
    #[serde(default)]
    pub seed: u64,
    #[serde(default)]
    physics: PhysicsOverrides,
    #[serde(default)]
    numerics: NumericsOverrides,
    #[serde(default)]
    lineage: Option<PathBuf>,
}

fn one() -> u32 {
    1
}

/// An axis as it is written: with one of the three.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "Axis")]
pub(super) struct AxisDocument {
    pub parameter: String,
    #[serde(default)]
    pub range: Option<Interval>,
    #[serde(default)]
    pub list: Option<Vec<AxisValue>>,
    #[serde(default)]
    pub sample: Option<Interval>,
}

/// So many values between two, both included where they are evenly spaced.
#[derive(Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Interval {
    pub from: f64,
    pub to: f64,
    pub count: usize,
}

impl Sweep {
    /// Reads and checks a sweep file. `base` is what the file does not name; `overrides` of the form `key=value` come after
    /// what it names, and before its axes. A lineage is looked for from the file's own folder.
    ///
    /// # Errors
    /// Names the file, the field, its value and what is allowed.
    pub fn read(path: &Path, base: &Settings, overrides: &[String]) -> Result<Sweep, InputError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        Sweep::parse_in(folder, &read_text(path)?, &path.display().to_string(), base, overrides)
    }

    /// Reads and checks a sweep from RON text, as [`read`](Self::read) does; `file` is what errors call it.
    ///
    /// # Errors
    /// Those of [`read`](Self::read).
    pub fn parse(text: &str, file: &str, base: &Settings, overrides: &[String]) -> Result<Sweep, InputError> {
        Sweep::parse_in(Path::new(""), text, file, base, overrides)
    }

    fn parse_in(
        folder: &Path,
        text: &str,
        file: &str,
        base: &Settings,
        overrides: &[String],
    ) -> Result<Sweep, InputError> {
        let mut document: Document = parse_document(text, file, "a sweep file", "Sweep")?;
        let mut settings = base.clone();
        std::mem::take(&mut document.physics).apply(&mut settings);
        std::mem::take(&mut document.numerics).apply(&mut settings);
        settings.check_fields(file)?;
        settings.override_fields(overrides)?;
        let path = document.lineage.take().map(|path| folder.join(path));
        let lineage = Lineage::load(path.as_deref())?;
        Check { file, document: &document, settings: &settings, lineage: &lineage }.run()
    }

    /// The lineage of a tree with this first cell: with another first radius where the sweep gives one, and with the cell's
    /// cue in place of its own where the sweep names cues.
    pub(super) fn lineage_at(&self, cell: &Cell) -> Lineage {
        let mut lineage = self.lineage.clone();
        if self.axes.0.iter().any(|axis| axis.target == Target::Field("r0")) {
            lineage.forget_first_radius();
        }
        if self.cue.is_none() && self.axes.0.iter().all(|axis| axis.target != Target::Cue) {
            return lineage;
        }
        lineage.with_cues_replaced(if cell.cue.is_none() { "none" } else { "given" }, &cell.cue)
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        // Counted when it was checked.
        self.axes.points().unwrap_or(0)
    }
}
