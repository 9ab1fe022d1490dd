//! Hypotheses beside each other.

use furrow_analysis::fit::{FitProgress, FitRun};
use furrow_analysis::hypotheses::free::Free;
use furrow_analysis::hypotheses::observations::Chosen;
use furrow_analysis::hypotheses::{
    Effort, Hypothesis, Named, Noise, NoiseKind, Observations, Others, Question, TestedHypothesis, samples_csv,
    test as tested,
};
use furrow_analysis::tempering::Sampling;
use furrow_analysis::tree_settings;
use furrow_figures::plot;
use furrow_input::shown;
use furrow_lineage::Lineage;
use furrow_measured::lifetimes::{LifetimeOptions, Lifetimes};
use furrow_measured::published::jankele2021_lifetimes;
use furrow_measured::tracked::{TableKind, embryo_files};
use furrow_measured::volumes::{ReadOptions, Unit, Volumes};
use pyo3::prelude::*;
use std::path::PathBuf;

use crate::document::Document;
use crate::drawings::Drawing;
use crate::errors::{ARGUMENTS, Error};
use crate::inputs::{Given, MatchAsked, OfEmbryos, Tables, lineage_of, matched_names, of_embryos, shard_of};
use crate::memo::Memo;
use crate::supervise::{Interrupt, supervised};
use crate::trees::one_of;

/// The arguments of a test; Python gives them as a dict.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct TestAsked {
    table: Tables,
    cues: Vec<String>,
    /// A file of more hypotheses.
    hypotheses: Option<PathBuf>,
    free: Option<Vec<String>>,
    lineage: Option<String>,
    noise: Option<String>,
    folded: bool,
    cells: Option<Vec<String>>,
    population: Option<Vec<String>>,
    class: Vec<String>,
    voxel: OfEmbryos,
    matching: MatchAsked,
    unit: Option<String>,
    /// The standard deviation of mean rounds, if they are used.
    rounds: Option<f64>,
    /// Lifetimes, of no file and no text the published ones, and the standard deviation of their logarithm.
    lifetimes: Option<(Tables, f64)>,
    /// Particles, moves and seed of each search.
    search: (Option<usize>, Option<u64>, u64),
    /// Points of each sample.
    samples: Option<usize>,
    /// Part and number of parts of a sample.
    shard: Option<(u64, u64)>,
}

impl TestAsked {
    fn hypotheses(&self) -> Result<Vec<Named>, Error> {
        let mut asked = Named::list(&self.cues, ARGUMENTS)?;
        if let Some(file) = &self.hypotheses {
            asked.extend(Named::file(file)?);
        }
        Ok(asked)
    }

    /// What was observed beside χ.
    fn others(&self, lineage: &Lineage) -> Result<Vec<Others>, Error> {
        let mut all = Vec::new();
        if let Some(sd) = self.rounds {
            all.push(Others::rounds(lineage, sd, "rounds")?);
        }
        if let Some((table, sd)) = &self.lifetimes {
            let options =
                LifetimeOptions { names: matched_names(lineage, &self.matching)?, ..LifetimeOptions::default() };
            let found = match table {
                (_, Some(text)) => Lifetimes::read_with(text.as_bytes(), "lifetimes", &options)?,
                (files, None) if files.is_empty() => jankele2021_lifetimes()?,
                (files, None) => Lifetimes::read_files(&embryo_files(files, TableKind::Lifetimes)?.0, &options)?,
            };
            all.push(Others::lifetimes(&found, lineage, *sd, "lifetimes")?);
        }
        Ok(all)
    }

    fn observations(&self, lineage: &Lineage) -> Result<Observations, Error> {
        let voxel = of_embryos("voxel", &self.voxel, "a length in µm above 0")?;
        let names = matched_names(lineage, &self.matching)?;
        let unit = self.unit.as_deref().map(|unit| {
            unit.parse::<Unit>().map_err(|_| Error::not_allowed("unit", shown(unit), "um3, voxels or relative"))
        });
        let reading = ReadOptions { voxel, unit: unit.transpose()?, names, class: self.class.clone(), group: None };
        let chosen = Chosen { cells: self.cells.as_deref(), groups: self.population.as_deref() };
        let (files, text) = &self.table;
        let Some(text) = text else {
            return Ok(Observations::read(
                &embryo_files(files, TableKind::Volumes)?.0,
                &reading,
                lineage,
                chosen,
                [ARGUMENTS; 2],
            )?);
        };
        let mut volumes = Volumes::default();
        volumes.read(text.as_bytes(), "table", &reading)?;
        volumes.require_used("table")?;
        reading.names.require_met()?;
        Ok(Observations::of_tables(&volumes, lineage, chosen, ("table", [ARGUMENTS; 2]))?)
    }
}

/// The samples of all hypotheses: the numbers of each point, and all as a table (CSV).
type Samples = (Vec<Vec<Vec<f64>>>, String);

/// Several cues, each fitted to measured χ, and whether they are distinguishable.
#[pyfunction]
#[pyo3(signature = (asked, given, memo, threads, progress=None))]
pub fn test(
    py: Python<'_>,
    asked: TestAsked,
    given: Given,
    memo: &Memo,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> Result<(Document, Drawing, Samples), Error> {
    let (of_call, memo) = (memo, memo.solved()?);
    let found = supervised(py, Interrupt::Finishes, progress, move |watch| {
        let lineage = lineage_of(asked.lineage.as_deref())?;
        let settings = given.for_divisions()?;
        settings.check_axisymmetric(ARGUMENTS)?;
        let settings = tree_settings(settings, &lineage, 0, memo.quantisation());
        let free = asked.free.as_ref().map(|texts| Free::list(texts, &lineage, ARGUMENTS)).transpose()?;
        let hypotheses =
            Hypothesis::all(&asked.hypotheses()?, free.as_deref(), &lineage, &settings.cell, [ARGUMENTS; 2])?;
        let kind = asked.noise.as_deref().map(|kind| one_of("noise", kind, NoiseKind::NAMED)).transpose()?;
        let observations = Observations { others: asked.others(&lineage)?, ..asked.observations(&lineage)? };
        let noise = Noise::of(&observations, kind, asked.folded, ("table", ARGUMENTS))?;
        let (particles, moves, seed) = asked.search;
        let effort = Effort { particles, moves, seed };
        let (observations, hypotheses, noise, memo) = (&observations, &hypotheses, &noise, &memo);
        let shard = asked.shard.map(shard_of).transpose()?;
        let of_part = shard.map_or(seed, |shard| shard.seed(seed));
        let sampling = asked.samples.map(|particles| Sampling { particles, seed: of_part });
        let question = Question { observations, hypotheses, noise, effort, sampling, memo };
        question.check(ARGUMENTS)?;
        let show = |FitProgress { done, of, .. }| watch.set([0, done, of]);
        let run = FitRun { progress: Some(&show), ..FitRun::new(&lineage, &settings, threads, &watch.stop) };
        let found = tested(&run, &question)?;
        let points = |tested: &TestedHypothesis| tested.posterior.as_ref().map_or(Vec::new(), |p| p.points.clone());
        let points = found.hypotheses.iter().map(points).collect();
        let sampled = found.hypotheses.iter().filter_map(|of| Some((of.name.as_str(), of.posterior.as_ref()?)));
        let csv = samples_csv(sampled, shard);
        Ok((Document::of(&found)?, Drawing::of(plot::hypotheses::draw(&found)), (points, csv)))
    });
    of_call.warned(py, found)
}
