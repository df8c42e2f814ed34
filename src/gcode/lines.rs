//! Where lines end, and the bytes a controller acts on before it reads lines.

use std::io::BufRead;

use super::check::Notes;

/// Longest line that is held, in bytes; what is longer is no G-code.
pub(super) const MAX_LINE_BYTES: usize = 65_536;

/// Soft reset: ends the job wherever it stands.
const SOFT_RESET: u8 = 0x18;

/// Where the first line of `bytes` ends and where the next begins: at a line feed, a carriage return (either ends a line on GRBL) or both,
/// which count as one. `None` without a line end.
fn line_end(bytes: &[u8]) -> Option<(usize, usize)> {
    let end = bytes.iter().position(|b| matches!(b, b'\n' | b'\r'))?;
    let both = bytes[end] == b'\r' && bytes.get(end + 1) == Some(&b'\n');
    Some((end, end + 1 + usize::from(both)))
}

/// The lines of a text, without their ends.
pub(super) fn lines(text: &str) -> impl Iterator<Item = &str> {
    let mut rest = text;
    std::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        let (end, next) = line_end(rest.as_bytes()).unwrap_or((rest.len(), rest.len()));
        let line = &rest[..end];
        rest = &rest[next..];
        Some(line)
    })
}

/// The lines of a file as [`super::Checker::read`] counts them, without their ends and one at a time. Bytes that are no UTF-8 become U+FFFD; of
/// a line longer than 65,536 bytes only so much and one byte more is given.
pub fn read_lines(mut input: impl BufRead) -> impl Iterator<Item = std::io::Result<String>> {
    let mut line = Vec::new();
    std::iter::from_fn(move || match read_line(&mut input, &mut line, MAX_LINE_BYTES) {
        Ok(0) => None,
        Ok(_) => Some(Ok(String::from_utf8_lossy(&line).into_owned())),
        Err(e) => Some(Err(e)),
    })
}

/// Reads the next line of a file without its end into `line`, of which at most `most` bytes and one are kept, and tells how many bytes were
/// taken: 0 at the end.
///
/// # Errors
/// Those of `input`.
pub(super) fn read_line(input: &mut impl BufRead, line: &mut Vec<u8>, most: usize) -> std::io::Result<u64> {
    line.clear();
    let mut taken = 0;
    loop {
        let held = match input.fill_buf() {
            Ok(held) => held,
            Err(e) if e.kind() == std::io::ErrorKind::Interrupted => continue,
            Err(e) => return Err(e),
        };
        let found = line_end(held);
        let (end, next) = found.unwrap_or((held.len(), held.len()));
        // One byte more than permitted shows that the line is too long.
        let room = (most + 1).saturating_sub(line.len());
        line.extend_from_slice(&held[..end.min(room)]);
        let split = found.is_some() && held[next - 1] == b'\r' && next == held.len();
        let at_end = held.is_empty();
        input.consume(next);
        taken += next as u64;
        // The line feed of a pair may come with the next of the file.
        if split && input.fill_buf()?.first() == Some(&b'\n') {
            input.consume(1);
            taken += 1;
        }
        if at_end || found.is_some() {
            return Ok(taken);
        }
    }
}

/// Looks for bytes GRBL takes out of the stream and acts on at once, and tells whether the line is to be read on. Outside comments all but the
/// soft reset are refused anyway, as what is no word.
pub(super) fn real_time(line: usize, bytes: &[u8], notes: &mut Notes) -> bool {
    let column = |at: usize| String::from_utf8_lossy(&bytes[..at]).chars().count() + 1;
    if let Some(at) = bytes.iter().position(|b| *b == SOFT_RESET) {
        notes.errors.add(line, column(at), "soft-reset", || {
            "byte 0x18 resets the machine in mid-job (GRBL soft reset); take it out".into()
        });
        return false;
    }
    let (mut parentheses, mut semicolon) = (false, false);
    let acted_on = bytes.iter().position(|b| {
        let comment = parentheses || semicolon;
        match b {
            b'!' | b'~' | b'?' | 0x80.. => return comment,
            b')' => parentheses = false,
            b'(' if !semicolon => parentheses = true,
            b';' if !parentheses => semicolon = true,
            _ => {}
        }
        false
    });
    if let Some(at) = acted_on {
        notes.warnings.add(line, column(at), "real-time-byte", || {
            let byte = match bytes[at] {
                b @ 0x80.. => format!("byte 0x{b:02X}"),
                b => format!("{:?}", char::from(b)),
            };
            format!("{byte} in a comment: GRBL holds, resumes or changes speed at such bytes if the sender passes comments on; write plain letters")
        });
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(text: &str, capacity: usize) -> (Vec<String>, u64) {
        let mut input = std::io::BufReader::with_capacity(capacity, text.as_bytes());
        let (mut line, mut all, mut done) = (Vec::new(), Vec::new(), 0);
        loop {
            let taken = read_line(&mut input, &mut line, 1000).unwrap();
            if taken == 0 {
                return (all, done);
            }
            done += taken;
            all.push(String::from_utf8(line.clone()).unwrap());
        }
    }

    #[test]
    fn lines_end_at_either_sign_or_both() {
        let text = "a\rb\r\nc\n\nd\r\re";
        assert_eq!(lines(text).collect::<Vec<_>>(), ["a", "b", "c", "", "d", "", "e"]);
        assert_eq!(lines("a\r\n").count() + lines("").count(), 1);
    }

    #[test]
    fn lines_read_one_by_one_are_those_that_are_counted_whatever_bytes_they_hold() {
        let file = b"G1X1\rG1X2\r\n; gr\xf6\xdfe\n\nM2".as_slice();
        let lines: Vec<String> = read_lines(file).map(Result::unwrap).collect();
        assert_eq!(lines, ["G1X1", "G1X2", "; gr\u{fffd}\u{fffd}e", "", "M2"]);
        let long = vec![b'X'; 2 * MAX_LINE_BYTES];
        assert_eq!(read_lines(long.as_slice()).next().unwrap().unwrap().len(), MAX_LINE_BYTES + 1);
    }

    proptest! {
        #[test]
        fn a_file_has_the_lines_of_its_text_however_it_comes(text in "[a\r\n]{0,40}", capacity in 1..9_usize) {
            let (all, done) = read(&text, capacity);
            prop_assert_eq!(all, lines(&text).collect::<Vec<_>>());
            prop_assert_eq!(done, text.len() as u64);
        }
    }
}
