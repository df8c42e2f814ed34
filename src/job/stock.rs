//! Which sheets are cut from: names and sizes become containers within the machine's reach.

use super::Error;
use super::StartFrom;
use super::settings::Setup;
use crate::config::{Grain, Profile, Roll, StockGrain};
use crate::design::{Paper, StripAlong};
use crate::geom::{P2, Rect};
use crate::nest::Container;
use crate::progress::Warning;

/// One kind of sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// "A4", "500x300".
    pub name: String,
    /// Along x on the machine, mm.
    pub width_mm: f64,
    /// Along y on the machine, mm.
    pub height_mm: f64,
    /// How many there are; `None` for as many as needed.
    pub count: Option<u32>,
    /// How the grain runs.
    pub grain: StockGrain,
    /// A roll: `width_mm` is the longest feed made at once and `height_mm` its width.
    pub roll: bool,
}

/// The word that names a roll by its width: "roll 600".
const ROLL: &str = "roll ";

/// Reads `A4`, `A4@3`, `420x297` or `500x300@4` (mm; @ how many).
pub fn parse_stock(given: &str, profile: &Profile) -> Result<Sheet, Error> {
    let (size, count) = match given.split_once('@') {
        None => (given, None),
        Some((size, count)) => match count.trim().parse::<u32>() {
            Ok(n) if n > 0 => (size, Some(n)),
            _ => return Err(unknown(given, profile)),
        },
    };
    if let Some(stock) = profile.stock_named(size.trim())
        && let Some([width_mm, height_mm]) = stock.size_mm
    {
        let name = stock.name.clone();
        return Ok(Sheet { name, width_mm, height_mm, count: count.or(stock.count), grain: stock.grain, roll: false });
    }
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|v| v.is_finite() && *v > 0.0);
    let sides = size.split_once(['x', 'X']).and_then(|(w, h)| Some((number(w)?, number(h)?)));
    let (width_mm, height_mm) = sides.or_else(|| paper_size(size.trim())).ok_or_else(|| unknown(given, profile))?;
    Ok(Sheet { name: size.trim().to_owned(), width_mm, height_mm, count, grain: StockGrain::Unknown, roll: false })
}

/// The roll a machine is fed with: `roll 600`, a roll of the profile's by name, or when nothing is named the profile's first or else the machine's full width.
fn parse_roll(given: Option<&str>, roll: &Roll, setup: &Setup) -> Result<Sheet, Error> {
    let profile = &setup.profile;
    let named = |name: &str| {
        let stock = profile.stock_named(name)?;
        Some((stock.name.clone(), stock.roll_width_mm?))
    };
    let width = |text: &str| text.trim().parse::<f64>().ok().filter(|w| w.is_finite() && *w > 0.0);
    let (name, width_mm) = match given {
        Some(given) => match (named(given), given.strip_prefix(ROLL).and_then(width)) {
            (Some(own), _) => own,
            (None, Some(width_mm)) => (given.to_owned(), width_mm),
            (None, None) => {
                let problem = format!(
                    "is fed from a roll and {given:?} is none; name its width with --roll, for example --roll {:.0}",
                    roll.media_width_mm
                );
                return Err(Error::Machine { machine: setup.machine.name.clone(), problem });
            }
        },
        None => profile
            .stock
            .iter()
            .find_map(|s| named(&s.name))
            .unwrap_or_else(|| (format!("{ROLL}{:.0}", roll.media_width_mm), roll.media_width_mm)),
    };
    if width_mm > roll.media_width_mm || width_mm <= 2.0 * roll.pinch_margin_mm {
        let problem = format!(
            "takes rolls of up to {} mm, of which its pinch rollers need {} mm along each rim; {width_mm} mm is no such roll",
            roll.media_width_mm, roll.pinch_margin_mm
        );
        return Err(Error::Machine { machine: setup.machine.name.clone(), problem });
    }
    let height_mm = width_mm - 2.0 * roll.pinch_margin_mm;
    Ok(Sheet { name, width_mm: roll.max_length_mm, height_mm, count: None, grain: StockGrain::Long, roll: true })
}

