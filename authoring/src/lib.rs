//! Tests of springs that come from files and editors; see `tests/`. They are a separate package, so that tests of the
//! crate alone do not build the file readers.
