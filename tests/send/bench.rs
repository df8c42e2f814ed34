//! The program in a folder of its own, with or without somebody at its terminal, and an emulated board on a socket.

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use furbelow::emulator::{Board, BoardSettings, Fault, When};
use furbelow::geom::{P3, V3};
use serialport::{SerialPort, TTYPort};

/// Emulated seconds in one of ours.
const HASTE: f64 = 20.0;

/// Longer than anything here takes on a machine with much to do.
const PATIENCE: Duration = Duration::from_secs(60);

/// A folder that is gone afterwards.
pub struct Scratch(tempfile::TempDir);

impl Scratch {
    pub fn new() -> Scratch {
        Scratch(tempfile::tempdir().expect("a folder"))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().expect("in a folder")).expect("made");
        std::fs::write(path, text).expect("written");
    }

    fn furbelow(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_furbelow"));
        command.args(arguments).current_dir(self.0.path()).env_remove("RUST_LOG");
        command.env("FURBELOW_CONFIG_DIR", self.path("config"));
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }
}

/// Runs it with nobody there; exit code, stdout and stderr.
pub fn run(scratch: &Scratch, arguments: &[&str]) -> (i32, String, String) {
    let output = scratch.furbelow(arguments).output().expect("runs");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code().expect("ended by itself"), text(output.stdout), text(output.stderr))
}

/// It runs, and what it tells is read line by line, stdout and stderr together.
pub struct Running {
    child: Child,
    lines: Receiver<String>,
    told: String,
    /// The other end of its terminal, and its own, which must stay open.
    terminal: Option<(TTYPort, TTYPort)>,
}

impl Running {
    /// With somebody at the terminal.
    pub fn at_a_terminal(scratch: &Scratch, arguments: &[&str]) -> Running {
        let (master, own) = TTYPort::pair().expect("a pseudo-terminal");
        let stdin = std::fs::File::open(own.name().expect("a name")).expect("opens");
        let child = scratch.furbelow(arguments).stdin(stdin).spawn().expect("runs");
        Running::new(child, Some((master, own)))
    }

    /// With nobody there.
    pub fn unattended(scratch: &Scratch, arguments: &[&str]) -> Running {
        Running::new(scratch.furbelow(arguments).spawn().expect("runs"), None)
    }

    fn new(mut child: Child, terminal: Option<(TTYPort, TTYPort)>) -> Running {
        let (telling, lines) = mpsc::channel();
        let pipes: [Box<dyn Read + Send>; 2] =
            [Box::new(child.stdout.take().expect("piped")), Box::new(child.stderr.take().expect("piped"))];
        for pipe in pipes {
            let telling = telling.clone();
            std::thread::spawn(move || {
                BufReader::new(pipe).lines().map_while(Result::ok).for_each(|line| drop(telling.send(line)));
            });
        }
        Running { child, lines, told: String::new(), terminal }
    }

    /// Waits for the next line that holds a text.
    pub fn wait_for(&mut self, text: &str) -> String {
        let until = Instant::now() + PATIENCE;
        while let Ok(line) = self.lines.recv_timeout(until.saturating_duration_since(Instant::now())) {
            self.told += &format!("{line}\n");
            if line.contains(text) {
                return line;
            }
        }
        panic!("{text:?} never came: {}", self.told);
    }

    /// All it has told so far.
    pub fn told(&mut self) -> String {
        while let Ok(line) = self.lines.try_recv() {
            self.told += &format!("{line}\n");
        }
        self.told.clone()
    }

    pub fn types(&mut self, text: &str) {
        let (master, _) = self.terminal.as_mut().expect("at a terminal");
        master.write_all(text.as_bytes()).expect("typed");
    }

    /// Sends signals, a moment apart.
    pub fn signal(&self, names: &str) {
        let id = self.child.id();
        let kills: Vec<String> = names.split(' ').map(|name| format!("kill -{name} {id}")).collect();
        let sent = Command::new("sh").args(["-c", &kills.join(" && sleep 0.02 && ")]).status().expect("sh");
        assert!(sent.success());
    }

