//! `furbelow design show FILE`: what a design amounts to, section by section.

use std::path::PathBuf;

use super::super::Failure;
use super::super::output::{self, line, number, table};
use super::super::screen::Screen;
use super::{picture, read};
use crate::config::Library;
use crate::job::{self, PartSurvey, SectionRole as Role, SectionSurvey, Survey};

/// Arguments of `design show`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// A design .toml; `-` for stdin
    file: PathBuf,
    /// This part only
    #[arg(long, value_name = "NAME")]
    part: Option<String>,
    /// Write the part's picture, .svg or .png (with --part, where there are several)
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let (order, _) = read(&args.file)?;
    let mut screen = Screen::open()?;
    let survey = job::survey(&order, &Library::open(), &mut screen);
    screen.close();
    let mut survey = survey?;
    if let Some(name) = &args.part {
        let names: Vec<String> = survey.parts.iter().map(|p| p.name.clone()).collect();
        survey.parts.retain(|p| p.name == *name);
        if survey.parts.is_empty() {
            return Err(Failure::config(format!("there is no part {name}; parts are {}", names.join(", "))));
        }
    }
    if let Some(file) = &args.picture {
        match survey.parts.as_slice() {
            [part] => picture(&part.picture, file)?,
            parts => {
                let names: Vec<&str> = parts.iter().map(|p| p.name.as_str()).collect();
                let message = format!("--picture shows one part; say --part with one of {}", names.join(", "));
                return Err(Failure::config(message));
            }
        }
    }
    if args.json { output::json(&survey) } else { tell(&survey, true) }
}

/// Tables of the parts and, with `sections`, of all their sections.
pub(super) fn tell(survey: &Survey, sections: bool) -> Result<(), Failure> {
    line(&format!("{} on {}\n", survey.material, survey.machine))?;
    let heading = ["PART", "LAYERS", "FILLED", "STRIP", "MASS", "JOINTS", "SECTIONS", "FOOT", "PLANE"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    rows.extend(survey.parts.iter().map(part_row));
    line(&table(&rows))?;
    for part in survey.parts.iter().filter(|_| sections) {
        let heading = ["SECTION", "WHAT", "LENGTH MM", "MIDDLE U, V MM", "JOINTS", "DENSIFIED", ""];
        let mut rows = vec![heading.map(str::to_owned).to_vec()];
        rows.extend(part.sections.iter().map(section_row));
        line(&format!("\npart {}\n{}", part.name, table(&rows)))?;
        let mut rows = vec![["JOINT", "AT U, V MM"].map(str::to_owned).to_vec()];
        rows.extend(
            part.joints_mm.iter().enumerate().map(|(i, at)| vec![format!("{}{}", part.name, i + 1), place(*at)]),
        );
        line(&format!("\n{}", table(&rows)))?;
    }
    if !survey.edits.is_empty() {
        line("\nedits, in order")?;
    }
    for (i, edit) in survey.edits.iter().enumerate() {
        line(&format!("  {}  {edit}", i + 1))?;
    }
    super::change::warnings(&survey.warnings)
}

fn place([u, v]: [f64; 2]) -> String {
    format!("{}, {}", number(u), number(v))
}

fn part_row(part: &PartSurvey) -> Vec<String> {
    let list = |values: [f64; 3]| values.map(number).join(", ");
    vec![
        part.name.clone(),
        part.layers.map(|n| n.to_string()).unwrap_or_default(),
        format!("{:.0} %", 100.0 * part.filled_fraction),
        format!("{:.0} mm", part.strip_length_mm),
        format!("{:.1} g", part.strip_mass_g),
        part.joints_mm.len().to_string(),
        part.sections.len().to_string(),
        format!("{:?}", part.foot).to_lowercase(),
        format!("through {}, normal {}", list(part.plane.origin_mm), list(part.plane.normal)),
    ]
}

fn section_row(section: &SectionSurvey) -> Vec<String> {
    let role = match section.role {
        Role::Outer => "outer",
        Role::Inner => "inner",
        Role::Densified => "densified",
    };
    let what = if section.closes_room { format!("{role} loop") } else { role.to_owned() };
    let joint = |joint: &Option<String>| joint.clone().unwrap_or_else(|| "-".to_owned());
    let [from, to] = &section.joints;
    let level = match section.level {
        0 => String::new(),
        1 => "once".to_owned(),
        n => format!("{n} times"),
    };
    vec![
        section.number.to_string(),
        what,
        format!("{:.1}", section.length_mm),
        place(section.middle_mm),
        format!("{}-{}", joint(from), joint(to)),
        level,
        if section.pinned { "length given".to_owned() } else { String::new() },
    ]
}
