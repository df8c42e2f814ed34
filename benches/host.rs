//! What the host costs: `cargo bench --bench host -- --json`.
//!
//! * `session`: time inside the session for each line of a job on the emulated board, clock and port left out.
//! * `link`: from a line's answer to the next line, over a pseudo-terminal to a board that answers at once and takes one line at a time; the
//!   answering thread and the way through the terminal and back are in it.
//! * `counting`, `send-response`: 2000 segments of 0.2 mm at F3000 on the emulated board, whose controller takes 3.7 ms a line: feed reached, and its
//!   share of the feed asked for. `send-response` waits for each answer before the next line, with a host that takes a millisecond.

use std::time::{Duration, Instant};

use furbelow::emulator::{Board, BoardSettings};
use furbelow::stream::{Action, Command, Event, Outcome, Session, Settings};
use serde::Serialize;

/// Feed asked for, mm/min, and length of a segment, mm.
const FEED: f64 = 3000.0;
const SEGMENT_MM: f64 = 0.2;
const SEGMENTS: usize = 2000;

/// How often the session is told the time, and the time a host takes to answer, s.
const TICK_S: f64 = 0.001;

#[derive(Serialize)]
struct Row {
    name: &'static str,
    lines: usize,
    /// Host's time for each line, ms; none where it is not measured.
    ms_per_line: Option<f64>,
    feed_mm_per_min: Option<f64>,
    feed_share: Option<f64>,
}

fn main() {
    let json = std::env::args().any(|a| a == "--json");
    let (session, counting) = counting();
    let mut rows = vec![session];
    #[cfg(unix)]
    rows.push(link::row());
    rows.extend([counting, send_response()]);
    for row in rows {
        if json {
            println!("{}", serde_json::to_string(&row).expect("a row holds nothing JSON cannot"));
            continue;
        }
        let time = row.ms_per_line.map_or(String::new(), |ms| format!(", {ms:.4} ms a line"));
        let feed = row.feed_mm_per_min.zip(row.feed_share);
        let feed = feed.map_or(String::new(), |(feed, share)| format!(", {feed:.0} mm/min: {:.1} %", 100.0 * share));
        println!("{}: {} lines{time}{feed}", row.name, row.lines);
    }
}

/// A circle of 50 mm radius in short segments.
fn circle() -> Vec<String> {
    let at = |k: usize| SEGMENT_MM * k as f64 / 50.0;
    let mut lines = vec!["M4S500".to_owned(), "G0X50Y0".into(), format!("G1F{FEED}")];
    lines.extend((1..=SEGMENTS).map(|k| format!("X{:.3}Y{:.3}", 50.0 * at(k).cos(), 50.0 * at(k).sin())));
    lines
}

/// Feed reached in the lit stretches of what a board has done.
fn reached(name: &'static str, lines: usize, board: &Board) -> Row {
    let lit_s: f64 = board.trace().iter().filter(|s| s.is_lit()).map(|s| s.end_s - s.start_s).sum();
    let feed = SEGMENTS as f64 * SEGMENT_MM * 60.0 / lit_s;
    Row { name, lines, ms_per_line: None, feed_mm_per_min: Some(feed), feed_share: Some(feed / FEED) }
}

fn counting() -> (Row, Row) {
    let mut board = Board::new(BoardSettings::default());
    let mut session = Session::new(Duration::ZERO, Settings::default());
    let (mut now_s, mut inside, mut started, mut ended) = (0.0, Duration::ZERO, false, false);
    let mut to_board = Vec::new();
    let lines = circle().len();
    let mut status = false;
    while !ended {
        now_s += TICK_S;
        let answer = board.step(now_s, &std::mem::take(&mut to_board));
        let now = Duration::from_secs_f64(now_s);
        let began = Instant::now();
        let mut actions = if answer.is_empty() { Vec::new() } else { session.on_bytes(now, &answer) };
        actions.extend(session.on_tick(now));
        if started {
            inside += began.elapsed();
        } else if session.is_ready() && status {
            started = true;
            let lines = Box::new(circle().into_iter().map(Ok));
            actions.extend(session.command(now, Command::Run { lines }));
        }
        for action in actions {
            match action {
                Action::Write(bytes) => to_board.extend(bytes),
                Action::Event(Event::Ended(ending)) => {
                    assert_eq!(ending.outcome, Outcome::Done);
                    ended = true;
                }
                Action::Event(Event::Status(..)) => status = true,
                Action::Event(_) => {}
            }
        }
    }
    let ms_per_line = Some(inside.as_secs_f64() * 1e3 / lines as f64);
    let session = Row { name: "session", lines, ms_per_line, feed_mm_per_min: None, feed_share: None };
    (session, reached("counting", lines, &board))
}

