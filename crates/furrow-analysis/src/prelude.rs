//! What most files of this crate import.

pub use furrow_cell::settings::Settings;
pub use furrow_cell::{Cell, Cue, Numerics, Parameter};
pub use furrow_formats::files::WriteError;
pub use furrow_input::{InputError, did_you_mean, listed, parse_document, read_text, shown};
pub use furrow_lineage::batch::{Memo, PhaseDiagram, PhasePlane, Quantisation, SchedulerError, SchedulerOptions};
pub use furrow_lineage::batch::{StoreWarning, Summary, phase::spaced, scheduler};
pub use furrow_lineage::{EndRule, Founder, FounderRounds, GrowError, Grower, Length, Lineage, Rounds, Scope};
pub use furrow_lineage::{Thresholds, Tree, TreeSettings, founder_rounds};
pub use furrow_mechanics::division::{DivisionInput, Outcome, divide};
pub use furrow_mechanics::equilibria::{BranchOptions, CriticalRadii, ShapeError, pitchfork};
pub use rayon::prelude::*;
pub use serde::{Deserialize, Serialize};
pub use serde_json::json;
pub use std::collections::{BTreeMap, HashMap, HashSet};
pub use std::path::{Path, PathBuf};
pub use std::sync::Mutex;
pub use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
