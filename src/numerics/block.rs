//! The almost block diagonal system of the nodes, bordered by scalar unknowns and by rows that touch every node.
//!
//! Unknowns are δy_0 … δy_N (n each) and δp. Elimination walks from left to right: the rows that still involve only δy_i
//! (first the left conditions) join the n rows −G_i δy_i + δy_{i+1} − B_i δp = c_i, partial pivoting removes δy_i, and
//! what remains is carried to the next interval. Because [carried; −G_i] always has full column rank, a singular system
//! (a fold, a pitchfork) shows only in the last small block, whose determinant is therefore a test function.
//!
//! # References
//! Ascher, Mattheij & Russell 1995, ch. 7 (stability of block elimination with row pivoting for separated conditions).

use super::condense::Condensed;
use super::dense::{self, Determinant, LANE, Lane, PivotFailure};

/// Rows at one end: `rows` conditions with derivatives by y (× n) and by p (× scalars), row-major.
#[derive(Clone, Copy, Debug)]
pub struct EndRows<'a> {
    /// ∂r/∂y.
    pub ry: &'a [f64],
    /// ∂r/∂p.
    pub rp: &'a [f64],
    /// Number of conditions.
    pub rows: usize,
}

/// A dense linear form on all nodes and scalars: Σ w_i·y_i + w_p·p.
#[derive(Clone, Copy, Debug)]
pub struct LinearForm<'a> {
    /// Weights of the node values; (N + 1) × n.
    pub nodes: &'a [f64],
    /// Weights of the scalar unknowns.
    pub scalars: &'a [f64],
}

/// Factors of the bordered almost block diagonal matrix.
#[derive(Clone, Debug, Default)]
pub struct BlockFactor {
    n: usize,
    np: usize,
    nl: usize,
    nr: usize,
    nb: usize,
    lanes: usize,
    final_lanes: usize,
    panels: Vec<Lane>,
    permutation: Vec<u8>,
    final_block: Vec<Lane>,
    final_permutation: Vec<u8>,
    forward: Vec<f64>,
}

impl BlockFactor {
    fn rows(&self) -> usize {
        self.nl + self.n + self.nb
    }

    /// Factorises with the first `scalars` scalar unknowns (0 leaves them out), the given end rows, the integral rows of
    /// the condensed system if `integrals` and further linear rows.
    ///
    /// `offsets` are the derivatives ∂h/∂p of the integral conditions (integrals × scalars).
    pub fn factor(
        &mut self,
        condensed: &Condensed,
        scalars: usize,
        left: EndRows<'_>,
        right: EndRows<'_>,
        integrals: bool,
        offsets: &[f64],
        forms: &[LinearForm<'_>],
    ) -> Result<(), PivotFailure> {
        let dims = condensed.layout.dims;
        let intervals = condensed.intervals();
        let n = dims.components;
        let ni = if integrals { dims.integrals } else { 0 };
        let np = scalars;
        let stride = dims.scalars;
        let nb = ni + forms.len();
        let lanes = dense::lanes_for(2 * n + np);
        let nf = n + np;
        *self = BlockFactor {
            n,
            np,
            nl: left.rows,
            nr: right.rows,
            nb,
            lanes,
            final_lanes: dense::lanes_for(nf),
            panels: std::mem::take(&mut self.panels),
            permutation: std::mem::take(&mut self.permutation),
            final_block: std::mem::take(&mut self.final_block),
            final_permutation: std::mem::take(&mut self.final_permutation),
            forward: std::mem::take(&mut self.forward),
        };
        assert_eq!(left.rows + right.rows + nb, nf, "as many conditions as unknowns");
        let rows = self.rows();
        let size = rows * lanes;
        self.panels.resize(intervals * size, [0.0; LANE]);
        self.permutation.resize(intervals * n, 0);
        self.forward.resize(intervals * n + nf, 0.0);
        self.panels.fill([0.0; LANE]);
        let put_ends = |row: &mut [f64], rows_at: &EndRows<'_>, k: usize, p_at: usize| {
            row[..n].copy_from_slice(&rows_at.ry[k * n..(k + 1) * n]);
            if np > 0 {
                row[p_at..p_at + np].copy_from_slice(&rows_at.rp[k * stride..k * stride + np]);
            }
        };
        for k in 0..left.rows {
            put_ends(self.panels[k * lanes..(k + 1) * lanes].as_flattened_mut(), &left, k, 2 * n);
        }
        for k in 0..nb {
            let at = (left.rows + n + k) * lanes;
            let row = self.panels[at..at + lanes].as_flattened_mut();
            let p = &mut row[2 * n..2 * n + np];
            if k < ni {
                p.copy_from_slice(&offsets[k * stride..k * stride + np]);
            } else {
                p.copy_from_slice(&forms[k - ni].scalars[..np]);
            }
        }
        for i in 0..intervals {
            let (done, rest) = self.panels.split_at_mut((i + 1) * size);
            let panel = &mut done[i * size..];
            let ml = condensed.layout.map_lanes;
            let transition = condensed.transition(i);
            for k in 0..n {
                let at = (left.rows + k) * lanes;
                let row = panel[at..at + lanes].as_flattened_mut();
                let source = transition[k * ml..(k + 1) * ml].as_flattened();
                for c in 0..n {
                    row[c] = -source[c];
                }
                row[n + k] = 1.0;
                for q in 0..np {
                    row[2 * n + q] = -source[n + q];
                }
            }
            for k in 0..nb {
                let at = (left.rows + n + k) * lanes;
                let row = panel[at..at + lanes].as_flattened_mut();
                if k < ni {
                    let source = condensed.integral(i)[k * ml..(k + 1) * ml].as_flattened();
                    for c in 0..n {
                        row[c] += source[c];
                    }
                    for q in 0..np {
                        row[2 * n + q] += source[n + q];
                    }
                } else {
                    for c in 0..n {
                        row[c] += forms[k - ni].nodes[i * n + c];
                    }
                }
            }
            dense::eliminate(panel, lanes, n, left.rows + n, &mut self.permutation[i * n..(i + 1) * n])?;
            if i + 1 < intervals {
                // Rows n.. of this panel become rows 0..nl and nl+n.. of the next.
                for k in 0..left.rows + nb {
                    let source = panel[(n + k) * lanes..(n + k + 1) * lanes].as_flattened();
                    let to = if k < left.rows { k } else { k + n };
                    let target = rest[to * lanes..(to + 1) * lanes].as_flattened_mut();
                    target[..n].copy_from_slice(&source[n..2 * n]);
                    target[2 * n..2 * n + np].copy_from_slice(&source[2 * n..2 * n + np]);
                }
            }
        }
        let fl = self.final_lanes;
        self.final_block.clear();
        self.final_block.resize(nf * fl, [0.0; LANE]);
        self.final_permutation.resize(nf, 0);
        let last = &self.panels[(intervals - 1) * size..];
        for k in 0..left.rows + nb {
            let source = last[(n + k) * lanes..(n + k + 1) * lanes].as_flattened();
            let to = if k < left.rows { k } else { k + right.rows };
            let target = self.final_block[to * fl..(to + 1) * fl].as_flattened_mut();
            target[..nf].copy_from_slice(&source[n..n + nf]);
            if k >= left.rows + ni {
                let form = &forms[k - left.rows - ni];
                for c in 0..n {
                    target[c] += form.nodes[intervals * n + c];
                }
            }
        }
        for k in 0..right.rows {
            let to = left.rows + k;
            put_ends(self.final_block[to * fl..(to + 1) * fl].as_flattened_mut(), &right, k, n);
        }
        dense::eliminate(&mut self.final_block, fl, nf, nf, &mut self.final_permutation)
    }

