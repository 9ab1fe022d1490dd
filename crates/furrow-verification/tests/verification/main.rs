//! Tests of the mechanics against independent statements, in one program: each would be linked by itself otherwise.

mod decisions;
mod derivatives;
mod differences;
mod growth_rates;
mod line;
mod manufactured;
mod own_laws;
mod peer;
mod random_cells;
mod regulator;
mod shell_profiles;
mod strong_regulators;
mod surface;
mod time;
mod virtual_power;
