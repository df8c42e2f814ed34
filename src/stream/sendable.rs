//! Lines as they go over the wire: without blanks and comments, and without bytes a board would act on at once.

use super::trouble::Trouble;

/// What a line asks of the sender besides being counted.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sendable {
    /// What goes over the wire, without line feed.
    pub(super) text: String,
    /// The board writes its memory and loses bytes meanwhile: the line goes alone, at rest.
    pub(super) alone: bool,
    /// How long the machine stands before it answers, s (G4).
    pub(super) dwell_s: f64,
}

/// A line of a program made ready, `None` when nothing of it is sent. `number` is its place in the file, from 1.
///
/// # Errors
/// A byte that a board takes for a real-time command, or one that is no printable ASCII; more characters than `limit`.
pub(super) fn sendable(line: &str, number: usize, limit: usize) -> Result<Option<Sendable>, Trouble> {
    let mut text = String::with_capacity(line.len());
    let mut hidden = false;
    for c in line.chars() {
        match c {
            ')' if hidden => hidden = false,
            _ if hidden => {}
            ';' => break,
            '(' => hidden = true,
            c if c.is_whitespace() => {}
            // `?`, `!` and `~` are real-time commands wherever they stand; so are bytes above 127.
            '?' | '!' | '~' => return Err(Trouble::Unsendable { line: number, found: c }),
            c if !c.is_ascii_graphic() => return Err(Trouble::Unsendable { line: number, found: c }),
            c => text.push(c.to_ascii_uppercase()),
        }
    }
    if text.len() > limit {
        return Err(Trouble::TooLong { line: number, chars: text.len(), limit });
    }
    if text.is_empty() {
        return Ok(None);
    }
    let alone = writes_memory(&text);
    let dwell_s = dwell_s(&text);
    Ok(Some(Sendable { text, alone, dwell_s }))
}

/// True for lines that make the board write its memory (GRBL's EEPROM): on an AVR the receive interrupt is off meanwhile and bytes are lost.
fn writes_memory(text: &str) -> bool {
    if let Some(command) = text.strip_prefix('$') {
        return command.contains('=') && !command.starts_with("J=");
    }
    ["G10", "G28.1", "G30.1"].iter().any(|code| has_code(text, code))
}

fn has_code(text: &str, code: &str) -> bool {
    text.match_indices(code).any(|(at, _)| {
        let next = text.as_bytes().get(at + code.len());
        !next.is_some_and(|b| b.is_ascii_digit() || *b == b'.')
    })
}

fn dwell_s(text: &str) -> f64 {
    if !has_code(text, "G4") && !has_code(text, "G04") {
        return 0.0;
    }
    let seconds = text.split_once('P').map_or("", |(_, rest)| rest);
    let end = seconds.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(seconds.len());
    seconds[..end].parse().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(line: &str) -> Option<String> {
        sendable(line, 1, 79).unwrap().map(|s| s.text)
    }

    #[test]
    fn blanks_and_comments_stay_at_home() {
        assert_eq!(text("g1 x 10.5 (to the right?) y2 ; really!"), Some("G1X10.5Y2".into()));
        assert_eq!(text("; job: stool"), None);
        assert_eq!(text("\r"), None);
    }

    #[test]
    fn a_byte_the_board_would_act_on_is_never_sent() {
        for (line, found) in
            [("G1X1!", '!'), ("G1?", '?'), ("~", '~'), ("G1X1\u{18}", '\u{18}'), ("G1X\u{84}", '\u{84}')]
        {
            assert_eq!(sendable(line, 7, 79), Err(Trouble::Unsendable { line: 7, found }));
        }
        let long = format!("G1X{}", "1".repeat(80));
        assert_eq!(sendable(&long, 3, 79), Err(Trouble::TooLong { line: 3, chars: 83, limit: 79 }));
    }

    #[test]
    fn lines_that_write_the_boards_memory_go_alone() {
        let alone = |line| sendable(line, 1, 79).unwrap().unwrap().alone;
        assert!(["G10L20P1X0Y0", "G28.1", "$30=1000", "$N0=G54", "$RST=$", "G21G10L2P1X0"].into_iter().all(alone));
        assert!(!["G1X10", "G28", "G1X1G100", "$J=G91X10F100", "$H", "$$"].into_iter().any(alone));
    }

    #[test]
    fn a_dwell_is_known_by_its_seconds() {
        let dwell = |line| sendable(line, 1, 79).unwrap().unwrap().dwell_s;
        assert_eq!([dwell("G4 P2.5"), dwell("G04P1"), dwell("G40"), dwell("G4")], [2.5, 1.0, 0.0, 0.0]);
    }
}
