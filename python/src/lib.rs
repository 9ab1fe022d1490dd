//! The compiled part of the Python package, a thin layer: the library checks and computes, and results reach Python as numpy
//! arrays without copies, or as JSON. `python/furrow/` turns them into what users see.
//!
//! | file | contents |
//! |---|---|
//! | `errors` | the library's errors as Python's exceptions |
//! | `supervise` | work without the interpreter's lock, stopped by Ctrl-C |
//! | `inputs` | a cell and its numerics, checked |
//! | `memo` | solved divisions |
//! | `cells` | one cell: its division, its stationary shapes, its threshold |
//! | `trees` | lineages |
//! | `solve` | the values of one parameter that give a wanted division |
//! | `sweeps` | many points |
//! | `studies` | constants from thresholds, lineages over sets of constants |
//! | `comparisons` | the model beside counts, volumes and outlines of measured embryos |
//! | `measurements` | the model beside measured lifetimes and doses, the clock fitted to lifetimes |

mod cells;
mod comparisons;
mod errors;
mod inputs;
mod measurements;
mod memo;
mod solve;
mod studies;
mod supervise;
mod sweeps;
mod trees;

/// The part of `furrow` that is compiled.
#[pyo3::pymodule]
mod _furrow {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::{
        cells::{branch, divide, film, pitchfork, steady},
        comparisons::{compare_contours, compare_counts, compare_volumes},
        inputs::{Inputs, parameter_names, presets},
        measurements::{compare_dose, compare_lifetimes, fit_clock},
        memo::Memo,
        solve::solve,
        studies::{calibrate, ensemble, ranges},
        sweeps::sweep,
        trees::{GrownTree, grow, read_tree},
    };

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        module.add("solver_version", furrow_lineage::batch::SOLVER_VERSION)
    }
}
