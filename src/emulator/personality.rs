//! Firmware that speaks GRBL's protocol and is not GRBL: what it calls itself, and what it does not suffer from.

use super::board::Board;

/// Whose board this is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Personality {
    /// GRBL 1.1h on an ATmega328p.
    Grbl,
    /// grblHAL 1.1f on a 32-bit controller with USB of its own.
    GrblHal,
    /// FluidNC 3.7 on an ESP32: talks while it boots, does not tell its buffers.
    FluidNc,
}

impl Personality {
    /// What it calls itself when it starts.
    pub(super) fn banner(self) -> &'static str {
        match self {
            Personality::Grbl => "Grbl 1.1h ['$' for help]",
            Personality::GrblHal => "GrblHAL 1.1f ['$' or '$HELP' for help]",
            Personality::FluidNc => "Grbl 3.7 [FluidNC v3.7.8 (wifi) '$' for help]",
        }
    }

    /// What it says while it boots, before the banner.
    pub(super) fn boot_noise(self) -> &'static [&'static str] {
        match self {
            Personality::Grbl | Personality::GrblHal => &[],
            Personality::FluidNc => &[
                "ets Jun  8 2016 00:22:57",
                "rst:0x1 (POWERON_RESET),boot:0x13 (SPI_FAST_FLASH_BOOT)",
                "[MSG:INFO: FluidNC v3.7.8]",
                "[MSG:INFO: Compiled with ESP32 SDK:v4.4.4]",
                "[MSG:INFO: Machine: laser]",
            ],
        }
    }

    /// Characters a line may have: LINE_BUFFER_SIZE - 1 of GRBL, 256 of grblHAL (protocol.h), 255 of FluidNC (Channel.h).
    pub(super) fn line_chars(self) -> usize {
        match self {
            Personality::Grbl => 79,
            Personality::GrblHal => 256,
            Personality::FluidNc => 255,
        }
    }

    /// Time with deaf ears for every byte that is stored, s: 3.4 ms on an ATmega328p (data sheet: erase and write); the others store in the
    /// background.
    pub(super) fn eeprom_byte_s(self) -> f64 {
        match self {
            Personality::Grbl => super::link::EEPROM_BYTE_S,
            Personality::GrblHal | Personality::FluidNc => 0.0,
        }
    }
}

impl Board {
    /// The lines of `$I`.
    pub(super) fn build_lines(&self) -> Vec<String> {
        let (blocks, bytes, user) =
            (self.hardware.planner_blocks, self.hardware.rx_bytes, self.memory.build_info.as_str());
        match self.hardware.personality {
            Personality::Grbl => vec![format!("[VER:1.1h.20190830:{user}]"), format!("[OPT:V,{blocks},{bytes}]")],
            // It counts the place its ring buffer needs between end and start as one it has.
            Personality::GrblHal => vec![
                format!("[VER:1.1f.20240801:{user}]"),
                format!("[OPT:VNMSL,{blocks},{},3,0]", bytes + 1),
                "[NEWOPT:ENUMS,RT+]".into(),
                "[FIRMWARE:grblHAL]".into(),
            ],
            Personality::FluidNc => vec![
                format!("[VER:3.7 FluidNC v3.7.8 (esp32-wifi) :{user}]"),
                "[OPT:PHS]".into(),
                "[MSG:Machine: laser]".into(),
            ],
        }
    }
}
