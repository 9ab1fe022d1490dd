//! Drawing for all pictures: one style, a canvas for SVG, PDF and PNG, charts, legends, cells.
//!
//! | file | content |
//! |---|---|
//! | [`style`] | colours, sizes of text, dashes, names of quantities with their units |
//! | [`canvas`] | lines, areas and text |
//! | `svg`, `raster`, [`format`](mod@format) | the finished picture as SVG, as pixels, as a file |
//! | `font` | how wide text is, its indices, where it breaks |
//! | [`panel`] | a chart's axes, and what is drawn at the coordinates of its data |
//! | [`legend`] | markers and legends |
//! | [`scale`] | the scale of a colour |
//! | [`cell`] | a cell: its contour in its shell, the cue along it |
//! | [`regulator`] | the colours of what a cue has the flow carry |

pub mod canvas;
pub mod cell;
pub(crate) mod font;
pub mod format;
pub mod legend;
pub mod panel;
mod pdf;
mod raster;
pub mod regulator;
pub mod scale;
pub mod style;
pub(crate) mod svg;

pub use canvas::{Anchor, Canvas, Stroke};
pub use format::{FigureError, Format};
