//! Tests of the engine, in one program: each would be linked by itself otherwise.

mod bent;
mod crossing;
mod derivatives;
mod divisions;
mod invariance;
mod own_law;
mod plane;
mod power;
mod states;
mod stationary;
