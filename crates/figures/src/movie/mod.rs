//! A division as a moving picture.
