//! The modes in effect on the board, so that where a program leads is known also when it does not say all of them itself.

use super::Session;
use crate::gcode::{Interpreter, parse_line};
use crate::geom::{P3, V3};

/// As a board starts.
pub(super) fn at_start() -> Interpreter {
    Interpreter::new(P3::origin(), [V3::zeros(); 6], [P3::origin(); 2])
}

/// The words of an answer to `$G`: "G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0". `None` for modes from which nothing can be followed: arcs without an
/// end, other places for zero than G54.
pub(super) fn told(words: &str) -> Option<Interpreter> {
    let line = parse_line(words, 1).ok()?;
    let mut modes = at_start();
    modes.line(&line).ok()?;
    (modes.modal().offset == 0).then_some(modes)
}

impl Session {
    /// The board has carried out a line that was not the job's.
    pub(super) fn obeyed(&mut self, text: &str) {
        if text.starts_with('$') {
            return;
        }
        self.modes = self.modes.take().and_then(|mut modes| {
            modes.line(&parse_line(text, 1).ok()?).ok()?;
            (modes.modal().offset == 0).then_some(modes)
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_board_tells_of_its_modes_is_in_effect() {
        let modes = told("G1 G54 G17 G20 G91 G94 M4 M9 T0 F500 S300").map(|i| i.modal());
        let modes = modes.expect("known modes");
        assert!(modes.inches && modes.incremental && modes.power_s == 300.0 && modes.motion == "G1");
        for words in ["G2 G54 G17 G21 G90 G94 M5 M9 T0 F100 S0", "G0 G55 G17 G21 G90 G94 M5 M9 T0 F0 S0", "?"] {
            assert!(told(words).is_none(), "{words}");
        }
        assert!(told("G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0").is_some());
    }
}
