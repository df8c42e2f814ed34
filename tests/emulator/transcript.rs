//! Replays the recorded session: the same inputs, the same answers, positions aside.

use furbelow::emulator::{Fault, When};

use super::bench::{Bench, with};

/// Positions and work offsets made equal.
fn masked(line: &str) -> String {
    let mask = |field: &str| match field.split_once(':') {
        Some((key @ ("MPos" | "WCO"), rest)) => format!("{key}:*{}", if rest.ends_with('>') { ">" } else { "" }),
        _ => field.to_owned(),
    };
    line.split('|').map(mask).collect::<Vec<_>>().join("|")
}

/// A Python literal's bytes: `'..'` is a line, `b'..'` real-time bytes.
fn bytes(literal: &str) -> Vec<u8> {
    if let Some(raw) = literal.strip_prefix('b') {
        let inside = raw.trim_matches('\'');
        return match inside.strip_prefix("\\x") {
            Some(hex) => vec![u8::from_str_radix(hex, 16).unwrap()],
            None => inside.as_bytes().to_vec(),
        };
    }
    let mut line = literal.strip_prefix('\'').unwrap().strip_suffix('\'').unwrap().as_bytes().to_vec();
    line.push(b'\n');
    line
}

/// Replies as recorded, separated by ` | `; empty ones are empty lines, comments are dropped.
fn replies(text: &str) -> Vec<String> {
    let text = text.split("   #").next().unwrap();
    if text.trim().is_empty() {
        return Vec::new();
    }
    // A status report has bars without blanks.
    text.split(" |").map(|reply| masked(reply.trim())).collect()
}

#[test]
fn the_recorded_session_is_answered_the_same() {
    let path = format!("{}/tests/grbl-transcript.txt", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let mut bench = Bench::booted(with(&[(22, 1.0)]));
    let mut compared = 0;
    let mut pushed: Vec<String> = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let expect = |heard: Vec<String>, expected: &str| {
            let heard: Vec<String> = heard.iter().map(|l| masked(l)).collect();
            assert_eq!(heard, replies(expected), "line {}: {line}", number + 1);
        };
        if let Some(rest) = line.strip_prefix("BOOT  |") {
            assert_eq!(bench.lines()[1..], replies(rest), "the greeting follows an empty line");
        } else if line == "ok | ok" {
            let burst: String = (1..=5).map(|k| format!("G1X{k}.25Y{k}.37537F3000(abcdef)\n")).collect();
            expect(bench.ask(format!("G10L20P1X1.5Y2.5Z2\n{burst}").as_bytes()), line);
        } else if line.starts_with("ok | ok | ok") {
            let blast: Vec<u8> = (1..=60).flat_map(|k| format!("G1X{}Y{}F9\n", k % 2, k % 3).into_bytes()).collect();
            let heard = bench.ask(&blast);
            assert!(heard.iter().all(|l| l == "ok" || l.starts_with("error:")), "{heard:?}");
        } else if line.starts_with("--- hard limit") {
            for line in ["$21=1", "G91", "G1X50F1000"] {
                bench.ok(line);
            }
            bench.board.set_switch(0, true);
        } else if let Some(rest) = line.strip_prefix("# pushed: ") {
            pushed = replies(rest);
        } else if line.starts_with("# laser PWM") {
            assert_eq!(bench.board.power(), 0.0, "{line}");
        } else if line.starts_with("--- unplugged") {
            bench.board.set_switch(0, false);
            bench.ok("G1X50F1000");
            let now_s = bench.now_s;
            bench.board.schedule(When::At(now_s + 0.1), Fault::Unplug { powered: false });
            bench.board.schedule(When::At(now_s + 0.3), Fault::Replug);
            bench.wait(1.0);
            assert!(bench.board.open(bench.now_s));
            bench.wait(2.0);
        } else if let Some(rest) = line.strip_prefix("# new device node; on opening: ") {
            expect(bench.lines(), rest);
        } else if let Some((sent, expected)) = line.split_once(" ->").filter(|_| !line.starts_with(['#', '-'])) {
            let mut heard = bench.ask(&bytes(sent));
            if !pushed.is_empty() {
                assert_eq!(heard[..1], pushed[..]);
                heard.remove(0);
                pushed.clear();
            }
            expect(heard, expected);
            compared += 1;
        }
    }
    assert!(compared > 85, "{compared}");
}
