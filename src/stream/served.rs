//! An emulated board behind a pseudo-terminal: any sender on this computer can open it like a serial port.
//!
//! A pseudo-terminal has no DTR line, so that opening it is noticed by its other end being there: the board resets then, if it is one that does. Each
//! time the other end goes the board gets a new terminal, as one that is plugged in anew; a link keeps its name. What its sender had written
//! before it went still arrives.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags, fcntl_setfl, open};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use crate::emulator::{Board, BoardSettings, Segment};

/// How long the board is left to itself: bytes of 115,200 baud come every 0.09 ms, and what waits is no later than this.
const STEP: Timespec = Timespec { tv_sec: 0, tv_nsec: 1_000_000 };

/// How often a terminal that nobody has open is looked at.
const CLOSED_WAIT: Duration = Duration::from_millis(2);

/// Bytes taken at once.
const READ_BYTES: usize = 4096;

/// A board on the real clock, served until this is dropped.
pub struct ServedBoard {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

struct Shared {
    board: Mutex<Board>,
    began: Instant,
    /// Where the terminal is found, in a folder of its own.
    link: PathBuf,
    closing: AtomicBool,
}

/// The board's end of a terminal.
struct Terminal {
    master: File,
    /// Somebody has the other end.
    open: bool,
    /// Bytes from the board that the terminal has not taken yet.
    waiting: Vec<u8>,
}

impl ServedBoard {
    /// Serves a board, whose time 0 is now, and hands what it does to `seen`, in order.
    ///
    /// # Errors
    /// There are no pseudo-terminals, or no folder for temporary files.
    pub fn start(board: Board, seen: impl FnMut(Vec<Segment>) + Send + 'static) -> io::Result<ServedBoard> {
        let folder = tempfile::Builder::new().prefix("furbelow-board-").tempdir()?;
        let link = folder.path().join("tty");
        let terminal = Terminal::new(&link)?;
        let shared =
            Arc::new(Shared { board: Mutex::new(board), began: Instant::now(), link, closing: AtomicBool::new(false) });
        let serving = Arc::clone(&shared);
        let thread = std::thread::spawn(move || {
            serving.serve(terminal, seen);
            drop(folder);
        });
        Ok(ServedBoard { shared, thread: Some(thread) })
    }

    /// Serves the board of `--port emulator`.
    ///
    /// # Errors
    /// See [`ServedBoard::start`].
    pub fn emulator() -> io::Result<ServedBoard> {
        ServedBoard::start(Board::new(BoardSettings::default()), drop)
    }

    /// What a sender opens. It is missing while the board is unplugged.
    pub fn path(&self) -> &Path {
        &self.shared.link
    }

    /// Does something to the board, whose time, in s, comes with it.
    pub fn with<T>(&self, act: impl FnOnce(&mut Board, f64) -> T) -> T {
        act(&mut self.shared.board(), self.shared.now_s())
    }
}

impl Drop for ServedBoard {
    fn drop(&mut self) {
        self.shared.closing.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A panic on the thread has been printed where it happened.
            let _ = thread.join();
        }
    }
}

impl Shared {
    fn board(&self) -> MutexGuard<'_, Board> {
        self.board.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn now_s(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    fn serve(&self, first: Terminal, mut seen: impl FnMut(Vec<Segment>)) {
        let mut terminal = Some(first);
        while !self.closing.load(Ordering::Relaxed) {
            let mut board = self.board();
            let now_s = self.now_s();
            let mut said = board.step(now_s, &[]);
            if !board.is_plugged() {
                if terminal.take().is_some() {
                    // Nobody finds a device that is not there; when it is gone already, so much the better.
                    let _ = std::fs::remove_file(&self.link);
                }
            } else if let Some(at) = &mut terminal {
                let bytes = match at.take(&mut board, now_s) {
                    Ok(bytes) => bytes,
                    Err(_) => {
                        // The new one is made while the old one still has its name: nobody takes one for the other.
                        terminal = Terminal::new(&self.link).ok();
                        continue;
                    }
                };
                said.extend(board.step(now_s, &bytes));
                at.give(&said);
            } else {
                // Without a terminal for the moment there may be one later.
                terminal = Terminal::new(&self.link).ok();
            }
            seen(board.take_trace());
            drop(board);
            match &terminal {
                Some(at) if at.open => at.wait(),
                _ => std::thread::sleep(CLOSED_WAIT),
            }
        }
    }
}

impl Terminal {
    /// A new terminal, found at `link`.
    fn new(link: &Path) -> io::Result<Terminal> {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
        grantpt(&master)?;
        unlockpt(&master)?;
        let name = ptsname(&master, Vec::new())?;
        fcntl_setfl(&master, OFlags::NONBLOCK)?;
        // Without this the terminal would send every byte back and wait for whole lines. Closing the other end marks it as one nobody has.
        let other = open(&name, OFlags::RDWR | OFlags::NOCTTY, Mode::empty())?;
        let mut modes = tcgetattr(&other)?;
        modes.make_raw();
        tcsetattr(&other, OptionalActions::Now, &modes)?;
        drop(other);
        let fresh = link.with_extension("new");
        std::os::unix::fs::symlink(std::ffi::OsStr::from_bytes(name.to_bytes()), &fresh)?;
        std::fs::rename(&fresh, link)?;
        Ok(Terminal { master: File::from(master), open: false, waiting: Vec::new() })
    }

