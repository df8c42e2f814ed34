//! Where a job lies that is taken up again: only where the machine, a head put by hand or crosses say so.

use furbelow::emulator::BoardSettings;
use furbelow::geom::{P3, V3};
use serde_json::Value;

use super::bench::{Running, Scratch, Socket, run};
use super::rows::{cutting, cutting_beyond, homing, jobs, rows, scratch};

/// A board that opening its port does not start anew.
fn lasting(hardware: BoardSettings) -> BoardSettings {
    BoardSettings { resets_on_open: false, ..hardware }
}

fn with(mut hardware: BoardSettings, settings: &[(u16, f64)]) -> BoardSettings {
    hardware.settings = settings.iter().fold(hardware.settings, |s, (n, v)| s.with(*n, *v));
    hardware
}

#[test]
fn a_place_that_was_lost_in_a_reset_while_moving_is_not_believed_after_an_unlock() {
    // So slow to brake that the second signal comes before it stands.
    let socket = Socket::new(lasting(with(homing(), &[(120, 10.0), (121, 10.0)])));
    let scratch = scratch();
    let mut running = cutting_beyond(2, &scratch, &socket.port, &["--home"]);
    loop {
        let event: Value = serde_json::from_str(&running.wait_for("\"event\":\"status\"")).expect("an event");
        if event["feed_mm_per_min"].as_f64() > Some(1000.0) {
            break;
        }
    }
    running.signal("INT INT");
    let (code, told) = running.ends();
    assert!(code == 130 && told.contains("\"position_kept\":false"), "{told}");
    socket.told(&["$X"]);
    let before_mm = socket.burnt_mm();
    let (code, _, stderr) = run(&scratch, &["resume", "--yes"]);
    assert!(code == 1 && stderr.contains("may have lost its place"), "{stderr}");
    assert_eq!(socket.burnt_mm(), before_mm);
}

#[test]
fn homing_after_a_job_that_was_zeroed_by_hand_does_not_say_where_that_job_lay() {
    let hardware = BoardSettings { head_mm: P3::new(350.0, 350.0, 0.0), ..lasting(with(homing(), &[(20, 0.0)])) };
    let (scratch, socket) = (scratch(), Socket::new(hardware));
    socket.told(&["$X", "G91G0X-300Y-300", "G90", "G4P0", "G10L20P1X0Y0"]);
    let running = cutting(&scratch, &socket.port, &[]);
    running.signal("INT");
    assert_eq!(running.ends().0, 130);
    let before_mm = socket.burnt_mm();
    // Work zero is kept in the board's memory and is the same number, counted from elsewhere.
    let (code, _, stderr) = run(&scratch, &["resume", "--yes", "--home"]);
    assert!(code == 1 && stderr.contains("may have lost its place"), "{stderr}");
    assert_eq!(socket.burnt_mm(), before_mm);
}

#[test]
fn a_job_that_was_laid_where_the_head_stood_goes_on_when_the_head_is_put_there_again() {
    let mut hardware = BoardSettings { head_mm: P3::new(20.0, 30.0, 0.0), ..BoardSettings::default() };
    hardware.memory.offsets_mm[0] = V3::new(-100.0, -50.0, 0.0);
    let (scratch, socket) = (scratch(), Socket::new(hardware));
    let running = cutting(&scratch, &socket.port, &["--from", "current"]);
    running.signal("INT");
    assert_eq!(running.ends().0, 130);
    let at = ["-m", "diode-400", "--port", socket.port.as_str()];
    let off = V3::new(20.0, 30.0, 0.0) - socket.real_mm().coords;
    let (x, y) = (format!("{:.3}", off.x), format!("{:.3}", off.y));
    let (code, _, stderr) = run(&scratch, &[["jog", &x, &y].as_slice(), &at].concat());
    assert_eq!(code, 0, "{stderr}");
    let (code, stdout, stderr) = run(&scratch, &["resume", "--yes", "--zero"]);
    assert_eq!(code, 0, "{stdout}{stderr}");
    let (low, high) = socket.lit_bounds();
    let expected = [(low.x, 30.0), (low.y, 35.0), (high.x, 110.0), (high.y, 64.0)];
    assert!(expected.iter().all(|(is, should)| (is - should).abs() < 0.05), "{low} {high}");
}

