//! Cost of a tree over its number of distinct divisions, on one thread and on two.
//!
//! ```text
//! cargo bench --bench scaling
//! ```
//!
//! The built-in tree is grown without a cache to increasing depth. CPU time is measured for the divisions on their threads, which is
//! valid on a busy machine too. The longest chain of divisions, from mother to daughter, limits the gain: on two
//! threads the ratio is at most total / max(total / 2, chain).

use furrow_formats::tree_to_json;
use std::collections::HashMap;
use std::sync::Mutex;
use std::time::Instant;

use furrow_cell::Cell;
use furrow_lineage::batch::{Key, Memo, Quantisation, SchedulerOptions};
use furrow_lineage::{EndRule, Grower, Lineage, Tree, TreeSettings};
use furrow_mechanics::division::{DivisionInput, divide};

#[path = "common/clock.rs"]
mod clock;
use clock::now;

struct Run {
    tree: Tree,
    wall: f64,
    /// CPU seconds of each division solved.
    cost: HashMap<Key, f64>,
    memo: Memo,
}

impl Run {
    fn grow(depth: u32, threads: usize) -> Run {
        let mut lineage = Lineage::c_elegans().unwrap();
        lineage.limits.max_depth = depth;
        let memo = Memo::new(Quantisation::DEFAULT);
        let settings = TreeSettings::default();
        let options = SchedulerOptions { threads, ..SchedulerOptions::default() };
        let cost = Mutex::new(HashMap::new());
        let began = Instant::now();
        let timed = |input: &DivisionInput| {
            let start = now();
            let division = divide(input);
            let seconds = now() - start;
            cost.lock().unwrap().insert(Key::new(input), seconds);
            division
        };
        let grower = Grower { lineage: &lineage, settings, ends: EndRule::Dynamics, memo: &memo, options };
        let (tree, _) = grower.grow(timed).unwrap();
        let wall = began.elapsed().as_secs_f64();
        let cost = cost.into_inner().unwrap();
        Run { tree, wall, cost, memo }
    }

    fn total(&self) -> f64 {
        self.cost.values().sum()
    }

    /// CPU seconds of the most expensive line of descent.
    fn chain(&self) -> f64 {
        let TreeSettings { cell: first, numerics, seed, .. } = &self.tree.settings;
        let mut below = vec![0.0f64; self.tree.len()];
        for node in self.tree.cells().rev() {
            let grown = self.tree.cell(node);
            let cell = Cell { r0: grown.r0, cue: grown.cue.clone(), ..first.clone() };
            let input = DivisionInput { cell, numerics: *numerics, seed: *seed };
            let own = self.cost.get(&Key::new(&self.memo.canonical(&input))).copied().unwrap_or(0.0);
            let longest = self.tree.daughters(node).into_iter().flatten().map(|d| below[d.index()]).fold(0.0, f64::max);
            below[node.index()] = own + longest;
        }
        below[0]
    }
}

fn main() {
    println!("depth cells divisions    cpu s cpu ms/division chain s  wall s 1 thread 2 threads  ratio  bound");
    for depth in [2, 4, 5, 6, 8, 10, 200] {
        let [one, two] = [1, 2].map(|threads| Run::grow(depth, threads));
        assert_eq!(tree_to_json(&one.tree).unwrap(), tree_to_json(&two.tree).unwrap());
        let (total, chain) = (one.total(), one.chain());
        println!(
            "{depth:5} {:5} {:9} {total:8.3} {:15.1} {chain:7.3} {:16.3} {:9.3} {:6.2} {:6.2}",
            one.tree.len(),
            one.cost.len(),
            1e3 * total / one.cost.len() as f64,
            one.wall,
            two.wall,
            one.wall / two.wall,
            total / (0.5 * total).max(chain),
        );
    }
}
