//! The real program sending: sheet by sheet, asked and answered, stopped by signals, against emulated boards.
#![cfg(unix)]

#[path = "send/bench.rs"]
mod bench;
#[path = "send/fleet.rs"]
mod fleet;
#[path = "send/placing.rs"]
mod placing;
#[path = "send/resume.rs"]
mod resume;
#[path = "send/rows.rs"]
mod rows;

use std::fs;
use std::time::{Duration, Instant};

use bench::{Running, Scratch, Socket, run};
use furbelow::emulator::{BoardSettings, Settings};
use furbelow::geom::V3;
use serde_json::Value;

/// Quick enough for tests, slow enough to interfere.
const FAST: [&str; 4] = ["-m", "diode-400", "--port", "emulator:50x"];

/// The keys of every event.
const KEYS: [&str; 14] = [
    "t_s",
    "event",
    "sheet",
    "sheets",
    "line",
    "acked",
    "executed",
    "state",
    "x_mm",
    "y_mm",
    "feed_mm_per_min",
    "power",
    "progress",
    "eta_s",
];

/// A head as `make` writes it, and a program that cuts to and fro along so many lines.
fn sheet(number: usize, machine: &str, cuts: usize) -> String {
    let head = format!(
        "; furbelow\n; sheet: {number}/2 A4 297 x 210 mm\n; machine: {machine}\n; material: paper-160\n; grain: along X\n; UNCALIBRATED: values from practice, uncalibrated; cut first\n"
    );
    let body: String =
        (0..cuts).map(|k| format!("X{}Y{:.3}\n", if k % 2 == 0 { 90 } else { 10 }, 5.0 + k as f64 * 1e-3)).collect();
    format!("{head}G21G90G94G17G54M5S0\nM4S0\nG0X10Y5\nG1X10S200F6000\n{body}M5S0\nG0X0Y0\nM2\n")
}

fn two_sheets(cuts: usize) -> Scratch {
    let scratch = Scratch::new();
    for number in [1, 2] {
        scratch.write(&format!("job/sheets/sheet-{number:02}.nc"), &sheet(number, "diode-400", cuts));
    }
    scratch
}

fn events(stdout: &str) -> Vec<Value> {
    stdout.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}"))).collect()
}

fn named<'a>(events: &'a [Value], name: &str) -> Vec<&'a Value> {
    events.iter().filter(|e| e["event"] == name).collect()
}

#[test]
fn a_folder_is_cut_sheet_by_sheet_and_the_next_one_waits_for_somebody() {
    let scratch = two_sheets(40);
    let mut running = Running::at_a_terminal(&scratch, &[["send", "job"].as_slice(), &FAST].concat());
    running.wait_for("all done?");
    let before = running.told();
    assert!(before.contains("UNCALIBRATED: nobody measured paper-160 on diode-400"), "{before}");
    assert!(before.contains("sheet 1 of 2: A4, 297 x 210 mm, grain along X"), "{before}");
    assert!(before.contains("[ ] eyewear for 450 nm"), "{before}");
    running.types("\n");
    running.wait_for("sheet-01.nc, ");
    // Impatience does not count as an answer to what has not been asked yet.
    running.types("\n\n");
    // One goes to stdout, the other to stderr: either may arrive first.
    for text in ["load sheet 2 of 2: A4, 297 x 210 mm, grain along X", "Enter goes on"] {
        if !running.told().contains(text) {
            running.wait_for(text);
        }
    }
    std::thread::sleep(Duration::from_millis(300));
    assert!(!running.told().contains("sheet-02.nc, "), "it goes on by itself: {}", running.told());
    running.types("\n");
    let (code, told) = running.ends();
    assert_eq!(code, 0, "{told}");
    assert!(told.contains("sheet-02.nc, ") && told.matches("100 %").count() == 2, "{told}");
}

