//! A block-tridiagonal matrix with bordering rows and columns, and its factorisation.
//!
//! Splines of degree 4 couple to four neighbours on each side, so blocks of four splines are coupled only to the neighbouring
//! blocks. Pivoting is restricted to a block. The first border is the pressure with the condition on the volume; a branch
//! adds its parameter with the condition on its amplitude.

use std::ops::Range;

use faer::linalg::solvers::{PartialPivLu, Solve};
use faer::{Mat, MatMut, MatRef};

/// The matrix.
#[derive(Clone, Debug)]
pub struct Bordered {
    blocks: Vec<Range<usize>>,
    /// Block of each unknown.
    block_of: Vec<usize>,
    diagonal: Vec<Mat<f64>>,
    /// Block (k + 1, k).
    lower: Vec<Mat<f64>>,
    /// Block (k, k + 1).
    upper: Vec<Mat<f64>>,
    /// The borders, the pressure first. Entries in the row of one border and the column of another are 0.
    pub borders: Vec<Border>,
}

/// A bordering column and row.
#[derive(Clone, Debug)]
pub struct Border {
    /// The coefficients of the border's unknown.
    pub column: Vec<f64>,
    /// The border's equation.
    pub row: Vec<f64>,
}

/// The matrix is singular, or its entries are not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the linear equations are singular")]
pub struct Singular;

impl Bordered {
    /// A matrix of zeros, with one border.
    pub fn zeros(blocks: &[Range<usize>]) -> Bordered {
        let size = blocks.last().map_or(0, |block| block.end);
        let square = |rows: &Range<usize>, columns: &Range<usize>| Mat::zeros(rows.len(), columns.len());
        let block_of = blocks.iter().enumerate().flat_map(|(k, block)| block.clone().map(move |_| k)).collect();
        Bordered {
            block_of,
            diagonal: blocks.iter().map(|block| square(block, block)).collect(),
            lower: blocks.windows(2).map(|pair| square(&pair[1], &pair[0])).collect(),
            upper: blocks.windows(2).map(|pair| square(&pair[0], &pair[1])).collect(),
            blocks: blocks.to_vec(),
            borders: vec![Border { column: vec![0.0; size], row: vec![0.0; size] }],
        }
    }

    /// Number of unknowns without the borders.
    pub fn size(&self) -> usize {
        self.block_of.len()
    }

