//! What is left of the sheet when the machine is done, from the files alone: sheets/*.svg says what is wanted, sheets/*.nc what is cut.
//!
//! Nothing of the program is used but the program itself. A laser's beam is a disc of the kerf's width, dragged along every cut move; a blade is a tip
//! that trails the axis the moves are for. Compared is with what such a tool can reach at all.

mod kerf {
    pub mod compare;
    pub mod plane;
    pub mod program;
    pub mod sheet;
}

use kerf::compare::{self, Found};
use kerf::program::{self, Run};
use kerf::sheet::{self, Nominal};
use std::fs;
use std::path::Path;
use std::process::Command;

const MODELS: [&str; 5] = ["cuboid", "stool", "teddy", "lampshade", "shell"];

/// A drag knife on a mat, as somebody would add it. The trail is the profile's.
const KNIFE: &str = "schema = 1\nname = \"knife\"\ninherits = \"pen-a3\"\nhold = \"mat\"\n[tool]\nclass = \"knife\"\n";
const TRAIL_MM: f64 = 0.25;

/// Every sheet of a job: what is wanted, what is made, and the kerf.
fn made(model: &str, machine: &str, material: &str) -> Vec<(Vec<Nominal>, Vec<Run>, f64)> {
    let folder = tempfile::tempdir().unwrap();
    let machines = folder.path().join("config/machines");
    fs::create_dir_all(&machines).unwrap();
    fs::write(machines.join("knife.toml"), KNIFE).unwrap();
    let shape = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models").join(format!("{model}.obj"));
    let output = Command::new(env!("CARGO_BIN_EXE_furbelow"))
        .args(["make", shape.to_str().unwrap(), "--machine", machine, "--material", material, "--out", "out"])
        .current_dir(folder.path())
        .env("FURBELOW_CONFIG_DIR", folder.path().join("config"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{model} on {machine}: {}", String::from_utf8_lossy(&output.stderr));
    let sheets = folder.path().join("out/sheets");
    let mut files: Vec<_> = fs::read_dir(sheets).unwrap().map(|f| f.unwrap().path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "nc"));
    files.sort();
    assert!(!files.is_empty());
    files
        .iter()
        .map(|file| {
            let text = fs::read_to_string(file).unwrap();
            let (runs, kerf_mm) = program::runs(&text);
            (sheet::nominal(&fs::read_to_string(file.with_extension("svg")).unwrap()), runs, kerf_mm)
        })
        .collect()
}

/// Gaps that are meant, mm.
struct Meant {
    /// Bridges on outlines: width of sheet left, and pitch.
    bridge: (f64, f64),
    /// What a blade leaves of a flap's cut at each end of its hinge.
    hinge: f64,
    /// What a perforation leaves between two dashes of a mark.
    dash: f64,
}

const NOTHING: Meant = Meant { bridge: (0.0, f64::INFINITY), hinge: 0.0, dash: 0.0 };

fn judge(model: &str, nominal: &[Nominal], found: &Found, meant: &Meant) {
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

#[test]
fn a_laser_leaves_every_model_true_to_size_but_for_its_bridges() {
    for model in MODELS {
        for (nominal, runs, kerf_mm) in made(model, "diode-400", "paper-160") {
            assert_eq!(kerf_mm, 0.15);
            let found = compare::beam(&nominal, &runs, kerf_mm);
            judge(model, &nominal, &found, &Meant { bridge: (0.4, 100.0), ..NOTHING });
            let outlines = nominal.iter().zip(&found.gaps).filter(|(n, _)| n.class == "outline");
            for (outline, gaps) in outlines {
                assert!(gaps.len() >= 2, "{model}: {} hangs on {} bridges", outline.piece, gaps.len());
            }
        }
    }
}

#[test]
fn a_co2_laser_leaves_film_true_to_size_with_its_slots_and_leads() {
    for (nominal, runs, kerf_mm) in made("stool", "k40", "polyester-0.1") {
        let found = compare::beam(&nominal, &runs, kerf_mm);
        judge("stool", &nominal, &found, &Meant { bridge: (0.25, 80.0), dash: 0.9, ..NOTHING });
    }
}

#[test]
fn a_blade_leaves_every_model_true_to_size_but_for_the_last_of_its_hinges() {
    for model in MODELS {
        for (mut nominal, runs, _) in made(model, "knife", "paper-160") {
            // What a knife cannot mark it leaves.
            nominal.retain(|path| path.class != "mark" && path.class != "label");
            let found = compare::blade(&nominal, &runs, TRAIL_MM);
            judge(model, &nominal, &found, &Meant { hinge: TRAIL_MM, ..NOTHING });
        }
    }
}

#[test]
fn the_check_sees_a_contour_offset_the_wrong_way_a_shifted_slit_and_a_missing_cut() {
    let (nominal, runs, kerf_mm) = made("stool", "diode-400", "paper-160").swap_remove(0);
    assert!(compare::beam(&nominal, &runs, kerf_mm).worst_mm <= compare::TOLERANCE_MM);
    for class in ["outline", "flap"] {
        let path = nominal.iter().find(|n| n.class == class).unwrap();
        let wrong: Vec<Run> = runs
            .iter()
            .map(|run| match path.is_followed_by(run, kerf_mm) {
                true => run.mapped(|p| p.mirrored_over(path)),
                false => run.clone(),
            })
            .collect();
        assert!(wrong != runs, "one {class} is cut");
        let found = compare::beam(&nominal, &wrong, kerf_mm);
        assert!(found.worst_mm > compare::TOLERANCE_MM, "a wrong {class} is not seen");
    }
    let slit = nominal.iter().find(|n| n.class == "slit").unwrap();
    let shifted: Vec<Run> = runs
        .iter()
        .map(|run| if slit.is_followed_by(run, 0.0) { run.mapped(|p| p.shifted(0.08)) } else { run.clone() })
        .collect();
    assert!(compare::beam(&nominal, &shifted, kerf_mm).worst_mm > compare::TOLERANCE_MM);
    let kept: Vec<Run> = runs.iter().filter(|run| !slit.is_followed_by(run, 0.0)).cloned().collect();
    let found = compare::beam(&nominal, &kept, kerf_mm);
    let index = nominal.iter().position(|n| n == slit).unwrap();
    assert!(found.gaps[index].iter().sum::<f64>() > 0.9 * slit.length());
}
