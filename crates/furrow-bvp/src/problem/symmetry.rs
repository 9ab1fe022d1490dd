//! Problems on the half of a mirror-symmetric domain.

/// A problem on the left half of a mirror-symmetric domain; its right end is the mirror.
pub trait MirrorSymmetric {
    /// Components that vanish at the mirror in antisymmetric perturbations: as many as make these, with the left
    /// conditions, a square problem.
    fn vanishing_at_mirror(&self) -> &[usize];

    /// Components that are free at the mirror in antisymmetric perturbations, the preferred one for normalising first.
    fn free_at_mirror(&self) -> &[usize];
}
