//! What all pictures are drawn with: one style, a canvas for SVG and PNG, axes, legends, cells.
//!
//! | file | what it says |
//! |---|---|
//! | [`style`] | colours, sizes of text, dashes, names of quantities with their units |
//! | [`canvas`] | lines, areas and text; the finished picture as SVG or PNG |
//! | [`panel`] | a chart's axes, and where its data are on the canvas |
//! | [`legend`] | what a colour, a dash or a marker stands for |
//! | [`cell`] | a cell: its contour in its shell, the cue along it, forces |

pub mod canvas;
pub mod cell;
pub mod legend;
pub mod panel;
pub mod style;

pub use canvas::{Anchor, Canvas, Drawing, FigureError, Format, Stroke};
