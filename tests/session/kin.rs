//! Boards with other firmware are known for what they are and fed as they can take it.

use furbelow::emulator::{Board, BoardSettings, Fault, When};
use furbelow::stream::{Event, Firmware, Outcome};

use super::bench::Bench;

/// Short lines, so many that a long buffer fills.
fn long_job() -> String {
    let lines: String = (1..=1500).map(|k| format!("X{:.3}\n", f64::from(k % 50) * 0.2)).collect();
    format!("M4S500\nG1F3000\n{lines}M5S0\n")
}

fn runs_whole(mut bench: Bench) -> Bench {
    bench.run(&long_job());
    assert!(bench.until(200.0, |b| b.ending.is_some()));
    assert_eq!(bench.ending.as_ref().map(|e| &e.outcome), Some(&Outcome::Done));
    assert_eq!(bench.board.bytes_lost(), 0);
    bench
}

#[test]
fn grbl_hal_is_known_by_its_banner_and_its_long_buffer_is_filled_and_never_overflows() {
    let bench = runs_whole(Bench::ready(BoardSettings::grbl_hal()));
    let board = bench.session.board();
    assert_eq!((board.firmware, board.rx_bytes, board.blocks), (Firmware::GrblHal, 1024, 100));
    let least_free = bench.events.iter().filter_map(|e| match e {
        Event::Status(status, _) => status.free.map(|(_, bytes)| bytes),
        _ => None,
    });
    assert!(least_free.min().is_some_and(|bytes| bytes < 20), "the buffer is used");
}

#[test]
fn a_board_that_does_not_greet_is_known_by_what_it_answers() {
    let cases = [
        (BoardSettings::grbl_hal(), Firmware::GrblHal),
        (BoardSettings { resets_on_open: false, ..BoardSettings::fluid_nc() }, Firmware::FluidNc),
        (BoardSettings { resets_on_open: false, ..BoardSettings::default() }, Firmware::Grbl),
    ];
    for (settings, firmware) in cases {
        let mut board = Board::new(settings);
        // It has been on for a while.
        board.step(5.0, &[]);
        let mut bench = Bench::new(board);
        bench.now_s = 5.0;
        bench.reopen();
        assert_eq!(bench.session.board().firmware, firmware);
    }
}

#[test]
fn fluid_nc_is_known_through_its_boot_messages_and_counted_as_grbl() {
    let bench = runs_whole(Bench::ready(BoardSettings::fluid_nc()));
    let board = bench.session.board();
    assert_eq!((board.firmware, board.rx_bytes), (Firmware::FluidNc, 128));
    assert_eq!(board.blocks, 16, "learnt from its reports");
}

#[test]
fn startup_lines_of_the_board_are_no_answers_to_ours() {
    let mut bench = Bench::ready(BoardSettings::default());
    for line in ["$N0=M8", "$N1=G90"] {
        bench.command(furbelow::stream::Command::Line(line.into()));
        bench.wait(1.0);
    }
    bench.board.schedule(When::At(bench.now_s), Fault::Reset);
    bench.wait(3.0);
    runs_whole(bench);
}

#[test]
fn what_a_board_says_by_itself_is_told_and_nothing_else() {
    let mut bench = Bench::new(Board::new(BoardSettings::fluid_nc()));
    bench.get_ready();
    bench.board.schedule(When::At(bench.now_s + 0.5), Fault::Chatter(3));
    bench.run(&long_job());
    assert!(bench.until(200.0, |b| b.ending.is_some()));
    assert_eq!(bench.ending.as_ref().map(|e| &e.outcome), Some(&Outcome::Done));
    let told = bench.events.iter().filter(|e| matches!(e, Event::Message(m) if m.starts_with("INFO: heap"))).count();
    assert_eq!(told, 3);
}
