//! Which samples stand on which card, and where.

use super::answers::Asked;
use super::error::Error;
use super::samples::{self, COMB_MM, RULER_MM, SQUARE_MM, STRIP_MM};
use super::shop::{Setting, Shop};
use crate::drawing::{Drawing, text_width};
use crate::geom::{Motion, Rect};

/// What is to be found out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Everything at once, coarsely: the first card of a new material.
    Start,
    /// What the beam takes away.
    Kerf,
    /// Which power and feed cut cleanly.
    Power,
    /// How long the slits have to be.
    Joint,
    /// How stiff the sheet is along and across its grain.
    Stiffness,
}

/// A card to cut and what to ask afterwards.
#[derive(Debug, Clone, PartialEq)]
pub struct Card {
    /// What it finds out.
    pub kind: Kind,
    /// Extent along x, mm.
    pub width_mm: f64,
    /// Extent along y, mm.
    pub height_mm: f64,
    /// What is made, in the card frame.
    pub samples: Vec<Sample>,
    /// What to ask, in order.
    pub questions: Vec<Asked>,
}

/// A drawing on a card.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Its paths in the card frame; the name is unique on the card.
    pub drawing: Drawing,
    /// How it is made where that is what the card tries; `None` for the usual way.
    pub trial: Option<Setting>,
}

/// A5, lying: small enough for every machine and for scraps.
const CARD_MM: [f64; 2] = [210.0, 148.0];
/// Between samples, mm.
const GAP_MM: f64 = 4.0;
/// Energies of the power row over that of the profile.
const ROW: [f64; 7] = [0.5, 0.63, 0.8, 1.0, 1.25, 1.6, 2.0];
/// Energies of the lettering samples over that of the profile.
const STRENGTHS: [f64; 5] = [0.5, 0.71, 1.0, 1.41, 2.0];
/// Powers and feeds of the power card over those of the profile.
const GRID: [f64; 5] = [0.5, 0.71, 1.0, 1.41, 2.0];
/// Length of the ruler, mm: no strip of a card hangs lower and still says something.
const RULER_LENGTH_MM: f64 = 120.0;
/// How much of a strip is held at least, mm.
const HELD_MM: f64 = 28.0;

impl Kind {
    /// The word of the command and of its files.
    pub fn word(self) -> &'static str {
        match self {
            Kind::Start => "start",
            Kind::Kerf => "kerf",
            Kind::Power => "power",
            Kind::Joint => "joint",
            Kind::Stiffness => "stiffness",
        }
    }
}

/// Draws a card.
///
/// # Errors
/// A card for a beam on a machine without one; a joint too wide for the card.
pub fn card(kind: Kind, shop: &Shop) -> Result<Card, Error> {
    let beam = |what: &'static str| match shop.laser {
        true => Ok(()),
        false => Err(Error::NoLaser { machine: shop.machine.clone(), what }),
    };
    let mut sheet = Sheet::new(shop);
    sheet.title(kind);
    match kind {
        Kind::Start => {
            let hanging = sheet.strips();
            if shop.laser {
                sheet.power_row()?;
                sheet.combs(&["kerf"])?;
            }
            sheet.joints(shop.engrave.is_some())?;
            sheet.questions.extend(hanging);
        }
        Kind::Kerf => {
            beam("kerf")?;
            sheet.combs(&["kerf", "kerf again"])?;
        }
        Kind::Power => {
            beam("power")?;
            sheet.grid()?;
        }
        Kind::Joint => sheet.joints(false)?,
        Kind::Stiffness => {
            let hanging = sheet.strips();
            sheet.questions.extend(hanging);
        }
    }
    let [width_mm, height_mm] = CARD_MM;
    Ok(Card { kind, width_mm, height_mm, samples: sheet.samples, questions: sheet.questions })
}

/// A card that is being filled, row by row from the top; what runs up the right side narrows the rows.
struct Sheet<'a> {
    shop: &'a Shop,
    /// What is free.
    room: Rect,
    samples: Vec<Sample>,
    questions: Vec<Asked>,
}

