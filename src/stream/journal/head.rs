//! What is known of a job before its first line.

use serde::{Deserialize, Serialize};

use crate::stream::Board;
use sha2::{Digest, Sha256};

/// Version of the files of a job.
pub(super) const SCHEMA: u32 = 1;

/// A job as it begins. Places are mm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// Version of these files.
    pub schema: u32,
    /// What people call the program: its path when it was sent.
    pub name: String,
    /// Which sheet of the set it is, from 1, and of how many.
    pub sheet: (usize, usize),
    /// Name or path of the machine, as it was given.
    pub machine: String,
    /// Where its board hangs, as it was given, or better a name that stays when it is plugged in again.
    pub port: String,
    /// True where the machine's tool burns.
    pub laser: bool,
    /// Seconds since 1970 when it began.
    pub began_unix_s: u64,
    /// Firmware and version.
    pub firmware: String,
    /// Blocks the planner holds.
    pub blocks: usize,
    /// SHA-256 of the board's settings, hexadecimal: a board with others is another one, or was changed.
    pub settings_sha256: String,
    /// The machine had been homed: its coordinates mean the same after it is homed again.
    pub homed: bool,
    /// Its coordinates meant something, homed in that session or before: they still do while the board is not restarted.
    #[serde(default)]
    pub knew_place: bool,
    /// Where work zero lay in machine coordinates.
    pub offset_mm: Option<[f64; 3]>,
    /// Where the head stood in work coordinates.
    pub start_mm: Option<[f64; 3]>,
    /// Where the program's own X0 Y0 lay in work coordinates, before it was laid elsewhere.
    #[serde(default)]
    pub own_zero_mm: [f64; 2],
    /// It was sent although it was made for another machine.
    #[serde(default)]
    pub anyway: bool,
    /// Middles of the two alignment crosses in work coordinates, where the program has some.
    pub crosses_mm: Option<[[f64; 2]; 2]>,
    /// The job it goes on with.
    pub resumes: Option<u32>,
    /// SHA-256 of the copy of the program, hexadecimal.
    pub program_sha256: String,
    /// Its lines.
    pub lines: usize,
}

impl Head {
    /// A job of a name for a machine at a port; what a board tells of itself is filled in, all else is left open.
    pub fn new(name: impl Into<String>, machine: impl Into<String>, port: impl Into<String>, board: &Board) -> Head {
        Head {
            schema: SCHEMA,
            name: name.into(),
            sheet: (1, 1),
            machine: machine.into(),
            port: port.into(),
            laser: true,
            began_unix_s: 0,
            firmware: format!("{} {}", board.firmware.title(), board.version).trim_end().to_owned(),
            blocks: board.blocks,
            settings_sha256: settings_hash(board),
            homed: board.homed,
            knew_place: board.knows_place(),
            offset_mm: board.offset_mm,
            start_mm: None,
            own_zero_mm: [0.0; 2],
            anyway: false,
            crosses_mm: None,
            resumes: None,
            program_sha256: String::new(),
            lines: 0,
        }
    }
}

/// A hash of all settings a board has told.
pub(super) fn settings_hash(board: &Board) -> String {
    let mut hash = Sha256::new();
    for (number, value) in &board.settings {
        hash.update(format!("${number}={value}\n"));
    }
    hexadecimal(&hash.finalize())
}

/// Bytes as digits.
pub(super) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
