//! G38: contact found, missed, and there from the start.

use furbelow::geom::P3;

use super::bench::Bench;

#[test]
fn a_probe_stops_at_its_contact_and_tells_where() {
    let mut bench = Bench::ready(&[]);
    bench.send(b"G38.2X50F600\n");
    bench.wait(2.0);
    let touched_mm = bench.board.position_mm().x;
    bench.board.set_probe(true);
    bench.wait(0.5);
    assert_eq!(bench.lines(), [format!("[PRB:{touched_mm:.3},0.000,0.000:1]"), "ok".into()]);
    // 10 mm/s at 500 mm/s2 brakes within 0.1 mm.
    let rest_mm = bench.board.position_mm().x;
    assert!((rest_mm - touched_mm - 0.1).abs() < 1e-6 && bench.state() == "Idle", "{touched_mm} {rest_mm}");
    assert!(bench.status().contains(&"Pn:P".to_owned()));
    assert!(bench.ask(b"$#\n").contains(&format!("[PRB:{touched_mm:.3},0.000,0.000:1]")));
    bench.ok("G91");
    bench.ok("G0Y5");
    bench.settle();
    assert!((bench.board.position_mm() - P3::new(rest_mm, 5.0, 0.0)).norm() < 1e-5, "programs go on from there");
}

#[test]
fn no_contact_is_an_alarm_only_where_it_must_be_found() {
    for (code, alarm) in [("G38.2", true), ("G38.3", false)] {
        let mut bench = Bench::ready(&[]);
        bench.send(format!("{code}X5F1200\n").as_bytes());
        bench.wait(2.0);
        let mut told = vec!["[PRB:5.000,0.000,0.000:0]".to_owned(), "ok".into()];
        if alarm {
            told.insert(0, "ALARM:5".into());
        }
        assert_eq!(bench.lines(), told);
        assert_eq!(bench.state(), if alarm { "Alarm" } else { "Idle" });
    }
}

#[test]
fn a_contact_that_is_there_from_the_start_is_an_alarm_and_nothing_moves() {
    let mut bench = Bench::ready(&[]);
    bench.board.set_probe(true);
    assert_eq!(bench.ask(b"G38.3X5F600\n"), ["ALARM:4", "ok"]);
    assert_eq!(bench.board.position_mm(), P3::origin());
    bench.ask(b"$X\n");
    bench.send(b"G38.4X5F600\n");
    bench.wait(0.2);
    bench.board.set_probe(false);
    bench.wait(0.5);
    assert!(bench.lines()[0].ends_with(":1]"), "away from the contact it is what is wanted");
}

#[test]
fn the_beam_is_off_while_probing() {
    let mut bench = Bench::ready(&[]);
    for line in ["M3S500", "G38.3X5F600"] {
        bench.ask(format!("{line}\n").as_bytes());
    }
    bench.wait(2.0);
    assert!(bench.board.trace().iter().all(|s| !s.is_lit()) && bench.board.position_mm().x == 5.0);
}
