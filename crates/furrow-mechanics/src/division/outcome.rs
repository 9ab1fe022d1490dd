//! The outcome of a division.

use furrow_bvp::{NewtonError, Work};
use furrow_cell::Cue;
use furrow_input::rounded_number;
use serde::{Deserialize, Serialize};

use crate::cortex::observables::SecondNeck;
use crate::equilibria::error::CellName;
use crate::law::LawError;
use crate::polarity::PolarityError;

/// The outcome of a division in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Divided into daughters of equal volume (|χ| below the documented tolerance).
    Symmetric,
    /// Divided into unequal daughters.
    Asymmetric,
    /// Came to rest undivided. Files and answers call it `failed`.
    #[serde(rename = "failed")]
    Arrested,
}

impl Outcome {
    /// Its name in files and answers.
    pub fn name(self) -> &'static str {
        match self {
            Outcome::Symmetric => "symmetric",
            Outcome::Asymmetric => "asymmetric",
            Outcome::Arrested => "failed",
        }
    }
}

impl std::fmt::Display for Outcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// The end of a division, with its numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ending {
    /// The neck closed.
    Divided {
        /// Whether |χ| is below the documented tolerance.
        symmetric: bool,
        /// (V_above − V_below)/V of the daughters from u above and below the furrow: positive when the daughter at the pole
        /// u = 0 is the smaller.
        chi_signed: f64,
        /// Furrow position in arclength fraction from the pole u = 0.
        u_furrow: f64,
        /// Radii R0 of the daughters from u below and above the furrow, in L_h.
        daughters: [f64; 2],
    },
    /// The cell came to rest undivided.
    Arrested {
        /// Leading growth rate of the final state, in 1/τ: negative (stable), except if the published scheme rests at
        /// an unstable shape. Absent if a perturbed shape still moved at the end of its time.
        growth_rate: Option<f64>,
    },
}

/// Two divisions agree if χ differs between seeds by at most this. For most cells the noise changes χ by 10⁻⁵ to
/// 3·10⁻⁴; where two furrows compete, by 10⁻² to 10⁻¹.
pub const NOISE_TOLERANCE: f64 = 1e-3;

/// A division depends on the mesh if χ changes by more than this on twice the mesh. For most cells the change is below
/// 10⁻³; where two furrows compete, or a bud at a pole grows from a tiny amplitude, it is 10⁻² to 1.
pub const MESH_TOLERANCE: f64 = 5e-3;

/// The outcome of one division and its work, as stored in the memo, the store, the tree and answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "DivisionRow", try_from = "DivisionRow")]
pub struct Division {
    /// Its end.
    pub ending: Ending,
    /// Time of pinch-off, or the time at which the shape was found at rest, in τ.
    pub t_end: f64,
    /// For a cell just above the threshold of division: growth rate σ of the stationary shape at which it waited longer
    /// than `t_max` allows, in 1/τ. The wait, ln(amplitude after/amplitude before)/σ, is included in `t_end`.
    pub slow_growth_rate: Option<f64>,
    /// The regulator φ at the furrow at pinch-off, or at u = ½ of the shape at rest; `None` without a regulator.
    pub phi: Option<f64>,
    /// Distance of the neck's centre, or of the waist's in a cell at rest, from the axis at the end, in L_h; `None` with axial
    /// symmetry, and without a waist.
    pub neck_offset: Option<f64>,
    /// The neck of a third part, where the cell falls into three; `None` without axial symmetry, where it is not looked for.
    pub second_neck: Option<SecondNeck>,
    /// Largest relative deviation of the cell volume over the whole division.
    pub volume_drift: f64,
    /// Work it took.
    pub work: Work,
}

impl Division {
    /// The outcome in one word.
    pub fn outcome(&self) -> Outcome {
        match self.ending {
            Ending::Divided { symmetric: true, .. } => Outcome::Symmetric,
            Ending::Divided { .. } => Outcome::Asymmetric,
            Ending::Arrested { .. } => Outcome::Arrested,
        }
    }

    /// Size asymmetry χ = |V1 − V2|/V; `None` if the cell did not divide.
    pub fn chi(&self) -> Option<f64> {
        self.chi_signed().map(f64::abs)
    }

    /// χ with the sign of [`Ending::Divided`]; `None` if the cell did not divide.
    pub fn chi_signed(&self) -> Option<f64> {
        if let Ending::Divided { chi_signed, .. } = self.ending { Some(chi_signed) } else { None }
    }

    /// Furrow position in arclength fraction from the pole u = 0; `None` if the cell did not divide.
    pub fn u_furrow(&self) -> Option<f64> {
        if let Ending::Divided { u_furrow, .. } = self.ending { Some(u_furrow) } else { None }
    }

