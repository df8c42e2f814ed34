//! Jobs that were stopped, killed, cut off or spoilt, and what comes of them afterwards; jobs laid by crosses.

use std::fs;

use furbelow::emulator::{Board, BoardSettings, Fault, Memory, Settings, When};
use furbelow::geom::V3;
use furbelow::stream::ServedBoard;
use serde_json::Value;

use super::bench::{Running, Scratch, Socket, run};
use super::rows::{cutting, cutting_beyond, homing, jobs, rows, scratch, whole_mm};

#[test]
fn a_stopped_job_goes_on_at_the_very_point_on_a_machine_that_homes() {
    let (scratch, socket) = (scratch(), Socket::new(homing()));
    let running = cutting(&scratch, &socket.port, &["--home"]);
    running.signal("INT");
    let (code, told) = running.ends();
    assert!(code == 130 && told.contains("furbelow resume 1"), "{told}");
    let before_mm = socket.burnt_mm();
    assert_eq!(jobs(&scratch)[0]["standing"], "stopped");
    let (code, _, stderr) = run(&scratch, &["resume", "--yes"]);
    assert!(code == 3 && stderr.contains("--home homes it first"), "{stderr}");
    let (code, stdout, stderr) = run(&scratch, &["resume", "--yes", "--home", "--at", "point", "--overlap-mm", "2"]);
    assert_eq!(code, 0, "{stdout}{stderr}");
    assert!(stderr.contains("the head stands over its first alignment cross"), "{stderr}");
    let twice_mm = socket.burnt_mm() - whole_mm(30);
    assert!((twice_mm - 2.0).abs() < 0.1, "{twice_mm} mm twice, {before_mm} mm before");
    let jobs = jobs(&scratch);
    let told = |k: usize| [&jobs[k]["standing"], &jobs[k]["resumed_by"], &jobs[k]["resumes"]].map(Value::to_string);
    assert_eq!(told(0), ["\"resumed\"", "2", "null"]);
    assert_eq!(told(1), ["\"done\"", "null", "1"]);
    let (code, _, stderr) = run(&scratch, &["resume", "1", "--yes"]);
    assert!(code == 1 && stderr.contains("job 2 went on with job 1"), "{stderr}");
    let (code, _, stderr) = run(&scratch, &["resume"]);
    assert!(code == 1 && stderr.contains("no job was left unfinished"), "{stderr}");
}

#[test]
fn a_sender_that_is_killed_leaves_a_journal_from_which_the_job_is_finished() {
    let (scratch, socket) = (scratch(), Socket::new(homing()));
    // Dropped is killed, as by kill -9.
    drop(cutting(&scratch, &socket.port, &["--home"]));
    let job = &jobs(&scratch)[0];
    assert_eq!(job["standing"], "interrupted");
    assert!(job["executed"].as_u64() > Some(14) && job["sent"].as_u64() > job["executed"].as_u64(), "{job}");
    let (_, shown, _) = run(&scratch, &["jobs", "show", "1"]);
    assert!(shown.contains("surely done") && shown.contains("furbelow resume 1"), "{shown}");
    // The original is no longer needed.
    fs::remove_file(scratch.path("rows.nc")).expect("removed");
    let (code, stdout, stderr) = run(&scratch, &["resume", "1", "--yes", "--home"]);
    assert_eq!(code, 0, "{stdout}{stderr}");
    assert!(socket.burnt_mm() > whole_mm(30) - 0.1, "all of it is cut");
    let (code, stdout, _) = run(&scratch, &["jobs", "prune", "--keep", "0", "--json"]);
    assert!(code == 0 && stdout.contains("\"left\": 0"), "{stdout}");
    let (_, stdout, _) = run(&scratch, &["jobs"]);
    assert_eq!(stdout, "nothing was sent yet\n");
}

#[test]
fn a_network_that_drops_ends_the_job_and_what_the_board_still_did_is_cut_again() {
    let (scratch, socket) = (scratch(), Socket::new(homing()));
    let running = cutting(&scratch, &socket.port, &["--home"]);
    socket.hang_up();
    let (code, told) = running.ends();
    assert!(code == 3 && told.contains("BY HAND"), "{told}");
    assert_eq!(jobs(&scratch)[0]["standing"], "failed");
    let (code, stdout, stderr) = run(&scratch, &["resume", "--yes", "--home"]);
    assert_eq!(code, 0, "{stdout}{stderr}");
    assert!(socket.is_dark_now() && socket.burnt_mm() > whole_mm(30) - 0.1, "all of it is cut");
}

