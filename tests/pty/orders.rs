//! Orders between jobs: jogging, homing, sleep.

use furbelow::stream::{Command, Event, Outcome, State, Trouble};

use super::stage::{Case, SQUARE, limited, plain};

pub const CASES: &[Case] = &[
    Case {
        name: "a jog goes where it should",
        board: plain,
        play: |stage| {
            stage.ready();
            stage.order(jog(5.0), None);
            stage.status("rest at 5 mm", |s| s.state == State::Idle && s.machine_mm == Some([5.0, 0.0, 0.0]));
        },
    },
    Case {
        name: "a cancelled jog stops on its way and the next job knows where",
        board: plain,
        play: |stage| {
            stage.ready();
            stage.give(Command::Jog { dx_mm: 300.0, dy_mm: 0.0, feed_mm_per_min: 1200.0 });
            stage.state(State::Jog);
            stage.give(Command::JogCancel);
            let status = stage.status("rest", |s| s.state == State::Idle);
            assert!(status.machine_mm.is_some_and(|p| p[0] < 250.0));
            stage.send(SQUARE);
            stage.done(8.0);
        },
    },
    Case {
        name: "a jog beyond the travel is refused and nothing moves",
        board: limited,
        play: |stage| {
            stage.ready();
            stage.order(jog(20.0), Some(15));
            stage.served.with(|board, _| assert_eq!(board.position_mm().x, 0.0));
        },
    },
    Case {
        name: "a job is refused while the machine jogs",
        board: plain,
        play: |stage| {
            stage.ready();
            stage.give(Command::Jog { dx_mm: 100.0, dy_mm: 0.0, feed_mm_per_min: 1200.0 });
            stage.state(State::Jog);
            stage.denied(Command::Run { lines: Box::new(std::iter::empty()) });
            stage.give(Command::JogCancel);
            stage.state(State::Idle);
        },
    },
    Case {
        name: "homing takes its time in silence and is known afterwards",
        board: limited,
        play: |stage| {
            stage.ready();
            stage.order(Command::Home, None);
            stage.status("home", |s| s.state == State::Idle && s.machine_mm.is_some_and(|p| p[0] == -2.0));
            stage.send(SQUARE);
            stage.done(8.0);
        },
    },
    Case {
        name: "homing that is stopped ends in an alarm",
        board: limited,
        play: |stage| {
            stage.ready();
            stage.order(jog(-80.0), None);
            stage.state(State::Idle);
            stage.give(Command::Home);
            stage.board_is(furbelow::emulator::State::Home);
            stage.give(Command::Reset);
            stage.event("alarm 6", |e| matches!(e, Event::Trouble(Trouble::Alarm { code: 6, .. })));
            stage.order(Command::Unlock, None);
        },
    },
    Case {
        name: "a sleeping board takes no job until it is reset",
        board: plain,
        play: |stage| {
            stage.ready();
            stage.order(Command::Sleep, None);
            stage.state(State::Sleep);
            stage.denied(Command::Run { lines: Box::new(std::iter::empty()) });
            stage.restart();
            stage.send(SQUARE);
            stage.done(8.0);
        },
    },
    Case {
        name: "a locked board takes no job until it is unlocked",
        board: limited,
        play: |stage| {
            stage.open();
            stage.event("ready", |e| matches!(e, Event::Ready(_)));
            stage.state(State::Alarm);
            stage.denied(Command::Run { lines: Box::new(std::iter::empty()) });
            stage.order(Command::Unlock, None);
            stage.state(State::Idle);
            stage.send(SQUARE);
            stage.done(8.0);
        },
    },
    Case {
        name: "a limit switch in rest leaves a board that hears a reset only",
        board: || super::stage::board_with(&[(21, 1.0)]),
        play: |stage| {
            stage.ready();
            stage.served.with(|board, _| board.set_switch(0, true));
            stage.event("alarm 1", |e| matches!(e, Event::Trouble(Trouble::Alarm { code: 1, .. })));
            stage.denied(Command::Unlock);
            stage.served.with(|board, _| board.set_switch(0, false));
            stage.restart();
            stage.send(SQUARE);
            stage.done(8.0);
        },
    },
    Case {
        name: "work zero is set where the tool stands",
        board: plain,
        play: |stage| {
            stage.ready();
            stage.order(jog(5.0), None);
            stage.state(State::Idle);
            stage.order(Command::Line("G10L20P1X0Y0".into()), None);
            stage.send("G1X1F6000\n");
            assert_eq!(stage.ending().outcome, Outcome::Done);
            stage.served.with(|board, _| assert!((board.position_mm().x - 6.0).abs() < 1e-9));
        },
    },
];

fn jog(dx_mm: f64) -> Command {
    Command::Jog { dx_mm, dy_mm: 0.0, feed_mm_per_min: 6000.0 }
}
