//! Measured contours beside a division's: each beside the model's contour with an equally deep furrow.
//!
//! The model's division does not run by the embryo's clock. Contours are therefore matched by shape: by the depth of the
//! furrow and, if depths are alike, as before there is a furrow, by elongation. Both numbers have no
//! unit. A series is of one cell, so all its contours share one scale: it makes their total area equal to the model's.

use ordered_float::OrderedFloat;
use serde::Serialize;

use super::furrow::furrow;
use super::overlap::{Overlap, overlap, overlap_of_pixels};
use super::polygons::Traced;
use super::{Contour, Moments};
use crate::statistics::{mean, sd};

/// Contours with depths that differ by no more are furrowed alike.
const ALIKE: f64 = 0.01;
/// Shallower furrows cannot be distinguished from the roughness of an outline: such contours are all alike.
const SHALLOW: f64 = 0.05;
/// Pixels along the long axis of a contour that was not traced in pixels.
const PIXELS: f64 = 200.0;
/// The stages that are shown.
pub const STAGES: usize = 6;
/// A contour with a smaller elongation is round and has no long axis.
const ROUND: f64 = 1.03;

/// A contour of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelContour {
    /// The frame it is from.
    pub frame: String,
    /// Time, in τ.
    pub t: f64,
    /// The section through the axis, in L_h.
    pub contour: Contour,
}

/// The shape of a contour in numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Shape {
    /// Area: of the measured in the unit of its file, of the model in L_h².
    pub area: f64,
    /// How much longer than wide: the root of the ratio of second moments.
    pub elongation: f64,
    /// Depth of the furrow, from 0 to 1.
    pub depth: f64,
}

/// A measured contour beside the model's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ContourMatch {
    /// Its file.
    pub file: String,
    /// Its name within the file.
    pub contour: String,
    /// The measured contour.
    pub measured: Shape,
    /// Centroid, in the unit of the file.
    pub centroid: [f64; 2],
    /// Angle of the long axis to the first coordinate, in degrees, from −90 to 90.
    pub angle: f64,
    /// The frame of the model.
    pub frame: String,
    /// Its time, in τ.
    pub t: f64,
    /// The model's contour.
    pub model: Shape,
    /// The overlap, by exact areas.
    pub overlap: Overlap,
    /// The overlap, by pixels.
    pub pixels: Overlap,
    /// The stage that it represents, from 0; `None` if it is not a stage.
    pub stage: Option<usize>,
    /// Changes to it, and remarks.
    pub notes: Vec<String>,
    /// Both contours in superposition, in L_h, the long axis along the second coordinate.
    #[serde(skip)]
    pub aligned: [Contour; 2],
}

/// All contours of a series.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Series {
    /// One L_h, in the unit of the files.
    pub length_scale: f64,
    /// Contours.
    pub n: usize,
    /// Mean similarity, by exact areas.
    pub similarity: f64,
    /// Its standard deviation.
    pub similarity_sd: Option<f64>,
    /// Mean similarity of the stages.
    pub similarity_of_stages: f64,
    /// Each contour, in the order of the files.
    pub contours: Vec<ContourMatch>,
}

/// An upright contour, with its shape.
struct Aligned {
    contour: Contour,
    moments: Moments,
    shape: Shape,
}

impl Aligned {
    fn of(contour: &Contour) -> Aligned {
        let moments = contour.moments();
        let upright = contour.upright();
        let Moments { area, elongation, .. } = moments;
        let shape = Shape { area, elongation, depth: furrow(&upright).depth };
        Aligned { contour: upright, moments, shape }
    }
}