#[test]
fn what_was_sent_although_it_was_made_for_another_machine_goes_on_likewise() {
    let (scratch, socket) = (Scratch::new(), Socket::new(homing()));
    scratch.write("rows.nc", &rows(30).replace("machine: diode-400", "machine: k40"));
    let running = cutting(&scratch, &socket.port, &["--home", "--anyway"]);
    running.signal("INT");
    assert_eq!(running.ends().0, 130);
    let (code, stdout, stderr) = run(&scratch, &["resume", "--yes", "--home"]);
    assert!(code == 0 && stderr.contains("made for k40"), "{stdout}{stderr}");
    assert_eq!(jobs(&scratch)[1]["standing"], "done");
}

#[test]
fn each_sheet_is_laid_by_its_own_crosses_when_it_lies_on_the_bed() {
    let (scratch, socket) = (Scratch::new(), Socket::new(homing()));
    for sheet in 1..=2 {
        scratch.write(&format!("job/sheets/sheet-{sheet:02}.nc"), &rows(2).replace("1/1", &format!("{sheet}/2")));
    }
    let send = ["send", "job", "--yes", "--home", "-m", "diode-400", "--port", socket.port.as_str()];
    let (code, _, stderr) = run(&scratch, &[&send, ["--pause-s", "0", "--align=8,6,98,6"].as_slice()].concat());
    assert!(code == 2 && stderr.contains("send them one by one"), "{stderr}");
    let mut running = Running::at_a_terminal(&scratch, &[&send, ["--align"].as_slice()].concat());
    running.wait_for("onto the first cross");
    running.types("\n");
    running.wait_for("onto the second cross");
    assert!(!running.told().contains("load sheet"), "{}", running.told());
    running.types("\n");
    running.wait_for("Enter goes on");
    let high = socket.lit_bounds().1;
    assert!((high.x + 398.0 - 90.0).abs() < 0.01, "{high}");
    running.types("\n");
    running.wait_for("onto the first cross");
    running.types("4 3\n");
    running.wait_for("idle at X9.000 Y5.000");
    running.types("\n");
    running.wait_for("onto the second cross");
    running.types("\n");
    let (code, told) = running.ends();
    assert!(code == 0 && told.contains("the sheet lies at X4.000 Y3.000"), "{told}");
    let high = socket.lit_bounds().1;
    assert!((high.x + 398.0 - 94.0).abs() < 0.01 && (high.y + 398.0 - 9.0).abs() < 0.01, "{high}");
}

#[test]
fn a_signal_ends_the_way_onto_a_cross_by_hand() {
    let (scratch, socket) = (scratch(), Socket::new(homing()));
    let send = ["send", "rows.nc", "--yes", "--home", "-m", "diode-400", "--port", socket.port.as_str(), "--align"];
    let mut running = Running::at_a_terminal(&scratch, &send);
    running.wait_for("onto the first cross");
    running.types("300 0\n");
    while !socket.is_moving() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    running.signal("INT");
    let (code, told) = running.ends();
    assert_eq!(code, 130, "{told}");
    assert!(socket.head_mm().x + 398.0 < 200.0 && !socket.is_moving(), "{}", socket.head_mm());
}

#[test]
fn a_zero_that_the_boards_own_check_would_forget_is_not_checked_away() {
    let (scratch, socket) = (Scratch::new(), Socket::new(lasting(BoardSettings::default())));
    scratch.write("rows.nc", &rows(2));
    socket.told(&["G92X-50Y-40"]);
    let send = ["send", "rows.nc", "--yes", "-m", "diode-400", "--port", socket.port.as_str()];
    let (code, _, stderr) = run(&scratch, &[&send, ["--check-on-board"].as_slice()].concat());
    assert!(code == 1 && stderr.contains("shifted by G92") && socket.burnt_mm() == 0.0, "{stderr}");
    let (code, stdout, stderr) = run(&scratch, &send);
    assert_eq!(code, 0, "{stdout}{stderr}");
    let low = socket.lit_bounds().0;
    assert!((low.x - 60.0).abs() < 0.01 && (low.y - 45.0).abs() < 0.01, "{low}");
}