impl<'a> Sheet<'a> {
    fn new(shop: &'a Shop) -> Sheet<'a> {
        let room = Rect::from_size(CARD_MM[0], CARD_MM[1]).grown(-shop.margin_mm);
        Sheet { shop, room, samples: Vec::new(), questions: Vec::new() }
    }

    fn put(&mut self, drawing: Drawing, x: f64, y: f64, trial: Option<Setting>) {
        self.samples.push(Sample { drawing: drawing.moved(&Motion::translation(x, y)), trial });
    }

    /// Letters, where the tool leaves any.
    fn write(&mut self, name: &str, text: &str, x: f64, y: f64) {
        if self.shop.engrave.is_some() {
            self.put(samples::letters(name, text, self.shop.letter_mm), x, y, None);
        }
    }

    /// Takes a row of this height from the top and gives its lower edge.
    fn row(&mut self, what: &'static str, height: f64, width: f64) -> Result<f64, Error> {
        let too_large = |needed_mm: f64, room_mm: f64| match needed_mm > room_mm + 1e-9 {
            true => Err(Error::NoRoom { what, needed_mm, room_mm }),
            false => Ok(()),
        };
        too_large(width, self.room.width())?;
        too_large(height, self.room.height())?;
        self.room.max.y -= height + GAP_MM;
        Ok(self.room.max.y + GAP_MM)
    }

    fn title(&mut self, kind: Kind) {
        if self.shop.engrave.is_none() {
            return;
        }
        let height = self.shop.letter_mm;
        let y = self.room.max.y - height;
        let text = format!("{} {} {}", self.shop.material, self.shop.machine, kind.word());
        if text_width(&text, height) <= self.room.width() {
            self.write("title", &text, self.room.min.x, y);
            self.room.max.y = y - GAP_MM;
        }
    }

    fn power_row(&mut self) -> Result<(), Error> {
        let letters = self.shop.engrave.map_or(0.0, |_| self.shop.letter_mm + 1.0);
        let pitch = SQUARE_MM + GAP_MM;
        let y = self.row("power row", SQUARE_MM + letters, ROW.len() as f64 * pitch)?;
        let settings = ROW.map(|factor| self.shop.cut.with_energy(factor, self.shop));
        for (i, setting) in settings.into_iter().enumerate() {
            let (number, x) = ((i + 1).to_string(), self.room.min.x + i as f64 * pitch);
            self.put(samples::square(&format!("power {number}")), x, y, Some(setting));
            self.write(&format!("number {number}"), &number, x + 0.3 * SQUARE_MM, y + SQUARE_MM + 1.0);
        }
        self.questions.push(Asked::WeakestThrough(settings.to_vec()));
        Ok(())
    }

    fn combs(&mut self, names: &[&str]) -> Result<(), Error> {
        for name in names {
            let y = self.row("kerf comb", COMB_MM[1], COMB_MM[0])?;
            self.put(samples::comb(name), self.room.min.x, y, None);
        }
        self.questions.push(Asked::Gap { cuts: samples::SLATS + 1 });
        Ok(())
    }

    fn grid(&mut self) -> Result<(), Error> {
        let shop = self.shop;
        let pitch = [SQUARE_MM + 8.0, SQUARE_MM + GAP_MM];
        let side = 22.0;
        let powers = GRID.map(|factor| (shop.cut.power * factor).clamp(shop.power_floor, 1.0));
        let feeds = GRID.map(|factor| (shop.cut.feed_mm_per_min * factor).min(shop.max_feed_mm_per_min).round());
        let (powers, feeds) = (distinct(&powers), distinct(&feeds));
        let head = shop.letter_mm + 1.0;
        let y = self.row("power grid", feeds.len() as f64 * pitch[1] + head, side + powers.len() as f64 * pitch[0])?;
        let top = y + feeds.len() as f64 * pitch[1];
        let mut cells = Vec::new();
        for (row, feed) in feeds.iter().enumerate() {
            let at = top - (row + 1) as f64 * pitch[1];
            let letter = char::from(b'a' + row as u8);
            self.write(&format!("feed {letter}"), &format!("{letter} {feed:.0}"), self.room.min.x, at + 3.0);
            for (column, power) in powers.iter().enumerate() {
                let x = self.room.min.x + side + column as f64 * pitch[0];
                let name = format!("{letter}{}", column + 1);
                let setting = Setting { feed_mm_per_min: *feed, power: *power };
                self.put(samples::square(&format!("power {name}")), x, at, Some(setting));
                cells.push((name, setting));
            }
        }
        for (column, power) in powers.iter().enumerate() {
            let x = self.room.min.x + side + column as f64 * pitch[0];
            let text = format!("{} {:.0}%", column + 1, 100.0 * power);
            self.write(&format!("power {}", column + 1), &text, x, top + 1.0);
        }
        self.questions.push(Asked::Cleanest(cells));
        Ok(())
    }

    /// The slits and their flap, and beside them lettering of several strengths.
    fn joints(&mut self, lettering: bool) -> Result<(), Error> {
        let shop = self.shop;
        let (slits, flap) = (samples::slits_length_mm(shop), samples::flap_length_mm(&shop.joint));
        let y = self.row("joint series", samples::coupon_width_mm(&shop.joint), slits + GAP_MM + flap)?;
        let x = self.room.min.x;
        self.put(samples::slits("slits", shop), x, y, None);
        self.put(samples::flap("flap", &shop.joint), x + slits + GAP_MM, y, None);
        self.questions.push(Asked::Slit(shop.slit_extras_mm().to_vec()));
        let (Some(engrave), true) = (shop.engrave, lettering) else { return Ok(()) };
        let settings = STRENGTHS.map(|factor| engrave.with_energy(factor, shop));
        let left = x + slits + flap + 2.0 * GAP_MM;
        let pitch = [text_width("A0", shop.letter_mm) + GAP_MM, shop.letter_mm + GAP_MM];
        let columns = (((self.room.max.x - left) / pitch[0]).floor().max(1.0) as usize).min(settings.len());
        let needed = settings.len().div_ceil(columns) as f64 * pitch[1];
        if left + pitch[0] > self.room.max.x || needed > samples::coupon_width_mm(&shop.joint) {
            return Err(Error::NoRoom { what: "lettering", needed_mm: needed, room_mm: self.room.max.x - left });
        }
        for (i, setting) in settings.into_iter().enumerate() {
            let text = format!("A{}", i + 1);
            let at = [left + (i % columns) as f64 * pitch[0], y + (i / columns) as f64 * pitch[1]];
            let drawing = samples::letters(&format!("label {}", i + 1), &text, shop.letter_mm);
            self.put(drawing, at[0], at[1], Some(setting));
        }
        self.questions.push(Asked::Label(settings.to_vec()));
        Ok(())
    }

    /// Two strips to hang over an edge, one up the right side and one along the foot, and above that a ruler where one can be marked; what is to be asked of
    /// them comes last.
    fn strips(&mut self) -> [Asked; 2] {
        let shop = self.shop;
        let reach = |length: f64| ((length - HELD_MM) / 5.0).floor() * 5.0;
        let (tall, x) = (self.room.height(), self.room.max.x - STRIP_MM);
        self.put(samples::hanging("across", "across", tall, reach(tall), true, shop), x, self.room.min.y, None);
        self.room.max.x = x - GAP_MM;
        let wide = self.room.width();
        let foot = |sheet: &mut Self, height: f64| {
            let y = sheet.room.min.y;
            sheet.room.min.y += height + GAP_MM;
            y
        };
        let y = foot(self, STRIP_MM);
        self.put(samples::hanging("along", "along", wide, reach(wide), false, shop), self.room.min.x, y, None);
        if shop.engrave.is_some() {
            let y = foot(self, RULER_MM);
            self.put(samples::ruler("ruler", RULER_LENGTH_MM, shop.letter_mm.min(4.0)), self.room.min.x, y, None);
        }
        [Asked::Drop { across: false, reach_mm: reach(wide) }, Asked::Drop { across: true, reach_mm: reach(tall) }]
    }
}

/// Values that differ, in order.
fn distinct(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    values
}

#[cfg(test)]
mod tests {
    use super::super::shop::paper;
    use super::*;

