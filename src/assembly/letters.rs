//! Helvetica as every PDF reader has it: which bytes stand for which letter, and how wide they are.

use super::spelling::spelt;

/// Two of the fourteen faces that need no font in the file (PDF 1.7, section 9.6.2.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Face {
    /// Helvetica.
    Plain,
    /// Helvetica-Bold.
    Bold,
}

impl Face {
    /// Both, in the order they stand in a page's resources.
    pub const ALL: [Face; 2] = [Face::Plain, Face::Bold];

    /// The name pages use.
    pub fn resource(self) -> &'static [u8] {
        match self {
            Face::Plain => b"F1",
            Face::Bold => b"F2",
        }
    }

    /// The name readers know.
    pub fn base_font(self) -> &'static [u8] {
        match self {
            Face::Plain => b"Helvetica",
            Face::Bold => b"Helvetica-Bold",
        }
    }
}

/// Widths of the characters from space to tilde, thousandths of the size (Adobe's metrics of the base fonts).
const PLAIN: [u16; 95] = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278, 556, 556, 556, 556, 556, 556, 556,
    556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833,
    722, 778, 667, 778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556,
    556, 278, 556, 556, 222, 222, 500, 222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334,
    260, 334, 584,
];
const BOLD: [u16; 95] = [
    278, 333, 474, 556, 556, 889, 722, 238, 333, 333, 389, 584, 278, 333, 278, 278, 556, 556, 556, 556, 556, 556, 556,
    556, 556, 556, 333, 333, 584, 584, 584, 611, 975, 722, 722, 722, 722, 667, 611, 778, 722, 278, 556, 722, 611, 833,
    722, 778, 667, 778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 333, 278, 333, 584, 556, 333, 556, 611, 556, 611,
    556, 333, 611, 611, 278, 278, 556, 278, 889, 611, 611, 611, 611, 389, 556, 333, 611, 556, 778, 556, 556, 500, 389,
    280, 389, 584,
];
/// Taken for accented letters, thousandths of the size: about that of the letter without its accent.
const ACCENTED: u16 = 611;

/// The text in WinAnsiEncoding; letters it does not have are spelt with those it has ([`spelt`]).
pub(super) fn encoded(text: &str) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(text.len());
    for c in text.chars() {
        match c {
            ' '..='~' => bytes.push(c as u8),
            // Latin letters with accents have the same number in both.
            '\u{a0}'..='\u{ff}' => bytes.push(c as u32 as u8),
            other => bytes.extend(spelt(other).bytes()),
        }
    }
    bytes
}

/// How wide a line of text is, mm.
pub(super) fn width_mm(text: &str, size_mm: f64, face: Face) -> f64 {
    let table = match face {
        Face::Plain => &PLAIN,
        Face::Bold => &BOLD,
    };
    let width = |b: u8| if b < 0x7f { table[usize::from(b - b' ')] } else { ACCENTED };
    encoded(text).into_iter().map(|b| f64::from(width(b))).sum::<f64>() * size_mm / 1000.0
}

/// The text in lines no wider than `width`, broken between words; a word that is wider stands alone.
pub(super) fn wrapped(text: &str, size_mm: f64, face: Face, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width_mm(&format!("{line} {word}"), size_mm, face) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_those_of_the_base_fonts() {
        assert!((width_mm("Joint A7", 10.0, Face::Plain) - 36.13).abs() < 1e-9);
        assert!((width_mm("W~", 1000.0, Face::Bold) - 1528.0).abs() < 1e-9);
        assert_eq!(width_mm("", 10.0, Face::Bold), 0.0);
    }

    #[test]
    fn letters_helvetica_does_not_have_are_spelt() {
        assert_eq!(encoded("B\u{e4}r"), b"B\xe4r");
        assert_eq!(encoded("me\u{10f} \u{141}\u{f3}d\u{17a}"), b"med L\xf3dz");
        assert_eq!(encoded("\u{43c}\u{435}\u{434}\u{432}\u{435}\u{434}\u{44c}"), b"medved'");
        assert_eq!(encoded("\u{718a}"), b"U+718A ");
    }

    #[test]
    fn lines_break_between_words_and_lose_none() {
        let text = "the flap of joint A7 goes through the slit of the same number";
        let lines = wrapped(text, 4.0, Face::Plain, 40.0);
        assert!(lines.len() > 2 && lines.iter().all(|l| width_mm(l, 4.0, Face::Plain) <= 40.0));
        assert_eq!(lines.join(" "), text);
        assert_eq!(wrapped("incomprehensibilities", 4.0, Face::Plain, 10.0).len(), 1);
    }
}