    /// What the sender has written; opens the board when the sender has just come.
    ///
    /// # Errors
    /// The sender has gone.
    fn take(&mut self, board: &mut Board, now_s: f64) -> io::Result<Vec<u8>> {
        let mut buffer = [0; READ_BYTES];
        let read = match self.master.read(&mut buffer) {
            // Linux says EIO, others say it is at its end.
            Ok(0) => Err(ErrorKind::BrokenPipe.into()),
            Err(e) if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => Ok(0),
            read => read,
        };
        let count = match read {
            Err(_) if !self.open => return Ok(Vec::new()),
            read => read?,
        };
        if !std::mem::replace(&mut self.open, true) {
            board.open(now_s);
        }
        Ok(buffer[..count].to_vec())
    }

    /// Passes on what the board says. With nobody there it is lost, as on a wire.
    fn give(&mut self, bytes: &[u8]) {
        if !self.open {
            return;
        }
        self.waiting.extend_from_slice(bytes);
        while !self.waiting.is_empty() {
            match self.master.write(&self.waiting) {
                Ok(n) if n > 0 => drop(self.waiting.drain(..n)),
                // A sender that does not read now may read later.
                _ => return,
            }
        }
    }

    fn wait(&self) {
        // Whatever it says, the terminal is looked at next.
        let _ = poll(&mut [PollFd::new(&self.master, PollFlags::IN)], Some(&STEP));
    }
}

#[cfg(test)]
mod tests {
    use super::super::Address;
    use super::*;
    use crate::emulator::{Fault, When};

    fn board() -> Board {
        Board::new(BoardSettings { boot_s: 0.02, ..BoardSettings::default() })
    }

    /// Reads until what has come ends so.
    fn hear(port: &mut dyn super::super::Port, end: &str) -> String {
        let (mut heard, mut buffer) = (Vec::new(), [0; 256]);
        let until = Instant::now() + Duration::from_secs(10);
        while Instant::now() < until {
            let n = port.read(&mut buffer).unwrap();
            heard.extend(&buffer[..n]);
            if heard.ends_with(end.as_bytes()) {
                return String::from_utf8(heard).unwrap();
            }
        }
        panic!("heard only {:?}", String::from_utf8_lossy(&heard));
    }

    #[test]
    fn whoever_opens_it_resets_it_and_what_was_written_last_arrives() {
        let served = ServedBoard::start(board(), drop).unwrap();
        let address = Address::Device(served.path().to_owned());
        let mut port = address.open(115_200).unwrap();
        assert_eq!(hear(&mut *port, "help]\r\n"), "\r\nGrbl 1.1h ['$' for help]\r\n");
        port.write(b"G91\n").unwrap();
        assert_eq!(hear(&mut *port, "ok\r\n"), "ok\r\n", "nothing is sent back but the answer");
        port.write(b"G1X2F600\n").unwrap();
        drop(port);
        let moved = |served: &ServedBoard| {
            (0..500).any(|_| {
                std::thread::sleep(Duration::from_millis(2));
                served.with(|board, _| board.position_mm().x > 1.0)
            })
        };
        assert!(moved(&served), "the line was written before the port was closed");
        let reopened = (0..200).find_map(|_| {
            std::thread::sleep(Duration::from_millis(5));
            address.open(115_200).ok()
        });
        assert_eq!(hear(&mut *reopened.unwrap(), "help]\r\n"), "\r\nGrbl 1.1h ['$' for help]\r\n");
        assert_eq!(served.with(|board, _| board.position_mm().x), 0.0);
    }

    #[test]
    fn an_unplugged_board_is_gone_and_comes_back_as_another_device() {
        let served = ServedBoard::start(board(), drop).unwrap();
        let first = served.path().canonicalize().unwrap();
        let mut port = Address::Device(first.clone()).open(115_200).unwrap();
        hear(&mut *port, "help]\r\n");
        served.with(|board, now_s| board.schedule(When::At(now_s), Fault::Unplug { powered: true }));
        let mut buffer = [0; 16];
        assert!((0..500).any(|_| port.read(&mut buffer).is_err()), "the sender notices");
        assert!(!served.path().exists());
        served.with(|board, now_s| board.schedule(When::At(now_s), Fault::Replug));
        let again = (0..500).find_map(|_| {
            std::thread::sleep(Duration::from_millis(2));
            served.path().canonicalize().ok()
        });
        assert_ne!(again.unwrap(), first, "the old one is still held open");
    }
}