#[test]
fn every_event_has_every_key_and_the_last_one_says_how_it_ended() {
    let scratch = two_sheets(40);
    let arguments = [["send", "job", "--yes", "--pause-s", "0", "--json"].as_slice(), &FAST].concat();
    let (code, stdout, stderr) = run(&scratch, &arguments);
    assert_eq!(code, 0, "{stderr}");
    let events = events(&stdout);
    for event in &events {
        assert!(KEYS.iter().all(|key| event.get(key).is_some()), "{event}");
    }
    assert!(events[0]["event"] == "warning" && events[0]["code"] == "uncalibrated", "{}", events[0]);
    let sheets = named(&events, "sheet");
    let places: Vec<_> = sheets.iter().map(|e| [&e["sheet"], &e["sheets"], &e["lines"]].map(Value::as_u64)).collect();
    assert_eq!(places, [[Some(1), Some(2), Some(53)], [Some(2), Some(2), Some(53)]]);
    assert_eq!(named(&events, "sheet-end").len(), 2);
    for number in [1, 2] {
        let of_sheet = |e: &&&Value| e["sheet"] == number && e["progress"].is_number();
        let statuses = named(&events, "status");
        let progress: Vec<f64> = statuses.iter().filter(of_sheet).map(|e| e["progress"].as_f64().unwrap()).collect();
        assert!(progress.len() > 3 && progress.is_sorted(), "{progress:?}");
        let last = statuses.iter().rfind(of_sheet).unwrap();
        assert!(last["progress"] == 1.0 && last["eta_s"] == 0.0 && last["power"] == 0.0, "{last}");
    }
    let end = events.last().unwrap();
    assert_eq!((end["event"].as_str(), end["outcome"].as_str()), (Some("end"), Some("done")));
    assert_eq!((&end["beam_off"], &end["position_kept"], &end["executed"]), (&true.into(), &true.into(), &53.into()));
}

#[test]
fn what_must_not_be_sent_is_refused_before_anything_moves() {
    let scratch = two_sheets(40);
    scratch.write("k40.nc", &sheet(1, "k40", 4));
    scratch.write("bad/1.nc", &sheet(1, "diode-400", 4));
    scratch.write("bad/2.nc", "G21G90\nG0X10Y10\nG0X999\n");
    scratch.write("film.nc", &sheet(1, "diode-400", 4).replace("paper-160", "polyester-0.1"));
    fs::create_dir(scratch.path("empty")).unwrap();
    let yes = ["--yes", "--json"];
    let cases: [(&[&str], i32, &str); 9] = [
        (&["job/sheets/sheet-01.nc"], 2, "nobody is there"),
        (&["job", "--yes"], 2, "--pause-s"),
        (&["job", "--yes", "--from-sheet", "3"], 2, "there are 2 sheets"),
        (&["k40.nc", yes[0]], 1, "made for k40"),
        (&["nothing.nc", yes[0]], 2, "nothing.nc cannot be read"),
        (&["empty", yes[0]], 2, "holds no .nc file"),
        (&["bad", yes[0], "--pause-s", "0"], 1, "2.nc must not be sent: line 3"),
        (&["film.nc", yes[0]], 1, "450 nm"),
        (&["job/sheets/sheet-02.nc", yes[0], "--home"], 1, "no homing switches"),
    ];
    for (arguments, expected, why) in cases {
        let (code, stdout, stderr) = run(&scratch, &[&["send", "--json"], arguments, &FAST].concat());
        assert_eq!(code, expected, "{arguments:?}: {stderr}");
        assert!(stderr.contains(why), "{arguments:?}: {stderr}");
        let events = events(&stdout);
        assert!(named(&events, "sheet").is_empty(), "{arguments:?}");
        assert_eq!(events.last().unwrap()["outcome"], "refused", "{arguments:?}");
    }
    let anyway = [["send", "k40.nc", "--yes", "--anyway"].as_slice(), &FAST].concat();
    let (code, _, stderr) = run(&scratch, &anyway);
    assert!(code == 0 && stderr.contains("UNCALIBRATED") && stderr.contains("those for k40"), "{stderr}");
    let rest = [["send", "job", "--yes", "--from-sheet", "2"].as_slice(), &FAST].concat();
    let (code, stdout, _) = run(&scratch, &rest);
    assert!(code == 0 && stdout.contains("sheet 2 of 2") && !stdout.contains("sheet-01"), "{stdout}");
}

