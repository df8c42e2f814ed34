//! What is cut this time: which pieces, how often, for whom, and where on the machine.

use std::path::PathBuf;

use clap::ValueEnum;

use super::Failure;
use crate::job::{Anchor, Batch, StartFrom};

/// Choices for one run, no part of the design.
#[derive(Debug, clap::Args)]
pub(super) struct BatchArgs {
    /// Cut only these pieces, as when one was torn: A3,B1
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// Number of sets, each on sheets of its own
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=500))]
    copies: u32,
    /// File with a name on each line, lettered on the margin of one set each
    #[arg(long, value_name = "FILE")]
    names: Option<PathBuf>,
    /// Where the job lies: where the machine knows the sheet to be, with a point of it (--anchor) at work zero, or at where the head stands
    #[arg(long, value_name = "WHERE", default_value = "absolute")]
    start_from: Start,
    /// Which point of the job lies there, with --start-from origin or current [default: front-left]
    #[arg(long, value_name = "POINT")]
    anchor: Option<AnchorPoint>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Start {
    /// The sheet lies in the machine's stop corner
    Absolute,
    /// The anchor lies at work X0 Y0, as set by hand
    Origin,
    /// The anchor lies where the head stands when the job starts
    Current,
}

/// Nine points of the box around the job.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum AnchorPoint {
    FrontLeft,
    Front,
    FrontRight,
    Left,
    Center,
    Right,
    BackLeft,
    Back,
    BackRight,
}

impl AnchorPoint {
    fn anchor(self) -> Anchor {
        let (x, y) = match self {
            AnchorPoint::FrontLeft => (0.0, 0.0),
            AnchorPoint::Front => (0.5, 0.0),
            AnchorPoint::FrontRight => (1.0, 0.0),
            AnchorPoint::Left => (0.0, 0.5),
            AnchorPoint::Center => (0.5, 0.5),
            AnchorPoint::Right => (1.0, 0.5),
            AnchorPoint::BackLeft => (0.0, 1.0),
            AnchorPoint::Back => (0.5, 1.0),
            AnchorPoint::BackRight => (1.0, 1.0),
        };
        Anchor { x, y }
    }
}

impl BatchArgs {
    /// What is cut this time.
    pub fn batch(&self) -> Result<Batch, Failure> {
        let anchor = self.anchor.unwrap_or(AnchorPoint::FrontLeft).anchor();
        let start = match self.start_from {
            Start::Absolute if self.anchor.is_some() => {
                let way_out = "--anchor says which point lies at a place set by hand: add --start-from origin or --start-from current";
                return Err(Failure::config(way_out.to_owned()));
            }
            Start::Absolute => StartFrom::Absolute,
            Start::Origin => StartFrom::Origin(anchor),
            Start::Current => StartFrom::Current(anchor),
        };
        let names = match &self.names {
            None => Vec::new(),
            Some(file) => {
                let text =
                    std::fs::read_to_string(file).map_err(|e| Failure::config(format!("{}: {e}", file.display())))?;
                text.lines().map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned).collect()
            }
        };
        Ok(Batch { only: self.only.clone(), copies: self.copies as usize, names, start })
    }
}
