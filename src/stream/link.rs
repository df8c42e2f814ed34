//! A session on a thread of its own, with a port and the clock.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{self, Receiver, Sender, TryRecvError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::event::{Action, Command, Ending, Event, Outcome};
use super::ledger::Progress;
use super::port::Port;
use super::realtime;
use super::session::{Session, Settings};
use super::trouble::Trouble;

/// Bytes taken at once.
const READ_BYTES: usize = 4096;

/// Between the hold and the reset of a sender that has failed: from 10,000 mm/min at 500 mm/s2 a machine stands after a third of a second.
const BRAKING: Duration = Duration::from_millis(400);

/// The user's end of a running session. When it is dropped, by a panic too, a job that still runs is stopped in order: hold, rest, reset. Whatever
/// ends the session by itself ends in [`Event::Ended`].
pub struct Link {
    commands: Option<Sender<Command>>,
    events: Receiver<(Duration, Event)>,
    thread: Option<JoinHandle<()>>,
}

impl Link {
    /// Starts a session on a port that was just opened.
    pub fn start(port: Box<dyn Port>, settings: Settings) -> Link {
        let (commands, asked) = mpsc::channel();
        let (telling, events) = mpsc::channel();
        let thread = std::thread::spawn(move || run(port, settings, &asked, &telling));
        Link { commands: Some(commands), events, thread: Some(thread) }
    }

    /// A way to give commands, for signal handlers too. A clone that is kept keeps the session alive. Commands to a session that has ended
    /// are lost.
    pub fn commands(&self) -> Option<Sender<Command>> {
        self.commands.clone()
    }

    /// Gives a command; lost when the session has ended.
    pub fn command(&self, command: Command) {
        if let Some(commands) = &self.commands {
            // A thread that has ended has told why.
            let _ = commands.send(command);
        }
    }

    /// The next event and when it came, since the start; `None` when none came in time or the session has ended.
    pub fn next(&self, wait: Duration) -> Option<(Duration, Event)> {
        self.events.recv_timeout(wait).ok()
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        if let Some(commands) = self.commands.take() {
            // Also ends a job when clones of the sender are still about. A thread that has ended needs no telling.
            let _ = commands.send(Command::Close);
        }
        if let Some(thread) = self.thread.take() {
            // A panic on the thread has been printed where it happened.
            let _ = thread.join();
        }
    }
}

/// Where events go: what happened, and when.
type Telling = Sender<(Duration, Event)>;

fn run(mut port: Box<dyn Port>, settings: Settings, asked: &Receiver<Command>, telling: &Telling) {
    let began = Instant::now();
    let mut progress = Progress::default();
    let served = catch_unwind(AssertUnwindSafe(|| serve(&mut *port, settings, began, asked, telling, &mut progress)));
    if served.is_err() {
        last_words(&mut *port);
        let outcome = Outcome::Failed(Trouble::Broken);
        let ending = Ending { outcome, progress, maybe: progress.sent, position_kept: false, beam_off: false };
        for event in [Event::Trouble(Trouble::Broken), Event::Ended(ending)] {
            tell(telling, began, event);
        }
    }
}

/// Nobody may be listening any more; the machine comes first.
fn tell(telling: &Telling, began: Instant, event: Event) {
    drop(telling.send((began.elapsed(), event)));
}

/// What a board is told when nothing of ours can be relied on: hold, and a moment later, at rest or not, reset. The beam is off then.
fn last_words(port: &mut dyn Port) {
    for (byte, wait) in [(realtime::HOLD, BRAKING), (realtime::RESET, Duration::ZERO)] {
        // What failed may have been the port.
        let _ = catch_unwind(AssertUnwindSafe(|| port.write(&[byte])));
        std::thread::sleep(wait);
    }
}