#[test]
fn a_file_that_changes_while_it_is_sent_is_sent_as_it_was_and_one_that_changes_before_is_not_sent() {
    // Longer than what is read at once.
    let scratch = two_sheets(4000);
    let one = scratch.path("job/sheets/sheet-01.nc");
    let arguments = ["send", "job/sheets/sheet-01.nc", "--yes", "--json", "-m", "diode-400", "--port", "emulator:500x"];
    let mut running = Running::unattended(&scratch, &arguments);
    running.wait_for("\"state\":\"run\"");
    fs::write(&one, fs::read_to_string(&one).unwrap() + "; more\n").unwrap();
    let (code, told) = running.ends();
    assert_eq!(code, 0, "{told}");
    let ended = told.lines().find(|line| line.contains("sheet-end")).expect("an account");
    assert!(ended.contains("\"outcome\":\"done\"") && ended.contains("\"executed\":4013"), "{ended}");

    // The second sheet, while the first is cut.
    let scratch = two_sheets(100);
    let mut running = Running::unattended(
        &scratch,
        &[["send", "job", "--yes", "--pause-s", "0", "--json"].as_slice(), &FAST].concat(),
    );
    running.wait_for("\"state\":\"run\"");
    scratch.write("job/sheets/sheet-02.nc", &sheet(2, "diode-400", 3));
    let (code, told) = running.ends();
    assert!(code == 2 && told.contains("sheet-02.nc cannot be sent: it was changed"), "{code}: {told}");
}

#[test]
fn signals_brake_and_reset_and_a_second_one_resets_at_once() {
    // Once in real time: braking from 10,000 mm/min takes a third of a second, in which the second signal comes.
    let cases = [("INT", "20x", true), ("TERM", "20x", true), ("HUP", "20x", true), ("INT INT", "1x", false)];
    std::thread::scope(|scope| {
        for (signals, speed, kept) in cases {
            scope.spawn(move || is_stopped_by(signals, speed, kept));
        }
    });
}

fn is_stopped_by(signals: &str, speed: &str, kept: bool) {
    let scratch = two_sheets(0);
    scratch.write("job.nc", &sheet(1, "diode-400", 400).replace("F6000", "F10000"));
    let port = format!("emulator:{speed}");
    let arguments = ["send", "job.nc", "--yes", "--json", "-m", "diode-400", "--port", &port];
    let mut running = Running::unattended(&scratch, &arguments);
    // At full feed where the braking matters; a fast clock shows that in few reports.
    running.wait_for(if kept { "\"state\":\"run\"" } else { "\"feed_mm_per_min\":10000" });
    running.signal(signals);
    let since = Instant::now();
    let (code, told) = running.ends();
    assert_eq!(code, 130, "{signals}: {told}");
    assert!(since.elapsed() < Duration::from_secs(5), "{signals}");
    let end: Value = serde_json::from_str(told.lines().rfind(|l| l.contains("\"end\"")).expect("an end")).unwrap();
    assert_eq!((&end["outcome"], &end["beam_off"]), (&"stopped".into(), &true.into()), "{signals}: {end}");
    assert_eq!(end["position_kept"], kept, "{signals}: {end}");
}

#[test]
fn words_typed_while_it_runs_hold_resume_slow_down_and_stop() {
    let scratch = two_sheets(1200);
    let arguments = ["send", "job/sheets/sheet-01.nc", "--yes", "--json", "-m", "diode-400", "--port", "emulator:10x"];
    let mut running = Running::at_a_terminal(&scratch, &arguments);
    let eta = |running: &mut Running| {
        let line = running.wait_for("\"state\":\"run\"");
        serde_json::from_str::<Value>(&line).unwrap()["eta_s"].as_f64().unwrap()
    };
    let full_s = eta(&mut running);
    running.types("50\n");
    let since = Instant::now();
    while eta(&mut running) < 1.6 * full_s {
        assert!(since.elapsed() < Duration::from_secs(20), "the forecast does not follow the override");
    }
    running.types("hold\n");
    running.wait_for("\"state\":\"hold\"");
    running.types("resume\n");
    running.wait_for("\"state\":\"run\"");
    running.types("please?\n");
    running.wait_for("type hold, resume, stop");
    running.types("stop\n");
    let (code, told) = running.ends();
    assert!(code == 130 && told.contains("\"outcome\":\"stopped\""), "{told}");
}

