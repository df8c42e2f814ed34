//! What breaks: plugs, power, cables, limits.

use furbelow::emulator::Fault;
use furbelow::stream::{Event, Outcome, Trouble};
use std::time::Duration;

use super::stage::{Case, SQUARE, board_with, limited, plain};

pub const CASES: &[Case] = &[
    Case {
        name: "a board that resets in a job ends it",
        board: plain,
        play: |stage| {
            stage.cutting();
            stage.strike(Fault::Reset);
            let ending = stage.ending();
            assert_eq!(ending.outcome, Outcome::Failed(Trouble::Restarted));
            assert!(!ending.position_kept && ending.beam_off, "{ending:?}");
        },
    },
    Case {
        name: "a pulled plug ends the job and a board with its own power carries out what it holds",
        board: plain,
        play: |stage| {
            stage.cutting();
            stage.strike(Fault::Unplug { powered: true });
            let ending = stage.ending();
            assert!(matches!(ending.outcome, Outcome::Failed(Trouble::Link(_))), "{ending:?}");
            assert!(!ending.beam_off && ending.maybe == 4, "{ending:?}");
            stage.ends_dark();
            assert!((stage.burnt_mm() - 40.0).abs() < 0.01, "M4 is dark where it ends");
        },
    },
    Case {
        name: "a pulled plug darkens a board without power at once",
        board: plain,
        play: |stage| {
            stage.cutting();
            stage.strike(Fault::Unplug { powered: false });
            assert!(matches!(stage.trouble(), Trouble::Link(_)));
            stage.served.with(|board, _| assert!(board.power() == 0.0 && !board.is_moving()));
            assert!(stage.burnt_mm() < 40.0);
        },
    },
    Case {
        name: "a plug that goes in again brings a device with a board that lost its place",
        board: plain,
        play: |stage| {
            stage.cutting();
            stage.strike(Fault::Unplug { powered: false });
            assert!(matches!(stage.trouble(), Trouble::Link(_)));
            stage.strike(Fault::Replug);
            let burnt_mm = stage.burnt_mm();
            stage.ready();
            stage.served.with(|board, _| assert!(board.position_mm().x == 0.0 && board.head_mm().x > 1.0));
            stage.send(SQUARE);
            stage.done(burnt_mm + 8.0);
        },
    },
    Case {
        name: "a limit switch in a cut stops at once and is reset",
        board: || board_with(&[(21, 1.0)]),
        play: |stage| {
            stage.cutting();
            stage.served.with(|board, _| board.set_switch(0, true));
            assert!(matches!(stage.trouble(), Trouble::Alarm { code: 1, .. }));
            stage.served.with(|board, _| assert_eq!(board.power(), 0.0));
            stage.served.with(|board, _| board.set_switch(0, false));
            stage.restart();
        },
    },
    Case {
        name: "a way out of the machine is an alarm and is reset",
        board: limited,
        play: |stage| {
            stage.ready();
            stage.send("M4S500\nG1X50Y50F6000\nX95\nX50\n");
            assert!(matches!(stage.trouble(), Trouble::Alarm { code: 2, .. }));
            stage.board_is(furbelow::emulator::State::Alarm);
        },
    },
    Case {
        name: "a lost ok is noticed when the machine rests",
        board: plain,
        play: |stage| {
            stage.ready();
            stage.strike(Fault::StuckOk(1));
            stage.send(SQUARE);
            let trouble = stage.trouble();
            assert!(matches!(trouble, Trouble::LostAnswer { lines: 1, .. }), "{trouble:?}");
        },
    },
    Case {
        name: "an ok that came in pieces is noticed",
        board: plain,
        play: |stage| {
            stage.ready();
            let strokes: String = (1..=60).map(|k| format!("G1X{}F1200\n", 2 + k % 2)).collect();
            stage.send(&format!("M4S500\nG0X2\n{strokes}M5S0\n"));
            stage.lit();
            // The answers and reports of a moment.
            stage.strike(Fault::DropOut(120));
            let trouble = stage.trouble();
            assert!(matches!(trouble, Trouble::LostAnswer { .. } | Trouble::Silent(_)), "{trouble:?}");
        },
    },
    Case {
        name: "a torn line is noticed",
        board: plain,
        play: |stage| {
            stage.ready();
            stage.strike(Fault::TornLine);
            stage.send(SQUARE);
            let trouble = stage.trouble();
            let noticed =
                matches!(trouble, Trouble::LostAnswer { .. } | Trouble::Refused { .. } | Trouble::OffPlan { .. });
            assert!(noticed, "{trouble:?}");
        },
    },
    Case {
        name: "garbage from the board harms nobody",
        board: plain,
        play: |stage| {
            stage.cutting();
            stage.strike(Fault::CorruptOut(300));
            let ending = stage.ending();
            let noticed = matches!(ending.outcome, Outcome::Done | Outcome::Failed(_));
            assert!(noticed && ending.beam_off, "{ending:?}");
        },
    },
    Case {
        name: "messages between the answers are told and no answers",
        board: plain,
        play: |stage| {
            stage.cutting();
            stage.strike(Fault::Chatter(20));
            stage.done(40.0);
            let told = stage.events.iter().filter(|e| matches!(e, Event::Message(m) if m.starts_with("INFO"))).count();
            assert_eq!(told, 20);
        },
    },
    Case {
        name: "a link that goes dead in a job ends it, and is told to be switched off by hand",
        board: plain,
        play: |stage| {
            stage.cutting();
            stage.strike(Fault::DropOut(u32::MAX));
            stage.strike(Fault::DropIn(u32::MAX));
            let ending = stage.ending();
            assert!(matches!(ending.outcome, Outcome::Failed(Trouble::Silent(_))), "{ending:?}");
            assert!(!ending.beam_off && ending.account().contains("BY HAND"), "{}", ending.account());
        },
    },
    Case {
        name: "a board that hears and says nothing is stopped all the same",
        board: plain,
        play: |stage| {
            stage.ready();
            stage.send("M4S500\nG1X300F1200\n");
            stage.lit();
            stage.strike(Fault::DropOut(u32::MAX));
            let ending = stage.ending();
            assert!(matches!(ending.outcome, Outcome::Failed(Trouble::Silent(_))), "{ending:?}");
            std::thread::sleep(Duration::from_millis(50));
            stage.served.with(|board, _| assert!(!board.is_moving() && board.power() == 0.0));
            assert!(stage.burnt_mm() < 200.0);
        },
    },
];
