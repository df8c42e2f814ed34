//! What besides the `$n` settings survives power: work offsets, stored places, startup lines, the text of `$I`.

use super::settings::changed_bytes;
use crate::geom::{P3, V3};

/// Startup lines GRBL keeps (N_STARTUP_LINE).
pub(super) const STARTUP_LINES: usize = 2;

/// The part of the EEPROM that programs and `$` commands write.
#[derive(Debug, Clone, PartialEq)]
pub struct Memory {
    /// Origins of G54 to G59, mm.
    pub offsets_mm: [V3; 6],
    /// The places of G28 and G30, machine coordinates, mm.
    pub homes_mm: [P3; 2],
    /// `$N0` and `$N1`: carried out after every start that does not lock the board, and after homing. Empty for none.
    pub startup: [String; STARTUP_LINES],
    /// The user's part of `$I`.
    pub build_info: String,
}

impl Default for Memory {
    /// As it leaves the factory: all zero and empty.
    fn default() -> Memory {
        Memory {
            offsets_mm: [V3::zeros(); 6],
            homes_mm: [P3::origin(); 2],
            startup: Default::default(),
            build_info: String::new(),
        }
    }
}

impl Memory {
    /// Bytes of the EEPROM that are written when this takes the place of `before`; none when nothing changes.
    pub(super) fn bytes_changed(&self, before: &Memory) -> usize {
        let places = |m: &Memory| -> Vec<f64> {
            let offsets = m.offsets_mm.iter().flat_map(|v| [v.x, v.y, v.z]);
            offsets.chain(m.homes_mm.iter().flat_map(|p| [p.x, p.y, p.z])).collect()
        };
        let texts = |m: &Memory| [m.startup[0].clone(), m.startup[1].clone(), m.build_info.clone()];
        let text_bytes = texts(before).iter().zip(texts(self)).map(|(b, a)| text_bytes(b, &a)).sum::<usize>();
        changed_bytes(&places(before), &places(self)) + text_bytes
    }
}

/// Bytes that differ between two texts and their ends, and one for the checksum.
fn text_bytes(before: &str, after: &str) -> usize {
    let (b, a) = (before.as_bytes(), after.as_bytes());
    let differs = (0..b.len().max(a.len())).filter(|k| b.get(*k) != a.get(*k)).count();
    if differs > 0 { differs + 1 } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_changes_is_written() {
        let before = Memory::default();
        assert_eq!(before.bytes_changed(&before), 0);
        let placed = Memory { homes_mm: [P3::new(1.0, 0.0, 0.0), P3::origin()], ..before.clone() };
        // 1.0 as f32 is 00 00 80 3f: two bytes, and the checksum.
        assert_eq!(placed.bytes_changed(&before), 3);
        let named = Memory { build_info: "LASER".into(), ..before.clone() };
        assert_eq!(named.bytes_changed(&before), 6);
    }
}