#[test]
fn without_switches_a_job_goes_on_only_by_its_crosses_or_a_new_zero() {
    let (scratch, socket) = (scratch(), Socket::new(BoardSettings::default()));
    let running = cutting(&scratch, &socket.port, &[]);
    running.signal("INT");
    assert_eq!(running.ends().0, 130);
    let (code, _, stderr) = run(&scratch, &["resume", "--yes", "--at", "point"]);
    assert!(code == 1 && stderr.contains("give --zero, or find the sheet by its crosses"), "{stderr}");
    // The board takes where its head stands for zero since its port was opened.
    let stands = socket.real_mm();
    let places = [(5.0, 2.0), (95.0, 2.0)].map(|(x, y)| format!("{:.3},{:.3}", x - stands.x, y - stands.y)).join(",");
    let (code, stdout, stderr) = run(&scratch, &["resume", "--yes", "--at", "point", &format!("--align={places}")]);
    assert_eq!(code, 0, "{stdout}{stderr}");
    let twice_mm = socket.burnt_mm() - whole_mm(30);
    assert!((twice_mm - 0.5).abs() < 0.1, "{twice_mm} mm twice");
    let (low, high) = socket.lit_bounds();
    let expected = [(low.x, 10.0), (low.y, 5.0), (high.x, 90.0), (high.y, 34.0)];
    assert!(expected.iter().all(|(is, should)| (is - should).abs() < 0.05), "{low} {high}");
}

#[test]
fn a_job_that_may_be_spoilt_is_marked_and_never_goes_on_silently() {
    let (scratch, socket) = (Scratch::new(), Socket::new(homing()));
    // Triangles, so slow that a side takes several reports of a sender whose clock is twenty times slower.
    let corner = |k: usize| {
        let (radius, turn) = (45.0 - k as f64, 2.0 * std::f64::consts::PI * k as f64 / 3.0);
        format!("X{:.3}Y{:.3}\n", 50.0 + radius * turn.cos(), 50.0 + radius * turn.sin())
    };
    let corners: String = (1..40).map(corner).collect();
    scratch.write("rows.nc", &format!("G21G90G94G17G54M5S0\nM4S0\nG0{}G1S200F300\n{corners}M5S0\n", corner(0)));
    let running = cutting_beyond(5, &scratch, &socket.port, &["--home"]);
    socket.strike(When::At(0.0), Fault::TornLine);
    let (code, told) = running.ends();
    assert!(code == 3 && told.contains("mm off the way of line"), "{told}");
    assert_eq!(jobs(&scratch)[0]["standing"], "damaged");
    let resume = ["resume", "--yes", "--home"];
    let (code, _, stderr) = run(&scratch, &resume);
    assert!(code == 1 && stderr.contains("--although-damaged"), "{stderr}");
    let mut running = Running::unattended(&scratch, &[resume.as_slice(), &["--although-damaged", "--json"]].concat());
    running.wait_for("\"state\":\"run\"");
    running.signal("INT");
    assert_eq!(running.ends().0, 130);
}

#[test]
fn a_job_is_laid_by_its_crosses_where_the_head_stands_or_not_at_all() {
    let (scratch, socket) = (scratch(), Socket::new(homing()));
    scratch.write("plain.nc", &rows(3).replace("; crosses", "; no"));
    scratch.write("rows.nc", &rows(3));
    let at = ["--yes", "--home", "-m", "diode-400", "--port", &socket.port];
    let send = |more: &[&str]| run(&scratch, &[["send"].as_slice(), more, &at].concat());
    // Crosses found 3 mm to the right and 4 mm up, and half a millimetre farther apart than they may be.
    let (code, _, stderr) = send(&["rows.nc", "--align=8,6,98.5,6"]);
    assert!(code == 1 && stderr.contains("90.50 mm apart on the sheet and 90.00 mm in the job"), "{stderr}");
    let (code, _, stderr) = send(&["plain.nc", "--align=8,6,98,6"]);
    assert!(code == 1 && stderr.contains("no alignment crosses"), "{stderr}");
    let (code, _, stderr) = send(&["rows.nc", "--align=390,6,480,6"]);
    assert!(code == 1 && stderr.contains("must not be sent"), "its limits are checked again: {stderr}");
    assert_eq!(socket.burnt_mm(), 0.0);
    let (code, _, stderr) = send(&["rows.nc", "--align=8,6,98,6"]);
    assert!(code == 0 && stderr.contains("X3.000 Y4.000, turned 0.000 degrees, at 100.000 %"), "{stderr}");
    let (low, high) = socket.lit_bounds();
    let expected = [(low.x, 13.0), (low.y, 9.0), (high.x, 93.0), (high.y, 11.0)];
    assert!(expected.iter().all(|(is, should)| (is + 398.0 - should).abs() < 0.01), "{low} {high}");
    // The machine's corner is at -400, 2 mm from work zero.
    let before = socket.burnt_mm();
    let (code, stdout, stderr) = send(&["rows.nc", "--from", "absolute"]);
    assert_eq!(code, 0, "{stdout}{stderr}");
    let (low, _) = socket.lit_bounds();
    assert!((low.x + 390.0).abs() < 0.01 && socket.burnt_mm() > before + 200.0, "{low}");
    let frame = ["frame", "rows.nc", "-m", "diode-400", "--port", "emulator:50x", "--json"];
    let (code, stdout, _) = run(&scratch, &[frame.as_slice(), &["--align=8,6,98,6"]].concat());
    let framed: Value = serde_json::from_str(&stdout).expect("JSON");
    assert_eq!((code, framed["bounds_mm"].to_string().as_str()), (0, "[13.0,9.0,93.0,11.0]"));
    let (code, _, stderr) = run(&scratch, &[frame.as_slice(), &["--from", "absolute"]].concat());
    assert!(code == 1 && stderr.contains("home it first"), "{stderr}");
}

