//! What a board sends, line by line.

use super::status::Status;

/// The firmware a board runs. Some alarms and errors mean different things on each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Firmware {
    /// GRBL 1.1.
    Grbl,
    /// grblHAL.
    GrblHal,
    /// FluidNC.
    FluidNc,
}

/// One line of a board's.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Reply {
    /// A line was taken.
    Ok,
    /// A line was refused.
    Error(u16),
    /// Something is wrong; the board is locked.
    Alarm(u16),
    /// The board has started.
    Banner { firmware: Firmware, version: String },
    /// A status report.
    Status(Status),
    /// `$n=v`.
    Setting(u16, f64),
    /// `[OPT:...,blocks,bytes]` of `$I`.
    Buffers { blocks: usize, bytes: usize },
    /// `[VER:...]` of `$I`.
    Version(String),
    /// `[FIRMWARE:...]` of `$I`, where it is one that is known.
    Firmware(Firmware),
    /// `[MSG:...]`.
    Message(String),
    /// `[GC:...]` of `$G`: the modes in effect, as words.
    Modes(String),
    /// `[G92:x,y,z]` of `$#`, mm.
    Shift([f64; 3]),
    /// `[TLO:z]` of `$#`, mm; of three axes that of the tool.
    ToolLength(f64),
    /// `>LINE:ok`: a line the board keeps has been carried out.
    Startup(String),
    /// Any other answer, for people.
    Text(String),
}

impl Firmware {
    /// The name people read.
    pub fn title(self) -> &'static str {
        match self {
            Firmware::Grbl => "GRBL",
            Firmware::GrblHal => "grblHAL",
            Firmware::FluidNc => "FluidNC",
        }
    }

    /// Segments it may still be stepping after their block has left the planner, each of another block at worst: the places of its segment buffer but
    /// one (SEGMENT_BUFFER_SIZE is 6 in GRBL's stepper.h and 10 in grblHAL's; FluidNC's configuration says 12).
    pub(super) fn segments(self) -> usize {
        match self {
            Firmware::Grbl => 5,
            Firmware::GrblHal => 9,
            Firmware::FluidNc => 11,
        }
    }

    /// Longest line it takes, in characters without the line feed.
    pub(super) fn line_chars(self) -> usize {
        match self {
            Firmware::Grbl => 79,
            Firmware::GrblHal | Firmware::FluidNc => 254,
        }
    }
}

impl Reply {
    /// Reads a line without its line feed; `None` for an empty one. Only `ok` alone and `error:n` alone answer a line: `>startup:ok` does not,
    /// nor does what noise has made of them.
    pub(super) fn parse(line: &str, inches: bool) -> Option<Reply> {
        let line = line.trim();
        if line.is_empty() {
            return None;
        }
        let text = || Reply::Text(line.to_owned());
        let coded = |code: &str| code.parse::<u16>().ok();
        Some(if line == "ok" {
            Reply::Ok
        } else if let Some(code) = line.strip_prefix("error:").and_then(coded) {
            Reply::Error(code)
        } else if let Some(code) = line.strip_prefix("ALARM:").and_then(coded) {
            Reply::Alarm(code)
        } else if line.starts_with('<') {
            Status::parse(line, inches).map_or_else(text, Reply::Status)
        } else if let Some(banner) = banner(line) {
            banner
        } else if let Some(setting) = line.strip_prefix('$') {
            setting_of(setting).unwrap_or_else(text)
        } else if let Some(startup) = line.strip_prefix('>').and_then(|l| l.strip_suffix(":ok")) {
            Reply::Startup(startup.to_owned())
        } else if let Some(inside) = line.strip_prefix('[').and_then(|l| l.strip_suffix(']')) {
            bracketed(inside, inches).unwrap_or_else(text)
        } else {
            text()
        })
    }
}

fn banner(line: &str) -> Option<Reply> {
    let (word, rest) = line.split_once(' ')?;
    let version = rest.split_whitespace().next().unwrap_or("").to_owned();
    if !version.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let firmware = match word {
        "GrblHAL" => Firmware::GrblHal,
        "Grbl" if rest.contains("FluidNC") => Firmware::FluidNc,
        "Grbl" => Firmware::Grbl,
        _ => return None,
    };
    Some(Reply::Banner { firmware, version })
}

