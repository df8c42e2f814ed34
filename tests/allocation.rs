//! What a solve allocates: all it needs before and in its first Newton step, nothing afterwards.
//!
//! A test program of its own, with a single test: it counts every allocation of the process.

use furbelow::geom::P2;
use furbelow::progress::{Observer, Progress};
use furbelow::ruffle::uniform_stack;
use furbelow::sim::{Material, Outcome, Settings, Solver, Supports};
use std::alloc::{GlobalAlloc, Layout, System};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is passed on unchanged to the system's allocator; counting does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        unsafe { System.realloc(at, layout, size) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Allocations so far at each step.
struct Steps(Vec<usize>);

impl Observer for Steps {
    fn step(&mut self, _: Progress) -> ControlFlow<()> {
        self.0.push(ALLOCATIONS.load(Ordering::Relaxed));
        ControlFlow::Continue(())
    }
}

const PAPER_160: Material = Material {
    flexural_rigidity_n_mm: 2.1,
    membrane_stiffness_n_per_mm: 600.0,
    grammage_g_per_m2: 160.0,
    thickness_mm: 0.19,
};

/// Allocations in each step but the first.
fn later_steps(solver: &mut Solver, positions: &mut Vec<P2>) -> Vec<usize> {
    let mut steps = Steps(Vec::with_capacity(1000));
    let e = solver.solve(positions, &mut steps).unwrap();
    assert_eq!(e.outcome, Outcome::Converged);
    *positions = e.positions;
    let counts = steps.0.windows(2).map(|w| w[1] - w[0]);
    counts.skip(1).collect()
}

#[test]
fn newton_steps_after_the_first_allocate_nothing() {
    let drawn = uniform_stack(2, 30.0, 52.8, 5.0);
    let supports = Supports { pinned: Vec::new(), upright: vec![drawn.ruffle.foot[0]] };
    let widths = vec![80.0; drawn.ruffle.node_count];
    let mut solver = Solver::new(&drawn.ruffle, &widths, &PAPER_160, &supports, &Settings::default()).unwrap();
    let mut positions = drawn.positions;

    // While the stack first folds up and comes under the plate, the lists of what is near what may grow, and sheets that meet need room in the system.
    let cold = later_steps(&mut solver, &mut positions);
    solver.press(Some(1.0)).unwrap();
    let pressed = later_steps(&mut solver, &mut positions);
    let grown = cold.iter().chain(&pressed).filter(|count| **count > 0).count();
    assert!(cold.len() > 10 && grown <= 4, "{cold:?}, {pressed:?}");

    for load_n in [1.1, 1.0, 0.9, 1.0] {
        solver.press(Some(load_n)).unwrap();
        let warm = later_steps(&mut solver, &mut positions);
        assert!(!warm.is_empty() && warm.iter().all(|count| *count == 0), "{load_n} N: {warm:?}");
    }
}
