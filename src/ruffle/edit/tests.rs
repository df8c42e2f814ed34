//! Every edit on its own.

use super::*;
use crate::ruffle::uniform_stack;

#[test]
fn placeholder() {
    let d = uniform_stack(2, 30.0, 52.8, 3.0);
    let s = EditSettings { segment_mm: 3.0, limits: Limits::default() };
    let e = densify(&d, 1, &s).unwrap();
    assert!(e.ruffle.sections.len() == 9 + 6, "{}", e.ruffle.sections.len());
}
