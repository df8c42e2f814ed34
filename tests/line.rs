//! The real program on the line: home, jog, frame, console and machine probe, against emulated boards on a socket whose trace says what they did.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use furbelow::emulator::{Board, BoardSettings, Settings};
use furbelow::geom::P2;

/// Emulated seconds in one of ours.
const HASTE: f64 = 20.0;

/// A board that listens on a socket until it is dropped. A connection resets it, as opening the port does to boards with a boot loader; one that is
/// not reset greets, as boards on the network do.
struct Machine {
    board: Arc<Mutex<Board>>,
    port: String,
    over: Arc<AtomicBool>,
}

impl Machine {
    fn new(hardware: BoardSettings) -> Machine {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let resets = hardware.resets_on_open;
        let port = format!("tcp:127.0.0.1:{}", listener.local_addr().expect("bound").port());
        let machine = Machine { board: Arc::new(Mutex::new(Board::new(hardware))), port, over: Arc::default() };
        let (board, over) = (Arc::clone(&machine.board), Arc::clone(&machine.over));
        std::thread::spawn(move || serve(&listener, &board, &over, resets));
        machine
    }

    /// With switches: homes to the back right ($23=0), soft limits on.
    fn homing(resets_on_open: bool) -> Machine {
        let settings = [(22, 1.0), (20, 1.0), (23, 0.0), (25, 6000.0), (130, 60.0), (131, 60.0)];
        let settings = settings.iter().fold(Settings::default(), |s, (n, v)| s.with(*n, *v));
        Machine::new(BoardSettings { settings, resets_on_open, ..BoardSettings::default() })
    }

    fn board(&self) -> MutexGuard<'_, Board> {
        self.board.lock().expect("no panic on its thread")
    }

    fn went_dark(&self) -> bool {
        let board = self.board();
        board.power() == 0.0 && board.trace().iter().all(|s| !s.is_lit())
    }

    fn is_near(&self, x_mm: f64, y_mm: f64) -> bool {
        (self.board().position_mm().xy() - P2::new(x_mm, y_mm)).norm() < 0.02
    }
}

impl Drop for Machine {
    fn drop(&mut self) {
        self.over.store(true, Ordering::SeqCst);
    }
}

