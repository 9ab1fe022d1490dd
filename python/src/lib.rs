//! The compiled part of the Python package, a thin layer: the library checks and computes, and results reach Python as numpy
//! arrays without copies, or as numbers, lists and dicts. `python/furrow/` turns them into what users see.
//!
//! | file | contents |
//! |---|---|
//! | `document` | results as Python's own values |
//! | `errors` | the library's errors as Python's exceptions |
//! | `words` | options of the command line in messages, as arguments |
//! | `supervise` | work without the interpreter's lock, stopped by Ctrl-C |
//! | `inputs` | a cell and its numerics, checked |
//! | `memo` | solved divisions |
//! | `bvp` | boundary-value problems of Python functions |
//! | `collocation` | their solutions between the nodes |
//! | `cells` | one cell: its division, its stationary shapes, its threshold |
//! | `shapes` | where division begins: boundaries, phase diagrams, critical radii, PAR polarity |
//! | `surfaces` | one cell without axial symmetry: its shapes, its state at rest |
//! | `drawings` | pictures and movies |
//! | `trees` | lineages |
//! | `recursion` | trees with each cell's parameters from a function |
//! | `solve` | the values of one parameter that give a wanted division |
//! | `sweeps` | many points |
//! | `studies` | constants from thresholds, lineages over sets of constants |
//! | `fits` | constants, activities and a cue fitted to observations |
//! | `hypotheses` | several cues beside each other |
//! | `files` | pages, templates, caches, the paper reproduced |
//! | `comparisons` | the model beside counts, volumes and outlines of measured embryos |
//! | `measurements` | the model beside measured lifetimes and doses, the clock fitted to lifetimes |

mod bvp;
mod cells;
mod collocation;
mod comparisons;
mod document;
mod drawings;
mod errors;
mod files;
mod fits;
mod hypotheses;
mod inputs;
mod measurements;
mod memo;
mod recursion;
mod shapes;
mod solve;
mod studies;
mod supervise;
mod surfaces;
mod sweeps;
mod trees;
mod words;

/// The part of `furrow` that is compiled.
#[pyo3::pymodule]
mod _furrow {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::{
        bvp::solve_bvp,
        cells::{branch, checks, divide, film, pitchfork, steady},
        collocation::Collocation,
        comparisons::{compare_contours, compare_counts, compare_volumes},
        drawings::{Drawing, draw_division, write_movie, write_shapes},
        files::{cache, explore, merge, new_lineage, reproduce, tree_schema, write_text},
        fits::{fit_activity, fit_constants, fit_cue, front},
        hypotheses::test,
        inputs::{Inputs, canonical_name, parameter_names, presets},
        measurements::{compare_dose, compare_lifetimes, fit_clock},
        memo::Memo,
        recursion::grow_by,
        shapes::{boundary, critical_radius, perturb, phase, polarity},
        solve::solve,
        studies::{calibrate, ensemble, ranges},
        surfaces::{steady_surface, surfaces},
        sweeps::sweep,
        trees::{GrownTree, export_observed, grow, grow_spread, read_tree, scenarios_files},
    };

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        module.add("solver_version", furrow_lineage::batch::SOLVER_VERSION)
    }
}