/// ISO 216 A sizes and US letter, landscape, mm: known to everybody whether the profile lists them or not.
fn paper_size(name: &str) -> Option<(f64, f64)> {
    match name.to_ascii_uppercase().as_str() {
        "A5" => Some((210.0, 148.0)),
        "A4" => Some((297.0, 210.0)),
        "A3" => Some((420.0, 297.0)),
        "LETTER" => Some((279.4, 215.9)),
        "A2" => Some((594.0, 420.0)),
        _ => None,
    }
}

fn unknown(given: &str, profile: &Profile) -> Error {
    let known: Vec<&str> = profile.stock.iter().filter(|s| s.size_mm.is_some()).map(|s| s.name.as_str()).collect();
    Error::UnknownStock { given: given.into(), profile: profile.name.clone(), known: known.join(", ") }
}

/// Sheets the design asks for, or all the material offers, each laid so that its grain runs along x, the way strips run.
pub(super) fn sheets(setup: &Setup) -> Result<Vec<Sheet>, Error> {
    let profile = &setup.profile;
    if let Some(roll) = &setup.machine.roll {
        if setup.stock.is_empty() {
            return Ok(vec![parse_roll(None, roll, setup)?]);
        }
        return setup.stock.iter().map(|name| parse_roll(Some(name), roll, setup)).collect();
    }
    if let Some(name) = setup.stock.iter().find(|name| name.starts_with(ROLL)) {
        let problem = format!("has a bed and no rollers for {name:?}; name sheets with --stock");
        return Err(Error::Machine { machine: setup.machine.name.clone(), problem });
    }
    let names: Vec<String> = if setup.stock.is_empty() {
        // What goes through the printer comes first.
        let printed = (setup.by_hand() && setup.paper == Paper::Letter).then(|| "Letter".to_owned());
        let own = profile.stock.iter().filter(|s| s.size_mm.is_some()).map(|s| s.name.clone());
        printed.into_iter().chain(own).collect()
    } else {
        setup.stock.clone()
    };
    let mut sheets = names.iter().map(|n| parse_stock(n, profile)).collect::<Result<Vec<Sheet>, Error>>()?;
    for sheet in &mut sheets {
        let upright = sheet.height_mm > sheet.width_mm;
        let grain_along_y = match sheet.grain {
            StockGrain::Long | StockGrain::Unknown => upright,
            StockGrain::Short => !upright,
        };
        if profile.grain == Grain::Directional && grain_along_y {
            (sheet.width_mm, sheet.height_mm) = (sheet.height_mm, sheet.width_mm);
        }
    }
    if sheets.is_empty() {
        return Err(Error::NoStock { profile: profile.name.clone(), machine: setup.machine.name.clone() });
    }
    Ok(sheets)
}

/// The part of a sheet the head reaches when the sheet lies in the stop corner.
pub(super) fn container(sheet: &Sheet, setup: &Setup) -> Container {
    let reach = setup.reach();
    if sheet.roll {
        return Container::Roll {
            name: sheet.name.clone(),
            width_mm: sheet.height_mm.min(reach.height()),
            max_length_mm: sheet.width_mm,
        };
    }
    let limited = overhang_mm(sheet, setup) > 0.0;
    let name = match limited {
        // What is told of pieces that do not fit: larger stock would not help.
        true => format!(
            "{} within {}'s reach, {:.0} x {:.0} mm",
            sheet.name,
            setup.machine.name,
            reach.width(),
            reach.height()
        ),
        false => sheet.name.clone(),
    };
    let (width_mm, height_mm) = (sheet.width_mm.min(reach.width()), sheet.height_mm.min(reach.height()));
    Container::sheet(name, width_mm, height_mm, sheet.count)
}

/// The same container with what stands on the bed blocked, as far as the machine's file tells and the sheet's place is known: in the stop corner.
pub(super) fn beside_clamps(mut container: Container, setup: &Setup, start: &StartFrom) -> Container {
    let size = container.size_mm();
    let sheet = Rect::from_size(size.x, size.y);
    if let Container::Sheet { blocked, .. } = &mut container {
        let tools = [Some(setup.toolpath(start)), setup.drawing(start)];
        for tool in tools.into_iter().flatten() {
            let back = tool.frame.motion(&sheet, &sheet).inverse();
            for (_, rect) in &tool.keep_outs {
                // The tool's way in lies outside of the outline.
                let on_sheet = Rect::EMPTY.with(back * rect.min).with(back * rect.max).grown(tool.lead_mm);
                let Rect { min, max } = Rect { min: on_sheet.min.sup(&sheet.min), max: on_sheet.max.inf(&sheet.max) };
                if min.x < max.x && min.y < max.y {
                    blocked.push(vec![min, P2::new(max.x, min.y), max, P2::new(min.x, max.y)]);
                }
            }
        }
    }
    container
}

