//! Several machines at once.

use std::time::{Duration, Instant};

use furbelow::emulator::{BoardSettings, Fault, When};
use serde_json::Value;

use super::bench::{Running, Scratch, Socket, run};
use super::rows::{homing, jobs, rows, whole_mm};

fn two_sheets(text: &str) -> Scratch {
    let scratch = Scratch::new();
    for sheet in 1..=2 {
        scratch.write(&format!("job/sheets/sheet-{sheet:02}.nc"), text);
    }
    scratch
}

#[test]
fn several_machines_share_the_sheets_and_one_that_fails_holds_no_other_up() {
    let scratch = Scratch::new();
    for sheet in 1..=4 {
        scratch.write(&format!("job/sheets/sheet-{sheet:02}.nc"), &rows(3));
    }
    let sockets = [Socket::new(BoardSettings::default()), Socket::new(BoardSettings::default())];
    let members =
        [sockets[0].port.as_str(), sockets[1].port.as_str(), "tcp:127.0.0.1:1"].map(|p| format!("diode-400@{p}"));
    let (code, _, stderr) = run(&scratch, &["send", "job", "--yes", "--machines", &members.join(",")]);
    assert!(code == 2 && stderr.contains("--pause-s"), "{stderr}");
    let send = ["send", "job", "--yes", "--json", "--pause-s", "0", "--machines", &members.join(",")];
    let (code, stdout, stderr) = run(&scratch, &send);
    assert_eq!(code, 0, "{stdout}{stderr}");
    let end: Value = serde_json::from_str(stdout.lines().last().expect("an end")).expect("JSON");
    assert_eq!((end["done"].to_string().as_str(), &end["outcome"]), ("[1,2,3,4]", &"done".into()));
    assert!(end["failures"][0].as_str().is_some_and(|why| why.contains("tcp:127.0.0.1:1")), "{end}");
    let burnt: Vec<f64> = sockets.iter().map(Socket::burnt_mm).collect();
    assert!((burnt.iter().sum::<f64>() - 4.0 * whole_mm(3)).abs() < 0.1, "{burnt:?}");
    assert!(burnt.iter().all(|mm| *mm > 1.0), "both had some of it: {burnt:?}");
    assert_eq!(jobs(&scratch).len(), 4);
}

#[test]
fn a_board_that_starts_anew_between_two_sheets_is_sent_no_more() {
    let (scratch, socket) = (two_sheets(&rows(3)), Socket::new(BoardSettings::default()));
    let member = format!("diode-400@{}", socket.port);
    let send = ["send", "job", "--yes", "--pause-s", "1", "--machines", &member];
    let mut running = Running::unattended(&scratch, &send);
    running.wait_for("sheet-02.nc");
    socket.strike(When::At(0.0), Fault::Reset);
    let (code, told) = running.ends();
    assert!(code == 3 && told.contains("the board restarted") && told.contains("not done: 2"), "{told}");
    assert!((socket.burnt_mm() - whole_mm(3)).abs() < 0.1, "{}", socket.burnt_mm());
}

#[test]
fn what_must_never_go_under_a_tool_is_refused_to_each_machine_and_doubts_are_told() {
    let scratch = two_sheets(&rows(3).replace("paper-160", "polyester-0.1"));
    let socket = Socket::new(BoardSettings::default());
    let member = format!("diode-400@{}", socket.port);
    let send = ["send", "job", "--yes", "--pause-s", "0", "--machines", &member];
    let (code, _, stderr) = run(&scratch, &send);
    assert!(code == 1 && stderr.contains("450 nm"), "{stderr}");
    assert_eq!(socket.burnt_mm(), 0.0);
    let scratch = two_sheets(&rows(3).replace("; material", "; UNCALIBRATED: cut first\n; material"));
    let (code, _, stderr) = run(&scratch, &[send.as_slice(), &["-p", "polyester-0.1"]].concat());
    assert!(code == 1 && stderr.contains("450 nm"), "{stderr}");
    let (code, stdout, stderr) = run(&scratch, &send);
    assert!(code == 0 && stdout.contains("UNCALIBRATED: nobody measured"), "{stdout}{stderr}");
}

#[test]
fn a_signal_while_the_machines_seek_their_switches_ends_that_at_once() {
    let mut hardware = homing();
    hardware.settings = hardware.settings.with(25, 200.0);
    let (scratch, socket) = (two_sheets(&rows(3)), Socket::new(hardware));
    let member = format!("diode-400@{}", socket.port);
    let send = ["send", "job", "--yes", "--home", "--pause-s", "0", "--machines", &member];
    let running = Running::unattended(&scratch, &send);
    let until = Instant::now() + Duration::from_secs(20);
    while !socket.is_moving() {
        assert!(Instant::now() < until, "it never homes");
        std::thread::sleep(Duration::from_millis(10));
    }
    running.signal("INT");
    let since = Instant::now();
    let (code, told) = running.ends();
    assert_eq!(code, 130, "{told}");
    assert!(since.elapsed() < Duration::from_secs(3) && !socket.is_moving(), "{:?}", since.elapsed());
}
