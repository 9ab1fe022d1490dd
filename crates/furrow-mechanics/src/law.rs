//! Cells with a law of active stress of their own: refusals, and whether a law can hold.

use furrow_bvp::{Gauss, Solution, mesh};
use furrow_cell::Cell;
use furrow_cell::law::{Active, Expression, NotFinite};

use crate::cortex::equations::{LENGTH, PSI, R, Z};
use crate::cortex::lanes::sin_cos;
use crate::cortex::{Cortex, Domain};
use crate::equilibria::passive::spheroid;

/// Why a cell with a law of its own is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LawError {
    /// The cue and the law do not go together.
    #[error("the law {law:?} and the cue {cue}: {reason}")]
    Cue {
        /// The law's name.
        law: String,
        /// The cue.
        cue: String,
        /// Why they do not go together.
        reason: String,
    },
    /// An expression has no finite value on the shape from which cells start.
    #[error("the law {law:?}: {} must be finite where cells start: {found}", found.expression.name())]
    NotFinite {
        /// The law's name.
        law: String,
        /// The expression, the place and the value.
        found: NotFinite,
    },
    /// Disturbances around the axis have equations for the paper's law alone.
    #[error("the law {law:?}: disturbances without axial symmetry have equations for the paper's law alone")]
    WithoutAxis {
        /// The law's name.
        law: String,
    },
    /// A surface without axial symmetry cannot have the law.
    #[error("the law {law:?} needs axial symmetry: {reason}")]
    NeedsAxis {
        /// The law's name.
        law: String,
        /// Why.
        reason: String,
    },
    /// The shortest waves grow fastest: no mesh is fine enough.
    #[error(
        "the law {law:?} cannot hold at u = {u:.3}: {modulus} there is {share:.3} of its value without the law and must stay above 0, else waves grow the faster the shorter they are, down to the mesh's own wavelength"
    )]
    ShortWaves {
        /// The law's name.
        law: String,
        /// The place.
        u: f64,
        /// The modulus that is not positive.
        modulus: &'static str,
        /// Its share of the value without the law.
        share: f64,
    },
}

/// Checks whether the cue of a cell goes with its law, and whether the law is finite on a sphere.
///
/// # Errors
/// [`LawError::Cue`], [`LawError::NotFinite`].
pub fn check(cell: &Cell) -> Result<(), LawError> {
    let Some(law) = &cell.law else { return Ok(()) };
    if let Some(found) = law.not_finite(cell) {
        return Err(LawError::NotFinite { law: law.name().to_owned(), found });
    }
    let refuse = |reason| LawError::Cue { law: law.name().to_owned(), cue: cell.cue.to_string(), reason };
    law.misfit(&cell.cue).map_or(Ok(()), |reason| Err(refuse(reason)))
}

/// Checks whether a surface without axial symmetry can have the law of a cell.
///
/// # Errors
/// [`LawError::NeedsAxis`], and the errors of [`check`].
pub fn check_without_axis(cell: &Cell) -> Result<(), LawError> {
    check(cell)?;
    let Some(law) = &cell.law else { return Ok(()) };
    let refuse = |reason| LawError::NeedsAxis { law: law.name().to_owned(), reason };
    law.needs_axis(cell).map_or(Ok(()), |reason| Err(refuse(reason)))
}

/// Whether the law cannot hold in the cell without activity, looked at on a spheroid without flow.
pub(crate) fn cannot_rest(cell: &Cell) -> Option<LawError> {
    cell.law.as_ref()?;
    let passive = cell.passive();
    let grid = mesh::uniform(0.0, Domain::Half.end(), 8);
    let y = spheroid(&Gauss::new(3).ok()?, &passive, &grid).ok()?;
    let cortex = Cortex::new(&passive, Domain::Half, &[]);
    let waves = short_waves(&cortex, &y);
    match waves {
        // Where short waves grow the rate of strain may have no value, and the stress that depends on it neither.
        Some(LawError::ShortWaves { share, .. }) if !share.is_nan() => waves,
        _ => not_finite(&cortex, &y).or(waves),
    }
}

/// The place of a shape without flow at which its cell's law has no finite value.
fn not_finite(cortex: &Cortex, y: &Solution) -> Option<LawError> {
    let law = cortex.cell.law.as_ref()?;
    let (gauss, length) = (y.gauss(), y.scalars[LENGTH]);
    let mut reader = cortex.constants().reader();
    y.stages.chunks_exact(y.components).enumerate().find_map(|(index, state)| {
        let u = y.stage_x(&gauss, index / y.m, index % y.m);
        let here = cortex.constants().of_state(u, state, length);
        let (Active { stress: [along, around], moment, normal_force }, [mean, _]) =
            reader.active(u, (state, 0.0, 1.0), &here, length)?;
        let values = [moment, along, around, normal_force];
        let expression = Expression::ALL.into_iter().find(|which| !values[*which as usize].is_finite())?;
        let (r, c2) = (state[R], sin_cos(state[PSI]).0 / state[R]);
        let (curvatures, xi_s) = ([mean - c2, c2], cortex.cell.xi_s);
        let found = NotFinite { expression, u, curvatures, r, xi_s, value: values[expression as usize] };
        Some(LawError::NotFinite { law: law.name().to_owned(), found })
    })
}

/// The place of a shape at which its cell's law makes the shortest waves grow. A law without rates of strain and without a
/// moment does not make them grow, since bending dominates.
pub fn short_waves(cortex: &Cortex, y: &Solution) -> Option<LawError> {
    let (law, name) = (cortex.constants().law.as_ref()?, cortex.cell.law.as_ref()?.name());
    if !law.viscous && !law.bends {
        return None;
    }
    let gauss = y.gauss();
    let length = y.scalars[LENGTH];
    let mut reader = cortex.constants().reader();
    let mut worst: Option<(f64, &'static str, f64)> = None;
    for (index, state) in y.stages.chunks_exact(y.components).enumerate() {
        let u = y.stage_x(&gauss, index / y.m, index % y.m);
        let (sin, cos) = sin_cos(state[PSI]);
        let past = cortex.past.get(index).filter(|_| cortex.rate != 0.0);
        let v_n = past.map_or(0.0, |[r, z]| cortex.rate * (sin * (state[R] - r) + cos * (state[Z] - z)));
        for (modulus, share) in reader.moduli(u, (state, v_n), length).into_iter().flatten() {
            // NaN counts as not positive.
            if (share.is_nan() || share <= 0.0) && worst.is_none_or(|(_, _, least)| share < least) {
                worst = Some((u, modulus, share));
            }
        }
    }
    worst.map(|(u, modulus, share)| LawError::ShortWaves { law: name.to_owned(), u, modulus, share })
}
