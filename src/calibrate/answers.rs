//! What is asked after a card was cut, and what the answers mean.

use super::card::Card;
use super::error::Error;
use super::hanging::flexural_rigidity_n_mm;
use super::shop::{Setting, Shop};

/// A question about a card.
#[derive(Debug, Clone, PartialEq)]
pub enum Asked {
    /// The first square of a row, weakest first, that falls out.
    WeakestThrough(Vec<Setting>),
    /// The square of a grid that falls out with the cleanest edges.
    Cleanest(Vec<(String, Setting)>),
    /// The gap beside the slats of a comb, mm.
    Gap {
        /// Cuts that made it.
        cuts: usize,
    },
    /// The shortest slit that takes the flap and holds it: how much longer each is than the neck, mm.
    Slit(Vec<f64>),
    /// The weakest lettering that can be read.
    Label(Vec<Setting>),
    /// How far a strip hangs, mm.
    Drop {
        /// The strip that was cut across the card's length.
        across: bool,
        /// How far it reaches over the edge, mm.
        reach_mm: f64,
    },
}

/// Answers by key; a question without one leaves what it is about alone.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Answers(pub Vec<(String, String)>);

/// What was found out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Finding {
    /// How it is cut.
    Cut(Setting),
    /// Full width the cut removes, mm.
    Kerf(f64),
    /// How much longer the slit is than the neck, mm.
    SlitExtra(f64),
    /// How it is engraved.
    Engrave(Setting),
    /// Flexural rigidity along the card's length, N mm.
    Along(f64),
    /// Flexural rigidity across the card's length, N mm.
    Across(f64),
}

impl Asked {
    /// What an answer is called.
    pub fn key(&self) -> &'static str {
        match self {
            Asked::WeakestThrough(_) => "square",
            Asked::Cleanest(_) => "cell",
            Asked::Gap { .. } => "gap",
            Asked::Slit(_) => "slit",
            Asked::Label(_) => "label",
            Asked::Drop { across: false, .. } => "along",
            Asked::Drop { across: true, .. } => "across",
        }
    }

    /// The question, as people read it.
    pub fn text(&self) -> String {
        match self {
            Asked::WeakestThrough(settings) => format!(
                "Lift the card: the squares in the row get more energy from left to right. Number of the first that falls out by itself (1-{}; 0: none did)",
                settings.len()
            ),
            Asked::Cleanest(_) => {
                "Of the squares that fall out by themselves, the one with the cleanest edge and the least brown (row and column, such as b3; 0: none did)".into()
            }
            Asked::Gap { .. } => {
                "Leave the slats in their window, push them together to one side without one riding over another. Width of the gap that is left, mm (two combs: both, with a space between)".into()
            }
            Asked::Slit(extras) => format!(
                "Push the flap through the slits, shortest first (number 1). Number of the first it goes through without tearing and holds in when you pull (1-{}; 0: none)",
                extras.len()
            ),
            Asked::Label(settings) => format!(
                "A1 to A{} are engraved stronger and stronger. Number of the first you read easily, with nothing cut through (0: none)",
                settings.len()
            ),
            Asked::Drop { across, reach_mm } => format!(
                "Hold the strip marked {} flat on a table with its two notches on the edge, so that {reach_mm:.0} mm reach out. How far below the table top is its tip, mm (both faces up in turn: both numbers, with a space between)",
                if *across { "\"across\" (the one that stood upright on the card)" } else { "\"along\" (the one that lay on the card)" }
            ),
        }
    }

    fn finding(&self, answer: &str, shop: &Shop) -> Result<Option<Finding>, Error> {
        let wrong = |needed: String| Error::Answer { key: self.key(), answer: answer.into(), needed };
        let choice = |count: usize| match answer.parse::<usize>() {
            Ok(0) => Ok(None),
            Ok(n) if n <= count => Ok(Some(n - 1)),
            _ => Err(wrong(format!("a whole number from 0 to {count}"))),
        };
        Ok(match self {
            // One step more than what just fell out: sheets and lenses differ from day to day.
            Asked::WeakestThrough(settings) => {
                choice(settings.len())?.map(|n| Finding::Cut(settings[(n + 1).min(settings.len() - 1)]))
            }
            Asked::Cleanest(_) if answer == "0" => None,
            Asked::Cleanest(cells) => {
                let found = cells.iter().find(|(name, _)| name.eq_ignore_ascii_case(answer));
                let last = cells.last().map_or("", |(name, _)| name);
                let (_, setting) =
                    found.ok_or_else(|| wrong(format!("a row's letter and a column's number, a1 to {last}, or 0")))?;
                Some(Finding::Cut(*setting))
            }
            Asked::Gap { cuts } => {
                let gap = mean(answer).filter(|gap| (0.0..=2.0 * *cuts as f64).contains(gap));
                let gap = gap.ok_or_else(|| wrong("a length in mm, or several".into()))?;
                Some(Finding::Kerf((gap / *cuts as f64 * 1000.0).round() / 1000.0))
            }
            Asked::Slit(extras) => choice(extras.len())?.map(|n| Finding::SlitExtra(extras[n])),
            Asked::Label(settings) => choice(settings.len())?.map(|n| Finding::Engrave(settings[n])),
            Asked::Drop { across, reach_mm } => {
                let drop_mm = mean(answer).ok_or_else(|| wrong("a length in mm, or several".into()))?;
                let hanging = || Error::Hanging { key: self.key(), overhang_mm: *reach_mm, drop_mm };
                let rigidity =
                    flexural_rigidity_n_mm(shop.grammage_g_per_m2, *reach_mm, drop_mm).ok_or_else(hanging)?;
                let rigidity = (rigidity * 1000.0).round() / 1000.0;
                Some(if *across { Finding::Across(rigidity) } else { Finding::Along(rigidity) })
            }
        })
    }
}

