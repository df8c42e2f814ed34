//! What is known of the board at the other end.

use std::collections::BTreeMap;

use super::reply::Firmware;

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
