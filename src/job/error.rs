//! Why a job was not made, and whether the input or the request is to blame.

use std::path::PathBuf;

/// Everything that can end a job.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A machine or profile is not in order, or the pair is forbidden.
    #[error(transparent)]
    Config(#[from] crate::config::Error),
    /// The design file is not in order.
    #[error(transparent)]
    Design(#[from] crate::design::Error),
    /// A test card cannot be made, or an answer to it not used.
    #[error(transparent)]
    Calibrate(#[from] crate::calibrate::Error),
    /// A tool that cuts nothing has nothing to calibrate.
    #[error("{machine} cuts nothing, so there is nothing to calibrate; take a laser or a knife")]
    NothingCut {
        /// The machine.
        machine: String,
    },
    /// The mesh cannot be used.
    #[error(transparent)]
    Mesh(#[from] crate::mesh::Error),
    /// The shape cannot be taken apart as the design says.
    #[error("{what} {problem}")]
    Apart {
        /// "split 2", "part A: body 9".
        what: String,
        /// What is wrong, and the way out.
        problem: String,
    },
    /// The plane gives no outline.
    #[error("part {part}: {source}")]
    Cut {
        /// The part.
        part: String,
        /// Why.
        source: crate::cut::Error,
    },
    /// An outline that is given cannot be used.
    #[error("part {part}: its outline cannot be used: {problem}")]
    Outline {
        /// The part.
        part: String,
        /// What is wrong and what would be right.
        problem: String,
    },
    /// An edit does not apply, or does not any more.
    #[error(
        "{place}edit {number} ({what}) does not apply: {source}. Change it or take it out; `furbelow design undo` takes back the last one"
    )]
    Edit {
        /// "design.toml:12: ", where there is a file.
        place: String,
        /// Its number in the list, from 1.
        number: usize,
        /// The edit in words.
        what: String,
        /// Why.
        source: crate::ruffle::EditError,
    },
    /// A change that does not work.
    #[error("{what} cannot be done, and nothing was changed: {source}")]
    Change {
        /// The edit in words.
        what: String,
        /// Why.
        source: Box<Error>,
    },
    /// A request that names something the part does not have.
    #[error("part {part}: {problem}")]
    Request {
        /// The part.
        part: String,
        /// What is wrong and the way out.
        problem: String,
    },
    /// The mesh gives no widths.
    #[error("part {part}: {source}")]
    Extrude {
        /// The part.
        part: String,
        /// Why.
        source: crate::extrude::Error,
    },
    /// The outline cannot be filled.
    #[error(transparent)]
    Fit(#[from] crate::fit::Error),
    /// The strip cannot be laid flat.
    #[error(transparent)]
    Strip(#[from] crate::strip::Error),
    /// The pieces do not fit the stock.
    #[error(transparent)]
    Nest(#[from] crate::nest::Error),
    /// The sheet cannot be cut within the machine's limits.
    #[error("{sheet}: {source}")]
    Toolpath {
        /// The sheet.
        sheet: String,
        /// Why.
        source: crate::toolpath::Error,
    },
    /// The program cannot be written.
    #[error("{sheet}: {source}")]
    Gcode {
        /// The sheet.
        sheet: String,
        /// Why.
        source: crate::gcode::Error,
    },
    /// A file is no drawing of ours, or holds no outline.
    #[error("{file}: {source}")]
    Drawing {
        /// The file.
        file: String,
        /// Where and why.
        source: crate::drawing::Error,
    },
    /// A drawing of an offcut that shows none, or several.
    #[error("{file}: {outlines} outlines; an offcut is one closed outline, with holes and blocked places inside it")]
    Offcut {
        /// The file.
        file: String,
        /// Outermost outlines found.
        outlines: usize,
    },
    /// A value cannot be written as JSON.
    #[error("{file}: {source}")]
    Json {
        /// The file.
        file: String,
        /// Why.
        source: serde_json::Error,
    },
    /// A file is no G-code.
    #[error("{file}: {source}")]
    Parse {
        /// The file.
        file: String,
        /// Where and why.
        source: crate::gcode::ParseError,
    },
    /// A program cannot be carried out.
    #[error("{sheet}: {source}")]
    Trace {
        /// The sheet or file.
        sheet: String,
        /// Why.
        source: crate::gcode::TraceError,
    },
    /// The program that was written breaks a limit of the machine.
    #[error("{sheet}: {finding}")]
    Check {
        /// The sheet.
        sheet: String,
        /// What and where.
        finding: crate::gcode::Finding,
    },
    /// A picture cannot be drawn.
    #[error("{file}: {source}")]
    Picture {
        /// The file.
        file: String,
        /// Why.
        source: crate::preview::Error,
    },
    /// A stock that was asked for is not known.
    #[error(
        "stock '{given}' is neither one of {profile}'s ({known}) nor a size such as 420x297 or 500x300@4 (mm, @ how many)"
    )]
    UnknownStock {
        /// What was asked for.
        given: String,
        /// The material.
        profile: String,
        /// Its stock.
        known: String,
    },
    /// No stock lies on the machine.
    #[error("{profile} has no sheets for {machine}; name some with --stock, for example --stock A4 or --stock 420x297")]
    NoStock {
        /// The material.
        profile: String,
        /// The machine.
        machine: String,
    },
    /// A piece that was asked for is not there.
    #[error("there is no piece {given:?}; the pieces are {known}")]
    UnknownPiece {
        /// What was asked for.
        given: String,
        /// What there is.
        known: String,
    },
    /// A file that is no plot.
    #[error("{file}: {source}")]
    Plot {
        /// The file.
        file: String,
        /// Why not.
        source: crate::gcode::PlotError,
    },
    /// The machine takes sheets where a roll was asked for, or the other way round.
    #[error("machine {machine} {problem}")]
    Machine {
        /// The machine.
        machine: String,
        /// What is wrong and the way out.
        problem: String,
    },
    /// The output folder holds somebody's design.
    #[error(
        "{path} holds a different design; run `furbelow make {path}` to use it, choose another folder with --out, or replace it with --force",
        path = path.display()
    )]
    ForeignDesign {
        /// The file.
        path: PathBuf,
    },
    /// A file cannot be read or written.
    #[error("{path}: {source}", path = path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

impl Error {
    /// True when the input is in order but the job cannot be made or breaks a limit (exit code 1); false when a file, setting or argument is at fault (exit code 2).
    pub fn refuses_job(&self) -> bool {
        match self {
            Error::Config(e) => e.refuses_job(),
            Error::Design(_) | Error::Mesh(_) | Error::UnknownStock { .. } | Error::UnknownPiece { .. } => false,
            Error::Calibrate(e) => !e.is_answer(),
            Error::Outline { .. } | Error::Drawing { .. } | Error::Offcut { .. } | Error::Machine { .. } => false,
            Error::ForeignDesign { .. } | Error::Parse { .. } | Error::Plot { .. } | Error::File { .. } => false,
            _ => true,
        }
    }

    /// A failed access to `path`.
    pub(super) fn file(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Error {
        let path = path.into();
        move |source| Error::File { path, source }
    }
}
