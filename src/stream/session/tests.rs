//! The session against the scripted board.

use std::time::Duration;

use proptest::prelude::*;

use super::super::event::{Action, Command, Event, Outcome};
use super::super::realtime::Override;
use super::super::status::{State, Status};
use super::super::trouble::Trouble;
use super::scripted::{BLOCKS, Bench, Board, RX};
use super::{Session, Settings};

/// A program of `n` moves with the beam on, each line with its own number in it.
fn moves(n: usize) -> Vec<String> {
    std::iter::once("M4 S300 ; light".to_owned()).chain((1..n).map(|k| format!("G1 X{k} F3000"))).collect()
}

#[test]
fn a_board_is_asked_before_it_is_used() {
    let bench = Bench::ready(Board::new(5));
    let ready = bench.events.iter().find_map(|e| if let Event::Ready(board) = e { Some(board) } else { None }).unwrap();
    assert_eq!((ready.version.as_str(), ready.blocks, ready.rx_bytes), ("1.1h.20190830", 15, 128));
    assert_eq!(ready.settings.get(&30), Some(&1000.0));
    assert!(!bench.board.realtime.contains(&0x18), "opening never resets");
}

#[test]
fn a_board_without_banner_is_asked_and_not_reset() {
    let bench = Bench::ready(Board { banner: false, ..Board::new(5) });
    assert!(bench.now_ms >= 3000 && !bench.board.realtime.contains(&0x18));
    assert!(bench.session.is_ready());
}

#[test]
fn a_dead_port_is_said_to_be_dead() {
    let mut bench = Bench {
        session: Session::new(Duration::ZERO, Settings::default()),
        board: Board { mute: true, ..Board::new(5) },
        now_ms: 0,
        events: Vec::new(),
    };
    bench.run_until(8_000, |b| !b.events.is_empty());
    assert!(matches!(bench.events[0], Event::Trouble(Trouble::Silent(_))));
    bench.command(Command::Run { lines: Box::new(std::iter::empty()) });
    assert!(matches!(bench.events[1], Event::Denied(_)));
}

#[test]
fn every_line_arrives_once_in_order_and_the_receive_buffer_never_overflows() {
    let mut bench = Bench::ready(Board::new(7));
    bench.send(moves(500));
    let ending = bench.end(20_000);
    assert_eq!(ending.outcome, Outcome::Done);
    let expected: Vec<String> = moves(500).iter().map(|l| l.split(" ;").next().unwrap().replace(' ', "")).collect();
    assert_eq!(bench.board.lines[..500], expected);
    assert_eq!(bench.board.lines[500..], ["M5S0"], "the beam is switched off behind every job");
    assert!(bench.board.fullest_rx <= RX && bench.board.fullest_rx > RX - 12, "{}", bench.board.fullest_rx);
    assert_eq!((ending.progress.executed, ending.maybe), (500, 500));
    // The planner never ran dry: 499 blocks of 8 ticks.
    assert!(bench.now_ms < 499 * 8 + 1000, "{} ms", bench.now_ms);
}

#[test]
fn status_is_asked_for_five_to_ten_times_a_second() {
    let mut bench = Bench::ready(Board::new(5));
    bench.events.clear();
    let end = bench.now_ms + 10_000;
    bench.run_until(10_001, |b| b.now_ms >= end);
    let reports = bench.events.iter().filter(|e| matches!(e, Event::Status(..))).count();
    assert!((50..=100).contains(&reports), "{reports}");
}

#[test]
fn the_work_position_is_told_in_every_report() {
    let bench = Bench::ready(Board::new(5));
    let Some(Event::Status(status, _)) = bench.events.iter().rfind(|e| matches!(e, Event::Status(..))) else {
        panic!()
    };
    assert_eq!((status.machine_mm, status.work_mm), (Some([1.0, 2.0, 0.0]), Some([5.0, 2.0, 0.0])));
}

#[test]
fn a_stop_holds_waits_for_rest_and_resets() {
    let mut bench = Bench::ready(Board::new(20));
    bench.send(moves(300));
    bench.run_until(5_000, |b| b.board.lines.len() > 60);
    bench.command(Command::Stop);
    let sent = bench.session.job.as_ref().unwrap().ledger.progress().sent;
    let ending = bench.end(1_000);
    assert_eq!(bench.board.realtime, [b'!', 0x18]);
    assert_eq!((&ending.outcome, ending.position_kept, ending.beam_off), (&Outcome::Stopped, true, true));
    assert_eq!(ending.maybe, sent);
    let executed = 60 - BLOCKS;
    assert!(ending.progress.executed + 6 >= executed && ending.progress.executed <= executed + 6, "{ending:?}");
    assert!(ending.account().contains("the position is kept"));
    assert!(!bench.events.iter().any(|e| matches!(e, Event::Trouble(_))));
    // Nothing is left that could light the beam.
    let lines = bench.board.lines.len();
    let end = bench.now_ms + 3_000;
    bench.run_until(3_001, |b| b.now_ms >= end);
    assert_eq!(bench.board.lines.len(), lines);
    assert!(!bench.board.beam && bench.session.is_ready());
}

