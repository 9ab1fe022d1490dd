//! Polarised states as a function of cell size, and the folds at which they end.
//!
//! A branch runs over the scale ℓ of a fixed shape. A cell with another R0 also has a slightly different shape, so that
//! polarity ends at the radius for which the cell's own shape has its fold at ℓ = 1.

use furrow_bvp::continuation::Advance;
use furrow_bvp::{
    Continuation, ContinuationError, ContinuationSettings, Direction, Fold, Metric, MinimallyAugmented, Solution,
    Termination, locate,
};
use ordered_float::OrderedFloat;
use serde::Serialize;

use super::error::PolarityError;
use super::membrane::Membrane;
use super::problem::{COMPONENTS, MEAN_A, Polarity, SCALE};
use super::states::{Evolution, Readings, Resolution, is_polarised, readings, step};
use furrow_cell::cue::{LENGTH_UM, ParConstants};
use furrow_cell::{Cell, Numerics, ZYGOTE};

/// Chemistry, units and discretisation: the inputs of polarity besides the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chemistry {
    /// Constants.
    pub constants: ParConstants,
    /// L_h in µm.
    pub length_um: f64,
    /// Discretisation of the cell's shape.
    pub numerics: Numerics,
    /// Discretisation of the chemistry.
    pub resolution: Resolution,
}

/// Initial positions of the boundary.
const PLACES: [f64; 3] = [0.5, 0.35, 0.65];

/// Radii R0, relative to the zygote's, at which a polarised state is looked for.
const SIZES: [f64; 10] = [0.15, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0, 1.5, 2.5, 4.0];

/// Radii, relative to the zygote's, between which branches are followed.
const RANGE: [f64; 2] = [0.02, 50.0];

/// Largest defect of a state with a resolved boundary.
const MOST_DEFECT: f64 = 1e-2;

/// Most points of a branch.
const MOST_POINTS: usize = 2000;

/// The end of polarised states towards smaller or larger cells.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PolarityLimit {
    /// Radius R0 of the last polarised cell, in L_h.
    pub r0: f64,
    /// Its only polarised state.
    #[serde(flatten)]
    pub state: Readings,
}

/// The direction in size in which a branch is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Towards {
    /// To smaller cells.
    Smaller,
    /// To larger cells.
    Larger,
}

impl Chemistry {
    /// The constants of Goehring et al. 2011 at the default discretisation.
    pub fn goehring2011() -> Chemistry {
        Chemistry::new(ParConstants::GOEHRING2011, LENGTH_UM)
    }

    /// Constants at the default discretisation, with L_h in µm.
    pub fn new(constants: ParConstants, length_um: f64) -> Chemistry {
        let (numerics, resolution) = (Numerics::default(), Resolution::default());
        Chemistry { constants, length_um, numerics, resolution }
    }

    /// The surface of a cell.
    ///
    /// # Errors
    /// [`PolarityError::Shape`].
    pub fn membrane(&self, cell: &Cell) -> Result<Membrane, PolarityError> {
        Membrane::of(cell, &self.numerics, self.length_um)
            .map_err(|source| PolarityError::Shape { r0: cell.r0, source })
    }

    /// The stationary state that evolves on a membrane, `scale` times as large, from a boundary at `u`.
    ///
    /// # Errors
    /// [`PolarityError::Evolution`], [`PolarityError::Unresolved`].
    pub(crate) fn evolved(&self, membrane: &Membrane, scale: f64, u: f64) -> Result<Solution, PolarityError> {
        let problem = Polarity::new(self.constants, membrane.clone(), Some(scale));
        let start = step(&problem, self.resolution, u)
            .map_err(|error| PolarityError::Shape { r0: scale * membrane.r0, source: error.into() })?;
        let mut evolution = Evolution::new(problem, start);
        match evolution.rest() {
            Ok(()) => {
                let defect = evolution.defect();
                if defect > MOST_DEFECT {
                    return Err(PolarityError::Unresolved { r0: scale * membrane.r0, defect });
                }
                Ok(evolution.state)
            }
            Err(source) => Err(PolarityError::Evolution { r0: scale * membrane.r0, time: evolution.time, source }),
        }
    }

    /// The polarised state that evolves on a membrane from one of several initial boundaries, if there is one.
    fn evolved_polarised(&self, membrane: &Membrane, scale: f64) -> Result<Option<Solution>, PolarityError> {
        for u in PLACES {
            let state = self.evolved(membrane, scale, u)?;
            if is_polarised(&state) {
                return Ok(Some(state));
            }
        }
        Ok(None)
    }

