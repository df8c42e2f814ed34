//! What is known of the board at the other end.

use std::collections::BTreeMap;

use super::reply::Firmware;
use super::status::Status;
use crate::geom::tolerance;

/// What a board told about itself; GRBL 1.1's values where it has not told.
#[derive(Debug, Clone, PartialEq)]
pub struct Board {
    /// Its firmware.
    pub firmware: Firmware,
    /// Its version, as the banner or `$I` gave it; empty when neither did.
    pub version: String,
    /// Moves its planner holds.
    pub blocks: usize,
    /// It has told how many these are; otherwise it is the most that a report had free.
    pub blocks_told: bool,
    /// Bytes its receive buffer holds.
    pub rx_bytes: usize,
    /// Its settings `$n`, by number, in the board's own units.
    pub settings: BTreeMap<u16, f64>,
    /// Where work zero lies in machine coordinates, mm; `None` before the first report that says so.
    pub offset_mm: Option<[f64; 3]>,
    /// G92 as it is in effect, mm, a part of `offset_mm`; `None` where the board has not told.
    pub shift_mm: Option<[f64; 3]>,
    /// The tool's length (G43.1) as it is in effect, mm, a part of `offset_mm` along z; `None` where the board has not told.
    pub tool_length_mm: Option<f64>,
    /// Where the head was last seen in machine coordinates, mm.
    pub machine_mm: Option<[f64; 3]>,
    /// It has been homed since it was opened, with this session.
    pub homed: bool,
    /// It started anew when its port was opened, or later: it takes where the head stood then for machine zero until it is homed.
    pub restarted: bool,
}

impl Default for Board {
    fn default() -> Board {
        Board {
            firmware: Firmware::Grbl,
            version: String::new(),
            blocks: 15,
            blocks_told: false,
            rx_bytes: 128,
            settings: BTreeMap::new(),
            offset_mm: None,
            shift_mm: None,
            tool_length_mm: None,
            machine_mm: None,
            homed: false,
            restarted: false,
        }
    }
}

impl Board {
    /// A setting that is on or off; `None` when the board has not told.
    pub fn switch(&self, number: u16) -> Option<bool> {
        self.settings.get(&number).map(|v| *v != 0.0)
    }

    /// True when machine coordinates mean something: it was homed, or keeps soft limits, which need homing ($20), and has not started anew since.
    pub fn knows_place(&self) -> bool {
        self.homed || self.switch(20) == Some(true) && !self.restarted
    }

    /// Takes in what a report tells of the place.
    pub fn seen(&mut self, status: &Status) {
        self.machine_mm = status.machine_mm.or(self.machine_mm);
        if let Some((machine, work)) = status.machine_mm.zip(status.work_mm) {
            self.offset_mm = Some(std::array::from_fn(|k| machine[k] - work[k]));
        }
    }

    /// Where an axis (0 for x) may be in machine coordinates, mm, lowest and highest, when it travels so far and knows its place. In GRBL that is from
    /// minus the travel to 0, wherever the switches are (limits.c, limits_go_home). In grblHAL told to make the switches its origin ($22 bit 3) an
    /// axis that homes downwards ($23) runs up from 0, as those of FluidNC commonly do; a head that is seen off 0 shows which.
    pub fn reach_mm(&self, axis: usize, travel_mm: f64) -> (f64, f64) {
        let bit = |number: u16, bit: usize| self.settings.get(&number).map(|mask| (*mask as u16) >> bit & 1 == 1);
        let seen_mm = self.machine_mm.map_or(0.0, |at| at[axis]);
        let upwards = if seen_mm.abs() > tolerance::LIMIT_SLACK_MM {
            seen_mm > 0.0
        } else {
            bit(22, 3) == Some(true) && bit(23, axis) != Some(false)
        };
        if upwards { (0.0, travel_mm) } else { (-travel_mm, 0.0) }
    }

    /// Bytes that may be under way. grblHAL's ring buffer holds one byte less than it tells; GRBL's holds what it tells.
    pub(super) fn window_bytes(&self) -> usize {
        match self.firmware {
            Firmware::GrblHal => self.rx_bytes - 1,
            Firmware::Grbl | Firmware::FluidNc => self.rx_bytes,
        }
    }

    /// Blocks that may be under way at most: those of the planner, and those that have left it and are being stepped.
    pub(super) fn open_blocks(&self) -> usize {
        self.blocks + self.firmware.segments()
    }

    /// Reports come in inches ($13).
    pub(super) fn inches(&self) -> bool {
        self.switch(13) == Some(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn machine_space_runs_down_from_the_switches_or_up_from_an_origin_there() {
        let board = |settings: &[(u16, f64)], x_mm: f64| Board {
            settings: settings.iter().copied().collect(),
            machine_mm: Some([x_mm, 0.0, 0.0]),
            ..Board::default()
        };
        let (down, up) = ((-400.0, 0.0), (0.0, 400.0));
        for (settings, x_mm, expected) in [
            (&[(22, 1.0), (23, 3.0)][..], 0.0, [down, down]),
            // 43 is 32 + 8 + 2 + 1.
            (&[(22, 43.0), (23, 3.0)], 0.0, [up, up]),
            (&[(22, 43.0), (23, 2.0)], 0.0, [down, up]),
            (&[(22, 43.0)], 0.0, [up, up]),
            (&[], 1.0, [up, down]),
            (&[(22, 43.0), (23, 3.0)], -1.0, [down, up]),
        ] {
            let board = board(settings, x_mm);
            assert_eq!([0, 1].map(|axis| board.reach_mm(axis, 400.0)), expected, "{settings:?} {x_mm}");
        }
        assert_eq!(Board::default().reach_mm(0, 300.0), (-300.0, 0.0));
    }
}