    /// Waits for its end: exit code and all it told.
    pub fn ends(mut self) -> (i32, String) {
        let until = Instant::now() + PATIENCE;
        let status = loop {
            match self.child.try_wait().expect("waited for") {
                Some(status) => break status,
                None if Instant::now() > until => panic!("it does not end: {}", self.told()),
                None => std::thread::sleep(Duration::from_millis(10)),
            }
        };
        while let Ok(line) = self.lines.recv_timeout(Duration::from_secs(5)) {
            self.told += &format!("{line}\n");
        }
        (status.code().expect("ended by itself"), self.told.clone())
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // One that has ended needs no killing.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A board on a socket, opened anew by each connection as boards with a boot loader are. Its thread ends with the test's process.
pub struct Socket {
    pub port: String,
    board: Arc<Mutex<Board>>,
    hangs_up: Arc<AtomicBool>,
}

impl Socket {
    pub fn new(hardware: BoardSettings) -> Socket {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = format!("tcp:127.0.0.1:{}", listener.local_addr().expect("bound").port());
        let board = Arc::new(Mutex::new(Board::new(hardware)));
        let hangs_up = Arc::<AtomicBool>::default();
        let (served, hanging) = (Arc::clone(&board), Arc::clone(&hangs_up));
        std::thread::spawn(move || serve(&listener, &served, &hanging));
        Socket { port, board, hangs_up }
    }

    fn with<T>(&self, look: impl FnOnce(&Board) -> T) -> T {
        look(&self.board.lock().expect("no panic on its thread"))
    }

    pub fn is_dark_now(&self) -> bool {
        self.with(|board| board.power() == 0.0 && !board.is_moving())
    }

    pub fn is_moving(&self) -> bool {
        self.with(Board::is_moving)
    }

    pub fn burnt_mm(&self) -> f64 {
        self.with(|board| board.trace().iter().filter(|s| s.is_lit()).map(|s| s.length_mm()).sum())
    }

    /// The box around what was burnt, where it really is, mm.
    pub fn lit_bounds(&self) -> (P3, P3) {
        self.with(|board| {
            let lit = board.trace().iter().filter(|s| s.is_lit() && s.length_mm() > 0.0);
            let far = P3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY);
            lit.flat_map(|s| [s.from_mm, s.to_mm]).fold((far, -far), |(low, high), p| (low.inf(&p), high.sup(&p)))
        })
    }

    /// Where the head really is, from the home corner.
    pub fn real_mm(&self) -> P3 {
        self.with(Board::head_mm)
    }

    /// Gives orders by hand, each when the one before is answered, in a connection of its own.
    pub fn told(&self, orders: &[&str]) {
        let mut stream = TcpStream::connect(self.port.trim_start_matches("tcp:")).expect("connects");
        stream.set_read_timeout(Some(PATIENCE)).expect("set");
        // A board that was just switched on hears nothing while it boots.
        std::thread::sleep(Duration::from_millis(200));
        let mut answers = BufReader::new(stream.try_clone().expect("a second handle")).lines().map_while(Result::ok);
        for order in orders {
            stream.write_all(format!("{order}\n").as_bytes()).expect("written");
            let answer = answers.find(|line| line == "ok" || line.starts_with("error")).expect("an answer");
            assert_eq!(answer, "ok", "{order}");
        }
    }

    /// Ends the connection there is.
    pub fn hang_up(&self) {
        self.hangs_up.store(true, Ordering::SeqCst);
    }

    /// Lets something go wrong.
    pub fn strike(&self, when: When, fault: Fault) {
        self.board.lock().expect("no panic on its thread").schedule(when, fault);
    }

    /// Where the head is as the board counts, from where it began.
    pub fn head_mm(&self) -> V3 {
        self.with(|board| board.position_mm().coords)
    }
}

fn serve(listener: &TcpListener, board: &Mutex<Board>, hangs_up: &AtomicBool) {
    let began = Instant::now();
    let now_s = || began.elapsed().as_secs_f64() * HASTE;
    let mut buffer = [0; 4096];
    while let Ok((mut stream, _)) = listener.accept() {
        stream.set_read_timeout(Some(Duration::from_millis(1))).expect("set");
        board.lock().expect("no panic").open(now_s());
        while !hangs_up.swap(false, Ordering::SeqCst) {
            let bytes = match stream.read(&mut buffer) {
                Ok(0) => break,
                Ok(n) => &buffer[..n],
                Err(e) if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => &[],
                Err(_) => break,
            };
            let answer = board.lock().expect("no panic").step(now_s(), bytes);
            if stream.write_all(&answer).is_err() {
                break;
            }
        }
    }
}
