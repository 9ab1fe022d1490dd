//! The antisymmetric problem that belongs to a problem on a mirror-symmetric half.

use crate::dense::Determinant;
use crate::dimensions::Dimensions;
use crate::direction::{Direction, Residual};
use crate::invalid::{self, InvalidInput};
use crate::kernels::AntisymmetricEnd;

use super::system::{FactorisationError, Progress, System};

impl System {
    /// Conditions at the mirror that make the antisymmetric problem square.
    pub(super) fn antisymmetric_conditions(&self) -> usize {
        let Dimensions { components, left, .. } = self.dimensions();
        components.saturating_sub(left)
    }

    /// Factorises the antisymmetric problem that belongs to the factorised one on a mirror-symmetric half: the same
    /// intervals and left conditions, the components in `vanishing` zero at the mirror in place of the right conditions, and
    /// neither scalar unknowns nor integral conditions. The determinant includes the stages.
    ///
    /// # Errors
    /// [`FactorisationError`] for a pivot that is not finite, for components that do not make the problem square, and without
    /// factors of the symmetric problem. A pivot that is zero makes the determinant zero.
    pub fn factor_antisymmetric(
        &self,
        vanishing: &[usize],
        end: &mut AntisymmetricEnd,
    ) -> Result<Determinant, FactorisationError> {
        self.set_vanishing(vanishing, end)?;
        self.factor_antisymmetric_rows(end)
    }

    /// [`factor_antisymmetric`](Self::factor_antisymmetric) with the right end rows of `end`.
    pub(crate) fn factor_antisymmetric_rows(
        &self,
        end: &mut AntisymmetricEnd,
    ) -> Result<Determinant, FactorisationError> {
        self.require(Progress::Eliminated)?;
        match self.block.factor_antisymmetric(end) {
            Ok(()) => Ok(self.determinant_with(Some(end))),
            // Exactly singular in the last block.
            Err(failure) if !failure.non_finite => Ok(Determinant { sign: 0.0, log_abs: f64::NEG_INFINITY }),
            Err(failure) => Err(failure.into()),
        }
    }

    /// [`factor_antisymmetric`](Self::factor_antisymmetric) without the determinant, which takes a logarithm for every pivot.
    ///
    /// # Errors
    /// As [`factor_antisymmetric`](Self::factor_antisymmetric), and for a pivot that is zero.
    pub fn eliminate_antisymmetric(
        &self,
        vanishing: &[usize],
        end: &mut AntisymmetricEnd,
    ) -> Result<(), FactorisationError> {
        self.set_vanishing(vanishing, end)?;
        Ok(self.block.factor_antisymmetric(end)?)
    }

    /// The end rows of an antisymmetric problem that is square.
    fn set_vanishing(&self, vanishing: &[usize], end: &mut AntisymmetricEnd) -> Result<(), InvalidInput> {
        self.require(Progress::Eliminated)?;
        let Dimensions { components: n, left, .. } = self.dimensions();
        invalid::at_most("left conditions of the antisymmetric problem", left, n)?;
        invalid::length("components that vanish at the mirror", vanishing.len(), n - left)?;
        vanishing.iter().try_for_each(|&c| invalid::index("component", c, n))?;
        end.set_vanishing(vanishing, n);
        Ok(())
    }

    /// Adds J δ to `out`, J being the antisymmetric problem where the system was evaluated last with derivatives. After a
    /// correction with older factors that is the remaining residual.
    ///
    /// # Errors
    /// [`InvalidInput`] without derivatives, or for other sizes than the system has.
    pub fn apply_antisymmetric(
        &mut self,
        end: &AntisymmetricEnd,
        direction: &Direction,
        out: &mut Residual,
    ) -> Result<(), InvalidInput> {
        self.require_derivatives()?;
        let (n, m) = (self.dimensions().components, self.gauss.m);
        let intervals = self.condensed.intervals();
        invalid::length("stage values of the direction", direction.stages.len(), intervals * m * n)?;
        invalid::length("node values of the direction", direction.nodes.len(), (intervals + 1) * n)?;
        invalid::length("stage rows of the residual", out.stages.len(), intervals * m * n)?;
        invalid::length("node rows of the residual", out.nodes.len(), intervals * n)?;
        (self.kernels.apply)(&self.condensed, &self.gauss, direction, out);
        let (first, last) = (&direction.nodes[..n], &direction.nodes[direction.nodes.len() - n..]);
        for (rows, y, out) in [(&self.ends.left[0], first, &mut out.left), (&end.rows, last, &mut out.right)] {
            out.iter_mut().zip(rows.chunks_exact(n)).for_each(|(out, row)| *out += product(row, y));
        }
        Ok(())
    }

    /// Solves the antisymmetric problem factorised by [`factor_antisymmetric`](Self::factor_antisymmetric) for stage and
    /// node residuals and right-hand sides of its end rows.
    ///
    /// # Errors
    /// [`InvalidInput`] if there are no factors, or the residual has other sizes.
    pub fn solve_antisymmetric(
        &mut self,
        end: &AntisymmetricEnd,
        residual: &Residual,
        out: &mut Direction,
    ) -> Result<(), InvalidInput> {
        self.check_residual(Some(end), residual)?;
        self.solve_everywhere(Some(end), residual, out);
        Ok(())
    }

    /// The last node alone of [`solve_antisymmetric`](Self::solve_antisymmetric), in its place in `out`.
    ///
    /// # Errors
    /// As [`solve_antisymmetric`](Self::solve_antisymmetric).
    pub(crate) fn solve_antisymmetric_last_node(
        &mut self,
        end: &AntisymmetricEnd,
        residual: &Residual,
        out: &mut Direction,
    ) -> Result<(), InvalidInput> {
        self.check_residual(Some(end), residual)?;
        self.solve_nodes(Some(end), residual, out, false);
        Ok(())
    }

    /// The solution of the antisymmetric problem for right-hand sides that are zero but for `right` of its right end rows.
    ///
    /// # Errors
    /// As [`solve_antisymmetric`](Self::solve_antisymmetric).
    pub(crate) fn solve_antisymmetric_unit(
        &mut self,
        end: &AntisymmetricEnd,
        right: &[f64],
        out: &mut Direction,
    ) -> Result<(), InvalidInput> {
        self.require_factors(Some(end))?;
        invalid::length("right rows of the residual", right.len(), self.antisymmetric_conditions())?;
        self.solve_from_last(Some(end), [right, &[]], out);
        Ok(())
    }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
