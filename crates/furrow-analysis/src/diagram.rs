//! The branch diagram of a cell: its stationary shapes over ξ_s.

use furrow_cell::{Cell, Numerics};
use furrow_input::InputError;
use furrow_mechanics::equilibria::asymmetric::{self, Scaling};
use furrow_mechanics::equilibria::azimuthal_scan::AzimuthalScan;
use furrow_mechanics::equilibria::curves::Curve;
use furrow_mechanics::equilibria::{Branch, BranchOptions, ShapeError, ShapePoint, primary};

/// The curves that bound the outcomes over a plane, as far as they could be followed.
#[derive(Clone, Debug, Default)]
pub struct Edges {
    /// Curves of pitchforks.
    pub pitchforks: Vec<Curve>,
    /// Curves of folds.
    pub folds: Vec<Curve>,
    /// Thresholds of disturbances that are not axisymmetric, by azimuthal number.
    pub azimuthal: Vec<(usize, Curve)>,
    /// Without axial symmetry, curves that end stable bent states, by name.
    pub bent: Vec<(&'static str, Curve)>,
}

/// The branches of a cell under their names.
#[derive(Clone, Debug)]
pub struct Diagram {
    /// `symmetric` (`cued` with a cue that tells the poles apart), and `asymmetric` where that has a pitchfork.
    pub branches: Vec<(&'static str, Branch)>,
    /// How Δu opens at the pitchfork, if there is one and points enough near it.
    pub scaling: Option<Scaling>,
    /// What could not be followed.
    pub warnings: Vec<String>,
}

impl Diagram {
    /// [`warnings`](Self::warnings), events that a finer mesh does not have, and growth rates beyond axial symmetry that are not known,
    /// and of sign changes that are not located.
    pub fn all_warnings(&self) -> Vec<String> {
        let rates = self.branches.iter().flat_map(|(name, branch)| unknown(name, &branch.points, &branch.azimuthal));
        let events =
            self.branches.iter().flat_map(|(name, branch)| branch.events.iter().map(move |event| (name, event)));
        let absent = events.filter(|(_, event)| event.error().is_infinite()).map(|(name, event)| {
            let (kind, xi_s) = (event.kind(), event.point().xi_s);
            format!(
                "the mesh is too coarse: halved intervals have no {kind} of the {name} branch at xi_s = {xi_s:.6}; \
                 repeat with twice the intervals"
            )
        });
        self.warnings.iter().cloned().chain(absent).chain(rates).collect()
    }
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
    Ok(Diagram { branches, scaling, warnings: Vec::new() })
}

/// Checks the reduced volume at which branches are to end; errors say it came from `source_name`.
///
/// # Errors
/// One that is not between 0 and 1.
pub fn reduced_volume(source_name: &str, value: Option<f64>) -> Result<Option<f64>, InputError> {
    let fine = value.is_none_or(|value| value > 0.0 && value < 1.0);
    let allowed = "above 0 and below 1, that of a sphere";
    InputError::require(fine, source_name, "reduced_volume", value.unwrap_or_default(), allowed).map(|()| value)
}

fn unknown(name: &str, points: &[ShapePoint], scan: &AzimuthalScan) -> Vec<String> {
    let xi = |index: usize| points.get(index).map_or(f64::NAN, |point| point.xi_s);
    let missing = scan.missing().into_iter().map(|(m, at)| {
        let (count, first) = (at.len(), xi(at[0]));
        let of = if count == 1 { "1 point".to_owned() } else { format!("{count} points") };
        format!("no growth rate for m = {m} at {of} of the {name} branch, first at ξ_s = {first:.6}: a sign change may be missing")
    });
    let not_located = scan.not_located.iter().map(|(m, index)| {
        format!(
            "the growth rate for m = {m} changes sign on the {name} branch behind ξ_s = {:.6}, where is not located",
            xi(*index)
        )
    });
    missing.chain(not_located).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_that_are_not_known_are_named() {
        let points = [1.0, 2.0, 3.0].map(|xi_s| ShapePoint { xi_s, ..ShapePoint::default() });
        let mut scan = AzimuthalScan::default();
        assert_eq!(unknown("symmetric", &points, &scan), [""; 0]);
        scan.rates = vec![vec![Some(-1.0), Some(-1.0)], vec![Some(-1.0), None], vec![Some(1.0), None]];
        scan.not_located = vec![(1, 1)];
        assert_eq!(
            unknown("symmetric", &points, &scan),
            [
                "no growth rate for m = 2 at 2 points of the symmetric branch, first at ξ_s = 2.000000: a sign change may be missing",
                "the growth rate for m = 1 changes sign on the symmetric branch behind ξ_s = 2.000000, where is not located",
            ]
        );
    }
}