fn serve(listener: &TcpListener, board: &Mutex<Board>, over: &AtomicBool, resets: bool) {
    let began = Instant::now();
    let now_s = || began.elapsed().as_secs_f64() * HASTE;
    let mut buffer = [0; 4096];
    while !over.load(Ordering::SeqCst) {
        let Ok((mut stream, _)) = listener.accept() else { return };
        stream.set_read_timeout(Some(Duration::from_millis(1))).expect("set");
        board.lock().expect("no panic").open(now_s());
        if !resets {
            let _ = stream.write_all(b"\r\nGrbl 1.1h ['$' for help]\r\n");
        }
        loop {
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

fn furbelow(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_furbelow"));
    command.args(arguments).env_remove("RUST_LOG").stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn told(output: Output) -> (i32, String, String) {
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code().expect("ended by itself"), text(output.stdout), text(output.stderr))
}

/// Runs a command on a machine; exit code, stdout and stderr.
fn on(machine: &Machine, arguments: &[&str]) -> (i32, String, String) {
    let arguments = [arguments, &["-m", "diode-400", "--port", &machine.port]].concat();
    told(furbelow(&arguments).output().expect("runs"))
}

fn typed(machine: &Machine, arguments: &[&str], text: &str) -> (i32, String, String) {
    let arguments = [arguments, &["-m", "diode-400", "--port", &machine.port]].concat();
    let mut child = furbelow(&arguments).stdin(Stdio::piped()).spawn().expect("runs");
    child.stdin.take().expect("piped").write_all(text.as_bytes()).expect("taken");
    told(child.wait_with_output().expect("ends"))
}

fn started(machine: &Machine, arguments: &[&str]) -> Child {
    let arguments = [arguments, &["-m", "diode-400", "--port", &machine.port]].concat();
    furbelow(&arguments).stdin(Stdio::piped()).spawn().expect("runs")
}

fn wait_for(what: impl Fn() -> bool) {
    let until = Instant::now() + Duration::from_secs(20);
    while !what() {
        assert!(Instant::now() < until, "it never came");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}: {text}"))
}

fn job(folder: &Path) -> String {
    let path = folder.join("square.nc");
    let text = "; machine: diode-400\nG21G90M4S600\nG0X20Y10\nG1X60F1200\nY50\nX20\nY10\nM5\nG0X0Y0\n";
    std::fs::write(&path, text).expect("written");
    path.display().to_string()
}

fn scratch() -> tempfile::TempDir {
    tempfile::tempdir().expect("a scratch folder")
}

#[test]
fn a_machine_without_switches_says_how_to_zero_it() {
    let machine = Machine::new(BoardSettings::default());
    let (code, _, err) = on(&machine, &["home"]);
    assert!(code == 1 && err.contains("$22=0") && err.contains("jog --zero"), "{code} {err}");
}

#[test]
fn a_machine_with_switches_homes_unlocks_and_refuses_to_move_before() {
    let machine = Machine::homing(true);
    let (code, _, err) = on(&machine, &["jog", "-5", "0"]);
    assert!(code == 3 && err.contains("alarm"), "{code} {err}");
    let (code, out, err) = on(&machine, &["home", "--json"]);
    assert_eq!(code, 0, "{out}{err}");
    let told = json(&out);
    assert_eq!((told["homed"].as_bool(), told["state"].as_str()), (Some(true), Some("idle")));
    assert!(machine.is_near(-2.0, -2.0), "{told}");
    // Opened anew it is locked again.
    let (code, out, err) = on(&machine, &["home", "--unlock"]);
    assert!(code == 0 && out.contains("unlocked: idle") && err.contains("keeps the position"), "{code} {out}{err}");
}

#[test]
fn jogs_go_so_far_or_there_and_set_work_zero_for_good() {
    let machine = Machine::new(BoardSettings { resets_on_open: false, ..BoardSettings::default() });
    let (code, out, err) = on(&machine, &["jog", "-12.5", "-5"]);
    assert!(code == 0 && out.contains("idle at X-12.500 Y-5.000"), "{code} {out}{err}");
    assert!(machine.is_near(-12.5, -5.0));
    let (code, out, _) = on(&machine, &["jog", "--zero"]);
    assert!(code == 0 && out.contains("X0.000 Y0.000 (machine X-12.500 Y-5.000): work zero is here"), "{out}");
    let (code, out, err) = on(&machine, &["jog", "--to", "30", "4", "--json"]);
    assert_eq!(code, 0, "{err}");
    assert_eq!(json(&out)["work_mm"], serde_json::json!([30.0, 4.0]));
    assert!(machine.is_near(17.5, -1.0) && machine.went_dark());
    let (code, _, err) = on(&machine, &["jog", "--to", "401", "4"]);
    assert!(code == 1 && err.contains("work area"), "{code} {err}");
    assert_eq!(on(&machine, &["jog", "1", "1", "--feed", "99999"]).0, 2);
    let (code, _, err) = on(&machine, &["jog"]);
    assert!(code == 2 && err.contains("how far"), "{code} {err}");
}

#[test]
fn a_jog_ends_at_the_travel_and_says_how_short_it_is() {
    let machine = Machine::homing(false);
    assert_eq!(on(&machine, &["home"]).0, 0);
    let (code, out, err) = on(&machine, &["jog", "-100", "-1"]);
    assert!(code == 0 && out.contains("X ends at the machine's travel, 42 mm short"), "{code} {out}{err}");
    assert!(machine.is_near(-60.0, -3.0));
    // What only the board can tell.
    let (code, _, err) = on(&machine, &["jog", "--to", "30", "0"]);
    assert!(code == 3 && err.contains("error:15: the jog would leave"), "{code} {err}");
}

#[cfg(unix)]
fn interrupt(child: &Child) {
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().expect("runs").success());
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_jog_on_the_way() {
    let machine = Machine::new(BoardSettings::default());
    let child = started(&machine, &["jog", "-300", "0", "--feed", "600"]);
    wait_for(|| machine.board().is_moving());
    interrupt(&child);
    let (code, _, err) = told(child.wait_with_output().expect("ends"));
    assert!(code == 130 && err.contains("stopped: idle at"), "{code} {err}");
    assert!(!machine.board().is_moving() && machine.board().position_mm().x > -100.0);
}

#[test]
fn a_border_is_traced_dark_and_ends_where_it_began() {
    let folder = scratch();
    let machine = Machine::new(BoardSettings::default());
    let (code, out, err) = on(&machine, &["frame", &job(folder.path())]);
    assert!(
        code == 0 && out.contains("around X20 Y10 to X60 Y50 (40 x 40 mm) once; back where it began"),
        "{out}{err}"
    );
    assert!(machine.went_dark() && machine.is_near(0.0, 0.0));
    let way: f64 = machine.board().trace().iter().map(|s| s.length_mm()).sum();
    let there = 20.0_f64.hypot(10.0);
    assert!((way - 160.0 - 2.0 * there).abs() < 0.2, "{way} mm");
}

#[test]
fn a_border_shows_the_beam_only_moving_only_as_bright_as_allowed_and_only_with_the_checklist_done() {
    let folder = scratch();
    let machine = Machine::new(BoardSettings::default());
    let job = job(folder.path());
    let (code, _, err) = on(&machine, &["frame", &job, "--beam"]);
    assert!(code == 2 && err.contains("--yes") && machine.board().trace().is_empty(), "{code} {err}");
    let (code, _, err) = on(&machine, &["frame", &job, "--beam", "5", "--yes"]);
    assert!(code == 1 && err.contains("at most 1 %"), "{code} {err}");
    let (code, out, err) = on(&machine, &["frame", &job, "--beam", "--yes", "--json"]);
    assert_eq!(code, 0, "{out}{err}");
    assert_eq!((json(&out)["beam_s"].as_f64(), json(&out)["outcome"].as_str()), (Some(10.0), Some("done")));
    let board = machine.board();
    let lit: Vec<_> = board.trace().iter().filter(|s| s.is_lit()).collect();
    let lit_mm: f64 = lit.iter().map(|s| s.length_mm()).sum();
    assert!((lit_mm - 160.0).abs() < 0.2, "{lit_mm} mm are lit");
    assert!(lit.iter().all(|s| s.length_mm() > 0.0 && s.start_power.max(s.end_power) <= 0.01 + 1e-9));
    assert_eq!(board.power(), 0.0);
}

#[test]
fn a_border_the_machine_does_not_reach_is_refused_before_anything_moves() {
    let folder = scratch();
    let far = folder.path().join("far.nc");
    std::fs::write(&far, "G21G90M4S600\nG0X20Y10\nG1X460F1200\nM5\n").expect("written");
    let machine = Machine::new(BoardSettings::default());
    let (code, _, err) = on(&machine, &["frame", &far.display().to_string()]);
    assert!(code == 1 && err.contains("border cannot be traced"), "{code} {err}");
    // Soft limits are on and work zero lies at machine zero: everything to the right of it is out of reach.
    let machine = Machine::homing(false);
    assert_eq!(on(&machine, &["home", "--unlock"]).0, 0);
    let (code, _, err) = on(&machine, &["frame", &job(folder.path())]);
    assert!(code == 1 && err.contains("leaves the travel"), "{code} {err}");
    assert!(machine.board().trace().is_empty());
    let nothing = folder.path().join("nothing.nc");
    std::fs::write(&nothing, "G21G90\nG0X20Y10\n").expect("written");
    let (code, _, err) = on(&machine, &["frame", &nothing.display().to_string()]);
    assert!(code == 1 && err.contains("burns nothing"), "{code} {err}");
}

#[test]
fn a_border_goes_round_until_enter_and_a_folder_counts_as_one_job() {
    let folder = scratch();
    let sheets = folder.path().join("sheets");
    std::fs::create_dir(&sheets).expect("made");
    for (name, x) in [("sheet-01.nc", 10), ("sheet-02.nc", 70)] {
        let text = format!("G21G90M4S600\nG0X{x}Y10\nG1X{}F1200\nY20\nM5\n", x + 10);
        std::fs::write(sheets.join(name), text).expect("written");
    }
    let machine = Machine::new(BoardSettings::default());
    let mut child = started(&machine, &["frame", "--box", "--repeat", "--json", &folder.path().display().to_string()]);
    wait_for(|| machine.board().trace().iter().map(|s| s.length_mm()).sum::<f64>() > 200.0);
    child.stdin.take().expect("piped").write_all(b"\n").expect("taken");
    let (code, out, err) = told(child.wait_with_output().expect("ends"));
    assert_eq!(code, 0, "{out}{err}");
    let told = json(&out);
    assert_eq!(told["bounds_mm"], serde_json::json!([10.0, 10.0, 80.0, 20.0]));
    assert!(told["rounds"].as_u64().expect("a number") >= 2 && machine.is_near(0.0, 0.0), "{told}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_border_dark_and_at_rest() {
    let folder = scratch();
    let machine = Machine::new(BoardSettings::default());
    let job = job(folder.path());
    let child = started(&machine, &["frame", &job, "--beam", "--yes", "--repeat", "--feed", "600"]);
    wait_for(|| machine.board().power() > 0.0);
    interrupt(&child);
    let (code, out, err) = told(child.wait_with_output().expect("ends"));
    assert!(code == 130 && out.contains("stopped on the way"), "{code} {out}{err}");
    assert!(machine.board().power() == 0.0 && !machine.board().is_moving());
}

#[test]
fn a_script_is_answered_line_by_line_and_errors_are_explained() {
    let machine = Machine::new(BoardSettings::default());
    let script = "; a comment\n?\nG21 G90\nG41\nG1 X-3 F6000\n$30=255\n$$\nhold\nresume\n";
    let (code, out, err) = typed(&machine, &["console"], script);
    assert!(code == 3 && err.contains("1 line of the script"), "{code} {out}{err}");
    assert!(out.contains("G41: error:20: the board does not know this word"), "{out}");
    assert!(out.contains("$30=255") && out.contains("idle at X0.000 Y0.000"), "{out}");
    assert!(machine.is_near(-3.0, 0.0), "it ends when the machine rests");
    let (code, out, _) = typed(&machine, &["console", "--json"], "$G\nreset\n$I\nG1!\n");
    assert_eq!(code, 3, "a byte that must not be sent");
    let events: Vec<_> = out.lines().map(json).collect();
    let kinds: Vec<_> = events.iter().map(|e| e["event"].as_str().expect("a word")).collect();
    for kind in ["text", "answer", "restarted", "trouble"] {
        assert!(kinds.contains(&kind), "{kind} in {out}");
    }
}

#[test]
fn a_beam_that_a_script_leaves_on_is_switched_off() {
    let machine = Machine::new(BoardSettings::default());
    let (code, out, err) = typed(&machine, &["console"], "M3 S20\nG1 X-5 F6000\n");
    assert!(code == 0 && err.contains("left on"), "{code} {out}{err}");
    assert_eq!(machine.board().power(), 0.0);
}

#[test]
fn an_alarm_in_a_script_is_explained_and_ends_it() {
    let machine = Machine::homing(true);
    let (code, out, _) = typed(&machine, &["console"], "unlock\nG0X5\n?\nG0X1\n");
    assert!(code == 3 && out.contains("ALARM:2: a move would have left the travel"), "{code} {out}");
}

#[test]
fn a_probed_board_becomes_a_machine_file_that_is_in_order() {
    let folder = scratch();
    let settings = Settings::default().with(30, 255.0).with(110, 6000.0).with(130, 310.0);
    let machine = Machine::new(BoardSettings { settings, rx_bytes: 256, ..BoardSettings::default() });
    let out = folder.path().join("mine.toml").display().to_string();
    let (code, text, err) = told(furbelow(&["machine", "probe", "--port", &machine.port]).output().expect("runs"));
    assert!(code == 0 && text.contains("$110=6000.000") && text.contains("[G54:0.000,0.000,0.000]"), "{text}{err}");
    let mut child = furbelow(&["machine", "check", "-"]).stdin(Stdio::piped()).spawn().expect("runs");
    child.stdin.take().expect("piped").write_all(text.as_bytes()).expect("taken");
    let (code, said, err) = told(child.wait_with_output().expect("ends"));
    assert_eq!((code, said.trim()), (0, "OK: machine probed"), "{err}");

    let (code, said, err) = on(&machine, &["machine", "probe", "--out", &out]);
    assert_eq!(code, 0, "{said}{err}");
    let lines =
        ["controller.max_s: 1000 in diode-400, 255 on the board", "controller.rx_bytes: 128 in", "work_area.width_mm"];
    assert!(lines.iter().all(|line| said.contains(line)), "{said}");
    assert_eq!(told(furbelow(&["machine", "check", &out]).output().expect("runs")).0, 0);
    assert_eq!(on(&machine, &["machine", "probe", "--out", &out]).0, 2, "it is there already");
    let arguments = ["machine", "probe", "-m", &out, "--port", &machine.port, "--json"];
    let (code, said, err) = told(furbelow(&arguments).output().expect("runs"));
    assert_eq!((code, &json(&said)["differences"]), (0, &serde_json::json!([])), "{err}");
    assert_eq!(json(&said)["settings"]["$30"], 255.0);
}

#[test]
fn every_command_talks_to_the_emulator_too() {
    let emulator = ["-m", "diode-400", "--port", "emulator"];
    let (code, out, err) = told(furbelow(&[&["jog", "-1", "0"][..], &emulator].concat()).output().expect("runs"));
    assert!(code == 0 && out.contains("idle at X-1.000 Y0.000"), "{out}{err}");
}

#[cfg(unix)]
#[test]
fn the_emulated_board_is_served_to_any_sender_on_a_pseudo_terminal() {
    use std::io::{BufRead, BufReader};
    let mut serving = furbelow(&["ports", "--emulator", "--json"]).stdout(Stdio::piped()).spawn().expect("runs");
    let mut told_port = String::new();
    let pipe = BufReader::new(serving.stdout.take().expect("piped"));
    for line in pipe.lines().map_while(Result::ok) {
        told_port += &line;
        if line == "}" {
            break;
        }
    }
    let port = json(&told_port)["port"].as_str().expect("a path").to_owned();
    let (code, out, err) = told(furbelow(&["home", "-m", "diode-400", "--port", &port]).output().expect("runs"));
    serving.kill().expect("still there");
    serving.wait().expect("ends");
    assert!(!out.is_empty() || !err.is_empty());
    assert!(code != 3 || !err.contains("does not answer"), "{out}{err}");
    assert!(out.contains("X") || err.contains("switches"), "the board answered: {out}{err}");
}