/// Serves until the user goes away or the port fails. `progress` is kept up before anything is written, so that it holds after a panic too.
fn serve(
    port: &mut dyn Port,
    settings: Settings,
    began: Instant,
    asked: &Receiver<Command>,
    telling: &Telling,
    progress: &mut Progress,
) {
    let mut session = Session::new(Duration::ZERO, settings);
    let mut buffer = [0; READ_BYTES];
    let mut closing = false;
    loop {
        let mut actions = Vec::new();
        while !closing {
            match asked.try_recv() {
                Ok(Command::Close) | Err(TryRecvError::Disconnected) => closing = true,
                Ok(command) => actions.extend(session.command(began.elapsed(), command)),
                Err(TryRecvError::Empty) => break,
            }
            if closing {
                actions.extend(session.command(began.elapsed(), Command::Close));
            }
        }
        let mut failure = None;
        match port.read(&mut buffer) {
            Ok(0) => {}
            Ok(n) => actions.extend(session.on_bytes(began.elapsed(), &buffer[..n])),
            Err(e) => failure = Some(e),
        }
        actions.extend(session.on_tick(began.elapsed()));
        *progress = session.progress();
        for action in actions {
            match action {
                Action::Write(bytes) if failure.is_none() => failure = port.write(&bytes).err(),
                Action::Write(_) => {}
                Action::Event(event) => tell(telling, began, event),
            }
        }
        if let Some(error) = failure {
            for action in session.on_link_lost(began.elapsed(), &error.to_string()) {
                if let Action::Event(event) = action {
                    tell(telling, began, event);
                }
            }
            return;
        }
        if closing && !session.is_busy() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::port::MockPort;
    use super::*;
    use std::io;
    use std::sync::{Arc, Mutex};

    /// What a board has been told, and what it has yet to say.
    #[derive(Default)]
    struct Wire {
        told: Vec<u8>,
        to_say: Vec<u8>,
        held: bool,
        unplugged: bool,
        /// Reads, or writes of lines, whichever is named, panic from now on.
        panics: Option<&'static str>,
    }

    /// A port whose calls panic when the wire says so. The mock itself cannot be called again after a panic inside it.
    struct Panicking(Box<MockPort>, Arc<Mutex<Wire>>);

    impl Panicking {
        fn panic_in(&self, what: &str) {
            let panics = locked(&self.1).panics;
            assert!(panics != Some(what), "as the test wants it");
        }
    }

    impl Port for Panicking {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            self.panic_in("read");
            self.0.read(buffer)
        }

        fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
            self.0.write(bytes)?;
            if bytes.ends_with(b"\n") {
                self.panic_in("write");
            }
            Ok(())
        }
    }

    impl Wire {
        fn realtime(&self) -> Vec<u8> {
            self.told.iter().copied().filter(|b| matches!(b, b'!' | 0x18)).collect()
        }
    }

    /// A panic while it is locked is the test's own.
    fn locked(wire: &Mutex<Wire>) -> std::sync::MutexGuard<'_, Wire> {
        wire.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// A port to a board that answers at once and takes `line_ms` for every line.
    fn port(wire: &Arc<Mutex<Wire>>, line_ms: u64) -> Box<MockPort> {
        let mut port = MockPort::new();
        let (reading, writing) = (Arc::clone(wire), Arc::clone(wire));
        wire.lock().unwrap().to_say.extend(b"\r\nGrbl 1.1h ['$' for help]\r\n");
        port.expect_read().returning(move |buffer| {
            std::thread::sleep(Duration::from_micros(200));
            let mut wire = locked(&reading);
            if wire.unplugged {
                return Err(io::Error::other("unplugged"));
            }
            let n = wire.to_say.len().min(buffer.len());
            buffer[..n].copy_from_slice(&wire.to_say[..n]);
            wire.to_say.drain(..n);
            Ok(n)
        });
        port.expect_write().returning(move |bytes| {
            let mut wire = locked(&writing);
            wire.told.extend(bytes);
            for byte in bytes {
                match byte {
                    b'\n' if !wire.held => {
                        std::thread::sleep(Duration::from_millis(line_ms));
                        wire.to_say.extend(b"ok\r\n");
                    }
                    b'?' => {
                        let state = if wire.held { "Hold:0" } else { "Idle" };
                        let report = format!("<{state}|Bf:15,128|FS:0,0>\r\n");
                        wire.to_say.extend(report.bytes());
                    }
                    b'!' => wire.held = true,
                    0x18 => {
                        wire.held = false;
                        wire.to_say.extend(b"\r\nGrbl 1.1h ['$' for help]\r\n");
                    }
                    _ => {}
                }
            }
            Ok(())
        });
        Box::new(port)
    }

    fn wait_for(link: &Link, what: impl Fn(&Event) -> bool) -> Event {
        let until = Instant::now() + Duration::from_secs(20);
        while Instant::now() < until {
            if let Some((_, event)) = link.next(Duration::from_millis(100))
                && what(&event)
            {
                return event;
            }
        }
        panic!("it never came");
    }

    fn ready(wire: &Arc<Mutex<Wire>>, line_ms: u64) -> Link {
        let link = Link::start(Box::new(Panicking(port(wire, line_ms), Arc::clone(wire))), Settings::default());
        wait_for(&link, |e| matches!(e, Event::Ready(_)));
        wait_for(&link, |e| matches!(e, Event::Status(..)));
        link
    }

    fn job(link: &Link, n: usize) {
        let lines = Box::new((0..n).map(|k| Ok(format!("G1X{k}F1000"))));
        link.command(Command::Run { lines });
    }

    #[test]
    fn a_job_goes_over_the_port_whole() {
        let wire = Arc::default();
        let link = ready(&wire, 0);
        job(&link, 300);
        let Event::Ended(ending) = wait_for(&link, |e| matches!(e, Event::Ended(_))) else { unreachable!() };
        assert_eq!((ending.outcome, ending.progress.executed), (Outcome::Done, 300));
        let told = String::from_utf8(wire.lock().unwrap().told.clone()).unwrap().replace('?', "");
        let sent: Vec<&str> = told.lines().filter(|l| l.starts_with("G1")).collect();
        assert_eq!(sent, (0..300).map(|k| format!("G1X{k}F1000")).collect::<Vec<_>>());
    }

    #[test]
    fn whoever_lets_go_of_a_link_leaves_a_machine_that_was_held_and_reset() {
        let wire: Arc<Mutex<Wire>> = Arc::default();
        let link = ready(&wire, 2);
        let kept = link.commands();
        job(&link, 100_000);
        wait_for(&link, |e| matches!(e, Event::Status(_, progress) if progress.sent > 0));
        drop(link);
        drop(kept);
        assert_eq!(wire.lock().unwrap().realtime(), [b'!', 0x18]);
        assert_eq!(wire.lock().unwrap().told.last(), Some(&0x18), "the reset is the last word");
    }

    #[test]
    fn a_port_that_is_pulled_out_ends_the_job_and_the_thread() {
        let wire: Arc<Mutex<Wire>> = Arc::default();
        let link = ready(&wire, 2);
        job(&link, 100_000);
        wait_for(&link, |e| matches!(e, Event::Status(_, progress) if progress.sent > 0));
        wire.lock().unwrap().unplugged = true;
        let Event::Ended(ending) = wait_for(&link, |e| matches!(e, Event::Ended(_))) else { unreachable!() };
        assert!(matches!(ending.outcome, Outcome::Failed(Trouble::Link(ref why)) if why == "unplugged"));
        assert!(!ending.beam_off && ending.maybe >= ending.progress.executed);
    }

    #[test]
    fn a_panic_of_the_user_leaves_a_machine_that_was_held_and_reset() {
        let wire: Arc<Mutex<Wire>> = Arc::default();
        let link = ready(&wire, 2);
        job(&link, 100_000);
        wait_for(&link, |e| matches!(e, Event::Status(_, progress) if progress.sent > 0));
        let panicked = std::thread::spawn(move || {
            let _link = link;
            panic!("as the test wants it");
        });
        assert!(panicked.join().is_err());
        assert_eq!(locked(&wire).realtime(), [b'!', 0x18]);
    }

    #[test]
    fn a_panic_of_the_sessions_own_thread_leaves_a_board_that_was_held_and_reset_and_says_so() {
        for panics in ["read", "write"] {
            let wire: Arc<Mutex<Wire>> = Arc::default();
            let link = ready(&wire, 2);
            job(&link, 100_000);
            wait_for(&link, |e| matches!(e, Event::Status(_, progress) if progress.acked > 0));
            locked(&wire).panics = Some(panics);
            let Event::Ended(ending) = wait_for(&link, |e| matches!(e, Event::Ended(_))) else { unreachable!() };
            assert_eq!(ending.outcome, Outcome::Failed(Trouble::Broken), "{panics}");
            assert!(!ending.beam_off && !ending.position_kept && ending.account().contains("BY HAND"));
            let told = locked(&wire).told.clone();
            assert_eq!(locked(&wire).realtime(), [b'!', 0x18], "{panics}");
            assert_eq!(told.last(), Some(&0x18), "{panics}: the reset is the last word");
            let sent = String::from_utf8_lossy(&told).matches("G1X").count();
            assert!(ending.maybe >= sent, "{panics}: {sent} lines went out: {ending:?}");
        }
    }
}
