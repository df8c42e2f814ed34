//! A job of a day: a session and a board need no more memory after 24 hours than after one.
//!
//! A test program of its own, with a single test: it counts what the whole process holds.

use furbelow::emulator::{Board, BoardSettings};
use furbelow::stream::{Action, Command, Event, Session, Settings};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

struct Counting;

static HELD: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is passed on unchanged to the system's allocator; counting does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        HELD.fetch_add(layout.size(), Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        HELD.fetch_add(size, Ordering::Relaxed);
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        unsafe { System.realloc(at, layout, size) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// How often the session is told the time, s: as seldom as it bears.
const TICK_S: f64 = 0.05;

const HOUR_S: f64 = 3600.0;

/// What may differ between two moments of the same job: tables grow to the next power of two, answers are on the wire. A table that grew by one
/// byte with every line would show as 100,000.
const BREATH_BYTES: usize = 4096;

/// Some 860 ms a line: there and back, with the power changing, so that each is new.
fn endless() -> impl Iterator<Item = std::io::Result<String>> + Send {
    let start = ["M4S500", "G0X0Y0", "G1F3000"].map(|line| Ok(line.to_owned()));
    let lines = (0_u64..)
        .map(|k| Ok(format!("X{:.1}Y{:.1}S{}", 38.0 * (k % 2) as f64, (k / 2 % 100) as f64 * 0.1, 100 + k % 800)));
    start.into_iter().chain(lines)
}

#[test]
fn a_day_of_cutting_needs_no_more_memory_than_an_hour() {
    let mut board = Board::new(BoardSettings::default());
    let settings = Settings { status_every: Duration::from_secs(1), ..Settings::default() };
    let mut session = Session::new(Duration::ZERO, settings);
    let (mut now_s, mut to_board, mut started, mut told) = (0.0, Vec::new(), false, false);
    let (mut held, mut acked) = (Vec::new(), 0);
    for hour in [1.0, 2.0, 24.0] {
        let mut most = 0;
        while now_s < hour * HOUR_S {
            now_s += TICK_S;
            let now = Duration::from_secs_f64(now_s);
            let answer = board.step(now_s, &std::mem::take(&mut to_board));
            // A user of the board takes what was burnt away now and then.
            board.take_trace();
            let mut actions = if answer.is_empty() { Vec::new() } else { session.on_bytes(now, &answer) };
            actions.extend(session.on_tick(now));
            if !started && told && session.is_ready() {
                started = true;
                actions.extend(session.command(now, Command::Run { lines: Box::new(endless()) }));
            }
            for action in actions {
                match action {
                    Action::Write(bytes) => to_board.extend(bytes),
                    Action::Event(Event::Status(_, progress)) => (told, acked) = (true, progress.acked),
                    Action::Event(Event::Ended(ending)) => panic!("it has no end: {ending:?}"),
                    Action::Event(_) => {}
                }
            }
            most = most.max(HELD.load(Ordering::Relaxed));
        }
        held.push(most);
    }
    println!("{acked} lines; at most {held:?} bytes held in the first, second and 24th hour");
    assert!(acked > 95_000, "{acked} lines");
    assert!(held[2] < held[0].max(held[1]) + BREATH_BYTES, "{held:?}");
}
