//! Boards with grblHAL and FluidNC: what they call themselves and what they can do.

use furbelow::emulator::{BoardSettings, Fault, When};

use super::bench::Bench;

#[test]
fn grbl_hal_names_itself_and_its_buffers_takes_long_lines_and_hears_while_it_stores() {
    let mut bench = Bench::booted(BoardSettings::grbl_hal());
    assert_eq!(bench.lines(), ["", "GrblHAL 1.1f ['$' or '$HELP' for help]"]);
    let info = bench.ask(b"$I\n");
    assert!(info.contains(&"[OPT:VNMSL,100,1024,3,0]".to_owned()) && info.contains(&"[FIRMWARE:grblHAL]".to_owned()));
    assert!(bench.status().contains(&"Bf:100,1023".to_owned()), "one place of the ring is never used");
    bench.ok(&format!("G1X1.{}F100", "0".repeat(100)));
    bench.settle();
    let burst = "G91\nG90\n".repeat(20);
    assert_eq!(bench.ask(format!("$110=777\n{burst}").as_bytes()).len(), 41);
    assert_eq!(bench.board.bytes_lost(), 0);
    assert!(bench.board.open(bench.now_s));
    assert_eq!(bench.ask(b"\n"), ["ok"], "opening does not reset it");
}

#[test]
fn fluid_nc_talks_while_it_boots_and_does_not_tell_its_buffers() {
    let mut bench = Bench::booted(BoardSettings::fluid_nc());
    let greeting = bench.lines();
    assert!(greeting.iter().any(|l| l.starts_with("[MSG:INFO: ")), "{greeting:?}");
    assert_eq!(greeting.last().unwrap(), "Grbl 3.7 [FluidNC v3.7.8 (wifi) '$' for help]");
    let info = bench.ask(b"$I\n");
    assert!(info[0].starts_with("[VER:3.7 FluidNC ") && info[1] == "[OPT:PHS]", "{info:?}");
}

#[test]
fn a_board_that_chatters_answers_as_before() {
    let mut bench = Bench::ready(&[]);
    bench.board.schedule(When::At(bench.now_s), Fault::Chatter(2));
    assert_eq!(bench.ask(b"G91\n"), ["[MSG:INFO: heap 170000]", "[MSG:INFO: heap 169999]", "ok"]);
}
