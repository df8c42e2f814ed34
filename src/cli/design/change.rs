//! `furbelow design densify | undensify | layers | plane | split | move-point | length`: one edit more.

use std::path::PathBuf;

use super::super::Failure;
use super::super::output::{self, line, table};
use super::super::screen::Screen;
use super::{is_stdin, picture, read, write};
use crate::config::Library;
use crate::design::MAX_LEVELS;
use crate::job::{self, Changed, Cut, PartSurvey, Places, Request};
use crate::progress::Warning;

/// What every change is given.
#[derive(Debug, clap::Args)]
struct Target {
    /// A design .toml; `-` reads stdin and writes stdout
    file: PathBuf,
    /// The part, such as A
    part: String,
}

/// What every change tells.
#[derive(Debug, clap::Args)]
struct Telling {
    /// Write a picture of the part as it is now, .svg or .png
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Try it without changing the file
    #[arg(long)]
    dry_run: bool,
    /// Print the part as it is now as a JSON object on stdout
    #[arg(long)]
    json: bool,
}

/// Sections by number, by joints, or in a box.
#[derive(Debug, clap::Args)]
#[group(required = true, multiple = false)]
struct Where {
    /// Sections, by their numbers in the picture or the joints at their ends (A3-A4)
    #[arg(value_name = "SECTION")]
    sections: Vec<String>,
    /// Or those in a box of the picture, from one corner to the other, mm from its origin
    #[arg(long = "box", num_args = 4, value_names = ["U0", "V0", "U1", "V1"], allow_negative_numbers = true)]
    corners: Option<Vec<f64>>,
}

impl Where {
    fn places(&self) -> Places {
        match self.corners.as_deref() {
            Some([u0, v0, u1, v1]) => Places::Box([*u0, *v0, *u1, *v1]),
            _ => Places::Named(self.sections.clone()),
        }
    }
}

/// Arguments of `design densify`.
#[derive(Debug, clap::Args)]
pub struct Densify {
    #[command(flatten)]
    target: Target,
    #[command(flatten)]
    places: Where,
    /// How often: 2 densifies the loops that the first time makes as well
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=MAX_LEVELS as i64))]
    level: u8,
    #[command(flatten)]
    telling: Telling,
}

/// Arguments of `design undensify`.
#[derive(Debug, clap::Args)]
pub struct Undensify {
    #[command(flatten)]
    target: Target,
    #[command(flatten)]
    places: Where,
    #[command(flatten)]
    telling: Telling,
}

/// Arguments of `design layers`.
#[derive(Debug, clap::Args)]
pub struct Layers {
    #[command(flatten)]
    target: Target,
    /// How many: 5, or +1 and -1 for one more and one less
    #[arg(value_name = "N|+1|-1", allow_hyphen_values = true)]
    layers: String,
    #[command(flatten)]
    telling: Telling,
}

/// Arguments of `design plane`.
#[derive(Debug, clap::Args)]
pub struct Plane {
    #[command(flatten)]
    target: Target,
    #[command(flatten)]
    place: PlanePlace,
    #[command(flatten)]
    telling: Telling,
}

#[derive(Debug, clap::Args)]
#[group(required = true, multiple = true)]
struct PlanePlace {
    /// A point on the plane, in the shape's own axes, mm [default: as it is]
    #[arg(long, num_args = 3, value_names = ["X", "Y", "Z"], allow_negative_numbers = true)]
    origin: Option<Vec<f64>>,
    /// Its normal: the direction the strip is wide in [default: as it is]
    #[arg(long, num_args = 3, value_names = ["X", "Y", "Z"], allow_negative_numbers = true)]
    normal: Option<Vec<f64>>,
    /// Move it so far along its normal, mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    offset: Option<f64>,
}

/// Arguments of `design split`.
#[derive(Debug, clap::Args)]
pub struct Split {
    #[command(flatten)]
    target: Target,
    #[command(flatten)]
    place: SplitPlace,
    /// Which way the new part lies, with --origin
    #[arg(long, num_args = 3, value_names = ["X", "Y", "Z"], allow_negative_numbers = true, requires = "origin")]
    normal: Option<Vec<f64>>,
    /// Name of the new part [default: the next free letter]
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    #[command(flatten)]
    telling: Telling,
}

#[derive(Debug, clap::Args)]
#[group(required = true, multiple = false)]
struct SplitPlace {
    /// Along an upright line of the picture, mm from its origin; what is right of it is the new part
    #[arg(long, value_name = "U", allow_negative_numbers = true)]
    right_of: Option<f64>,
    /// Along a level line of the picture, mm; what is above it is the new part
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    above: Option<f64>,
    /// Along a plane through a point in the shape's own axes, mm; what lies ahead of it, where --normal points, is the new part
    #[arg(long, num_args = 3, value_names = ["X", "Y", "Z"], allow_negative_numbers = true, requires = "normal")]
    origin: Option<Vec<f64>>,
}

/// Arguments of `design move-point`.
#[derive(Debug, clap::Args)]
pub struct MovePoint {
    #[command(flatten)]
    target: Target,
    /// The joint, as numbered in the picture: A3 or 3
    joint: String,
    /// Where it goes, mm from the picture's origin, to the right
    #[arg(allow_negative_numbers = true)]
    u: f64,
    /// And up
    #[arg(allow_negative_numbers = true)]
    v: f64,
    #[command(flatten)]
    telling: Telling,
}

