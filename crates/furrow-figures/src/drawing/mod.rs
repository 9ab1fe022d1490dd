//! Drawing for all pictures: one style, a canvas for SVG, PDF and PNG, charts, legends, cells.
//!
//! | file | content |
//! |---|---|
//! | [`style`] | colours, sizes of text, dashes, names of quantities with their units |
//! | `canvas` | lines, areas and text |
//! | `svg`, `raster`, `format` | the finished picture as SVG, as pixels, as a file |
//! | `font` | widths of text, subscripts, line breaks |
//! | `panel` | a chart: its axes, and drawing in the coordinates of its data |
//! | `legend` | markers and legends |
//! | `scale` | colour scales |
//! | `cell` | a cell: its contour in its shell, and the cue along it |
//! | `regulator` | colours of the regulator that the flow carries |

mod canvas;
pub(crate) mod cell;
pub(crate) mod font;
pub(crate) mod format;
pub(crate) mod legend;
pub(crate) mod panel;
mod pdf;
pub(crate) mod raster;
pub(crate) mod regulator;
pub(crate) mod scale;
pub mod style;
pub(crate) mod svg;

pub use canvas::{Anchor, Canvas, Label, Stroke};
pub use format::{FigureError, Format};
