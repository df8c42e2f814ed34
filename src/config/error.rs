//! What can go wrong with machines and profiles.

use std::fmt;
use std::path::PathBuf;

use super::machine::ToolClass;
use super::source::Problem;

/// Why a machine or profile cannot be had, or why the two do not go together.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// No file of that name, neither built in nor in the user's folder.
    #[error("no {kind} is called \"{name}\"{} (`furbelow {kind} list` shows all, the path of a .toml file works too)",
        near.as_ref().map(|n| format!("; did you mean \"{n}\"?")).unwrap_or_default())]
    Unknown {
        /// What was looked for.
        kind: Kind,
        /// The name asked for.
        name: String,
        /// The most similar name there is.
        near: Option<String>,
    },
    /// A file or folder cannot be read.
    #[error("cannot read {}", path.display())]
    Read {
        /// Where it is.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file says something it may not say. Holds everything that was found.
    #[error("{}", problems.iter().map(Problem::to_string).collect::<Vec<_>>().join("\n"))]
    Invalid {
        /// At least one, in the order of the file.
        problems: Vec<Problem>,
    },
    /// The file is no TOML.
    #[error("{file}")]
    Toml {
        /// What messages call it.
        file: String,
        /// What is wrong and where.
        source: toml_edit::TomlError,
    },
    /// A process row belongs to a machine, and none was named.
    #[error("{key} depends on the machine: name it with --machine")]
    NeedsMachine {
        /// The key asked for.
        key: String,
    },
    /// A key that names a table where a value is meant, or goes through a value.
    #[error("{file}: {key} is no single value; name one in it, such as joint.laser.slit_extra_mm")]
    NoTable {
        /// What messages call the file.
        file: String,
        /// The key asked for.
        key: String,
    },
    /// The profile says that this tool must never touch this material.
    #[error("{profile} must not be cut with a {} ({machine}): {reason}; take another machine or another material", class.title())]
    Forbidden {
        /// Name of the machine.
        machine: String,
        /// Name of the profile.
        profile: String,
        /// The machine's tool.
        class: ToolClass,
        /// Why, in the profile's words.
        reason: String,
    },
    /// The profile has no settings for this tool.
    #[error("{profile} has no [[process]] row for cutting with a {} ({machine}); add one to the profile, or take a machine with a {tools}",
        class.title())]
    NoProcess {
        /// Name of the machine.
        machine: String,
        /// Name of the profile.
        profile: String,
        /// The machine's tool.
        class: ToolClass,
        /// Tools the profile can be cut with.
        tools: String,
    },
    /// The laser's power is too far from that of any row for rescaling to mean anything.
    #[error(
        "{machine} has {power_w} W; the nearest values of {profile} are for {reference_power_w} W, and rescaling holds from half to twice \
        that: `calibrate power` on this machine, or add a measured [[process]] row to the profile"
    )]
    NeedsCalibration {
        /// Name of the machine.
        machine: String,
        /// Name of the profile.
        profile: String,
        /// The machine's optical power, W.
        power_w: f64,
        /// That of the nearest row, W.
        reference_power_w: f64,
    },
    /// Even at its power floor and full speed the laser gives the material too much energy.
    #[error("{machine} is too strong for {profile}: at its least power ({:.0} %) it would have to {operation} at {feed_mm_per_min:.0} mm/min, \
        its limit is {limit_mm_per_min:.0}; take a weaker laser", power_floor * 100.0)]
    TooStrong {
        /// Name of the machine.
        machine: String,
        /// Name of the profile.
        profile: String,
        /// "cut" or "engrave".
        operation: &'static str,
        /// The tool's floor, 0..1.
        power_floor: f64,
        /// The feed that would be right.
        feed_mm_per_min: f64,
        /// The machine's fastest feed.
        limit_mm_per_min: f64,
    },
}

impl Error {
    /// True when machine and profile are each in order but do not go together: the job cannot be made (exit code 1). All other errors
    /// are about names and files (exit code 2).
    pub fn refuses_job(&self) -> bool {
        match self {
            Error::Unknown { .. }
            | Error::Read { .. }
            | Error::Invalid { .. }
            | Error::Toml { .. }
            | Error::NeedsMachine { .. }
            | Error::NoTable { .. } => false,
            Error::Forbidden { .. }
            | Error::NoProcess { .. }
            | Error::NeedsCalibration { .. }
            | Error::TooStrong { .. } => true,
        }
    }
}

/// The two kinds of files in this room.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// machines/NAME.toml
    Machine,
    /// profiles/NAME.toml
    Profile,
}

impl Kind {
    /// The folder files of this kind live in.
    pub fn folder(self) -> &'static str {
        match self {
            Kind::Machine => "machines",
            Kind::Profile => "profiles",
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Kind::Machine => "machine",
            Kind::Profile => "profile",
        })
    }
}
