//! What the board is: its hardware, and the `$n` settings it keeps in its EEPROM.

use super::memory::Memory;
use super::personality::Personality;
use crate::gcode::Limits;
use crate::geom::P3;

/// The board and the machine around it.
#[derive(Debug, Clone, PartialEq)]
pub struct BoardSettings {
    /// `$n` settings as they are in the EEPROM when the board is made.
    pub settings: Settings,
    /// Bits per second of the link, ten a byte.
    pub baud: f64,
    /// How long the boot loader eats bytes after a reset by the port, s; 1.7 measured on an ATmega328p.
    pub boot_s: f64,
    /// True when opening the port resets the board (DTR).
    pub resets_on_open: bool,
    /// Time to read and plan a line with a motion, s: 0.0037 measured on an ATmega328p, half of it for other lines.
    pub line_s: f64,
    /// Blocks the planner holds.
    pub planner_blocks: usize,
    /// Bytes the receive buffer holds.
    pub rx_bytes: usize,
    /// Where the head really is when the board is made, mm from the home switches' corner; the board itself starts at 0.
    pub head_mm: P3,
    /// What else is in the EEPROM when the board is made.
    pub memory: Memory,
    /// Whose firmware it runs.
    pub personality: Personality,
    /// Seed of corrupted bytes.
    pub seed: u64,
}

impl Default for BoardSettings {
    /// The board of the measurements: 115200 baud, 128 bytes, 15 blocks, 400 x 400 mm.
    fn default() -> BoardSettings {
        BoardSettings {
            settings: Settings::default(),
            baud: 115_200.0,
            boot_s: 1.7,
            resets_on_open: true,
            line_s: 0.0037,
            planner_blocks: 15,
            rx_bytes: 128,
            head_mm: P3::origin(),
            memory: Memory::default(),
            personality: Personality::Grbl,
            seed: 1,
        }
    }
}

impl BoardSettings {
    /// A board with grblHAL: USB of its own, so that opening does not reset it, and long buffers. Its times are estimates, not measurements.
    pub fn grbl_hal() -> BoardSettings {
        BoardSettings {
            personality: Personality::GrblHal,
            baud: 1_000_000.0,
            boot_s: 0.3,
            resets_on_open: false,
            line_s: 0.0002,
            planner_blocks: 100,
            rx_bytes: 1023,
            ..BoardSettings::default()
        }
    }

    /// A board with FluidNC on its serial line. Its times are estimates, not measurements.
    pub fn fluid_nc() -> BoardSettings {
        BoardSettings {
            personality: Personality::FluidNc,
            boot_s: 1.0,
            line_s: 0.0004,
            planner_blocks: 16,
            rx_bytes: 256,
            ..BoardSettings::default()
        }
    }
}

/// `$n` settings: numbers and values in the order `$$` lists them.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    values: Vec<(u16, f64)>,
}

/// Numbers of on/off settings.
const SWITCHES: &[u16] = &[4, 5, 6, 13, 20, 21, 22, 32];

/// Numbers of settings that are listed with three decimals.
const DECIMALS: &[u16] = &[11, 12, 24, 25, 27, 100, 101, 102, 110, 111, 112, 120, 121, 122, 130, 131, 132];

impl Default for Settings {
    /// The settings of the measured board, with homing and limits off.
    fn default() -> Settings {
        let values = [
            (0, 10.0),
            (1, 255.0),
            (2, 0.0),
            (3, 0.0),
            (4, 0.0),
            (5, 0.0),
            (6, 0.0),
            (10, 3.0),
            (11, 0.01),
            (12, 0.002),
            (13, 0.0),
            (20, 0.0),
            (21, 0.0),
            (22, 0.0),
            (23, 3.0),
            (24, 25.0),
            (25, 1500.0),
            (26, 250.0),
            (27, 2.0),
            (30, 1000.0),
            (31, 0.0),
            (32, 1.0),
            (100, 80.0),
            (101, 80.0),
            (102, 80.0),
            (110, 10_000.0),
            (111, 10_000.0),
            (112, 3000.0),
            (120, 500.0),
            (121, 500.0),
            (122, 100.0),
            (130, 400.0),
            (131, 400.0),
            (132, 50.0),
        ];
        Settings { values: values.to_vec() }
    }
}

