//! A board in the computer in place of one on a wire, for trying things out: `--port emulator`.

use super::Port;
use crate::emulator::{Board, BoardSettings};
use std::collections::VecDeque;
use std::io;
use std::time::{Duration, Instant};

/// An emulated board on the real clock.
pub(super) struct Emulated {
    board: Board,
    began: Instant,
    /// Bytes from the board that nobody has read yet.
    waiting: VecDeque<u8>,
    /// Longest wait of a read.
    read_wait: Duration,
}

impl Emulated {
    /// Opens a board as it leaves the shop: it boots, and greets after the boot loader's wait.
    pub fn new(read_wait: Duration) -> Emulated {
        Emulated {
            board: Board::new(BoardSettings::default()),
            began: Instant::now(),
            waiting: VecDeque::new(),
            read_wait,
        }
    }

    fn step(&mut self, bytes: &[u8]) {
        let now_s = self.began.elapsed().as_secs_f64();
        self.waiting.extend(self.board.step(now_s, bytes));
        // Nobody asks this board what it burnt.
        self.board.take_trace();
    }
}

impl Port for Emulated {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.step(&[]);
        if self.waiting.is_empty() {
            std::thread::sleep(self.read_wait);
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