    /// Adds to an entry.
    #[inline]
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        let (i, j) = (self.block_of[row], self.block_of[column]);
        let part = match (i, j) {
            _ if i == j => &mut self.diagonal[i],
            _ if i > j => &mut self.lower[j],
            _ => &mut self.upper[i],
        };
        part[(row - self.blocks[i].start, column - self.blocks[j].start)] += value;
    }

    /// The matrix without its borders times a vector.
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.size()];
        let mut add = |part: MatRef<'_, f64>, rows: &Range<usize>, columns: &Range<usize>| {
            for (j, x) in x[columns.clone()].iter().enumerate() {
                for (i, out) in out[rows.clone()].iter_mut().enumerate() {
                    *out += part[(i, j)] * x;
                }
            }
        };
        for k in 0..self.blocks.len() {
            add(self.diagonal[k].as_ref(), &self.blocks[k], &self.blocks[k]);
            if k + 1 < self.blocks.len() {
                add(self.lower[k].as_ref(), &self.blocks[k + 1], &self.blocks[k]);
                add(self.upper[k].as_ref(), &self.blocks[k], &self.blocks[k + 1]);
            }
        }
        out
    }

    /// An entry, 0 outside the blocks.
    pub fn entry(&self, row: usize, column: usize) -> f64 {
        let (i, j) = (self.block_of[row], self.block_of[column]);
        let at = (row - self.blocks[i].start, column - self.blocks[j].start);
        match i.abs_diff(j) {
            0 => self.diagonal[i][at],
            1 if i > j => self.lower[j][at],
            1 => self.upper[i][at],
            _ => 0.0,
        }
    }

    /// Factorises the matrix, which is consumed.
    ///
    /// # Errors
    /// [`Singular`].
    pub fn factor(mut self) -> Result<Factored, Singular> {
        let mut factors: Vec<PartialPivLu<f64>> = Vec::with_capacity(self.blocks.len());
        for k in 0..self.blocks.len() {
            if let Some(before) = factors.last() {
                // The Schur complement D_k − L_{k−1} D_{k−1}⁻¹ U_{k−1}.
                before.solve_in_place(self.upper[k - 1].as_mut());
                let (lower, upper) = (self.lower[k - 1].as_ref(), self.upper[k - 1].as_ref());
                faer::linalg::matmul::matmul(
                    self.diagonal[k].as_mut(),
                    faer::Accum::Add,
                    lower,
                    upper,
                    -1.0,
                    faer::Par::Seq,
                );
            }
            factors.push(self.diagonal[k].partial_piv_lu());
        }
        let Bordered { blocks, lower, upper, borders, .. } = self;
        let inner = Inner { blocks, factors, lower, upper };
        let solved = |Border { mut column, row }| {
            inner.solve(&mut column);
            Border { column, row }
        };
        let borders: Vec<Border> = borders.into_iter().map(solved).collect();
        let schur = Mat::from_fn(borders.len(), borders.len(), |i, j| dot(&borders[i].row, &borders[j].column));
        let volume = schur.determinant();
        if !volume.is_finite() || volume == 0.0 {
            return Err(Singular);
        }
        Ok(Factored { inner, borders, schur: schur.partial_piv_lu() })
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The factorised blocks.
#[derive(Clone, Debug)]
struct Inner {
    blocks: Vec<Range<usize>>,
    factors: Vec<PartialPivLu<f64>>,
    lower: Vec<Mat<f64>>,
    /// D_k⁻¹ U_k.
    upper: Vec<Mat<f64>>,
}

/// A factorised [`Bordered`].
#[derive(Clone, Debug)]
pub struct Factored {
    inner: Inner,
    /// Rows, and the solutions for the columns.
    borders: Vec<Border>,
    schur: PartialPivLu<f64>,
}

impl Inner {
    fn solve(&self, x: &mut [f64]) {
        let column = |x: &[f64]| Mat::from_fn(x.len(), 1, |i, _| x[i]);
        let subtract = |from: &mut [f64], matrix: MatRef<'_, f64>, by: &[f64]| {
            let mut change = Mat::zeros(from.len(), 1);
            let (to, by): (MatMut<'_, f64>, Mat<f64>) = (change.as_mut(), column(by));
            faer::linalg::matmul::matmul(to, faer::Accum::Replace, matrix, by.as_ref(), 1.0, faer::Par::Seq);
            from.iter_mut().enumerate().for_each(|(i, from)| *from -= change[(i, 0)]);
        };
        let mut before: Option<Range<usize>> = None;
        for (k, block) in self.blocks.iter().enumerate() {
            if let Some(before) = before {
                let (above, here) = x.split_at_mut(block.start);
                subtract(&mut here[..block.len()], self.lower[k - 1].as_ref(), &above[before]);
            }
            let mut solved = column(&x[block.clone()]);
            self.factors[k].solve_in_place(solved.as_mut());
            x[block.clone()].iter_mut().enumerate().for_each(|(i, x)| *x = solved[(i, 0)]);
            before = Some(block.clone());
        }
        for k in (0..self.upper.len()).rev() {
            let (block, next) = (self.blocks[k].clone(), self.blocks[k + 1].clone());
            let (here, below) = x.split_at_mut(next.start);
            subtract(&mut here[block], self.upper[k].as_ref(), &below[..next.len()]);
        }
    }
}

impl Factored {
    /// Solves for a right-hand side and the values of the borders' rows; returns the borders' unknowns.
    pub fn solve(&self, x: &mut [f64], rows: &[f64]) -> Vec<f64> {
        self.inner.solve(x);
        let mut found = Mat::from_fn(rows.len(), 1, |i, _| dot(&self.borders[i].row, x) - rows[i]);
        self.schur.solve_in_place(found.as_mut());
        for (j, border) in self.borders.iter().enumerate() {
            x.iter_mut().zip(&border.column).for_each(|(x, column)| *x -= found[(j, 0)] * column);
        }
        (0..rows.len()).map(|j| found[(j, 0)]).collect()
    }
}
