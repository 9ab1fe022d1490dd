//! The branch diagram of a cell: its stationary shapes over ξ_s.

use furrow_cell::{Cell, Numerics};
use furrow_mechanics::equilibria::asymmetric::{self, Scaling};
use furrow_mechanics::equilibria::curves::Curve;
use furrow_mechanics::equilibria::{Branch, BranchOptions, ShapeError, primary};

/// The curves that bound the outcomes over a plane, as far as they could be followed.
#[derive(Clone, Debug, Default)]
pub struct Edges {
    /// Curves of pitchforks.
    pub pitchforks: Vec<Curve>,
    /// Curves of folds.
    pub folds: Vec<Curve>,
    /// Thresholds of disturbances that are not axisymmetric, by azimuthal number.
    pub azimuthal: Vec<(usize, Curve)>,
}

/// The branches of a cell under their names.
#[derive(Clone, Debug)]
pub struct Diagram {
    /// `symmetric` (`cued` with a cue that tells the poles apart), and `asymmetric` where that has a pitchfork.
    pub branches: Vec<(&'static str, Branch)>,
    /// How Δu opens at the pitchfork, if there is one and points enough near it.
    pub scaling: Option<Scaling>,
}

/// The branch that grows out of the passive shape and, of a mirror-symmetric cell, the asymmetric one of its first pitchfork.
///
/// ```
/// use furrow_cell::{Cell, Numerics};
/// use furrow_mechanics::equilibria::BranchOptions;
/// use furrow_analysis::diagram;
///
/// let options = BranchOptions { xi: [0.0, 25.0], ..BranchOptions::default() };
/// let found = diagram(&Cell::new(2.0), &Numerics::default(), &options)?;
/// let names: Vec<&str> = found.branches.iter().map(|(name, _)| *name).collect();
/// assert_eq!(names, ["symmetric", "asymmetric"]);
/// # Ok::<(), furrow_mechanics::equilibria::ShapeError>(())
/// ```
///
/// # Errors
/// [`ShapeError`] where the first branch cannot be followed. One that ends early says why in [`Branch::ended`].
pub fn diagram(cell: &Cell, numerics: &Numerics, options: &BranchOptions) -> Result<Diagram, ShapeError> {
    let branch = primary::follow(cell, numerics, options, |_| true)?;
    let asymmetric = branch.pitchforks().next().map(|pitchfork| asymmetric::follow(pitchfork, cell, options));
    let mut branches = vec![(if cell.is_mirror_symmetric() { "symmetric" } else { "cued" }, branch)];
    let mut scaling = None;
    if let Some(found) = asymmetric {
        branches.push(("asymmetric", found.branch));
        scaling = found.scaling;
    }
    Ok(Diagram { branches, scaling })
}