#[test]
fn a_second_stop_resets_at_once_and_says_that_the_position_is_in_doubt() {
    let mut bench = Bench::ready(Board::new(20));
    bench.send(moves(300));
    bench.run_until(5_000, |b| b.board.lines.len() > 60);
    bench.command(Command::Stop);
    bench.command(Command::Stop);
    let ending = bench.end(100);
    assert_eq!(bench.board.realtime, [b'!', 0x18]);
    assert!(!ending.position_kept && ending.beam_off);
    assert!(ending.account().contains("home or zero"));
}

#[test]
fn an_error_inside_the_window_names_its_line_and_stops() {
    let mut bench = Bench::ready(Board { refuse: Some((40, 20)), ..Board::new(20) });
    let mut lines = moves(300);
    lines.insert(3, "(a comment that is not sent)".into());
    bench.send(lines);
    let ending = bench.end(5_000);
    // Line 40 the board read is line 41 of the file.
    let Outcome::Failed(Trouble::Refused { line, text, code, .. }) = &ending.outcome else { panic!("{ending:?}") };
    assert_eq!((*line, text.as_str(), *code), (41, "G1X39F3000", 20));
    assert_eq!(bench.board.realtime, [b'!', 0x18]);
    assert!(ending.position_kept && bench.board.lines.len() < 70);
}

#[test]
fn a_lost_answer_is_noticed_when_the_machine_rests() {
    let mut bench = Bench::ready(Board { lose_answers_to: vec![50, 120], ..Board::new(3) });
    bench.send(moves(200));
    let ending = bench.end(10_000);
    assert!(matches!(ending.outcome, Outcome::Failed(Trouble::LostAnswer { lines: 2, .. })), "{ending:?}");
    assert!(ending.progress.executed < 200 && ending.maybe == 200);
}

#[test]
fn a_dwell_is_no_lost_answer() {
    let mut bench = Bench::ready(Board::new(3));
    bench.session.window.push(super::super::window::Entry {
        text: "G4P2".into(),
        kind: super::super::window::Kind::Job(1),
        alone: false,
        dwell_s: 2.0,
        effect: Default::default(),
    });
    bench.send(Vec::new());
    let end = bench.now_ms + 2_500;
    bench.run_until(2_501, |b| b.now_ms >= end);
    assert!(bench.ending().is_none());
    assert!(matches!(bench.end(2_000).outcome, Outcome::Failed(Trouble::LostAnswer { first: 1, lines: 1 })));
}

#[test]
fn a_banner_in_the_middle_of_a_job_ends_it_and_forgets_what_was_under_way() {
    let mut bench = Bench::ready(Board::new(20));
    bench.send(moves(300));
    bench.run_until(5_000, |b| b.board.lines.len() > 60);
    bench.board.boot(true);
    let ending = bench.end(50);
    assert_eq!(ending.outcome, Outcome::Failed(Trouble::Restarted));
    assert!(!ending.position_kept && bench.session.window.is_empty());
    assert!(bench.session.is_ready());
    assert_eq!(bench.board.realtime, [0x18], "lines that were on the wire are thrown away");
}

#[test]
fn an_alarm_in_a_job_resets_and_says_what_to_do() {
    let mut bench = Bench::ready(Board::new(20));
    bench.send(moves(300));
    bench.run_until(5_000, |b| b.board.lines.len() > 60);
    bench.board.say("ALARM:1");
    bench.board.state = State::Alarm;
    let ending = bench.end(200);
    assert!(matches!(ending.outcome, Outcome::Failed(Trouble::Alarm { code: 1, .. })));
    assert_eq!(bench.board.realtime, [0x18]);
    assert!(bench.events.iter().any(|e| matches!(e, Event::Trouble(t) if t.to_string().contains("limit switch"))));
}

#[test]
fn after_a_limit_alarm_nothing_but_a_reset_is_sent() {
    let mut bench = Bench::ready(Board::new(20));
    bench.board.say("ALARM:2");
    bench.tick();
    bench.command(Command::Unlock);
    assert!(matches!(bench.events.last(), Some(Event::Denied(reason)) if reason.contains("reset")));
    bench.command(Command::Reset);
    bench.run_until(100, |b| b.events.contains(&Event::Restarted));
    bench.command(Command::Unlock);
    bench.run_until(100, |b| b.events.contains(&Event::Answered { line: "$X".into(), error: None }));
}