fn send_response() -> Row {
    let mut board = Board::new(BoardSettings::default());
    let mut now_s = 3.0;
    board.step(now_s, &[]);
    let lines = circle();
    for line in &lines {
        let mut answer = board.step(now_s, format!("{line}\n").as_bytes());
        while !answer.ends_with(b"\n") {
            now_s = board.next_s().expect("a line is answered");
            answer.extend(board.step(now_s, &[]));
        }
        now_s += TICK_S;
    }
    board.step(now_s + 10.0, &[]);
    reached("send-response", lines.len(), &board)
}

#[cfg(unix)]
mod link {
    use super::Row;
    use furbelow::stream::{Address, Command, Event, Link, Outcome, Settings};
    use serialport::{SerialPort, TTYPort};
    use std::io::{Read, Write};
    use std::time::{Duration, Instant};

    const LINES: usize = 2000;

    pub fn row() -> Row {
        let (mut master, slave) = TTYPort::pair().expect("a pseudo-terminal");
        let path = slave.name().expect("it has a name");
        master.set_timeout(Duration::from_secs(10)).expect("a terminal has a timeout");
        let board = std::thread::spawn(move || {
            // Held open so that the terminal stays while nobody else has it.
            let _slave = slave;
            answer(&mut master);
        });
        let port = Address::Device(path.into()).open(115_200).expect("the other end");
        let link = Link::start(port, Settings { banner_wait: Duration::ZERO, ..Settings::default() });
        let wait = |is: &dyn Fn(&Event) -> bool| loop {
            match link.next(Duration::from_secs(10)) {
                Some((_, event)) if is(&event) => return event,
                Some(_) => {}
                None => panic!("the board does not answer"),
            }
        };
        wait(&|e| matches!(e, Event::Ready(_)));
        wait(&|e| matches!(e, Event::Status(..)));
        // 70 characters: two such lines do not fit a buffer of 128 bytes.
        let lines = (0..LINES).map(|k| Ok(format!("G1X{k}.{}F1000", "0".repeat(60))));
        let began = Instant::now();
        link.command(Command::Run { lines: Box::new(lines) });
        let Event::Ended(ending) = wait(&|e| matches!(e, Event::Ended(_))) else { unreachable!("asked for") };
        let seconds = began.elapsed().as_secs_f64();
        assert_eq!(ending.outcome, Outcome::Done);
        drop(link);
        board.join().expect("the board has gone");
        let ms_per_line = Some(seconds * 1e3 / LINES as f64);
        Row { name: "link", lines: LINES, ms_per_line, feed_mm_per_min: None, feed_share: None }
    }

    /// Answers every line and every question at once, until nobody asks for a second.
    fn answer(master: &mut TTYPort) {
        let mut buffer = [0; 4096];
        master.set_timeout(Duration::from_secs(1)).expect("a terminal has a timeout");
        while let Ok(n) = master.read(&mut buffer) {
            let mut said = Vec::new();
            for byte in &buffer[..n] {
                match byte {
                    b'\n' => said.extend(b"ok\r\n"),
                    b'?' => said.extend(b"<Idle|Bf:15,128|FS:0,0>\r\n"),
                    _ => {}
                }
            }
            if master.write_all(&said).is_err() {
                return;
            }
        }
    }
}