    /// Solves for node updates (`nodes`, holding on entry c_i of interval i at index i·n, length (N + 1)·n) and scalar
    /// updates. `left`, `right` and `border` are right-hand sides of the condition rows (integrals first in `border`).
    pub fn solve(&mut self, nodes: &mut [f64], left: &[f64], right: &[f64], border: &[f64], scalars: &mut [f64]) {
        let (n, np, nl, nb) = (self.n, self.np, self.nl, self.nb);
        let intervals = self.permutation.len() / n;
        let size = self.rows() * self.lanes;
        let nf = n + np;
        let mut x = [0.0; 64];
        x[..nl].copy_from_slice(left);
        x[nl + n..nl + n + nb].copy_from_slice(border);
        for i in 0..intervals {
            let panel = &self.panels[i * size..(i + 1) * size];
            x[nl..nl + n].copy_from_slice(&nodes[i * n..(i + 1) * n]);
            dense::forward_vector(
                panel,
                self.lanes,
                n,
                nl + n + nb,
                &self.permutation[i * n..(i + 1) * n],
                &mut x[..nl + n + nb],
            );
            self.forward[i * n..(i + 1) * n].copy_from_slice(&x[..n]);
            // Carried rows move to the front; border rows stay behind the next n.
            for k in 0..nl {
                x[k] = x[n + k];
            }
        }
        let mut y = [0.0; 64];
        y[..nl].copy_from_slice(&x[..nl]);
        y[nl..nl + self.nr].copy_from_slice(right);
        y[nl + self.nr..nf].copy_from_slice(&x[nl + n..nl + n + nb]);
        dense::solve_vector(&self.final_block, self.final_lanes, nf, &self.final_permutation, &mut y[..nf]);
        nodes[intervals * n..].copy_from_slice(&y[..n]);
        scalars[..np].copy_from_slice(&y[n..nf]);
        for i in (0..intervals).rev() {
            let panel = &self.panels[i * size..(i + 1) * size];
            let (before, after) = nodes.split_at_mut((i + 1) * n);
            let (here, next) = (&mut before[i * n..], &after[..n]);
            for k in (0..n).rev() {
                let row = panel[k * self.lanes..(k + 1) * self.lanes].as_flattened();
                let mut sum = self.forward[i * n + k];
                for c in k + 1..n {
                    sum -= row[c] * here[c];
                }
                for c in 0..n {
                    sum -= row[n + c] * next[c];
                }
                for q in 0..np {
                    sum -= row[2 * n + q] * scalars[q];
                }
                here[k] = sum / row[k];
            }
        }
    }

    /// Multiplies the determinant of the factorised matrix into `det`.
    pub fn accumulate_determinant(&self, det: &mut Determinant) {
        let n = self.n;
        let size = self.rows() * self.lanes;
        for (i, panel) in self.panels.chunks_exact(size).enumerate() {
            dense::accumulate_determinant(panel, self.lanes, n, &self.permutation[i * n..(i + 1) * n], det);
        }
        dense::accumulate_determinant(
            &self.final_block,
            self.final_lanes,
            self.n + self.np,
            &self.final_permutation,
            det,
        );
        // Moving the right rows ahead of the border rows is a fixed permutation; its sign is left out.
    }
}
