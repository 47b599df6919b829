//! Tests of springs that come from files and editors; see `tests/`. A package of its own, so that who tests the crate
//! alone need not build what reads them.
