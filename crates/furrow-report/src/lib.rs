//! Tables, the lineage's drawing and pages.

pub mod html;
mod observed_table;
mod page;
pub mod reproduction;
pub mod scenarios_page;
pub mod scenarios_table;
pub mod shapes;
pub mod summary;
pub mod svg;
pub mod table;

pub use html::{explorer, html};
pub use scenarios_page::scenarios_page;
pub use scenarios_table::scenarios_table;
pub use shapes::{EventReport, StationaryReport, ThresholdReport};
pub use summary::{Generation, TreeSummary};
pub use svg::{colours as founder_colours, svg};
pub use table::founders_table;

/// Text with the characters that XML and HTML reserve replaced.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
