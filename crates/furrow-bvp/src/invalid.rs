//! Why input is refused: one error for sizes, meshes and settings, which the errors of all solvers carry.

use crate::dimensions::TooLarge;

/// Why a problem, a guess or a setting is refused before anything is computed.
///
/// # Examples
/// ```
/// use furrow_bvp::{Gauss, InvalidInput, Solution};
/// let gauss = Gauss::new(4)?;
/// let refused = Solution::from_fn(&gauss, &[0.0, 2.0, 1.0], 2, &[], |_, y| y.fill(0.0));
/// assert_eq!(refused, Err(InvalidInput::Mesh { index: 2, value: 1.0 }));
/// assert!(Gauss::new(9).is_err());
/// # Ok::<(), InvalidInput>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidInput {
    /// The problem does not fit the kernels.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// The problem has another number of conditions than the task needs.
    #[error("the problem has {missing} more unknowns than conditions, {allowed} allowed")]
    NotSquare {
        /// Unknowns less conditions.
        missing: isize,
        /// The numbers that the task allows.
        allowed: &'static str,
    },
    /// A mesh of less than two nodes.
    #[error("a mesh of {nodes} nodes: at least 2 are needed")]
    ShortMesh {
        /// Nodes.
        nodes: usize,
    },
    /// A node that is not finite, or not larger than the node before it.
    #[error("node {index} of the mesh is {value}: nodes are finite and increase")]
    Mesh {
        /// Index of the node.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// Another number of values than the problem and the mesh ask for.
    #[error("{length} {name}, {expected} needed")]
    Length {
        /// The counted objects.
        name: &'static str,
        /// How many there are.
        length: usize,
        /// How many are needed.
        expected: usize,
    },
    /// More values than the kernels take.
    #[error("{length} {name}, {limit} allowed")]
    TooMany {
        /// The counted objects.
        name: &'static str,
        /// How many there are.
        length: usize,
        /// Most of them.
        limit: usize,
    },
    /// A step that has to come first is missing, or it failed.
    #[error("the system is not {step} yet")]
    NotReady {
        /// The step.
        step: &'static str,
    },
    /// An index beyond the end.
    #[error("{name} {index} does not exist: there are {count}, counted from 0")]
    Index {
        /// The objects that the index counts.
        name: &'static str,
        /// The index.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A known solution on another interval than the guess.
    #[error("a known solution from {} to {}, and the problem is from {} to {}", known[0], known[1], own[0], own[1])]
    Interval {
        /// Ends of the known solution.
        known: [f64; 2],
        /// Ends of the guess.
        own: [f64; 2],
    },
    /// A number outside its range.
    #[error("{name} is {value}, {allowed} is allowed")]
    Setting {
        /// The meaning of the number.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The allowed values.
        allowed: &'static str,
    },
}

/// A number of a message, rounded to seven digits: later digits are noise to its reader, and so are hundreds of zeros.
pub(crate) fn short(number: f64) -> String {
    let rounded = format!("{number:.6e}").parse().unwrap_or(number);
    if rounded != 0.0 && rounded.abs() < 1e-4 { format!("{rounded:e}") } else { rounded.to_string() }
}

/// Refuses a number of values other than the one needed.
pub(crate) fn length(name: &'static str, length: usize, expected: usize) -> Result<(), InvalidInput> {
    if length == expected { Ok(()) } else { Err(InvalidInput::Length { name, length, expected }) }
}

/// Refuses more values than `limit`.
pub(crate) fn at_most(name: &'static str, length: usize, limit: usize) -> Result<(), InvalidInput> {
    if length <= limit { Ok(()) } else { Err(InvalidInput::TooMany { name, length, limit }) }
}

/// Refuses a system for which an earlier step is missing.
pub(crate) fn ready(is_done: bool, step: &'static str) -> Result<(), InvalidInput> {
    if is_done { Ok(()) } else { Err(InvalidInput::NotReady { step }) }
}

/// Refuses an index beyond the end.
pub(crate) fn index(name: &'static str, index: usize, count: usize) -> Result<(), InvalidInput> {
    if index < count { Ok(()) } else { Err(InvalidInput::Index { name, index, count }) }
}

/// Refuses all but finite numbers above 0.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<(), InvalidInput> {
    setting(name, value, value > 0.0 && value.is_finite(), "a finite number above 0")
}

/// Refuses a number that is not `allowed`.
pub(crate) fn setting(
    name: &'static str,
    value: f64,
    is_allowed: bool,
    allowed: &'static str,
) -> Result<(), InvalidInput> {
    if is_allowed { Ok(()) } else { Err(InvalidInput::Setting { name, value, allowed }) }
}

/// Refuses a known solution on another interval than the guess, except for rounding.
pub(crate) fn interval(known: &[f64], own: &[f64]) -> Result<(), InvalidInput> {
    let (Some(known), Some(own)) = (ends(known), ends(own)) else { return Ok(()) };
    let slack = 1e-9 * (own[1] - own[0]);
    let is_same = (0..2).all(|k| (known[k] - own[k]).abs() <= slack);
    if is_same { Ok(()) } else { Err(InvalidInput::Interval { known, own }) }
}

/// First and last node of a mesh.
fn ends(mesh: &[f64]) -> Option<[f64; 2]> {
    Some([*mesh.first()?, *mesh.last()?])
}

/// Refuses a mesh with fewer than two nodes, or with nodes that are not finite or do not increase.
pub(crate) fn mesh(nodes: &[f64]) -> Result<(), InvalidInput> {
    if nodes.len() < 2 {
        return Err(InvalidInput::ShortMesh { nodes: nodes.len() });
    }
    let mut before = f64::NEG_INFINITY;
    for (index, &value) in nodes.iter().enumerate() {
        if !(value.is_finite() && value > before) {
            return Err(InvalidInput::Mesh { index, value });
        }
        before = value;
    }
    Ok(())
}
