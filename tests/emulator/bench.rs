//! A board on the bench with someone typing at it, and a host that counts characters.

use std::collections::VecDeque;

use furbelow::emulator::{Board, BoardSettings, Settings};

/// A board, the time, and what it has said that is not read yet.
pub struct Bench {
    pub board: Board,
    pub now_s: f64,
    heard: String,
}

/// The measured board with some settings changed.
pub fn with(changes: &[(u16, f64)]) -> BoardSettings {
    let settings = changes.iter().fold(Settings::default(), |s, (n, value)| s.with(*n, *value));
    BoardSettings { settings, ..BoardSettings::default() }
}

impl Bench {
    /// A board that has just booted; its greeting is still to be read.
    pub fn booted(settings: BoardSettings) -> Bench {
        let mut bench = Bench { board: Board::new(settings), now_s: 0.0, heard: String::new() };
        bench.wait(2.0);
        bench
    }

    /// A booted board whose greeting has been read.
    pub fn ready(changes: &[(u16, f64)]) -> Bench {
        let mut bench = Bench::booted(with(changes));
        bench.lines();
        bench
    }

    pub fn send(&mut self, bytes: &[u8]) {
        let out = self.board.step(self.now_s, bytes);
        self.heard.push_str(&String::from_utf8_lossy(&out));
    }

    pub fn wait(&mut self, seconds: f64) {
        self.now_s += seconds;
        self.send(&[]);
    }

    /// What has been said since last read.
    pub fn lines(&mut self) -> Vec<String> {
        let heard = std::mem::take(&mut self.heard);
        heard.split_terminator("\r\n").map(str::to_owned).collect()
    }

    /// Sends bytes, waits a quarter of a second, reads.
    pub fn ask(&mut self, bytes: &[u8]) -> Vec<String> {
        self.send(bytes);
        self.wait(0.25);
        self.lines()
    }

    /// Sends a line and expects only `ok`.
    pub fn ok(&mut self, line: &str) {
        assert_eq!(self.ask(format!("{line}\n").as_bytes()), ["ok"], "{line}");
    }

    /// A status report's fields.
    pub fn status(&mut self) -> Vec<String> {
        let lines = self.ask(b"?");
        let [line] = &lines[..] else { panic!("{lines:?}") };
        line.trim_matches(['<', '>']).split('|').map(str::to_owned).collect()
    }

    /// Its state as reported.
    pub fn state(&mut self) -> String {
        self.status()[0].clone()
    }

    /// Sends lines, never more than 128 bytes ahead of the answers, answering at once; returns all the answers.
    pub fn stream(&mut self, lines: &[&str]) -> Vec<String> {
        let mut under_way: VecDeque<usize> = VecDeque::new();
        let (mut next, mut answers) = (0, Vec::new());
        while answers.len() < lines.len() {
            let mut bytes = Vec::new();
            while next < lines.len() && under_way.iter().sum::<usize>() + lines[next].len() < 128 {
                bytes.extend_from_slice(lines[next].as_bytes());
                bytes.push(b'\n');
                under_way.push_back(lines[next].len() + 1);
                next += 1;
            }
            self.send(&bytes);
            self.now_s = self.board.next_s().expect("something happens while a line is unanswered");
            self.send(&[]);
            let whole = self.heard.rfind('\n').map_or(0, |end| end + 1);
            let rest = self.heard.split_off(whole);
            for line in self.lines() {
                if line == "ok" || line.starts_with("error:") {
                    under_way.pop_front();
                    answers.push(line);
                }
            }
            self.heard = rest;
        }
        answers
    }

    /// Waits until the head rests.
    pub fn settle(&mut self) {
        self.wait(0.01);
        while self.board.is_moving() {
            self.now_s = self.board.next_s().expect("a moving head stops").max(self.now_s);
            self.wait(1e-6);
        }
    }
}
