//! The model beside measured embryos.

use std::path::PathBuf;

use furrow_analysis::compare::counts::{counts as counted, counts_of_embryo};
use furrow_analysis::compare::volumes::{GroupComparison, Regression, regression_of};
use furrow_analysis::compare::volumes_comparison::{LengthScale, MeasuredVolumes, VolumesComparison, VolumesModel};
use furrow_analysis::{grown, read_constants_of, scenarios_of, tree_settings};
use furrow_input::InputError;
use furrow_input::shown;
use furrow_measured::contour::Contour;
use furrow_measured::contour::polygons::Traced;
use furrow_measured::contour::series::{ModelContour, Series, series as laid_beside};
use furrow_measured::names::Names;
use furrow_measured::published::{SEA_URCHIN_SOURCE, SOURCE, jankele2021, villoutreix2016};
use furrow_measured::tracked::{TableKind, TrackOptions, embryo_files, read_embryo};
use furrow_measured::volumes::{ReadOptions, Unit, Volumes};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use serde::Serialize;
use serde_json::json;

use crate::document::Document;
use crate::errors::{ARGUMENTS, Error};
use crate::inputs::{
    Given, MatchAsked, OfEmbryos, Source, Tables, is_empty, lineage_of, matched_names, of_embryos, positive, text_of,
};
use crate::memo::Memo;
use crate::supervise::{Interrupt, supervised};
use crate::trees::GrownTree;

/// A tree beside the observed embryo, by every reading of "rounds", or beside one that another program followed.
#[pyfunction]
#[pyo3(signature = (tree, measured, matching))]
pub fn compare_counts(
    py: Python<'_>,
    tree: &GrownTree,
    measured: Option<PathBuf>,
    matching: MatchAsked,
) -> Result<Document, Error> {
    py.detach(|| {
        let names = matched_names(&tree.tree.lineage, &matching)?;
        let embryo = measured.map(|file| {
            let embryo = read_embryo(&file, &TrackOptions::default(), &names)?;
            Ok::<_, InputError>((embryo, file.display().to_string()))
        });
        let embryo = embryo.transpose()?;
        names.require_met()?;
        let found = match &embryo {
            Some((embryo, file)) => counts_of_embryo(&tree.tree, embryo, &names, file)?,
            None => counted(&tree.tree, "tree")?,
        };
        Document::of(&found)
    })
}

/// The arguments of a comparison of volumes; Python gives them as a dict.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct VolumesAsked {
    tables: Tables,
    against: Tables,
    voxel: OfEmbryos,
    matching: MatchAsked,
    unit: Option<String>,
    group: Option<String>,
    published: Option<String>,
    bins: Option<Vec<f64>>,
    regress: Option<(String, String)>,
    population: Option<Vec<String>>,
    lineage: Option<String>,
    constants: Option<Source>,
    length_scale: Option<Length>,
}

/// One L_h: a length, or `fit`.
#[derive(FromPyObject)]
enum Length {
    Given(f64),
    Word(String),
}

impl VolumesAsked {
    /// Adds tables: as text, and in files. Their rows without a group are of this one.
    fn read_into(
        &self,
        volumes: &mut Volumes,
        (files, text): &Tables,
        group: &Option<String>,
        names: &Names,
    ) -> Result<(), Error> {
        let unit = self.unit.as_deref().map(|unit| {
            unit.parse::<Unit>().map_err(|_| Error::not_allowed("unit", shown(unit), "um3, voxels or relative"))
        });
        let (group, names) = (group.clone(), names.clone());
        let voxel = of_embryos("voxel", &self.voxel, "a length in µm above 0")?;
        let options = ReadOptions { voxel, group, unit: unit.transpose()?, names, class: Vec::new() };
        if let Some(text) = text {
            volumes.read(text.as_bytes(), "volumes", &options)?;
        }
        embryo_files(files, TableKind::Volumes)?.0.iter().try_for_each(|file| volumes.read_file(file, &options))?;
        Ok(())
    }

    fn read(&self, names: &Names) -> Result<MeasuredVolumes, Error> {
        let mut volumes = Volumes::default();
        if is_empty(&self.tables) {
            names.require_met()?;
            return Ok(match self.published.as_deref() {
                Some("villoutreix2016") => MeasuredVolumes::published(SEA_URCHIN_SOURCE, villoutreix2016()?),
                _ => MeasuredVolumes::published(SOURCE, jankele2021()?),
            });
        }
        // If the tables have no groups, the two conditions become two groups.
        let [first, second] = match is_empty(&self.against) {
            true => [self.group.clone(), None],
            false => ["measured", "against"].map(|name| Some(name.to_owned())),
        };
        self.read_into(&mut volumes, &self.tables, &first, names)?;
        self.read_into(&mut volumes, &self.against, &second, names)?;
        volumes.require_used("volumes")?;
        volumes.require_options()?;
        names.require_met()?;
        Ok(MeasuredVolumes::of(volumes, (ARGUMENTS, self.population.as_deref()))?)
    }

    /// The regression of two groups: of those named, or of the two conditions.
    fn regressions(&self, groups: &[GroupComparison]) -> Result<Vec<Regression>, Error> {
        let names = match &self.regress {
            Some((x, y)) => [&**x, &**y],
            None if is_empty(&self.against) => return Ok(Vec::new()),
            None => ["measured", "against"],
        };
        match (regression_of(groups, names[0], names[1]), &self.regress) {
            (Some(found), _) => Ok(vec![found]),
            // Tables with their own groups lack the two conditions' names.
            (None, None) => Ok(Vec::new()),
            (None, Some(_)) => {
                let known: Vec<&str> = groups.iter().map(|group| group.group.as_str()).collect();
                let allowed = format!("two groups of the tables; groups are {}", known.join(", "));
                Err(Error::not_allowed("regress", names.join(", "), allowed))
            }
        }
    }

