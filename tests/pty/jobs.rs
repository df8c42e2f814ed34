//! Jobs: whole, held, stopped, refused.

use furbelow::stream::{Command, Event, Outcome, Override, State, Trouble};

use super::stage::{Case, LONG_CUT, SQUARE, board_with, plain};

pub const CASES: &[Case] = &[
    Case {
        name: "a small job is burnt whole",
        board: plain,
        play: |stage| {
            stage.ready();
            stage.send(SQUARE);
            stage.done(8.0);
        },
    },
    Case {
        name: "one job after the other",
        board: plain,
        play: |stage| {
            stage.ready();
            for k in 1..=3 {
                stage.send(SQUARE);
                stage.done(8.0 * f64::from(k));
            }
        },
    },
    Case {
        name: "a job is held in the dark and goes on to the same end",
        board: plain,
        play: |stage| {
            stage.cutting();
            stage.give(Command::Hold);
            stage.state(State::Hold(0));
            stage.served.with(|board, _| assert_eq!(board.power(), 0.0));
            stage.give(Command::Resume);
            stage.done(40.0);
        },
    },
    Case {
        name: "an open door stops a job until it is closed",
        board: plain,
        play: |stage| {
            stage.cutting();
            stage.give(Command::Door);
            stage.state(State::Door(0));
            stage.served.with(|board, _| assert_eq!(board.power(), 0.0));
            stage.give(Command::Resume);
            stage.done(40.0);
        },
    },
    Case {
        name: "a stop with the door open keeps the position",
        board: plain,
        play: |stage| {
            stage.cutting();
            stage.give(Command::Door);
            stage.state(State::Door(0));
            stage.give(Command::Stop);
            let ending = stage.ending();
            assert!(ending.outcome == Outcome::Stopped && ending.position_kept && ending.beam_off, "{ending:?}");
        },
    },
    Case {
        name: "a stop in a cut brakes, darkens and keeps the position",
        board: plain,
        play: |stage| {
            stage.cutting();
            stage.give(Command::Stop);
            let ending = stage.ending();
            assert!(ending.outcome == Outcome::Stopped && ending.position_kept && ending.beam_off, "{ending:?}");
            assert!(stage.burnt_mm() < 40.0);
            stage.state(State::Idle);
            stage.send("G1X0F6000\n");
            assert_eq!(stage.ending().outcome, Outcome::Done);
        },
    },
    Case {
        name: "a stop is dark in time",
        board: plain,
        play: |stage| {
            stage.cutting();
            stage.give(Command::Stop);
            stage.dark_soon();
        },
    },
    Case {
        name: "a stop in a constant beam's cut is dark in time",
        board: plain,
        play: |stage| {
            stage.ready();
            stage.send(&LONG_CUT.replace("M4", "M3"));
            stage.lit();
            stage.give(Command::Stop);
            stage.dark_soon();
        },
    },
    Case {
        name: "a second stop does not wait",
        board: plain,
        play: |stage| {
            stage.cutting();
            stage.give(Command::Stop);
            stage.give(Command::Stop);
            stage.dark_soon();
        },
    },
    Case {
        name: "a reset in motion is told to have lost the position",
        board: plain,
        play: |stage| {
            stage.cutting();
            stage.give(Command::Reset);
            let ending = stage.ending();
            assert!(ending.outcome == Outcome::Stopped && !ending.position_kept && ending.beam_off, "{ending:?}");
        },
    },
    Case {
        name: "whoever goes away in a job leaves a stopped machine",
        board: plain,
        play: |stage| {
            stage.cutting();
            stage.close();
            stage.served.with(|board, _| assert!(!board.is_moving() && board.power() == 0.0));
            assert!(stage.burnt_mm() < 40.0);
        },
    },
    Case {
        name: "an error in the counted window names its line and stops",
        board: plain,
        play: |stage| {
            stage.ready();
            let short = "G1X1F600\nX2\nX3\nG5\nX4\nX5\n";
            stage.send(&format!("M4S500\n{short}"));
            let trouble = stage.trouble();
            assert!(matches!(trouble, Trouble::Refused { line: 5, code: 20, .. }), "{trouble:?}");
        },
    },
    Case {
        name: "a byte that must not be sent stops the job before it",
        board: plain,
        play: |stage| {
            stage.ready();
            stage.send("G1X1F6000\nG1X2?\n");
            assert_eq!(stage.trouble(), Trouble::Unsendable { line: 2, found: '?' });
        },
    },
    Case {
        name: "a file that cannot be read on stops the job",
        board: plain,
        play: |stage| {
            stage.ready();
            let broken = [Ok("G1X1F6000".to_owned()), Err(std::io::Error::other("the disk is gone"))];
            stage.give(Command::Run { lines: Box::new(broken.into_iter()) });
            assert!(matches!(stage.trouble(), Trouble::Unreadable { line: 2, .. }));
        },
    },
    Case {
        name: "a pause waits for people and is no lost answer",
        board: plain,
        play: |stage| {
            stage.ready();
            stage.send("G1X1F6000\nM0\nX2\n");
            stage.state(State::Hold(0));
            std::thread::sleep(std::time::Duration::from_millis(1000));
            stage.give(Command::Resume);
            assert_eq!(stage.ending().outcome, Outcome::Done);
        },
    },
    Case {
        name: "a dwell is no lost answer",
        board: plain,
        play: |stage| {
            stage.ready();
            stage.send("G1X1F6000\nG4P1.5\nX2\n");
            assert_eq!(stage.ending().outcome, Outcome::Done);
        },
    },
    Case {
        name: "lines that write the board's memory lose nothing",
        board: plain,
        play: |stage| {
            stage.ready();
            let shifts: String = (1..=4).map(|k| format!("G10L2P1X{k}.3Y-{k}.7\nG1X1F6000\nX2\nX3\nX1\n")).collect();
            stage.send(&format!("{shifts}G10L2P1X0Y0\nG0X0Y0\n"));
            assert_eq!(stage.ending().outcome, Outcome::Done);
            stage.served.with(|board, _| assert_eq!(board.bytes_lost(), 0));
        },
    },
    Case {
        name: "check mode finds an error and moves nothing",
        board: plain,
        play: |stage| {
            stage.ready();
            stage.order(Command::Line("$C".into()), None);
            stage.state(State::Check);
            stage.send("G1X5F600\nG5\n");
            assert!(matches!(stage.trouble(), Trouble::Refused { line: 2, code: 20, .. }));
            stage.served.with(|board, _| assert_eq!(board.position_mm().x, 0.0));
        },
    },
    Case {
        name: "check mode passes a good job and is left",
        board: plain,
        play: |stage| {
            stage.ready();
            stage.order(Command::Line("$C".into()), None);
            stage.state(State::Check);
            stage.send(SQUARE);
            assert_eq!(stage.ending().outcome, Outcome::Done);
            assert_eq!(stage.burnt_mm(), 0.0);
            stage.give(Command::Line("$C".into()));
            stage.event("its restart", |e| matches!(e, Event::Restarted));
            stage.state(State::Idle);
        },
    },
    Case {
        name: "overrides show in the reports and change the time",
        board: || board_with(&[(10, 3.0)]),
        play: |stage| {
            stage.cutting();
            stage.give(Command::Override(Override::Feed, 130));
            stage.give(Command::Override(Override::Power, 80));
            stage.status("both overrides", |s| s.overrides == Some([130, 100, 80]));
            stage.done(40.0);
        },
    },
    Case {
        name: "reports in inches and in work coordinates are read the same",
        board: || board_with(&[(13, 1.0), (10, 2.0)]),
        play: |stage| {
            stage.ready();
            stage.send("G21\nM4S500\nG1X25.4F6000\nM5\n");
            stage.done(25.4);
        },
    },
];
