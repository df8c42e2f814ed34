//! Test cards as files, and what their answers put into a profile.

use super::dry_run::{self, Form, Look};
use super::order::StartFrom;
use super::program;
use super::settings::Setup;
use super::{Error, minutes};
use crate::calibrate::{self, Answers, Card, Finding, Kind, Setting, Shop};
use crate::config::{Changes, Grain, Library, ToolClass};
use crate::drawing::{self, Drawing};
use crate::preview::ColorBy;
use crate::toolpath::{Tool, Toolpath, Trial};

/// Pixels of a card's picture along its longer side.
const PICTURE_PX: u32 = 1600;

/// A card, ready to cut.
#[derive(Debug, Clone)]
pub struct TestCard {
    /// What it holds and asks.
    pub card: Card,
    /// Files by name: the program, the drawing and a picture.
    pub files: Vec<(String, Vec<u8>)>,
    /// Name of the program among them.
    pub program: String,
    /// Planned time, s.
    pub time_s: f64,
    /// What to do before it is cut.
    pub setup: Vec<String>,
}

/// What answers came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Learnt {
    /// What goes into the profile.
    pub changes: Changes,
    /// The same in words.
    pub told: Vec<String>,
}

/// Draws a card and writes its program.
///
/// # Errors
/// A machine or material that is not known or must not meet, a tool that cuts nothing, a card that does not fit.
pub fn test_card(kind: Kind, machine: &str, material: &str, library: &Library) -> Result<TestCard, Error> {
    let setup = Setup::for_test(machine, material, library)?;
    let card = calibrate::card(kind, &shop(&setup)?)?;
    let start = StartFrom::Absolute;
    let mut settings = setup.toolpath(&start);
    let trial =
        |name: &str, s: Setting| Trial { piece: name.to_owned(), feed_mm_per_min: s.feed_mm_per_min, power: s.power };
    settings.trials = card.samples.iter().filter_map(|s| Some(trial(&s.drawing.name, s.trial?))).collect();
    // What is to fall out by itself is not held.
    settings.bridges = None;
    settings.crosses = false;
    settings.cross_cut = false;
    let drawings: Vec<Drawing> = card.samples.iter().map(|sample| sample.drawing.clone()).collect();
    let file = format!("calibrate-{}", kind.word());
    let header = |toolpath: &Toolpath, tool: Tool, time_s: f64| {
        let sheet = format!("1/1 card {} x {} mm", card.width_mm, card.height_mm);
        program::header(vec![("job", file.clone()), ("sheet", sheet)], toolpath, tool, time_s, &setup)
    };
    let size_mm = [card.width_mm, card.height_mm];
    let written = program::written(&file, &drawings, size_mm, &settings, &header, &setup, &start)?;
    let ending = if setup.plotter(settings.tool).is_some() { "plt" } else { "nc" };
    let program = format!("{file}.{ending}");
    let look = Look { name: &program, text: &written.text, machine: Some(machine), material: Some(material) };
    let picture = dry_run::look(&look, library, Form::Png(PICTURE_PX), ColorBy::Power)?;
    let svg = drawing::sheet_svg(card.width_mm, card.height_mm, &drawings);
    let files = vec![
        (program.clone(), written.text.into_bytes()),
        (format!("{file}.svg"), svg.into_bytes()),
        (format!("{file}.png"), picture.bytes),
    ];
    let setup = setup.machine.setup.iter().chain(&setup.profile.setup).cloned().collect();
    Ok(TestCard { card, files, program, time_s: written.time_s, setup })
}

fn shop(setup: &Setup) -> Result<Shop, Error> {
    let (machine, profile) = (&setup.machine, &setup.profile);
    if matches!(machine.tool.class, ToolClass::Pen | ToolClass::Scissors) {
        return Err(Error::NothingCut { machine: machine.name.clone() });
    }
    let setting = |p: &crate::config::Process| Setting { feed_mm_per_min: p.feed_mm_per_min, power: p.power };
    Ok(Shop {
        machine: machine.name.clone(),
        material: profile.name.clone(),
        laser: machine.tool.class.is_laser(),
        cut: setting(&setup.pairing.cut),
        engrave: setup.marking().map(setting),
        power_floor: machine.tool.power_floor,
        max_feed_mm_per_min: machine.max_feed_mm_per_min(),
        joint: setup.joint(),
        letter_mm: profile.min_label_height_mm,
        grammage_g_per_m2: profile.grammage_g_per_m2,
        margin_mm: setup.margin_mm(),
    })
}