#[test]
fn a_board_that_is_unplugged_and_comes_back_as_another_device_is_found_and_the_job_finished() {
    let settings = [(22, 1.0), (20, 1.0), (23, 0.0), (24, 600.0), (25, 6000.0), (132, 5.0)];
    let settings = settings.iter().fold(Settings::default(), |s, (n, v)| s.with(*n, *v));
    let mut memory = Memory::default();
    memory.offsets_mm[0] = V3::new(-98.0, -98.0, 0.0);
    let board = Board::new(BoardSettings { settings, memory, boot_s: 0.05, ..BoardSettings::default() });
    let Ok(served) = ServedBoard::start(board, drop) else { return };
    let scratch = Scratch::new();
    scratch.write("rows.nc", &rows(12));
    let port = served.path().display().to_string();
    let running = cutting(&scratch, &port, &["--home"]);
    served.with(|board, now_s| board.schedule(When::At(now_s), Fault::Unplug { powered: false }));
    let (code, told) = running.ends();
    assert!(code == 3 && told.contains("the port failed"), "{told}");
    served.with(|board, now_s| board.schedule(When::At(now_s), Fault::Replug));
    while !served.path().exists() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let (code, stdout, stderr) = run(&scratch, &["resume", "--yes", "--home"]);
    assert_eq!(code, 0, "{stdout}{stderr}");
}

#[test]
fn a_beam_that_was_left_on_at_rest_is_switched_off_before_anything_is_asked() {
    let (scratch, socket) =
        (Scratch::new(), Socket::new(BoardSettings { resets_on_open: false, ..BoardSettings::default() }));
    scratch.write("rows.nc", &rows(2).replace("machine: diode-400", "machine: k40"));
    socket.told(&["M3S500", "G1X2F6000", "G4P0.01"]);
    assert!(!socket.is_dark_now(), "lit where it stands");
    let send = ["send", "rows.nc", "--yes", "-m", "diode-400", "--port", socket.port.as_str()];
    let (code, _, stderr) = run(&scratch, &send);
    assert!(code == 1 && stderr.contains("made for k40") && stderr.contains("it is off now"), "{stderr}");
    assert!(socket.is_dark_now());
}

#[test]
fn what_is_left_of_a_set_and_what_is_not_left_of_a_job_is_told() {
    let (scratch, socket) = (Scratch::new(), Socket::new(homing()));
    scratch.write("rows.nc", &rows(30).replace("1/1", "2/5"));
    let running = cutting(&scratch, &socket.port, &["--home"]);
    running.signal("INT");
    assert_eq!(running.ends().0, 130);
    let (code, stdout, stderr) = run(&scratch, &["resume", "--yes", "--home"]);
    let rest = format!("furbelow send . --from-sheet 3 -m diode-400 --port {}", socket.port);
    assert!(code == 0 && stdout.contains(&rest) && stdout.contains("sheet 2 of 5"), "{stdout}{stderr}");

    // Stopped in the way home, after the last cut.
    scratch.write("rows.nc", &rows(2).replace("G0X0Y0\n", "G1X0Y0F100\n"));
    let running = cutting_beyond(11, &scratch, &socket.port, &["--home"]);
    running.signal("INT");
    let (code, told) = running.ends();
    assert_eq!(code, 130, "{told}");
    let (code, stdout, stderr) = run(&scratch, &["resume", "--yes", "--home"]);
    assert!(code == 0 && stdout.contains("all its cuts are surely carried out"), "{stdout}{stderr}");
    let picture = scratch.path("left.png");
    let (code, shown, stderr) = run(&scratch, &["jobs", "show", "3", "--picture", "left.png"]);
    assert!(code == 0 && shown.contains("done"), "{shown}{stderr}");
    assert!(fs::read(picture).is_ok_and(|bytes| bytes.starts_with(b"\x89PNG")));
    let (code, _, stderr) = run(&scratch, &["jobs", "show", "3", "--picture", "left.html"]);
    assert!(code == 2 && stderr.contains(".png or .svg"), "{stderr}");
    // The same of a job in which something went wrong.
    let log = scratch.path("config").join("jobs/0003/log");
    let notes = fs::read_to_string(&log).expect("a log");
    let before: Vec<&str> = notes.lines().filter(|note| !note.contains("\"mark\":\"done\"")).collect();
    let notes = before.join("\n").replace("\"mark\":\"stopped\"", "\"damaged\":true,\"mark\":\"failed\"") + "\n";
    fs::write(&log, notes).expect("written");
    let (code, stdout, stderr) = run(&scratch, &["resume", "3", "--yes", "--home", "--although-damaged", "--json"]);
    let end = stdout.lines().last().expect("an end");
    assert!(code == 0 && end.contains("look at the sheet") && !end.contains("all is cut"), "{stdout}{stderr}");
}