    /// The polarised state of a cell; `None` if there is no such state at its size. A membrane that evolves to a
    /// uniform state may still have a polarised one: it is looked for along the branch that starts at a polarised size.
    ///
    /// # Errors
    /// [`PolarityError`]; `NoPolarity` if the shape is polarised at no size.
    pub fn polarised(&self, cell: &Cell) -> Result<Option<Solution>, PolarityError> {
        let membrane = self.membrane(cell)?;
        if let Some(state) = self.evolved_polarised(&membrane, 1.0)? {
            return Ok(Some(state));
        }
        // The search starts from the nearest size, as there may be several ranges of sizes.
        let mut scales = self.scales(&membrane);
        scales.sort_by_cached_key(|item| OrderedFloat(item.ln().abs()));
        let (scale, state) = self.first_polarised(&membrane, &scales)?;
        let towards = if scale > 1.0 { Towards::Smaller } else { Towards::Larger };
        let mut branch = self.branch(membrane, scale, &state, towards)?;
        if follow(&mut branch, 1.0)? != BranchEnd::Reached {
            return Ok(None);
        }
        let mut state = branch.state.solution.clone();
        state.scalars.truncate(SCALE);
        Ok(Some(state))
    }

    /// Radius R0 of a cell with the size of the real zygote.
    fn zygote(&self) -> f64 {
        ZYGOTE * LENGTH_UM / self.length_um
    }

    /// Scales of a membrane at which a polarised state is looked for, from the smallest cell to the largest.
    fn scales(&self, membrane: &Membrane) -> [f64; SIZES.len()] {
        SIZES.map(|size| size * self.zygote() / membrane.r0)
    }

    /// The first of the scales at which a membrane is polarised, and its state there.
    fn first_polarised(&self, membrane: &Membrane, scales: &[f64]) -> Result<(f64, Solution), PolarityError> {
        // Nearly all states evolve from a boundary in the middle.
        for u in PLACES {
            for &scale in scales {
                let state = self.evolved(membrane, scale, u)?;
                if is_polarised(&state) {
                    return Ok((scale, state));
                }
            }
        }
        let range = scales.iter().fold([f64::INFINITY, 0.0], |[low, high], x| [x.min(low), x.max(high)]);
        Err(PolarityError::NoPolarity { range: range.map(|scale| scale * membrane.r0) })
    }

    /// The branch of polarised states over the scale of a membrane, from its state at one scale.
    ///
    /// # Errors
    /// [`PolarityError::Branch`].
    pub fn branch(
        &self,
        membrane: Membrane,
        scale: f64,
        state: &Solution,
        towards: Towards,
    ) -> Result<Continuation<Polarity>, PolarityError> {
        let problem = Polarity::new(self.constants, membrane, None);
        let mut guess = state.clone();
        guess.scalars.truncate(SCALE);
        guess.scalars.push(scale);
        let settings = ContinuationSettings { max_step: 0.2, first_step: 0.02, ..ContinuationSettings::default() };
        let metric = metric(state, scale);
        Ok(Continuation::start(problem, guess, metric, settings, towards == Towards::Larger)?)
    }

    /// The size at which polarised states of cells like `cell`, for any radius of `cell`, end towards smaller or larger
    /// cells. The branch starts at the smallest or the largest polarised cell of several sizes.
    ///
    /// # Errors
    /// [`PolarityError`]; `NoFold` if the states do not end in a fold.
    pub fn limit(&self, cell: &Cell, towards: Towards) -> Result<PolarityLimit, PolarityError> {
        let cell = Cell { r0: self.zygote(), ..cell.clone() };
        let (found, tangent) = self.fold(self.membrane(&cell)?, towards)?;
        self.own_fold(&cell, found, &tangent)
    }

    /// The same on a [line](Membrane::line), in place of a cell's surface: its length in µm, and the state.
    ///
    /// # Errors
    /// As [`limit`](Self::limit).
    pub fn limit_on_line(&self, aspect: f64, towards: Towards) -> Result<(f64, Readings), PolarityError> {
        let line = Membrane::line(self.zygote(), aspect, self.length_um);
        let (length, (found, _)) = (line.length, self.fold(line, towards)?);
        let faded = || PolarityError::NoFold { why: "the last state is not polarised".to_owned() };
        Ok((length * found.scalars[SCALE], readings(&found).ok_or_else(faded)?))
    }