/// What answers to a card mean for the profile, with `source` saying where they come from.
///
/// # Errors
/// As [`test_card`], and answers that are none.
pub fn learnt(
    kind: Kind,
    machine: &str,
    material: &str,
    answers: &Answers,
    source: &str,
    library: &Library,
) -> Result<Learnt, Error> {
    let setup = Setup::for_test(machine, material, library)?;
    let shop = shop(&setup)?;
    let found = calibrate::findings(&calibrate::card(kind, &shop)?, answers, &shop)?;
    let mut learnt = Learnt { changes: Changes { values: Vec::new(), source: source.to_owned() }, told: Vec::new() };
    for finding in &found {
        learnt.take(finding, &setup);
    }
    learnt.take_rigidity(&found, setup.profile.grain);
    Ok(learnt)
}

impl Learnt {
    fn set(&mut self, key: impl Into<String>, value: f64) {
        self.changes.values.push((key.into(), format!("{value}")));
    }

    fn take(&mut self, finding: &Finding, setup: &Setup) {
        let tenth = |value: f64| (value * 10.0).round() / 10.0;
        match *finding {
            Finding::Cut(s) => {
                self.set("cut.feed_mm_per_min", tenth(s.feed_mm_per_min));
                self.set("cut.power", (s.power * 1e4).round() / 1e4);
                self.told.push(format!("cut at {:.0} mm/min with {:.1} %", s.feed_mm_per_min, 100.0 * s.power));
            }
            Finding::Engrave(s) => {
                self.set("engrave.feed_mm_per_min", tenth(s.feed_mm_per_min));
                self.set("engrave.power", (s.power * 1e4).round() / 1e4);
                self.told.push(format!("engrave at {:.0} mm/min with {:.1} %", s.feed_mm_per_min, 100.0 * s.power));
            }
            Finding::Kerf(kerf_mm) => {
                self.set("cut.kerf_mm", kerf_mm);
                self.told.push(format!("kerf {kerf_mm} mm"));
            }
            Finding::SlitExtra(extra_mm) => {
                let table = if setup.machine.tool.class.is_laser() { "laser" } else { "knife" };
                self.set(format!("joint.{table}.slit_extra_mm"), extra_mm);
                self.told.push(format!("slits {extra_mm} mm longer than the neck"));
            }
            Finding::Along(_) | Finding::Across(_) => {}
        }
    }

    /// The stiffer way is along the grain, however the card lay.
    fn take_rigidity(&mut self, found: &[Finding], grain: Grain) {
        let along = found.iter().find_map(|f| if let Finding::Along(d) = f { Some(*d) } else { None });
        let across = found.iter().find_map(|f| if let Finding::Across(d) = f { Some(*d) } else { None });
        let thousandth = |value: f64| (value * 1e3).round() / 1e3;
        let (md, cd) = match (along, across, grain) {
            (None, None, _) => return,
            (Some(a), Some(b), Grain::None) => (Some(thousandth(0.5 * (a + b))), Some(thousandth(0.5 * (a + b)))),
            (one, None, Grain::None) | (None, one, Grain::None) => (one, one),
            (Some(a), Some(b), Grain::Directional) => {
                let way = if a >= b { "along" } else { "across" };
                self.told.push(format!("the grain runs {way} the card's longer side"));
                (Some(a.max(b)), Some(a.min(b)))
            }
            (along, across, Grain::Directional) => (along, across),
        };
        for (key, words, value) in
            [("flexural_rigidity_md_n_mm", "along", md), ("flexural_rigidity_cd_n_mm", "across", cd)]
        {
            if let Some(value) = value {
                self.set(key, value);
                self.told.push(format!("flexural rigidity {value} N mm {words} the grain"));
            }
        }
    }
}

impl TestCard {
    /// "2 min 10 s".
    pub fn time(&self) -> String {
        minutes(self.time_s)
    }
}