/// Holds contours beside the model's. `length_scale` is one L_h in the unit of the contours; without it they have together the
/// area of the model's. None if there are no contours of either.
pub fn series(measured: &[Traced], model: &[ModelContour], length_scale: Option<f64>) -> Option<Series> {
    let models: Vec<Aligned> = model.iter().map(|modelled| Aligned::of(&modelled.contour)).collect();
    let aligned: Vec<Aligned> = measured.iter().map(|traced| Aligned::of(&traced.contour)).collect();
    let nearest: Vec<usize> = aligned.iter().map(|one| nearest_model(&one.shape, &models)).collect::<Option<_>>()?;
    let areas: f64 = aligned.iter().map(|aligned| aligned.shape.area).sum();
    let of_models: f64 = nearest.iter().map(|k| models[*k].shape.area).sum();
    if aligned.is_empty() || of_models <= 0.0 {
        return None;
    }
    let length_scale = length_scale.unwrap_or((areas / of_models).sqrt());
    let pair = |k: usize| matched(&measured[k], &aligned[k], (&model[nearest[k]], &models[nearest[k]]), length_scale);
    let mut contours: Vec<ContourMatch> = (0..aligned.len()).map(pair).collect();
    for (stage, k) in stages(&contours).into_iter().enumerate() {
        contours[k].stage = Some(stage);
    }
    let similarities = |all: bool| -> Vec<f64> {
        let counted = contours.iter().filter(|contour| all || contour.stage.is_some());
        counted.map(|contour| contour.overlap.similarity).collect()
    };
    let (all, staged) = (similarities(true), similarities(false));
    Some(Series {
        length_scale,
        n: all.len(),
        similarity: mean(&all),
        similarity_sd: sd(&all),
        similarity_of_stages: mean(&staged),
        contours,
    })
}

/// The model's contour that looks most like it.
fn nearest_model(shape: &Shape, models: &[Aligned]) -> Option<usize> {
    let beyond_roughness = |depth: f64| if depth < SHALLOW { 0.0 } else { depth };
    let off = |k: usize| (beyond_roughness(models[k].shape.depth) - beyond_roughness(shape.depth)).abs();
    let nearest = (0..models.len()).map(off).fold(f64::INFINITY, f64::min);
    let longer = |k: usize| (models[k].shape.elongation - shape.elongation).abs();
    (0..models.len()).filter(|k| off(*k) <= nearest + ALIKE).min_by(|a, b| longer(*a).total_cmp(&longer(*b)))
}

fn matched(
    traced: &Traced,
    aligned: &Aligned,
    (modelled, model): (&ModelContour, &Aligned),
    length_scale: f64,
) -> ContourMatch {
    // An axis has two directions, and contours do not give the posterior end: the direction that fits better is used.
    let upright = aligned.contour.scaled(1.0 / length_scale);
    let turned = upright.turned();
    let [straight, about] = [&upright, &turned].map(|own| overlap(own, &model.contour));
    let (own, exact) = if about.similarity > straight.similarity { (turned, about) } else { (upright, straight) };
    let [low, high] = own.ends();
    let pixel = traced.pixel.map_or((high - low) / PIXELS, |pixel| pixel / length_scale);
    let mut notes = traced.notes.clone();
    if aligned.shape.elongation < ROUND {
        notes.push("is nearly round: its long axis means little".to_owned());
    }
    let axis = aligned.moments.long_axis;
    ContourMatch {
        file: traced.file.clone(),
        contour: traced.name.clone(),
        measured: aligned.shape,
        centroid: [aligned.moments.centroid.x, aligned.moments.centroid.y],
        angle: axis.y.atan2(axis.x).to_degrees(),
        frame: modelled.frame.clone(),
        t: modelled.t,
        model: model.shape,
        overlap: exact,
        pixels: overlap_of_pixels(&own, &model.contour, pixel),
        stage: None,
        notes,
        aligned: [own, model.contour.clone()],
    }
}

/// The contours shown as stages, in the order of their depth: those nearest to evenly spread depths.
fn stages(contours: &[ContourMatch]) -> Vec<usize> {
    let depth = |k: usize| contours[k].measured.depth;
    let mut free: Vec<usize> = (0..contours.len()).collect();
    free.sort_by_cached_key(|item| OrderedFloat(depth(*item)));
    if free.len() <= STAGES {
        return free;
    }
    let (least, most) = (depth(free[0]), depth(free[free.len() - 1]));
    let mut chosen = Vec::new();
    for stage in 0..STAGES {
        let wanted = least + (most - least) * stage as f64 / (STAGES - 1) as f64;
        let off = |k: &usize| (depth(*k) - wanted).abs();
        if let Some(at) = (0..free.len()).min_by(|a, b| off(&free[*a]).total_cmp(&off(&free[*b]))) {
            chosen.push(free.remove(at));
        }
    }
    chosen.sort_by_cached_key(|item| OrderedFloat(depth(*item)));
    chosen
}