    /// The fold over the scale of a membrane at which its polarised states end, and the direction of their branch there.
    fn fold(&self, membrane: Membrane, towards: Towards) -> Result<(Solution, Direction), PolarityError> {
        let r0 = membrane.r0;
        let mut scales = self.scales(&membrane);
        if towards == Towards::Larger {
            scales.reverse();
        }
        let (scale, state) = self.first_polarised(&membrane, &scales)?;
        let mut branch = self.branch(membrane, scale, &state, towards)?;
        let bound = RANGE[usize::from(towards == Towards::Larger)];
        let end = follow(&mut branch, bound)?;
        let at = r0 * branch.state.parameter();
        let why = match end {
            BranchEnd::Fold => None,
            BranchEnd::Reached => Some(format!("they exist at all sizes tried, to R0 = {at:.3}")),
            BranchEnd::Even => Some(format!("near R0 = {at:.3} they fade to a state that is not polarised")),
            BranchEnd::Endless => Some(format!("their branch is too long, it is at R0 = {at:.3}")),
        };
        if let Some(why) = why {
            return Err(PolarityError::NoFold { why });
        }
        let signs = if towards == Towards::Smaller { [-1.0, 1.0] } else { [1.0, -1.0] };
        let located = locate::between_last_points(&mut branch, Fold::new(SCALE), signs)?;
        Ok((located.solution, branch.state.tangent))
    }

    /// The radius for which the cell's own shape has its fold at scale 1, starting from the fold over the scale of the
    /// shape of `cell`. The shape is changed in steps small enough for Newton's method.
    fn own_fold(&self, cell: &Cell, mut y: Solution, tangent: &Direction) -> Result<PolarityLimit, PolarityError> {
        let (mut cell, mut largest) = (cell.clone(), SHAPE_STEP);
        for _ in 0..MOST_SHAPES {
            let scale = y.scalars[SCALE];
            if (scale - 1.0).abs() < SAME_SCALE {
                break;
            }
            let part = scale.clamp(1.0 / largest, largest);
            let next = Cell { r0: cell.r0 * part, ..cell.clone() };
            let mut moved = y.clone();
            moved.scalars[SCALE] = scale / part;
            let problem = Polarity::new(self.constants, self.membrane(&next)?, None);
            let metric = metric(&moved, moved.scalars[SCALE]);
            let mut fold = MinimallyAugmented::new(problem, Fold::new(SCALE), moved.m, metric, tangent)?;
            match fold.solve(&mut moved, None) {
                Ok(_) => (cell, y) = (next, moved),
                Err(error) if largest < SMALLEST_SHAPE_STEP => return Err(error.into()),
                Err(_) => largest = largest.sqrt(),
            }
        }
        let faded = || PolarityError::NoFold { why: "the last state is not polarised".to_owned() };
        Ok(PolarityLimit { r0: cell.r0 * y.scalars[SCALE], state: readings(&y).ok_or_else(faded)? })
    }
}

/// Most shapes tried for a limit, the largest and the smallest factor between their radii, and the accuracy of the
/// scale.
const MOST_SHAPES: usize = 300;
const SHAPE_STEP: f64 = 1.1;
const SMALLEST_SHAPE_STEP: f64 = 1.001;
const SAME_SCALE: f64 = 1e-10;

/// The norm for branches: concentrations relative to their means, the scale relative to its own size.
fn metric(state: &Solution, scale: f64) -> Metric {
    let weight = |k: usize| 1.0 / state.scalars[MEAN_A + k].powi(2).max(1e-6);
    let mut components = vec![0.0; COMPONENTS];
    (components[0], components[1]) = (weight(0), weight(1));
    Metric { components, scalars: vec![0.0, 0.0, 1.0 / (scale * scale)] }
}

/// The end of a branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BranchEnd {
    /// At the requested scale.
    Reached,
    /// In a fold before that scale, between the last two points.
    Fold,
    /// In a state that is not polarised.
    Even,
    /// At the largest number of points.
    Endless,
}

/// Follows a branch to a scale, or to the end of polarised states before it.
///
/// # Errors
/// Continuation fails.
pub fn follow(branch: &mut Continuation<Polarity>, wanted: f64) -> Result<BranchEnd, ContinuationError> {
    let start = branch.state.parameter();
    let range = [start.min(wanted), start.max(wanted)];
    let mut end = BranchEnd::Reached;
    let visit = |branch: &mut Continuation<Polarity>, advance: Advance| {
        if advance.passed_fold {
            end = BranchEnd::Fold;
        } else if !is_polarised(&branch.state.solution) {
            end = BranchEnd::Even;
        }
        end == BranchEnd::Reached
    };
    match branch.follow(range, MOST_POINTS, visit)? {
        Termination::PointLimit(_) => Ok(BranchEnd::Endless),
        _ => Ok(end),
    }
}