    /// Choice of one L_h.
    fn scale(&self) -> Result<LengthScale, Error> {
        Ok(match &self.length_scale {
            Some(Length::Given(length)) => {
                let allowed = "a length above 0, in the cube root of the tables' unit";
                LengthScale::Given(positive("length_scale", *length, allowed)?)
            }
            Some(Length::Word(word)) if word == "fit" => LengthScale::Fitted,
            Some(Length::Word(word)) => {
                return Err(Error::not_allowed("length_scale", shown(word), "a length above 0, or \"fit\""));
            }
            None => LengthScale::Usual,
        })
    }
}

/// Size asymmetries of measured divisions beside the model's. Volumes are tables in files or one table as text, and embryos
/// that other programs followed; default published means.
#[pyfunction]
#[pyo3(signature = (asked, given, memo, threads, progress=None))]
pub fn compare_volumes(
    py: Python<'_>,
    asked: VolumesAsked,
    given: Given,
    memo: &Memo,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> Result<Document, Error> {
    let settings = given.settings()?;
    let (of_call, memo) = (memo, memo.solved()?);
    let found = supervised(py, Interrupt::Finishes, progress, move |watch| {
        let length_scale = asked.scale()?;
        let lineage = lineage_of(asked.lineage.as_deref())?;
        let measured = asked.read(&matched_names(&lineage, &asked.matching)?)?;
        given.for_divisions()?;
        let tree_settings = tree_settings(settings.clone(), &lineage, 0, memo.quantisation());
        let sets = match text_of(&asked.constants.clone().unwrap_or_default(), "constants")? {
            Some((text, name)) => {
                let sets = read_constants_of(&text, &name, &lineage)?;
                given.check_beside(&sets, &name)?;
                sets
            }
            None => Vec::new(),
        };
        let found = watch.scheduled(threads, |options| {
            let model = VolumesModel {
                lineage: &lineage,
                own_cues: asked.lineage.is_some(),
                settings: &tree_settings,
                constants: &sets,
                length_scale,
                memo: &memo,
                options,
                cancel: &watch.stop,
            };
            let grow = |lineages| {
                let scenarios = scenarios_of(lineages, &settings, memo.quantisation());
                Ok::<_, Error>(grown(&scenarios, false, &memo, *options, &watch.stop)?.trees)
            };
            VolumesComparison::of(&measured, asked.bins.as_deref(), &model, grow, |groups| asked.regressions(groups))
        })?;
        let mut found = json!(found);
        found["divisions"] = json!(measured.divisions.divisions);
        found["of_nuclei"] = measured.volumes.of_nuclei.into();
        Ok(found.into())
    });
    of_call.warned(py, found)
}

/// A measured contour that could not be used.
#[derive(Serialize)]
struct SkippedContour {
    contour: usize,
    why: String,
}

/// A series of contours beside the model's, with each pair after alignment.
#[derive(Serialize)]
struct ContoursFound<'a> {
    #[serde(flatten)]
    series: &'a Series,
    laid: Vec<[Vec<[f64; 2]>; 2]>,
    used: usize,
    skipped: &'a [SkippedContour],
}

/// Compares measured contours with frames, which are sections through the axis with their times.
#[pyfunction]
pub fn compare_contours(
    py: Python<'_>,
    measured: Vec<PyReadonlyArray2<'_, f64>>,
    model: Vec<(f64, PyReadonlyArray2<'_, f64>)>,
    length: Option<f64>,
) -> Result<Document, Error> {
    let points = |array: &PyReadonlyArray2<'_, f64>| -> Vec<[f64; 2]> {
        array.as_array().rows().into_iter().filter_map(|row| Some([*row.get(0)?, *row.get(1)?])).collect()
    };
    let measured: Vec<Vec<[f64; 2]>> = measured.iter().map(points).collect();
    let model: Vec<(f64, Vec<[f64; 2]>)> = model.iter().map(|(t, array)| (*t, points(array))).collect();
    supervised(py, Interrupt::Abandons, None, move |_| {
        let allowed = "a length above 0, in the unit of the contours";
        length.map(|length| positive("length_scale", length, allowed)).transpose()?;
        let (mut traced, mut skipped) = (Vec::new(), Vec::new());
        for (k, points) in measured.into_iter().enumerate() {
            match Contour::new(points) {
                Ok((contour, _)) => {
                    let (file, name, notes) = (k.to_string(), String::new(), Vec::new());
                    traced.push(Traced { file, name, contour, pixel: None, notes });
                }
                Err(why) => skipped.push(SkippedContour { contour: k, why: why.to_string() }),
            }
        }
        if let (true, Some(SkippedContour { contour, why })) = (traced.is_empty(), skipped.first()) {
            return Err(Error::not_allowed(format!("measured[{contour}]"), why, "an outline that can be used"));
        }
        let frames = model.into_iter().enumerate().map(|(k, (t, points))| match Contour::new(points) {
            Ok((contour, _)) => Ok(ModelContour { frame: k.to_string(), t, contour }),
            Err(why) => Err(Error::not_allowed(format!("model[{k}]"), why, "a contour of three points or more")),
        });
        let frames = frames.collect::<Result<Vec<_>, Error>>()?;
        let series = laid_beside(&traced, &frames, length)
            .ok_or_else(|| Error::not_allowed("measured", "none", "at least one outline, and a model with frames"))?;
        let points = |contour: &Contour| contour.points().iter().map(|p| [p.x, p.y]).collect();
        let laid = series.contours.iter().map(|one| one.aligned.each_ref().map(points)).collect();
        Document::of(&ContoursFound { series: &series, laid, used: traced.len(), skipped: &skipped })
    })
}