/// The mean of the numbers in a text; `None` where there are none, or something else.
fn mean(text: &str) -> Option<f64> {
    let numbers: Option<Vec<f64>> = text
        .split([' ', ';'])
        .filter(|word| !word.is_empty())
        .map(|word| word.replace(',', ".").parse::<f64>().ok().filter(|n| n.is_finite()))
        .collect();
    let numbers = numbers.filter(|n| !n.is_empty())?;
    Some(numbers.iter().sum::<f64>() / numbers.len() as f64)
}

/// What the answers to a card's questions mean.
///
/// # Errors
/// A key that was not asked, an answer that is none, a strip that no stiffness explains.
pub fn findings(card: &Card, answers: &Answers, shop: &Shop) -> Result<Vec<Finding>, Error> {
    let keys = || card.questions.iter().map(Asked::key).collect::<Vec<_>>().join(", ");
    let mut found = Vec::new();
    for (key, answer) in &answers.0 {
        let asked = card.questions.iter().find(|asked| asked.key() == key);
        let asked = asked.ok_or_else(|| Error::UnknownKey { key: key.clone(), known: keys() })?;
        if !answer.trim().is_empty() {
            found.extend(asked.finding(answer.trim(), shop)?);
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::super::card::{Kind, card};
    use super::super::shop::paper;
    use super::*;

    fn found(kind: Kind, answers: &[(&str, &str)]) -> Result<Vec<Finding>, Error> {
        let shop = paper();
        let answers = Answers(answers.iter().map(|(k, v)| ((*k).into(), (*v).into())).collect());
        findings(&card(kind, &shop).unwrap(), &answers, &shop)
    }

    #[test]
    fn the_square_after_the_first_that_fell_out_is_taken() {
        let setting = |answer| found(Kind::Start, &[("square", answer)]).unwrap();
        // Number 4 is the profile's own 1200 mm/min; one step more is a quarter more energy.
        assert_eq!(setting("4"), [Finding::Cut(Setting { feed_mm_per_min: 960.0, power: 0.5 })]);
        assert_eq!(setting("7"), [Finding::Cut(Setting { feed_mm_per_min: 600.0, power: 0.5 })]);
        assert_eq!(setting("0"), []);
    }

    #[test]
    fn eleven_cuts_make_the_gap_of_a_comb() {
        assert_eq!(found(Kind::Start, &[("gap", "1.65")]), Ok(vec![Finding::Kerf(0.15)]));
        assert_eq!(found(Kind::Kerf, &[("gap", "1,6 1,7")]), Ok(vec![Finding::Kerf(0.15)]));
    }

    #[test]
    fn slits_letters_and_cells_are_named_by_their_number() {
        assert_eq!(found(Kind::Joint, &[("slit", "3")]), Ok(vec![Finding::SlitExtra(0.8)]));
        let engraved = found(Kind::Start, &[("label", "5")]).unwrap();
        assert_eq!(engraved, [Finding::Engrave(Setting { feed_mm_per_min: 900.0, power: 0.08 })]);
        let cell = found(Kind::Power, &[("cell", "B4")]).unwrap();
        assert_eq!(cell, [Finding::Cut(Setting { feed_mm_per_min: 852.0, power: 0.705 })]);
        assert_eq!(found(Kind::Power, &[("cell", "0")]), Ok(vec![]));
    }

    #[test]
    fn both_faces_are_averaged_and_an_empty_answer_changes_nothing() {
        let rigidity = |drop: &str| found(Kind::Stiffness, &[("along", drop), ("across", " ")]).unwrap();
        assert_eq!(rigidity("20 30"), rigidity("25"));
        assert!(matches!(rigidity("25")[..], [Finding::Along(d)] if d > 1.0 && d < 10.0), "{:?}", rigidity("25"));
    }

    #[test]
    fn wrong_answers_say_what_is_wanted() {
        let message = |kind, key, answer| found(kind, &[(key, answer)]).unwrap_err().to_string();
        assert!(message(Kind::Start, "square", "8").contains("from 0 to 7"));
        assert!(message(Kind::Start, "gap", "much").contains("a length in mm"));
        assert!(message(Kind::Power, "cell", "z9").contains("a1 to e5"));
        assert!(message(Kind::Kerf, "slit", "1").contains("asks for gap"));
        assert!(message(Kind::Stiffness, "along", "200").contains("hang"));
    }
}