    /// Radii R0 of the daughters from u below and above the furrow, in L_h; `None` if the cell did not divide.
    pub fn daughters(&self) -> Option<[f64; 2]> {
        if let Ending::Divided { daughters, .. } = self.ending { Some(daughters) } else { None }
    }

    /// Leading growth rate of the shape in which an undivided cell rests, in 1/τ.
    pub fn growth_rate(&self) -> Option<f64> {
        if let Ending::Arrested { growth_rate } = self.ending { growth_rate } else { None }
    }

    /// Volumes of the daughters from u below and above the furrow, as fractions of the mother's volume; `None` if it
    /// did not divide. Exactly equal if the division is symmetric.
    pub fn shares(&self) -> Option<[f64; 2]> {
        let below = match self.ending {
            Ending::Divided { symmetric: true, .. } => 0.5,
            Ending::Divided { chi_signed, .. } => 0.5 * (1.0 - chi_signed),
            Ending::Arrested { .. } => return None,
        };
        Some([below, 1.0 - below])
    }

    /// Whether this division agrees with the division of the same cell with another seed: the same outcome, and χ
    /// within [`NOISE_TOLERANCE`]. The sign of χ counts unless the cell is mirror-symmetric, since the noise then
    /// decides the side.
    pub fn agrees_with(&self, other: &Division, mirror_symmetric: bool) -> bool {
        let near = self.chi_apart(other, mirror_symmetric).is_none_or(|apart| apart <= NOISE_TOLERANCE);
        self.outcome() == other.outcome() && (near || self.outcome() == Outcome::Symmetric)
    }

    /// The difference of χ between two divisions of a cell, if both divide. The sign of χ counts unless the cell is
    /// mirror-symmetric.
    pub fn chi_apart(&self, other: &Division, mirror_symmetric: bool) -> Option<f64> {
        let chi = |of: &Division| if mirror_symmetric { of.chi() } else { of.chi_signed() };
        Some((chi(self)? - chi(other)?).abs())
    }

    /// Whether the [refined](super::DivisionInput::refined) division differs: only one of the two divides, or χ differs by more than
    /// [`MESH_TOLERANCE`].
    pub fn depends_on_numerics(&self, finer: &Division, mirror_symmetric: bool) -> bool {
        let moved = self.chi_apart(finer, mirror_symmetric).is_some_and(|apart| apart > MESH_TOLERANCE);
        moved || self.chi().is_some() != finer.chi().is_some()
    }

    /// The mirror image of the division under u → 1 − u: the division of the mirrored cell.
    pub fn mirrored(mut self) -> Division {
        if let Ending::Divided { chi_signed, u_furrow, daughters, .. } = &mut self.ending {
            (*chi_signed, *u_furrow) = (-*chi_signed, 1.0 - *u_furrow);
            daughters.reverse();
        }
        self.second_neck.iter_mut().for_each(|neck| neck.u = 1.0 - neck.u);
        self
    }

    /// The same division with the daughters' radii of a mother of radius `r0`, M.25.
    pub fn with_daughters_of(mut self, r0: f64) -> Division {
        let shares = self.shares();
        if let (Ending::Divided { daughters, .. }, Some(shares)) = (&mut self.ending, shares) {
            *daughters = shares.map(|share| r0 * share.cbrt());
        }
        self
    }

    /// The division for a cell with `factor` times the computed radius: the daughters' radii scale with the cell's, so
    /// that no volume is lost to rounding.
    pub fn with_daughters_scaled(mut self, factor: f64) -> Division {
        if let Ending::Divided { daughters, .. } = &mut self.ending {
            *daughters = daughters.map(|r0| r0 * factor);
        }
        self
    }
}

/// A division as one row of a table or one flat JSON object, with the fields of [`Division`] and [`Ending`].
#[expect(missing_docs, reason = "documented at `Division` and `Ending`")]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DivisionRow {
    pub outcome: Outcome,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chi: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chi_signed: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub u_furrow: Option<f64>,
    pub t_end: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub daughters: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub growth_rate: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slow_growth_rate: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phi: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub neck_offset: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub second_neck: Option<SecondNeck>,
    pub volume_drift: f64,
    #[serde(flatten)]
    pub work: Work,
}

impl From<Division> for DivisionRow {
    fn from(division: Division) -> DivisionRow {
        DivisionRow {
            outcome: division.outcome(),
            chi: division.chi(),
            chi_signed: division.chi_signed(),
            u_furrow: division.u_furrow(),
            t_end: division.t_end,
            daughters: division.daughters(),
            growth_rate: division.growth_rate(),
            slow_growth_rate: division.slow_growth_rate,
            phi: division.phi,
            neck_offset: division.neck_offset,
            second_neck: division.second_neck,
            volume_drift: division.volume_drift,
            work: division.work,
        }
    }
}

