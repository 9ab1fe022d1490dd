//! Boundary-value problems by Gauss collocation.
