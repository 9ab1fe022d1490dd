//! Presentation of results to readers.
//!
//! | file | contents |
//! |---|---|
//! | [`table`], `observed_table` | the founders' table as text; its columns beside observed counts |
//! | [`mod@scenarios_table`], [`mod@scenarios_page`] | several trees side by side, as text and as a page |
//! | [`mod@svg`] | the drawing of a lineage |
//! | [`mod@html`], `page` | the interactive page: its content, its frame with scripts and solver |
//! | [`summary`] | counts over a tree |
//! | [`shapes`] | records of stationary shapes, folds and pitchforks |
//! | [`reproduction`] | the paper's statements beside computed ones |

pub mod html;
mod observed_table;
mod over_time;
mod page;
pub mod reproduction;
pub mod scenarios_page;
pub mod scenarios_table;
pub mod shapes;
mod spread;
pub mod spread_table;
pub mod summary;
pub mod svg;
pub mod table;
pub mod time_axis;

pub use html::{explorer, html};
pub use scenarios_page::scenarios_page;
pub use scenarios_table::scenarios_table;
pub use shapes::{azimuthal_report, crossing_report, event_report, stationary_report, threshold_report};
pub use spread_table::spread_table;
pub use summary::{Generation, TreeSummary};
pub use svg::{colours as founder_colours, svg};
pub use table::founders_table;
pub use time_axis::TimeAxis;

/// Text with the characters that XML and HTML reserve replaced.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