/// A piece that exactly fills a container does not go in: placing allows for rounding. Pieces are made this much shorter, mm.
const FIT_SLACK_MM: f64 = 0.1;

/// Longest piece that fits a sheet the way strips run, mm.
pub(super) fn longest_piece_mm(sheet: &Sheet, setup: &Setup) -> f64 {
    let [along, _] = sides_mm(sheet, setup);
    along - 2.0 * setup.margin_mm() - FIT_SLACK_MM
}

/// Widest piece that fits a sheet across the way strips run, mm.
pub(super) fn widest_piece_mm(sheet: &Sheet, setup: &Setup) -> f64 {
    let [_, across] = sides_mm(sheet, setup);
    across - 2.0 * setup.margin_mm() - FIT_SLACK_MM
}

/// Extent of a sheet along and across the way strips run, mm. Its grain runs along x.
fn sides_mm(sheet: &Sheet, setup: &Setup) -> [f64; 2] {
    let size = container(sheet, setup).size_mm();
    match (setup.profile.grain, setup.strip_along) {
        (Grain::Directional, StripAlong::Grain) => [size.x, size.y],
        (Grain::Directional, StripAlong::Across) => [size.y, size.x],
        (Grain::None, _) => [size.x.max(size.y), size.x.min(size.y)],
    }
}

/// How far a sheet hangs over the machine's reach, mm.
pub(super) fn overhang_mm(sheet: &Sheet, setup: &Setup) -> f64 {
    let reach = setup.reach();
    (sheet.width_mm - reach.width()).max(sheet.height_mm - reach.height()).max(0.0)
}

/// What the user should know about the sheets that were used.
pub(super) fn warnings(used: &[&Sheet], setup: &Setup) -> Vec<Warning> {
    let mut warnings = Vec::new();
    for sheet in used {
        let over = overhang_mm(sheet, setup);
        if over > 0.0 {
            warnings.push(Warning::new(
                "stock-overhangs",
                format!(
                    "a sheet of {} hangs over {}'s reach by {over:.0} mm: the machine must be open on that side, or use smaller stock",
                    sheet.name, setup.machine.name
                ),
            ));
        }
    }
    if setup.profile.grain == Grain::Directional && used.iter().any(|s| s.grain == StockGrain::Unknown) {
        warnings.push(Warning::new(
            "grain-unknown",
            format!(
                "all strips run along the {} side of the sheet, and {} is taken to be stiffest along the long one: tear a corner (it tears straight along the grain) and turn the sheets if not",
                match setup.strip_along {
                    StripAlong::Grain => "long",
                    StripAlong::Across => "short",
                },
                setup.profile.name
            ),
        ));
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Library;

    fn paper() -> Profile {
        Library::built_in().profile("paper-160").unwrap()
    }

    #[test]
    fn stock_is_read_by_name_and_by_size() {
        let a4 = parse_stock("a4@3", &paper()).unwrap();
        assert_eq!((a4.width_mm, a4.height_mm, a4.count), (297.0, 210.0, Some(3)));
        let own = parse_stock("500 x 300@2", &paper()).unwrap();
        assert_eq!((own.width_mm, own.height_mm, own.count), (500.0, 300.0, Some(2)));
        assert_eq!(parse_stock("A2", &paper()).unwrap().width_mm, 594.0);
    }

    #[test]
    fn what_is_no_stock_is_refused_with_what_there_is() {
        for given in ["A9", "x", "0x10", "-5x10", "A4@0", "A4@", "nanx3", ""] {
            let message = parse_stock(given, &paper()).unwrap_err().to_string();
            assert!(message.contains("A4, A3"), "{given}: {message}");
        }
    }
}
