//! Pitchforks of mirror-symmetric shapes: thresholds ξ_s*, and on which side the asymmetric shapes lie.

use furrow_bvp::normal_form::pitchfork_normal_form;
use furrow_bvp::{
    AugmentedReport, BoundaryValueProblem, CollocationPoint, Continuation, Direction, MinimallyAugmented,
    SingularError, Solution, SymmetryBreaking, locate,
};

use super::branch::{Branch, BranchEvent, BranchOptions, ShapePoint};
use super::effort::Effort;
use super::error::{CellName, PointKind, ShapeError};
use super::primary;
use crate::cortex::Cortex;
use crate::cortex::equations::{COMPONENTS, LENGTH, M, PSI, Q, R};
use furrow_cell::{Cell, Numerics};

/// Whether the asymmetric branch exists above or below the pitchfork.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Criticality {
    /// ξ_s > ξ_s* on the asymmetric branch.
    Supercritical,
    /// ξ_s < ξ_s* on the asymmetric branch.
    Subcritical,
}

impl Criticality {
    /// That of a coefficient c in ξ_s = ξ_s* + c a², M.23.
    pub fn of(coefficient: f64) -> Criticality {
        if coefficient < 0.0 { Criticality::Subcritical } else { Criticality::Supercritical }
    }
}

impl std::fmt::Display for Criticality {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Criticality::Supercritical => "supercritical",
            Criticality::Subcritical => "subcritical",
        })
    }
}

/// A pitchfork of the mirror-symmetric branch.
#[derive(Clone, Debug, PartialEq)]
pub struct Pitchfork {
    /// Threshold ξ_s*, with the other observables.
    pub point: ShapePoint,
    /// c of ξ_s = ξ_s* + c (u_f − ½)² on the asymmetric branch, u_f the furrow (most negative meridional curvature).
    /// Positive: supercritical.
    pub coefficient: f64,
    /// How the location converged.
    pub report: AugmentedReport,
    /// The shape, on the half domain, with (L, p, ξ_s).
    pub shape: Solution,
    /// Antisymmetric null vector φ on the half domain.
    pub null: Direction,
    /// Furrow displacement u_f − ½ per unit of φ.
    pub furrow_shift: f64,
}

impl Pitchfork {
    /// Sub- or supercritical.
    pub fn criticality(&self) -> Criticality {
        Criticality::of(self.coefficient)
    }
}

/// The first pitchfork of the primary branch of a mirror-symmetric cell.
///
/// ```
/// use furrow_cell::{Cell, Numerics};
/// use furrow_mechanics::equilibria::{BranchOptions, pitchfork};
///
/// let found = pitchfork::first(&Cell::new(2.0), &Numerics::default(), &BranchOptions::default())?;
/// assert!((found.point.xi_s - 22.05688).abs() < 1e-5);
/// # Ok::<(), furrow_mechanics::equilibria::ShapeError>(())
/// ```
///
/// # Errors
/// [`ShapeError`]; `NotFound` if there is no pitchfork up to the end of the range, `NoPitchfork` if the cell's cue breaks
/// the symmetry.
pub fn first(cell: &Cell, numerics: &Numerics, options: &BranchOptions) -> Result<Pitchfork, ShapeError> {
    first_within(cell, numerics, options, &Effort::unlimited())
}

/// As [`first`], with so much work.
///
/// # Errors
/// Those of [`first`] and of [`primary::follow_within`].
pub fn first_within(
    cell: &Cell,
    numerics: &Numerics,
    options: &BranchOptions,
    effort: &Effort<'_>,
) -> Result<Pitchfork, ShapeError> {
    let name = CellName::of(cell);
    if !cell.is_mirror_symmetric() {
        return Err(ShapeError::NoPitchfork { cell: name, cue: cell.cue.to_string() });
    }
    let mut unwanted = |event: &BranchEvent| event.kind() != PointKind::Pitchfork;
    let branch = primary::follow_within(cell, numerics, options, effort, &mut unwanted)?;
    let Branch { events, ended, .. } = branch;
    let found = events.into_iter().find_map(|event| match event {
        BranchEvent::Pitchfork(pitchfork) => Some(*pitchfork),
        BranchEvent::Fold(_) => None,
    });
    found.ok_or_else(|| {
        let none = ShapeError::NotFound { cell: name, kind: PointKind::Pitchfork, xi_max: options.xi[1] };
        ended.error().cloned().unwrap_or(none)
    })
}

/// The pitchfork between the last two points of a continuation of symmetric shapes, where the antisymmetric determinant
/// changes sign as given.
///
/// # Errors
/// [`SingularError`].
pub fn pitchfork_near(branch: &mut Continuation<Cortex>, signs: [f64; 2]) -> Result<Pitchfork, SingularError> {
    let mut found = locate::between_last_points(branch, SymmetryBreaking::default(), signs)?;
    let mut pitchfork = describe(&mut found.augmented, found.solution, found.report)?;
    pitchfork.point.arclength = found.arclength;
    Ok(pitchfork)
}

/// Observables and normal form of a pitchfork just converged.
///
/// # Errors
/// [`SingularError`] if the normal form does not exist.
pub fn describe(
    point: &mut MinimallyAugmented<Cortex, SymmetryBreaking>,
    y: Solution,
    report: AugmentedReport,
) -> Result<Pitchfork, SingularError> {
    let form = pitchfork_normal_form(point, &y)?;
    let furrow_shift = furrow_shift(&point.problem, &y, &point.singularity.null);
    Ok(Pitchfork {
        point: ShapePoint::of(&y, &point.problem, &point.system.gauss),
        coefficient: form.parameters[0] / (furrow_shift * furrow_shift),
        report,
        null: point.singularity.null.clone(),
        furrow_shift,
        shape: y,
    })
}

/// Displacement of the furrow, the minimum of the meridional curvature c1 at the equator, per unit of the antisymmetric
/// direction φ: −∂_u δc1/∂_uu c1. With c1 = m/κ − c2, c2_s = (cosψ/r)(c1 − c2) and κ_s = 0, at the equator
///
/// * δc1_s = δq/κ + δψ (c1 − c2)/r, c1_ss = q_s/κ − m κ_ss/κ² + c1(c1 − c2)/r.
pub fn furrow_shift(cortex: &Cortex, y: &Solution, null: &Direction) -> f64 {
    let last = y.intervals();
    let state = y.node(last);
    let length = y.scalars[LENGTH];
    let kappa = cortex.constants().at(0.5, length).kappa;
    let kappa_ss = cortex.constants().rigidity_curvature(0.5, length) / (length * length);
    let (mut f, mut g) = ([0.0; COMPONENTS], [0.0]);
    cortex.rhs(CollocationPoint { x: 0.5, index: 0 }, state, &y.scalars, &mut f, &mut g);
    let phi = &null.nodes[last * COMPONENTS..];
    let c2 = 1.0 / state[R];
    let c1 = state[M] / kappa - c2;
    debug_assert!((state[PSI] - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
    let change = phi[Q] / kappa + phi[PSI] * (c1 - c2) / state[R];
    let bend = f[Q] / length / kappa - state[M] * kappa_ss / (kappa * kappa) + c1 * (c1 - c2) / state[R];
    -change / bend / length
}
