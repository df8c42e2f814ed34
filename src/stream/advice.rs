//! What error and alarm numbers mean, and what to do about them.
//!
//! GRBL 1.1's numbers are those of its doc/csv; from 10 upwards alarms, and from 39 upwards errors, mean something else on each firmware.

use super::reply::Firmware;

/// What `error:code` means and what to do, as one sentence.
pub fn error_advice(firmware: Firmware, code: u16) -> &'static str {
    match code {
        1 => "a word must begin with a letter: a byte was lost or the file is no G-code; check the cable and the file",
        2 => "a number is missing or garbled: bytes were lost on the way; use a shorter, shielded cable",
        3 => "the board does not know this $ command",
        4 => "a number must not be below 0",
        5 => "homing is switched off ($22=0); switch it on or zero by hand",
        6 => "the step pulse must be at least 3 us ($0)",
        7 => "the board's memory could not be read and was reset: look at all settings ($$)",
        8 => "this command is only taken while the machine is idle",
        9 => "the board is locked after an alarm or while it jogs: home it, or unlock it once the position is known",
        10 => "soft limits need homing: switch homing on first ($22=1)",
        11 => "the line is longer than the board takes; split it",
        12 => "the steps per second asked for are more than the board makes; lower $110-$112",
        13 => "the door is open; close it, then resume",
        14 => "the start-up line is too long for the board's memory",
        15 => "the jog would leave the machine's travel",
        16 => "the jog command is not well formed",
        17 => "laser mode needs a board built with variable spindle speed",
        20 => "the board does not know this word; write the file for GRBL",
        21 => "two words of the line contradict each other",
        22 => "a feed move came without a feed; give F",
        23 => "this word takes whole numbers only",
        24 => "two words of the line both want its axes",
        25 => "a word stands twice in the line",
        26 => "the line needs an axis word",
        27 => "line numbers end at 9,999,999",
        28 => "a value is missing from the line",
        29 => "G59.1 to G59.3 are not supported",
        30 => "G53 goes with G0 and G1 only",
        31 => "axis words stand in a line that does not use them",
        32 | 35 => "the arc names neither centre nor radius in its plane",
        33 => "the arc's end does not lie on its circle: numbers were rounded too far or bytes lost",
        34 => "the arc's radius is too small to reach its end",
        36 => "words stand in the line that nothing uses",
        37 => "G43.1 sets the length of the z axis only",
        38 => "tool numbers end at 255",
        _ if firmware == Firmware::Grbl => "an error GRBL 1.1 does not know: the answer may have been garbled",
        _ => "an error of this firmware's own; grblHAL lists them with $EE, FluidNC in its manual",
    }
}

/// What `ALARM:code` means and what to do, as one sentence.
pub fn alarm_advice(firmware: Firmware, code: u16) -> &'static str {
    match (firmware, code) {
        (_, 1) => "a limit switch was hit: the position is lost; free the head, reset, then home",
        (_, 2) => {
            "a move would have left the travel (soft limit): the position is kept; reset, unlock, and look at the work zero"
        }
        (_, 3) => "reset while moving: steps may be lost; home or zero again",
        (_, 4) => "the probe was already closed before probing; free it",
        (_, 5) => "the probe touched nothing within its travel",
        (_, 6) => "homing was reset; home again",
        (_, 7) => "the door opened while homing; close it and home again",
        (_, 8) => "homing could not leave the switch: raise the pull-off ($27) or look at the wiring",
        (_, 9) => "homing found no switch within the travel: look at $130-$132, $23 and the wiring",
        (Firmware::Grbl, 10) => "homing found the second switch of a double axis too far off",
        (Firmware::GrblHal, 10) => "the emergency stop is pressed; release it, then reset",
        (Firmware::GrblHal, 11) => "homing is required before anything else",
        (Firmware::GrblHal, 12) => "a limit switch is closed; free the head",
        (Firmware::GrblHal, 14) => "the spindle or laser did not come up in time",
        (Firmware::GrblHal, 17) => "a motor driver reports a fault; switch off and look",
        (Firmware::GrblHal, _) => "an alarm of grblHAL's own; $EA lists them",
        (Firmware::FluidNc, 10) => "the spindle or laser could not be controlled",
        (Firmware::FluidNc, 11) => "a control pin was closed at start",
        (Firmware::FluidNc, 12) => "a limit switch is closed and it is not known at which end",
        (Firmware::FluidNc, 13) => "a hard stop",
        (Firmware::FluidNc, 14) => "the machine has not been homed",
        (Firmware::FluidNc, _) => "an alarm of FluidNC's own; its manual lists them",
        (Firmware::Grbl, _) => "an alarm GRBL 1.1 does not know: the answer may have been garbled",
    }
}

/// True for alarms after which a board answers nothing until it is reset.
pub(super) fn is_critical(firmware: Firmware, code: u16) -> bool {
    matches!((firmware, code), (_, 1 | 2) | (Firmware::GrblHal, 10 | 17 | 20))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_number_means_something_else_on_another_firmware() {
        let all = [Firmware::Grbl, Firmware::GrblHal, Firmware::FluidNc].map(|f| alarm_advice(f, 10));
        assert!(all[0] != all[1] && all[1] != all[2]);
        assert!(is_critical(Firmware::GrblHal, 10) && !is_critical(Firmware::Grbl, 10));
    }

    #[test]
    fn every_error_of_grbl_has_its_own_sentence() {
        for code in (1..=17).chain(20..=38) {
            assert!(!error_advice(Firmware::Grbl, code).contains("does not know:"), "{code}");
        }
        assert!(error_advice(Firmware::Grbl, 200).contains("garbled"));
    }
}