#[test]
fn a_silent_board_is_held_then_reset_and_the_report_says_so() {
    let mut bench = Bench::ready(Board::new(20));
    bench.send(moves(300));
    bench.run_until(5_000, |b| b.board.lines.len() > 60);
    bench.board.mute = true;
    let ending = bench.end(11_000);
    assert!(matches!(ending.outcome, Outcome::Failed(Trouble::Silent(_))));
    assert_eq!(bench.board.realtime, [b'!', 0x18]);
    assert!(!ending.beam_off && ending.account().contains("BY HAND"));
    assert!(ending.maybe > ending.progress.acked - 1 && ending.progress.executed < ending.progress.acked);
}

#[test]
fn a_lost_port_ends_the_job_with_what_the_board_may_still_do() {
    let mut bench = Bench::ready(Board::new(20));
    bench.send(moves(300));
    bench.run_until(5_000, |b| b.board.lines.len() > 60);
    let actions = bench.session.on_link_lost(bench.now(), "unplugged");
    assert!(!actions.iter().any(|a| matches!(a, Action::Write(_))));
    bench.take(actions);
    let ending = bench.ending().unwrap();
    assert!(matches!(ending.outcome, Outcome::Failed(Trouble::Link(_))));
    assert!(ending.maybe >= bench.board.lines.len());
}

#[test]
fn a_line_that_writes_the_boards_memory_goes_alone_and_at_rest() {
    let mut bench = Bench::ready(Board::new(20));
    bench.send(["G1X1F100", "G1X2", "G10L20P1X0", "G1X3", "G1X4"].map(String::from));
    bench.run_until(2_000, |b| b.session.window.first().is_some_and(|entry| entry.text.starts_with("G10")));
    assert_eq!((bench.board.lines.len(), bench.session.window.len()), (2, 1));
    assert!(bench.board.blocks.is_empty(), "the machine was at rest");
    assert_eq!(bench.end(3_000).outcome, Outcome::Done);
}

#[test]
fn what_must_not_be_sent_stops_the_job_before_it_is() {
    let mut bench = Bench::ready(Board::new(5));
    bench.send(["G1X1F100", "G1X2!", "G1X3"].map(String::from));
    let ending = bench.end(2_000);
    assert_eq!(ending.outcome, Outcome::Failed(Trouble::Unsendable { line: 2, found: '!' }));
    assert!(bench.board.lines.len() <= 1);
}

#[test]
fn a_file_that_cannot_be_read_on_stops_the_job() {
    let mut bench = Bench::ready(Board::new(5));
    let lines = ["G1X1F100"].into_iter().map(|l| Ok(l.to_owned())).chain([Err(std::io::Error::other("disk"))]);
    bench.command(Command::Run { lines: Box::new(lines) });
    assert!(matches!(bench.end(2_000).outcome, Outcome::Failed(Trouble::Unreadable { line: 2, .. })));
}

#[test]
fn an_end_in_the_wrong_place_is_no_success() {
    for (off_mm, outcome) in [
        (0.0, Outcome::Done),
        (0.1, Outcome::Failed(Trouble::WrongPlace { expected_mm: [9.0, 2.0], found_mm: [9.1, 2.0] })),
    ] {
        let mut bench = Bench::ready(Board::new(100));
        bench.send(moves(10));
        bench.run_until(5_000, |b| b.board.blocks.len() == 1 && b.board.lines.len() >= 10);
        bench.board.blocks[0].1 += off_mm;
        assert_eq!(bench.end(5_000).outcome, outcome);
    }
}

#[test]
fn a_program_may_end_where_its_own_words_do_not_say() {
    // Zero is laid elsewhere on the way, or the way is told in steps from where the head stands.
    for lines in [["G1X9F3000", "G92X20", "G1X20"], ["G91", "G1X0F3000", "G90"]] {
        let mut bench = Bench::ready(Board::new(5));
        bench.board.x_mm = 9.0;
        bench.run_until(1_000, |b| b.session.status.as_ref().is_some_and(|s| s.work_mm == Some([9.0, 2.0, 0.0])));
        bench.board.still = true;
        bench.send(lines.map(String::from));
        assert_eq!(bench.end(5_000).outcome, Outcome::Done, "{lines:?}");
    }
}

#[test]
fn an_answer_too_many_ends_the_job() {
    let mut bench = Bench::ready(Board::new(50));
    bench.send(moves(10));
    bench.run_until(500, |b| b.session.job.as_ref().is_some_and(|j| j.closed) && b.session.window.is_empty());
    bench.board.say("ok");
    assert_eq!(bench.end(2_000).outcome, Outcome::Failed(Trouble::ExtraAnswer));
}

