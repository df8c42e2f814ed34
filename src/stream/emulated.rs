//! A board in the computer in place of one on a wire, for trying things out: `--port emulator`.

use super::Port;
use crate::emulator::{Board, BoardSettings};
use std::collections::VecDeque;
use std::io;
use std::time::{Duration, Instant};

/// Shorter naps are not worth the calls, s.
const LEAST_NAP_S: f64 = 1e-4;

/// An emulated board on the real clock, or on one that runs faster.
pub(super) struct Emulated {
    board: Board,
    began: Instant,
    /// Seconds of the board's in one of ours.
    speed: f64,
    /// Bytes from the board that nobody has read yet.
    waiting: VecDeque<u8>,
    /// Longest wait of a read.
    read_wait: Duration,
}

impl Emulated {
    /// Opens a board as it leaves the shop: it boots, and greets after the boot loader's wait.
    pub fn new(read_wait: Duration, speed: u32) -> Emulated {
        Emulated {
            board: Board::new(BoardSettings::default()),
            began: Instant::now(),
            speed: f64::from(speed),
            waiting: VecDeque::new(),
            read_wait,
        }
    }

    fn now_s(&self) -> f64 {
        self.began.elapsed().as_secs_f64() * self.speed
    }

    fn step(&mut self, bytes: &[u8]) {
        self.waiting.extend(self.board.step(self.now_s(), bytes));
        // Nobody asks this board what it burnt.
        self.board.take_trace();
    }
}

impl Port for Emulated {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.step(&[]);
        let mut left = self.read_wait;
        while self.waiting.is_empty() && !left.is_zero() {
            // No longer than until the board does something: on a fast clock it would wait for us meanwhile.
            let due_s = self.board.next_s().map_or(f64::INFINITY, |next_s| (next_s - self.now_s()) / self.speed);
            let nap = left.min(Duration::from_secs_f64(due_s.clamp(LEAST_NAP_S, 1.0)));
            std::thread::sleep(nap);
            left -= nap;
            self.step(&[]);
        }
        let n = buffer.len().min(self.waiting.len());
        for (to, from) in buffer.iter_mut().zip(self.waiting.drain(..n)) {
            *to = from;
        }
        Ok(n)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.step(bytes);
        Ok(())
    }
}
