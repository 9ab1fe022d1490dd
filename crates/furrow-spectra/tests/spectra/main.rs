//! Growth rates and cycles of textbook systems.

mod cycles;
mod evolution;
mod floquet;