    const KINDS: [Kind; 5] = [Kind::Start, Kind::Kerf, Kind::Power, Kind::Joint, Kind::Stiffness];

    fn felt() -> Shop {
        let mut shop = paper();
        let joint = &mut shop.joint;
        (joint.min_width_mm, joint.neck_mm, joint.barb_mm, joint.head_length_mm) = (35.0, 13.0, 3.0, 10.0);
        (joint.slit_length_mm, joint.slit_relief_mm, joint.neck_length_mm) = (14.0, 0.0, 3.0);
        (joint.edge_distance_mm, joint.cut_distance_mm) = (8.0, 12.0);
        (joint.hinge, joint.hook_radius_mm) = (None, 0.0);
        Shop { engrave: None, letter_mm: 7.0, ..shop }
    }

    #[test]
    fn samples_lie_inside_the_margins_and_clear_of_each_other() {
        for shop in [paper(), felt(), Shop { laser: false, ..paper() }] {
            for kind in KINDS {
                let Ok(card) = card(kind, &shop) else {
                    assert!(!shop.laser, "{kind:?}");
                    continue;
                };
                let inside = Rect::from_size(card.width_mm, card.height_mm).grown(-shop.margin_mm);
                let boxes: Vec<(Rect, &str)> =
                    card.samples.iter().map(|s| (s.drawing.bounds(), s.drawing.name.as_str())).collect();
                for (i, (a, name)) in boxes.iter().enumerate() {
                    assert!(inside.holds(a, 1e-9), "{kind:?} {name} {a:?}");
                    for (b, other) in &boxes[..i] {
                        let apart = (a.min - b.max).sup(&(b.min - a.max));
                        assert!(apart.x.max(apart.y) >= 0.5, "{kind:?}: {name} {a:?} and {other} {b:?}");
                    }
                }
                let mut names: Vec<&str> = boxes.iter().map(|(_, name)| *name).collect();
                names.sort_unstable();
                names.dedup();
                assert_eq!(names.len(), boxes.len());
                assert!(!card.questions.is_empty());
            }
        }
    }