impl Settings {
    /// The value of `$number`; 0 for a number there is not.
    pub fn get(&self, number: u16) -> f64 {
        self.values.iter().find(|(n, _)| *n == number).map_or(0.0, |(_, value)| *value)
    }

    /// The same settings with one changed; numbers there are not are left out.
    pub fn with(mut self, number: u16, value: f64) -> Settings {
        if let Some(place) = self.values.iter_mut().find(|(n, _)| *n == number) {
            place.1 = value;
        }
        self
    }

    /// True for an on/off setting that is on.
    pub(super) fn is_on(&self, number: u16) -> bool {
        self.get(number) != 0.0
    }

    /// `$number=value` as GRBL takes it (settings.c, settings_store_global_setting): how many bytes of the EEPROM change.
    ///
    /// # Errors
    /// GRBL's error number: 3 unknown, 4 negative, 5 and 10 limits without homing.
    pub(super) fn store(&mut self, number: u16, value: f64) -> Result<usize, u8> {
        if value < 0.0 {
            return Err(4);
        }
        if number == 20 && value != 0.0 && !self.is_on(22) {
            return Err(10);
        }
        let stored = match number {
            n if SWITCHES.contains(&n) => f64::from(u8::from(value != 0.0)),
            n if DECIMALS.contains(&n) || n == 30 || n == 31 => value,
            _ => value.trunc().min(255.0),
        };
        let place = self.values.iter_mut().find(|(n, _)| *n == number).ok_or(3)?;
        let before = std::mem::replace(&mut place.1, stored);
        if number == 22 && stored == 0.0 {
            // Soft limits need homing.
            *self = self.clone().with(20, 0.0);
        }
        Ok(changed_bytes(&[before], &[stored]))
    }

    /// The lines of `$$`.
    pub(super) fn lines(&self) -> impl Iterator<Item = String> {
        self.values.iter().map(|(n, value)| match DECIMALS.contains(n) {
            true => format!("${n}={value:.3}"),
            false => format!("${n}={value:.0}"),
        })
    }

    /// The planner's limits.
    pub(super) fn limits(&self, board: &BoardSettings) -> Limits {
        let axes = |first: u16| [first, first + 1, first + 2].map(|n| self.get(n).max(1e-3));
        Limits {
            max_rate_mm_per_min: axes(110),
            acceleration_mm_per_s2: axes(120),
            junction_deviation_mm: self.get(11),
            arc_tolerance_mm: self.get(12),
            planner_blocks: board.planner_blocks,
            bytes_per_s: board.baud / 10.0,
            rx_bytes: board.rx_bytes,
            line_s: board.line_s,
        }
    }
}

/// Bytes of the EEPROM that differ between values stored as 32-bit floats, and one for the checksum (eeprom.c writes only these).
pub(super) fn changed_bytes(before: &[f64], after: &[f64]) -> usize {
    let bytes = |v: f64| (v as f32).to_le_bytes();
    let pairs = before.iter().zip(after);
    let changed: usize = pairs.map(|(b, a)| bytes(*b).iter().zip(bytes(*a)).filter(|(b, a)| **b != *a).count()).sum();
    if changed > 0 { changed + 1 } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_refuse_what_grbl_refuses_and_cost_the_bytes_that_change() {
        let mut s = Settings::default();
        assert_eq!(s.store(20, 1.0), Err(10));
        assert_eq!(s.store(110, -1.0), Err(4));
        assert_eq!(s.store(99, 1.0), Err(3));
        assert_eq!(s.store(110, 10_000.0), Ok(0), "nothing changes");
        assert!(s.store(110, 6000.0).unwrap() >= 2);
        assert!(s.store(22, 1.0).is_ok() && s.store(20, 1.0).is_ok());
        s.store(22, 0.0).unwrap();
        assert_eq!(s.get(20), 0.0, "soft limits go with homing");
        assert!(s.lines().any(|l| l == "$110=6000.000") && s.lines().any(|l| l == "$32=1"));
    }
}