#[test]
fn a_door_opened_in_a_long_line_is_no_crawling() {
    let mut bench = Bench::ready(Board::new(60_000));
    for (number, value) in [(110, 6000.0), (111, 6000.0), (120, 300.0), (121, 300.0)] {
        bench.session.board.settings.insert(number, value);
    }
    bench.send(["G1X105F3000"].map(String::from));
    bench.run_until(1_000, |b| b.board.lines.len() == 1);
    // Two seconds of way, five at the door, two of way.
    for k in 0..60_u32 {
        let (state, at_s) = match k {
            0..13 => ("Run", 0.15 * f64::from(k)),
            13..46 => ("Door:0", 1.95),
            _ => ("Run", 0.15 * f64::from(k) - 4.95),
        };
        bench.session.now = bench.now() + Duration::from_millis(150 * u64::from(k));
        let report = format!("<{state}|MPos:{:.3},2.000,0.000|FS:0,0>", 1.5 + 5.0 * at_s);
        let status = Status::parse(&report, false).unwrap();
        assert_eq!(bench.session.locate(&status), None, "report {k}");
    }
}

#[test]
fn overrides_go_one_at_a_time_until_they_show() {
    let mut bench = Bench::ready(Board::new(20));
    bench.send(moves(300));
    bench.command(Command::Override(Override::Feed, 122));
    bench.run_until(3_000, |b| b.board.feed_percent == 122);
    assert_eq!(bench.board.realtime, [0x91, 0x91, 0x93, 0x93]);
}

#[test]
fn a_held_job_goes_on_where_it_was() {
    let mut bench = Bench::ready(Board::new(10));
    bench.send(moves(200));
    bench.run_until(5_000, |b| b.board.lines.len() > 60);
    bench.command(Command::Hold);
    let end = bench.now_ms + 5_000;
    bench.run_until(5_001, |b| b.now_ms >= end);
    assert!(bench.ending().is_none() && bench.board.lines.len() < 80);
    bench.command(Command::Resume);
    assert_eq!(bench.end(5_000).outcome, Outcome::Done);
    assert_eq!(bench.board.lines.len(), 201);
}

#[test]
fn a_long_job_is_streamed_and_not_held() {
    let mut bench = Bench::ready(Board::new(0));
    bench.send((1..60_000).map(|k| format!("G1X{k}")));
    let mut most = 0;
    while bench.ending().is_none() {
        bench.tick();
        bench.events.retain(|e| matches!(e, Event::Ended(_)));
        let held = bench.session.job.as_ref().map_or(0, |j| j.ledger.held());
        most = most.max(held + bench.session.window.len());
        bench.board.lines.truncate(1);
    }
    assert_eq!(bench.ending().unwrap().outcome, Outcome::Done);
    assert!(most <= BLOCKS + 6 + RX / 2, "{most} lines were held");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn whatever_the_board_says_no_more_than_its_buffer_is_ever_under_way_and_a_stop_is_the_last_word(
        block_ms in 0_u64..12, lengths in prop::collection::vec(1_usize..70, 1..120),
        lost in prop::collection::vec(1_usize..100, 0..3), garbage_at in prop::option::of(1_u64..400),
        stop_at in prop::option::of(1_u64..600),
    ) {
        let mut bench = Bench::ready(Board { lose_answers_to: lost, ..Board::new(block_ms) });
        let count = lengths.len();
        bench.send(lengths.into_iter().map(|n| format!("G1X{}", "1".repeat(n))));
        let begin = bench.now_ms;
        while bench.ending().is_none() {
            prop_assert!(bench.now_ms < begin + 20_000, "the job never ends");
            if garbage_at == Some(bench.now_ms - begin) {
                bench.board.out.extend(b"\xff<Ru|k\r\n");
            }
            if stop_at == Some(bench.now_ms - begin) {
                bench.command(Command::Stop);
            }
            bench.tick();
            prop_assert!(bench.board.fullest_rx <= RX && bench.session.window.bytes() <= RX);
        }
        let ending = bench.ending().unwrap().clone();
        let read = bench.board.lines.iter().filter(|l| l.starts_with('G')).count();
        // An honest account: nothing is done that is not admitted, and what is said to be done was read.
        prop_assert!(ending.progress.executed <= read && read <= ending.maybe, "{:?}, {} read", ending, read);
        if ending.outcome == Outcome::Done {
            prop_assert_eq!((read, ending.progress.executed), (count, count));
        }
        prop_assert!(!bench.board.beam);
    }
}
