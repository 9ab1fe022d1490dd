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
//! | `sweeps` | many points |
//! | `studies` | constants from thresholds, lineages over sets of constants |
//! | `comparisons` | the model beside measured embryos |

mod cells;
mod columns;
mod comparisons;
mod errors;
mod inputs;
mod memo;
mod studies;
mod supervise;
mod sweeps;
mod trees;

use pyo3::prelude::*;

/// The part of `furrow` that is compiled.
#[pymodule]
fn _furrow(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("solver_version", furrow_lineage::batch::SOLVER_VERSION)?;
    module.add_class::<inputs::Inputs>()?;
    module.add_class::<memo::Memo>()?;
    module.add_class::<trees::GrownTree>()?;
    module.add_function(wrap_pyfunction!(inputs::parameter_names, module)?)?;
    module.add_function(wrap_pyfunction!(inputs::presets, module)?)?;
    module.add_function(wrap_pyfunction!(cells::divide, module)?)?;
    module.add_function(wrap_pyfunction!(cells::film, module)?)?;
    module.add_function(wrap_pyfunction!(cells::steady, module)?)?;
    module.add_function(wrap_pyfunction!(cells::pitchfork, module)?)?;
    module.add_function(wrap_pyfunction!(cells::branch, module)?)?;
    module.add_function(wrap_pyfunction!(trees::grow, module)?)?;
    module.add_function(wrap_pyfunction!(trees::read_tree, module)?)?;
    module.add_function(wrap_pyfunction!(sweeps::sweep, module)?)?;
    module.add_function(wrap_pyfunction!(studies::calibrate, module)?)?;
    module.add_function(wrap_pyfunction!(studies::ensemble, module)?)?;
    module.add_function(wrap_pyfunction!(studies::ranges, module)?)?;
    module.add_function(wrap_pyfunction!(comparisons::compare_counts, module)?)?;
    module.add_function(wrap_pyfunction!(comparisons::compare_volumes, module)?)?;
    module.add_function(wrap_pyfunction!(comparisons::compare_contours, module)?)?;
    Ok(())
}
