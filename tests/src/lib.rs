//! Home of the tests that cross crates; they live in `tests/`.