impl TryFrom<DivisionRow> for Division {
    type Error = &'static str;

    fn try_from(row: DivisionRow) -> Result<Division, &'static str> {
        let ending = match (row.outcome, row.chi_signed.or(row.chi), row.u_furrow, row.daughters) {
            (Outcome::Arrested, ..) => Ending::Arrested { growth_rate: row.growth_rate },
            (outcome, Some(chi_signed), Some(u_furrow), Some(daughters)) => {
                Ending::Divided { symmetric: outcome == Outcome::Symmetric, chi_signed, u_furrow, daughters }
            }
            _ => return Err("a division into two has chi, u_furrow and daughters"),
        };
        let DivisionRow { t_end, slow_growth_rate, phi, neck_offset, second_neck, volume_drift, work, .. } = row;
        Ok(Division { ending, t_end, slow_growth_rate, phi, neck_offset, second_neck, volume_drift, work })
    }
}

/// The reason why time stepping stopped.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepFailure {
    /// The equations of a step could not be solved.
    #[error(transparent)]
    Newton(#[from] NewtonError),
    /// Every step was solved, but not accurately enough.
    #[error("the local error stays above its tolerance")]
    Inaccurate,
}

/// The reason why a division could not be computed.
#[expect(missing_docs, reason = "the messages say what the fields are")]
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DivisionError {
    /// An input is outside its domain.
    #[error("{field} = {value}: {allowed}")]
    BadInput { field: &'static str, value: f64, allowed: &'static str },
    /// The passive shape was not found.
    #[error("no passive shape found for {cell} ({source}); {}", cell.advice())]
    NoPassiveShape { cell: CellName, source: NewtonError },
    /// The position of a cue that follows PAR polarity could not be computed.
    #[error("PAR polarity, which the cue follows: {source}")]
    Polarity { source: PolarityError },
    /// The cell's own law of active stress is refused, or cannot hold.
    #[error("R0 = {}: {source}", radius(*r0))]
    Law { r0: f64, source: LawError },
    /// The start shape did not converge on the division's mesh.
    #[error(
        "the stationary shape of {cell} did not converge on the division's mesh ({source}); try more mesh intervals"
    )]
    NotStationary { cell: CellName, source: NewtonError },
    /// The time step fell below its minimum.
    #[error(
        "time stepping of the cell with R0 = {} stalled at t = {t:.3e} with step {dt:.1e} ({source}); {}",
        radius(*r0),
        advice_on_steps(*r0)
    )]
    Stalled { r0: f64, t: f64, dt: f64, source: StepFailure },
    /// The regulator reduces a coefficient that must stay above zero.
    #[error(
        "the regulator brings {field} of the cell with R0 = {} to {value:.2e} at u = {u:.3} and t = {t:.3e}, where it must stay above 0; lower its coupling or let it saturate (`half`)",
        radius(*r0)
    )]
    Coefficient { r0: f64, t: f64, field: &'static str, u: f64, value: f64 },
    /// The regulator concentrates in one place without limit.
    #[error(
        "the regulator of the cell with R0 = {} collapses to a point: at u = {u:.4} and t = {t:.3e} it is {c:.0} times as concentrated as at rest; raise its turnover or diffusion, or lower {pull}",
        radius(*r0)
    )]
    Collapses { r0: f64, t: f64, u: f64, c: f64, pull: &'static str },
    /// The cell is too close to the threshold of division to decide.
    #[error(
        "the cell with R0 = {} is too close to the threshold of division to decide (growth rate {growth_rate:.1e}/τ); change R0, epsilon or xi_s in the seventh digit",
        radius(*r0)
    )]
    Critical { r0: f64, growth_rate: f64 },
    /// The cell oscillates: no stationary shape near it is stable, and no growing mode divides it.
    #[error(
        "the cell with R0 = {} oscillates with a period of {} τ: it neither divides nor comes to rest; change R0, epsilon or xi_s by a percent",
        radius(*r0),
        time(*period)
    )]
    Oscillates { r0: f64, period: f64 },
    /// The cell keeps moving without repeating itself.
    #[error(
        "the cell with R0 = {} still moves at t = {} τ, after {steps} steps: it neither divides, nor rests, nor repeats itself; {advice}",
        radius(*r0),
        time(*t)
    )]
    Restless { r0: f64, t: f64, steps: usize, advice: &'static str },
    /// The equations with axial symmetry were asked for a cell without it, or the other way round for what only they have.
    #[error("{what}: {instead}")]
    Unsupported { what: &'static str, instead: &'static str },
    /// The passive shape of a cell without axial symmetry, or of one between plates, was not found.
    #[error(
        "the passive surface of the cell with R0 = {} is not found without axial symmetry ({reason}); raise p0 if the shell hardly holds the cell in its place, otherwise try more elements",
        radius(*r0)
    )]
    NoPassiveSurface { r0: f64, reason: String },
    /// The equations of a cell without axial symmetry could not be solved.
    #[error(
        "the surface of the cell with R0 = {} stalled at t = {} with step {dt:.1e} ({reason}), its neck at {neck:.3} R0; try more elements or modes",
        radius(*r0),
        time(*t)
    )]
    SurfaceStalled { r0: f64, t: f64, dt: f64, neck: f64, reason: String },
    /// The caller stopped the division.
    #[error("the division of the cell with R0 = {} was cancelled at t = {} τ", radius(*r0), time(*t))]
    Cancelled { r0: f64, t: f64 },
    /// The cell neither divided nor came to rest in the time allowed.
    #[error(
        "the cell with R0 = {} neither divided nor came to rest within t = {}; {}",
        radius(*r0),
        time(*t_max),
        advice_on_rest(*epsilon)
    )]
    Undecided { r0: f64, epsilon: f64, t_max: f64 },
}

