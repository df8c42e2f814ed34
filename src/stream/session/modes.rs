//! The modes in effect on the board, so that where a program leads is known also when it does not say all of them itself.

use super::Session;
use crate::gcode::{Interpreter, Line, Word, parse_line};
use crate::geom::{P3, V3};

/// Modal groups of which a board always tells one: offset, plane, units, distance, feed mode. What lacks one is garbled, or has a mode nobody here knows.
const GROUPS: [&[f64]; 5] =
    [&[54.0, 55.0, 56.0, 57.0, 58.0, 59.0], &[17.0, 18.0, 19.0], &[20.0, 21.0], &[90.0, 91.0], &[93.0, 94.0]];

/// Modes in which numbers mean other places: diameters (G7) and scaling (G51) of grblHAL.
const DISTORTING: [f64; 2] = [7.0, 51.0];

/// As a board starts.
pub(super) fn at_start() -> Interpreter {
    Interpreter::new(P3::origin(), [V3::zeros(); 6], [P3::origin(); 2])
}

/// The words of an answer to `$G`: "G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0" of GRBL, "G0 G54 G17 G21 G90 G94 G49 G98 G50 M5 M9 T0 F0 S0." of grblHAL. They
/// are read by modal group, and what changes no place is dropped. `None` where that leaves it open where zero lies or what a number means.
pub(super) fn told(words: &str) -> Option<Interpreter> {
    let words: Option<Vec<Word>> = words.split_whitespace().map(word).collect();
    let words = words?;
    let named = |letter: char, codes: &[f64]| {
        words.iter().copied().find(|word| word.letter == letter && codes.contains(&word.value))
    };
    if named('G', &DISTORTING).is_some() {
        return None;
    }
    let groups: Option<Vec<Word>> = GROUPS.iter().map(|codes| named('G', codes)).collect();
    let mut groups = groups?;
    let feed_mode = groups.pop()?;
    let value = |letter: char| words.iter().find(|word| word.letter == letter).map_or(0.0, |word| word.value);
    // An arc has no end here, nor has a probing; a program that goes on with either without a word of its own is not followed.
    let feeds = value('F') > 0.0;
    let motion = named('G', &[0.0, 1.0]).filter(|word| word.value == 0.0 || feeds);
    let motion = motion.unwrap_or(Word { letter: 'G', value: 80.0 });
    let mut modes = at_start();
    // The feed is told in mm whatever the units of programs are, and a feed mode forgets it; both coolants may be on, and are said one by one.
    let mut say = |words: Vec<Word>| modes.line(&Line { words, comment: None }).ok();
    say([feed_mode].into_iter().chain(['F', 'S'].map(|letter| Word { letter, value: value(letter) })).collect())?;
    say(groups.into_iter().chain([motion]).chain(named('M', &[3.0, 4.0, 5.0])).collect())?;
    for coolant in [7.0, 8.0].into_iter().filter_map(|code| named('M', &[code])) {
        say(vec![coolant])?;
    }
    (modes.modal().offset == 0).then_some(modes)
}

/// A word as boards write it: grblHAL ends whole numbers with a point.
fn word(text: &str) -> Option<Word> {
    let mut chars = text.chars();
    let letter = chars.next().filter(char::is_ascii_uppercase)?;
    Some(Word { letter, value: chars.as_str().parse().ok()? })
}

impl Session {
    /// The board has carried out a line that was not the job's.
    pub(super) fn obeyed(&mut self, text: &str) {
        if text.starts_with('$') {
            return;
        }
        let modes = self.modes.take().and_then(|mut modes| {
            modes.line(&parse_line(text, 1).ok()?).ok()?;
            (modes.modal().offset == 0).then_some(modes)
        });
        self.set_modes(modes);
    }

    /// Modes as lines have left them; what was known of G92 and the tool's length goes with them.
    pub(super) fn set_modes(&mut self, modes: Option<Interpreter>) {
        let board = &mut self.board;
        board.shift_mm = board.shift_mm.and(modes.as_ref()).map(|modes| modes.shift().into());
        board.tool_length_mm = board.tool_length_mm.and(modes.as_ref()).map(Interpreter::tool_length_mm);
        self.modes = modes;
    }

    /// What the board tells of G92 and the tool's length, into the modes.
    pub(super) fn shift_modes(&mut self) {
        if let Some(modes) = &mut self.modes {
            let shift_mm = self.board.shift_mm.unwrap_or_default();
            modes.set_shift(V3::from(shift_mm), self.board.tool_length_mm.unwrap_or_default());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_board_tells_of_its_modes_is_in_effect() {
        let modes = told("G1 G54 G17 G20 G91 G94 M4 M7 M8 T0 F500 S300").map(|i| i.modal());
        let modes = modes.expect("known modes");
        assert!(modes.inches && modes.incremental && modes.power_s == 300.0 && modes.motion == "G1");
        assert!(modes.feed_mm_per_min == 500.0 && modes.coolant == [true; 2]);
        for words in ["G0 G55 G17 G21 G90 G94 M5 M9 T0 F0 S0", "?", "", "G0 G17 G21 G90 G94 M5", "G0 G54 G17 G21 G9"] {
            assert!(told(words).is_none(), "{words}");
        }
        assert!(told("G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0").is_some());
    }

    #[test]
    fn words_that_only_other_firmware_knows_change_nothing() {
        let words = "G1 G54 G17 G21 G91 G94 G49 G98 G50 M4 M8 T3 F600 S300.";
        let modes = told(words).expect("known modes").modal();
        assert!(modes.incremental && modes.power_s == 300.0 && modes.motion == "G1" && modes.coolant == [false, true]);
        assert!(told("G0 G54 G17 G21 G90 G94 G49 G98 G51 M5 M9 T0 F0 S0.").is_none(), "scaled places are others");
    }

    #[test]
    fn a_motion_without_an_end_is_none() {
        for motion in ["G2", "G3", "G38.2", "G80", "G81"] {
            let mut modes = told(&format!("{motion} G54 G17 G21 G90 G94 M5 M9 T0 F100 S0")).expect("known modes");
            assert!(modes.clone().line(&parse_line("X10", 1).unwrap()).is_err(), "{motion}");
            assert!(modes.line(&parse_line("G1X10", 1).unwrap()).is_ok(), "{motion}");
        }
        assert_eq!(told("G1 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0").expect("known modes").modal().motion, "G80");
    }
}
