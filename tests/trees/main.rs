//! Lineages: cues, growth, ends, the cache, and the files of trees.

#[path = "../common/mod.rs"]
mod common;

mod carried_cues;
mod clock;
mod complaints;
mod embryo;
mod founder_shells;
mod growth;
mod lineage_cues;
mod lineage_file;
mod newick;
mod own_law;
mod physics_rules;
mod random_trees;
mod replicates;
mod robustness;
mod scenarios;
mod store_processes;
mod strong_cues;
mod tree_file;
mod tree_identity;
mod tree_schema;