    #[test]
    fn a_blade_measures_joint_and_stiffness_and_no_kerf() {
        let shop = Shop { laser: false, ..paper() };
        let keys = |kind| card(kind, &shop).map(|card| card.questions.iter().map(Asked::key).collect::<Vec<_>>());
        assert_eq!(keys(Kind::Start), Ok(vec!["slit", "label", "along", "across"]));
        assert!(matches!(keys(Kind::Kerf), Err(Error::NoLaser { what: "kerf", .. })));
        assert!(matches!(keys(Kind::Power), Err(Error::NoLaser { what: "power", .. })));
    }

    #[test]
    fn the_power_row_rises_in_energy_and_its_middle_is_what_the_profile_says() {
        let shop = paper();
        let card = card(Kind::Start, &shop).unwrap();
        let trials: Vec<Setting> =
            card.samples.iter().filter(|s| s.drawing.name.starts_with("power")).filter_map(|s| s.trial).collect();
        assert!(trials.windows(2).all(|w| w[0].energy() < w[1].energy()));
        assert_eq!(trials[3], shop.cut);
    }

    #[test]
    fn a_joint_too_wide_for_the_card_is_named() {
        let mut shop = paper();
        shop.joint.min_width_mm = 160.0;
        let error = card(Kind::Joint, &shop).unwrap_err();
        assert!(error.to_string().contains("joint series needs 160 mm"), "{error}");
    }
}
