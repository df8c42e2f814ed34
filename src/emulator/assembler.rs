//! Bytes become lines as in GRBL's main loop (protocol.c): blanks, comments and `/` dropped, small letters raised, too long lines told.

/// A line as the controller sees it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Text {
    Line(String),
    TooLong,
}

/// The line being gathered.
#[derive(Debug)]
pub(super) struct Assembler {
    /// Characters a line may have (LINE_BUFFER_SIZE - 1).
    limit: usize,
    line: String,
    in_parentheses: bool,
    after_semicolon: bool,
    overflow: bool,
}

impl Assembler {
    pub(super) fn new(limit: usize) -> Assembler {
        Assembler { limit, line: String::new(), in_parentheses: false, after_semicolon: false, overflow: false }
    }

    /// Takes a byte; a line feed or a carriage return ends the line.
    pub(super) fn take(&mut self, byte: u8) -> Option<Text> {
        if byte == b'\n' || byte == b'\r' {
            let done = std::mem::replace(self, Assembler::new(self.limit));
            return Some(if done.overflow { Text::TooLong } else { Text::Line(done.line) });
        }
        if self.in_parentheses || self.after_semicolon || self.overflow {
            self.in_parentheses &= byte != b')';
            return None;
        }
        match byte {
            0..=b' ' | b'/' => {}
            b'(' => self.in_parentheses = true,
            b';' => self.after_semicolon = true,
            _ if self.line.len() >= self.limit => self.overflow = true,
            _ => self.line.push(char::from(byte.to_ascii_uppercase())),
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str) -> Vec<Text> {
        let mut assembler = Assembler::new(79);
        text.bytes().filter_map(|b| assembler.take(b)).collect()
    }

    #[test]
    fn blanks_and_comments_are_dropped_and_a_carriage_return_ends_a_line_too() {
        let line = |t: &str| Text::Line(t.into());
        assert_eq!(lines("g1 x1(a ; b)y2 ; c\r\n/M5\n"), [line("G1X1Y2"), line(""), line("M5")]);
        let long = "x".repeat(79);
        assert_eq!(lines(&format!("{long}\n")), [line(&long.to_uppercase())]);
        assert_eq!(lines(&format!("{long}x\nM5\n")), [Text::TooLong, line("M5")]);
    }
}