/// Arguments of `design length`.
#[derive(Debug, clap::Args)]
pub struct Length {
    #[command(flatten)]
    target: Target,
    /// The section, by its number in the picture or the joints at its ends (A3-A4)
    section: String,
    /// Its length in mm, or x0.9 for so many times what it is drawn with
    #[arg(value_name = "MM|xFACTOR")]
    length: String,
    #[command(flatten)]
    telling: Telling,
}

impl Densify {
    pub(super) fn run(&self) -> Result<(), Failure> {
        apply(&self.target, &Request::Densify(self.places.places(), self.level.into()), &self.telling)
    }
}

impl Undensify {
    pub(super) fn run(&self) -> Result<(), Failure> {
        apply(&self.target, &Request::Undensify(self.places.places()), &self.telling)
    }
}

impl Layers {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let wrong = || Failure::config(format!("'{}' layers: say a number, or +1 or -1", self.layers));
        let request = if self.layers.starts_with(['+', '-']) {
            Request::LayersBy(self.layers.parse().map_err(|_| wrong())?)
        } else {
            Request::Layers(self.layers.parse().map_err(|_| wrong())?)
        };
        apply(&self.target, &request, &self.telling)
    }
}

impl Plane {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let three = |values: &Option<Vec<f64>>| values.as_deref().and_then(|v| v.try_into().ok());
        let request = Request::Plane {
            origin_mm: three(&self.place.origin),
            normal: three(&self.place.normal),
            offset_mm: self.place.offset.unwrap_or(0.0),
        };
        apply(&self.target, &request, &self.telling)
    }
}

impl Split {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let three = |values: &Option<Vec<f64>>| values.as_deref().and_then(|v| v.try_into().ok());
        let cut = match (self.place.right_of, self.place.above, three(&self.place.origin), three(&self.normal)) {
            (Some(u), ..) => Cut::U(u),
            (_, Some(v), ..) => Cut::V(v),
            (_, _, Some(origin), Some(normal)) => Cut::Plane(origin, normal),
            _ => return Err(Failure::config("split: say where, with --right-of, --above, or --origin and --normal")),
        };
        apply(&self.target, &Request::Split(cut, self.name.clone()), &self.telling)
    }
}

impl MovePoint {
    pub(super) fn run(&self) -> Result<(), Failure> {
        apply(&self.target, &Request::MovePoint(self.joint.clone(), [self.u, self.v]), &self.telling)
    }
}

impl Length {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let places = Places::Named(vec![self.section.clone()]);
        let wrong =
            |_| Failure::config(format!("length '{}': say mm, such as 62.5, or a factor, such as x0.9", self.length));
        let request = match self.length.strip_prefix('x') {
            Some(factor) => Request::LengthFactor(places, factor.parse().map_err(wrong)?),
            None => Request::LengthMm(places, self.length.trim_end_matches("mm").parse().map_err(wrong)?),
        };
        apply(&self.target, &request, &self.telling)
    }
}

/// Works the changed design out; writes the file only when that went well.
fn apply(target: &Target, request: &Request, telling: &Telling) -> Result<(), Failure> {
    let (order, source) = read(&target.file)?;
    let mut screen = Screen::open()?;
    let changed = job::change(&order, &source, &target.part, request, &Library::open(), &mut screen);
    screen.close();
    let changed = changed?;
    if let Some(file) = &telling.picture {
        picture(&changed.after.picture, file)?;
    }
    if !telling.dry_run {
        write(&target.file, &changed.text)?;
    }
    if is_stdin(&target.file) {
        return Ok(());
    }
    if telling.json {
        return output::json(&changed.after);
    }
    let done = if telling.dry_run { "would be" } else { "is now" };
    line(&format!("{}: {done} edit {} of {}\n", changed.edit, changed.number, target.file.display()))?;
    line(&table(&comparison(&changed)))?;
    warnings(&changed.warnings)
}

/// Before and after, and the new part of a split.
fn comparison(changed: &Changed) -> Vec<Vec<String>> {
    let row = |name: &str, value: &dyn Fn(&PartSurvey) -> String| {
        let added = changed.added.iter().map(value);
        [name.to_owned(), value(&changed.before), value(&changed.after)].into_iter().chain(added).collect()
    };
    let mut head = vec![format!("PART {}", changed.after.name), "BEFORE".to_owned(), "NOW".to_owned()];
    head.extend(changed.added.iter().map(|p| format!("PART {}", p.name)));
    vec![
        head,
        row("layers", &|p| p.layers.map(|n| n.to_string()).unwrap_or_default()),
        row("sections", &|p| p.sections.len().to_string()),
        row("joints", &|p| p.joints_mm.len().to_string()),
        row("strip", &|p| format!("{:.0} mm", p.strip_length_mm)),
        row("mass", &|p| format!("{:.2} g", p.strip_mass_g)),
        row("filled", &|p| format!("{:.0} %", 100.0 * p.filled_fraction)),
        row("foot", &|p| format!("{:?}", p.foot).to_lowercase()),
    ]
}

/// What the user should know.
pub(super) fn warnings(warnings: &[Warning]) -> Result<(), Failure> {
    if !warnings.is_empty() {
        line("")?;
    }
    for warning in warnings {
        line(&format!("! {}", warning.message))?;
    }
    Ok(())
}
