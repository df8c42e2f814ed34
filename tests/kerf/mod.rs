//! What is left of the sheets when the machine is done, from the files alone: sheets/*.svg says what is wanted, sheets/*.nc what is cut.
//!
//! Nothing of the program is used but the program itself. A laser's beam is a disc of the kerf's width, dragged along every cut move. Compared is with what
//! such a beam can reach at all.

pub mod compare;
pub mod plane;
pub mod program;
pub mod sheet;

use compare::Found;
use program::Run;
use sheet::Nominal;
use std::fs;
use std::path::Path;

/// A sheet of a job.
pub struct Sheet {
    /// What is wanted.
    pub nominal: Vec<Nominal>,
    /// What the machine's own tool makes.
    pub runs: Vec<Run>,
    /// What its pen draws.
    pub pen: Vec<Run>,
    pub kerf_mm: f64,
}

/// Every sheet of the job in a folder.
pub fn sheets(job: &Path) -> Vec<Sheet> {
    let mut files: Vec<_> = fs::read_dir(job.join("sheets")).unwrap().map(|f| f.unwrap().path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "nc"));
    files.sort();
    assert!(!files.is_empty());
    let read = |file: &std::path::PathBuf| {
        let (runs, kerf_mm) = program::runs(&fs::read_to_string(file).unwrap());
        let pen = job.join("pen").join(file.file_name().unwrap());
        let pen = fs::read_to_string(pen).map_or_else(|_| Vec::new(), |text| program::runs(&text).0);
        let nominal = sheet::nominal(&fs::read_to_string(file.with_extension("svg")).unwrap());
        Sheet { nominal, runs, pen, kerf_mm }
    };
    files.iter().map(read).collect()
}

/// Gaps that are meant, mm.
pub struct Meant {
    /// Bridges on outlines: width of sheet left, and pitch.
    pub bridge: (f64, f64),
    /// What a blade leaves of a flap's cut at each end of its hinge.
    pub hinge: f64,
    /// What a perforation leaves between two dashes of a mark.
    pub dash: f64,
}

/// None.
pub const NOTHING: Meant = Meant { bridge: (0.0, f64::INFINITY), hinge: 0.0, dash: 0.0 };

/// Refuses what is off by more than the tolerance, and gaps that nobody meant.
pub fn judge(model: &str, nominal: &[Nominal], found: &Found, meant: &Meant) {
    assert!(found.worst_mm <= compare::TOLERANCE_MM, "{model}: off by {} mm: {}", found.worst_mm, found.where_worst);
    for (path, gaps) in nominal.iter().zip(&found.gaps) {
        let (left, most) = match path.class.as_str() {
            "outline" => (meant.bridge.0, (path.length() / meant.bridge.1).ceil().max(2.0) as usize),
            "flap" => (meant.hinge, 2),
            "mark" | "label" => (meant.dash, usize::MAX),
            _ => (0.0, 0),
        };
        // The kerf is taken off both ends of a bridge, and looking takes steps.
        let widest = if left > 0.0 { left + 0.2 } else { 0.0 };
        assert!(gaps.len() <= most, "{model}: {} gaps in the {} of {}", gaps.len(), path.class, path.piece);
        for gap in gaps {
            assert!(*gap <= widest, "{model}: {gap:.2} mm left uncut in the {} of {}", path.class, path.piece);
        }
    }
}
