//! Tests of the engine, in one program: each would be linked by itself otherwise.

mod crossing;
mod derivatives;
mod divisions;
mod invariance;
mod power;
mod states;
mod stationary;