/// A radius in a message, with as many digits as distinguish divisions.
fn radius(r0: f64) -> String {
    rounded_number(r0, 7)
}

/// A time in a message.
fn time(t: f64) -> String {
    rounded_number(t, 5)
}

/// Advice for a cell that keeps moving, by the parts of its cue.
pub fn advice_on_motion(cue: &Cue) -> &'static str {
    let regulator = cue.regulator();
    let source = regulator.and_then(|regulator| regulator.source).is_some_and(|source| source.amplitude != 0.0);
    let painted = cue.terms().iter().any(|term| term.amplitude != 0.0);
    let coupled = regulator.is_some_and(|regulator| regulator.couplings.iter().any(|c| c.strength != 0.0));
    match (painted || source, coupled, regulator.is_some()) {
        (true, ..) => "lower xi_s or the cue's amplitude",
        (_, true, _) => "lower xi_s or the strength of the cue's regulator",
        (.., true) => "lower xi_s, or raise the regulator's turnover or diffusion",
        _ => "lower xi_s",
    }
}

/// What pulls a regulator together: its couplings, or the law that reads it.
pub(super) fn pull(cue: &Cue) -> &'static str {
    let coupled = cue.regulator().is_some_and(|regulator| regulator.couplings.iter().any(|c| c.strength != 0.0));
    if coupled { "its coupling" } else { "xi_s" }
}

/// No divisions were found for larger cells.
const LARGEST: f64 = 100.0;

/// Advice if a time step cannot be solved.
fn advice_on_steps(r0: f64) -> &'static str {
    match r0 > LARGEST {
        true => "divisions are found of cells of R0 up to 100",
        false => "try more mesh intervals, a larger time_tolerance or a larger step_factor",
    }
}

/// Below this volume fraction the force of the shell on the cell may be below rounding.
const WIDE_SHELL: f64 = 0.3;

/// Advice if a cell is not found to be at rest.
fn advice_on_rest(epsilon: f64) -> &'static str {
    match epsilon < WIDE_SHELL {
        true => "raise epsilon to 0.3: in a shell as wide as this nothing holds the cell in its place",
        false => "raise t_max, or try more mesh intervals",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_names_what_the_cue_has() {
        for (cue, advice) in [
            ("none", "lower xi_s"),
            ("kappa:band,u0=0.4,omega=0.1,amplitude=0.2", "lower xi_s or the cue's amplitude"),
            (
                "regulator:step,u0=0.4,omega=0.1,amplitude=1,turnover=1,diffusion=1,activity=0",
                "lower xi_s or the cue's amplitude",
            ),
            ("regulator:none,turnover=1,diffusion=1,activity=0.5", "lower xi_s or the strength of the cue's regulator"),
            (
                "regulator:none,turnover=1,diffusion=1,activity=0",
                "lower xi_s, or raise the regulator's turnover or diffusion",
            ),
        ] {
            assert_eq!(advice_on_motion(&cue.parse().unwrap()), advice, "{cue}");
        }
    }

    #[test]
    fn computed_numbers_have_few_digits() {
        let error = DivisionError::Undecided { r0: 5.399999998509884, epsilon: 0.87, t_max: 628675793.6022962 };
        let expected = "the cell with R0 = 5.4 neither divided nor came to rest within t = 6.2868e8; raise t_max";
        assert!(error.to_string().starts_with(expected), "{error}");
        let (t, steps) = (11723.333333, 7);
        let error = DivisionError::Restless { r0: 2.0, t, steps, advice: "lower xi_s" }.to_string();
        assert!(
            error.contains("still moves at t = 11723 τ, after 7 steps") && error.ends_with("; lower xi_s"),
            "{error}"
        );
    }
}
