//! What is left of the sheet when a knife or a tube is done, and whether the check sees a spoilt program. What a diode laser leaves of every model is
//! judged in make.rs, where they are made.

#[path = "kerf/blade.rs"]
mod blade;
#[path = "kerf/mod.rs"]
mod kerf;
#[path = "kerf/spoil.rs"]
mod spoil;

use kerf::program::Run;
use kerf::{Meant, NOTHING, Sheet, compare, judge};
use std::fs;
use std::path::Path;
use std::process::Command;

const MODELS: [&str; 5] = ["cuboid", "stool", "teddy", "lampshade", "shell"];

/// A drag knife on a mat whose holder takes a pen too, as somebody would add it. The trail is the profile's.
const KNIFE: &str =
    "schema = 1\nname = \"knife\"\ninherits = \"pen-a3\"\nhold = \"mat\"\n[tool]\nclass = \"knife\"\n[pen]\n";
const TRAIL_MM: f64 = 0.25;

/// Every sheet of a job.
fn made(model: &str, machine: &str, material: &str) -> Vec<Sheet> {
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
    kerf::sheets(&folder.path().join("out"))
}

#[test]
fn a_co2_laser_leaves_film_true_to_size_with_its_slots_and_leads() {
    for Sheet { nominal, runs, kerf_mm, .. } in made("cuboid", "k40", "polyester-0.1") {
        let found = compare::compared(&nominal, &runs, 0.5 * kerf_mm);
        judge("cuboid", &nominal, &found, &Meant { bridge: (0.25, 80.0), dash: 0.9, ..NOTHING });
    }
}

#[test]
fn a_blade_leaves_every_model_true_to_size_but_for_the_last_of_its_hinges() {
    for model in MODELS {
        for Sheet { nominal, runs, pen, .. } in made(model, "knife", "paper-160") {
            assert!(!pen.is_empty() && runs.iter().all(|run| run.operation != "engrave"));
            let found = blade::blade(&nominal, &runs, &pen, TRAIL_MM);
            judge(model, &nominal, &found, &Meant { hinge: TRAIL_MM, ..NOTHING });
        }
    }
}

#[test]
fn the_check_sees_a_contour_offset_the_wrong_way_a_shifted_slit_and_a_missing_cut() {
    let Sheet { nominal, runs, kerf_mm, .. } = made("cuboid", "diode-400", "paper-160").swap_remove(0);
    let judged = |runs: &[Run]| compare::compared(&nominal, runs, 0.5 * kerf_mm);
    assert!(judged(&runs).worst_mm <= compare::TOLERANCE_MM);
    for class in ["outline", "flap"] {
        let path = nominal.iter().find(|n| n.class == class).unwrap();
        let wrong: Vec<Run> = runs
            .iter()
            .map(|run| match spoil::follows(run, path, kerf_mm) {
                true => spoil::mapped(run, |p| spoil::mirrored(p, path)),
                false => run.clone(),
            })
            .collect();
        assert!(wrong != runs, "one {class} is cut");
        assert!(judged(&wrong).worst_mm > compare::TOLERANCE_MM, "a wrong {class} is not seen");
    }
    let slit = nominal.iter().find(|n| n.class == "slit").unwrap();
    let cuts_it = |run: &Run| spoil::follows(run, slit, 0.0);
    let aside = |run: &Run| spoil::mapped(run, |p| kerf::plane::at(p.x + 0.08, p.y));
    let shifted: Vec<Run> = runs.iter().map(|run| if cuts_it(run) { aside(run) } else { run.clone() }).collect();
    assert!(judged(&shifted).worst_mm > compare::TOLERANCE_MM);
    let kept: Vec<Run> = runs.iter().filter(|run| !cuts_it(run)).cloned().collect();
    let index = nominal.iter().position(|n| n == slit).unwrap();
    assert!(judged(&kept).gaps[index].iter().sum::<f64>() > 0.9 * slit.length());
}