#[test]
fn settings_that_would_spoil_the_job_are_set_right_when_that_is_agreed() {
    let scratch = two_sheets(10);
    scratch.write(
        "config/machines/old.toml",
        "schema = 1\nname = \"old\"\ninherits = \"diode-400\"\ntitle = \"Old board\"\nsource = \"test\"\n[controller]\nmax_s = 255\n",
    );
    scratch.write("old.nc", &sheet(1, "old", 10));
    let send = ["send", "old.nc", "-m", "old", "--port", "emulator:50x"];
    let (code, _, stderr) = run(&scratch, &[&send, ["--yes"].as_slice()].concat());
    assert!(code == 1 && stderr.contains("[$30=255: --fix sets it]"), "{stderr}");
    let (code, stdout, stderr) = run(&scratch, &[&send, ["--yes", "--fix", "--check-on-board"].as_slice()].concat());
    assert!(code == 0 && stdout.contains("$30=255 is set") && !stderr.contains("$30"), "{stdout}{stderr}");
    assert!(stdout.contains("the board takes every line"), "{stdout}");
    let mut running = Running::at_a_terminal(&scratch, &send);
    running.wait_for("set $30=255 on the board, for good? [y/N]");
    running.types("y\n");
    running.wait_for("$30=255 is set");
    running.wait_for("all done?");
    running.types("\n");
    let (code, told) = running.ends();
    assert_eq!(code, 0, "{told}");
}

#[test]
fn a_locked_machine_is_homed_in_the_same_connection_and_zero_is_where_the_head_stands() {
    let settings = [(22, 1.0), (20, 1.0), (23, 3.0), (25, 6000.0)];
    let settings = settings.iter().fold(Settings::default(), |s, (n, v)| s.with(*n, *v));
    let mut hardware = BoardSettings { settings, ..BoardSettings::default() };
    hardware.memory.offsets_mm[0] = V3::new(-398.0, -398.0, 0.0);
    let socket = Socket::new(hardware);
    let scratch = two_sheets(20);
    let send = ["send", "job/sheets/sheet-01.nc", "--yes", "-m", "diode-400", "--port", socket.port.as_str()];
    let (code, _, stderr) = run(&scratch, &send);
    assert!(code == 3 && stderr.contains("--home homes it first"), "{stderr}");
    let (code, stdout, stderr) = run(&scratch, &[&send, ["--home"].as_slice()].concat());
    assert!(code == 0 && !stderr.contains("not been homed"), "{stdout}{stderr}");
    assert!(socket.is_dark_now() && socket.burnt_mm() > 1500.0, "{}", socket.burnt_mm());

    // Without switches: work zero is far off until it is set here.
    let mut hardware = BoardSettings::default();
    hardware.memory.offsets_mm[0] = V3::new(50.0, 60.0, 0.0);
    let socket = Socket::new(hardware);
    let send = ["send", "job/sheets/sheet-01.nc", "--yes", "-m", "diode-400", "--port", socket.port.as_str()];
    let (code, _, stderr) = run(&scratch, &[&send, ["--zero"].as_slice()].concat());
    assert!(code == 0 && stderr.contains("the head stands idle at X0.000 Y0.000"), "{stderr}");
    assert!(socket.head_mm().norm() < 0.05, "the job ends at work zero, which is where it began: {}", socket.head_mm());
}

#[test]
fn whoever_stops_between_two_sheets_is_told_so_and_nothing_more_is_cut() {
    let scratch = two_sheets(5);
    let arguments = [["send", "job", "--yes", "--pause-s", "600", "--json"].as_slice(), &FAST].concat();
    let mut running = Running::unattended(&scratch, &arguments);
    running.wait_for("load sheet 2 of 2");
    running.signal("INT");
    let (code, told) = running.ends();
    assert_eq!(code, 130, "{told}");
    assert!(
        !told.contains("sheet-02.nc") && told.lines().any(|l| l.contains("\"end\"") && l.contains("stopped")),
        "{told}"
    );
}

#[test]
fn a_panic_unwinds_in_what_is_released_so_that_the_machine_is_stopped() {
    let manifest = include_str!("../Cargo.toml");
    assert!(
        !manifest.lines().any(|line| line.trim_start().starts_with("panic")),
        "Link stops the machine when it is dropped"
    );
}
