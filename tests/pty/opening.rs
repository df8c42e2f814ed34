//! Opening: boards that greet, that do not, that are not there.

use furbelow::emulator::{BoardSettings, Fault};
use furbelow::stream::{Address, Event, Firmware, Trouble};
use std::time::{Duration, Instant};

use super::stage::{Case, SQUARE, Stage, plain};

pub const CASES: &[Case] = &[
    Case {
        name: "a board that greets is asked and ready",
        board: plain,
        play: |stage| {
            stage.ready();
            knows(stage, Firmware::Grbl, 128);
        },
    },
    Case {
        name: "a board that does not reset on opening is asked without a reset",
        board: || BoardSettings { resets_on_open: false, ..plain() },
        play: |stage| {
            std::thread::sleep(Duration::from_millis(200));
            stage.ready();
            knows(stage, Firmware::Grbl, 128);
        },
    },
    Case {
        name: "bytes in the boot loader's time are lost and nothing else is",
        board: || BoardSettings { boot_s: 1.0, ..plain() },
        play: |stage| {
            let mut port = Address::Device(stage.served.path().to_owned()).open(115_200).unwrap();
            std::thread::sleep(Duration::from_millis(300));
            port.write(b"G1X50F6000\n").unwrap();
            std::thread::sleep(Duration::from_millis(1200));
            stage.served.with(|board, _| assert_eq!(board.position_mm().x, 0.0));
            stage.let_go(port);
            let began = Instant::now();
            stage.ready();
            assert!(began.elapsed() > Duration::from_millis(900));
        },
    },
    Case {
        name: "grblHAL is known by its banner",
        board: || BoardSettings { resets_on_open: true, ..BoardSettings::grbl_hal() },
        play: |stage| {
            stage.ready();
            knows(stage, Firmware::GrblHal, 1024);
            stage.send(SQUARE);
            stage.done(8.0);
        },
    },
    Case {
        name: "grblHAL without banner is known by what it answers",
        board: BoardSettings::grbl_hal,
        play: |stage| {
            std::thread::sleep(Duration::from_millis(500));
            stage.ready();
            knows(stage, Firmware::GrblHal, 1024);
        },
    },
    Case {
        name: "FluidNC is known through its boot messages",
        board: || BoardSettings { boot_s: 0.1, ..BoardSettings::fluid_nc() },
        play: |stage| {
            stage.ready();
            knows(stage, Firmware::FluidNc, 128);
            stage.send(SQUARE);
            stage.done(8.0);
        },
    },
    Case {
        name: "a board at another baud rate is silent",
        board: plain,
        play: |stage| {
            stage.strike(Fault::CorruptIn(u32::MAX));
            stage.strike(Fault::CorruptOut(u32::MAX));
            silent(stage);
        },
    },
    Case { name: "a port without a board is silent", board: || BoardSettings { boot_s: 1e9, ..plain() }, play: silent },
    Case {
        name: "a port that another program holds is refused",
        board: plain,
        play: |stage| {
            stage.ready();
            let second = Address::Device(stage.served.path().to_owned()).open(115_200);
            assert!(second.is_err());
            stage.send(SQUARE);
            stage.done(8.0);
        },
    },
    Case {
        name: "a port can be closed and opened again",
        board: plain,
        play: |stage| {
            for _ in 0..3 {
                stage.ready();
                stage.close();
            }
            stage.ready();
            stage.send(SQUARE);
            stage.done(8.0);
        },
    },
];

fn knows(stage: &Stage, firmware: Firmware, rx_bytes: usize) {
    let ready = stage.events.iter().find_map(|e| if let Event::Ready(board) = e { Some(board) } else { None });
    let board = ready.expect("it was ready");
    assert_eq!((board.firmware, board.rx_bytes), (firmware, rx_bytes));
    assert_eq!(board.settings.get(&30), Some(&1000.0));
}

fn silent(stage: &mut Stage) {
    stage.open();
    stage.event("silence", |e| matches!(e, Event::Trouble(Trouble::Silent(_))));
}