fn setting_of(text: &str) -> Option<Reply> {
    let (number, value) = text.split_once('=')?;
    // Older boards put a description in parentheses behind the value.
    let value = value.split([' ', '(']).next()?;
    Some(Reply::Setting(number.parse().ok()?, value.parse().ok()?))
}

fn bracketed(inside: &str, inches: bool) -> Option<Reply> {
    let (key, value) = inside.split_once(':')?;
    let unit_mm = if inches { 25.4 } else { 1.0 };
    let lengths_mm = || -> Vec<f64> {
        let lengths: Option<Vec<f64>> = value.split(',').map(|number| number.trim().parse().ok()).collect();
        lengths.unwrap_or_default().iter().map(|length| length * unit_mm).collect()
    };
    match key {
        "MSG" => Some(Reply::Message(value.to_owned())),
        "GC" => Some(Reply::Modes(value.to_owned())),
        "G92" => match lengths_mm()[..] {
            [x, y, z, ..] => Some(Reply::Shift([x, y, z])),
            _ => None,
        },
        "TLO" => match lengths_mm()[..] {
            [z] | [_, _, z, ..] => Some(Reply::ToolLength(z)),
            _ => None,
        },
        "FIRMWARE" if value == "grblHAL" => Some(Reply::Firmware(Firmware::GrblHal)),
        "VER" => Some(Reply::Version(value.trim_end_matches(':').to_owned())),
        "OPT" => {
            let mut parts = value.split(',').skip(1);
            let blocks = parts.next()?.parse().ok()?;
            Some(Reply::Buffers { blocks, bytes: parts.next()?.parse().ok()? })
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(line: &str) -> Option<Reply> {
        Reply::parse(line, false)
    }

    #[test]
    fn only_ok_and_error_answer_a_line() {
        assert_eq!(read("ok\r"), Some(Reply::Ok));
        assert_eq!(read("error:20"), Some(Reply::Error(20)));
        assert_eq!(read(">G54G20:ok"), Some(Reply::Startup("G54G20".into())));
        for text in ["okok", "o", "eror:9", "error:x", "k"] {
            assert_eq!(read(text), Some(Reply::Text(text.into())), "{text}");
        }
        assert_eq!(read("  "), None);
    }

    #[test]
    fn every_firmware_is_known_by_its_banner() {
        let cases = [
            ("Grbl 1.1h ['$' for help]", Firmware::Grbl, "1.1h"),
            ("GrblHAL 1.1f ['$' or '$HELP' for help]", Firmware::GrblHal, "1.1f"),
            ("Grbl 3.7 [FluidNC v3.7.8 (wifi) '$' for help]", Firmware::FluidNc, "3.7"),
        ];
        for (line, firmware, version) in cases {
            assert_eq!(read(line), Some(Reply::Banner { firmware, version: version.into() }));
        }
        assert_eq!(read("Grbl is busy"), Some(Reply::Text("Grbl is busy".into())));
    }

    #[test]
    fn settings_buffers_and_messages_are_values() {
        assert_eq!(read("$30=1000"), Some(Reply::Setting(30, 1000.0)));
        assert_eq!(read("$110=500.000 (x max rate, mm/min)"), Some(Reply::Setting(110, 500.0)));
        assert_eq!(read("$N0=G54"), Some(Reply::Text("$N0=G54".into())));
        assert_eq!(read("[OPT:VNMSL,35,1024,3,0]"), Some(Reply::Buffers { blocks: 35, bytes: 1024 }));
        assert_eq!(read("[MSG:'$H'|'$X' to unlock]"), Some(Reply::Message("'$H'|'$X' to unlock".into())));
        assert_eq!(read("[FIRMWARE:grblHAL]"), Some(Reply::Firmware(Firmware::GrblHal)));
        assert_eq!(read("ALARM:2"), Some(Reply::Alarm(2)));
        assert_eq!(read("[G92:1.000,-2.500,0.000]"), Some(Reply::Shift([1.0, -2.5, 0.0])));
        assert_eq!(Reply::parse("[TLO:0.500]", true), Some(Reply::ToolLength(12.7)));
        assert_eq!(read("[TLO:0.000,0.000,1.500]"), Some(Reply::ToolLength(1.5)));
        assert_eq!(read("[G92:1.000]"), Some(Reply::Text("[G92:1.000]".into())));
    }
}
