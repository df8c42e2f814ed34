//! Where a job lies on the bed: at work zero, where the head stands, in the machine's own corner, or by two crosses on the sheet.

use super::connection::{self, refused};
use super::frame::drive;
use super::keyboard::Keyboard;
use super::talk::{OnInterrupt, Talk};
use super::{Failure, jog};
use crate::config::{Corner, Machine};
use crate::gcode::{Action, Beam, CheckSettings, Move, check_moves};
use crate::geom::{P2, P3, Rect, Similarity, V2};
use crate::job;
use crate::stream::{Alignment, Command, Frame, Outcome};

/// How fast the head is moved onto a cross by hand, mm/min.
const NUDGE_MM_PER_MIN: f64 = 600.0;

/// Where the job is to lie.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct Placing {
    /// Where the job's X0 Y0 lies: at work zero (origin), where the head stands (current), or in the corner the machine measures from (absolute;
    /// it must have been homed)
    #[arg(long, value_name = "WHERE", default_value = "origin", conflicts_with = "align")]
    from: From,
    /// Lay the job so that its two alignment crosses meet those on the sheet: for a sheet that moved, one that was printed on or cut before, or its
    /// second tool. X1,Y1,X2,Y2 are where they are, in work coordinates; without them the head is moved onto them
    #[arg(long, value_name = "X1,Y1,X2,Y2", num_args = 0..=1, require_equals = true)]
    align: Option<Option<Crosses>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum From {
    /// At work zero.
    Origin,
    /// Where the head stands.
    Current,
    /// In the corner the machine measures from.
    Absolute,
}

/// Two places, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Crosses([P2; 2]);

impl std::str::FromStr for Crosses {
    type Err = String;

    fn from_str(text: &str) -> Result<Crosses, String> {
        let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse::<f64>()).collect();
        match numbers.as_deref() {
            Ok([a, b, c, d]) if [a, b, c, d].iter().all(|v| v.is_finite()) => {
                Ok(Crosses([P2::new(*a, *b), P2::new(*c, *d)]))
            }
            _ => Err("four numbers are needed, X1,Y1,X2,Y2, in mm".to_owned()),
        }
    }
}

impl Placing {
    /// By crosses that are `found`, when that is not `None`, or where they are said to be.
    pub(super) fn by_crosses(align: Option<Option<&str>>) -> Result<Placing, Failure> {
        let align = align.map(|places| places.map(str::parse).transpose()).transpose().map_err(Failure::config)?;
        Ok(Placing { from: From::Origin, align })
    }

    /// True when the head itself is to be moved onto the crosses.
    pub(super) fn is_by_hand(&self) -> bool {
        self.align == Some(None)
    }

    /// True when places of crosses are given, which are those of one sheet.
    pub(super) fn is_of_one_sheet(&self) -> bool {
        matches!(self.align, Some(Some(_)))
    }

    /// True when the job does not just lie at work zero.
    pub(super) fn is_asked_for(&self) -> bool {
        self.align.is_some() || self.from != From::Origin
    }

    /// True when crosses are to be met.
    pub(super) fn is_aligned(&self) -> bool {
        self.align.is_some()
    }

    /// From the job's coordinates to work coordinates, with the head at rest. `None` when the user has stopped it.
    ///
    /// # Errors
    /// The machine does not know its place, the job has no crosses, they are too far from where they should be, or nobody is there to move the head.
    pub(super) fn solve(
        &self,
        crosses_mm: Option<[[f64; 2]; 2]>,
        talk: &mut Talk,
        machine: &Machine,
        keyboard: Option<&Keyboard>,
    ) -> Result<Option<Similarity>, Failure> {
        let Some(found) = &self.align else {
            let shift = match self.from {
                From::Origin => V2::zeros(),
                From::Current => head(talk)?.coords,
                From::Absolute => corner(talk, machine)?.coords,
            };
            return Ok(Some(Similarity::new(shift, 0.0, 1.0)));
        };
        let planned = crosses_mm.ok_or_else(|| {
            refused("the job has no alignment crosses (its head has no line `; crosses: X.. Y.. and X.. Y.. mm`): make it again with a version that cuts them, or set work zero and leave --align out")
        })?;
        let planned = planned.map(P2::from);
        let found = match found {
            Some(Crosses(found)) => *found,
            None => match by_hand(planned, talk, machine, keyboard)? {
                Some(found) => found,
                None => return Ok(None),
            },
        };
        let alignment = Alignment::solve(planned, found).map_err(|e| refused(e.to_string()))?;
        eprintln!("{alignment}");
        Ok(Some(alignment.placing))
    }
}

fn head(talk: &Talk) -> Result<P2, Failure> {
    let [x, y, _] = talk.status.work_mm.ok_or_else(|| refused("the board does not say where the head is"))?;
    Ok(P2::new(x, y))
}

/// The corner the machine measures from, in work coordinates, mm.
///
/// # Errors
/// The machine does not know where it is.
pub(super) fn corner(talk: &Talk, machine: &Machine) -> Result<P2, Failure> {
    let unknown = || {
        refused("the machine does not know where its corner is: home it first (--home), or leave --from absolute out")
    };
    let offset = talk.board.offset_mm.filter(|_| talk.board.knows_place()).ok_or_else(unknown)?;
    let reach = |axis: usize| {
        let told = talk.board.settings.get(&(130 + axis as u16)).copied();
        talk.board.reach_mm(axis, told.unwrap_or(machine.controller.max_travel_mm[axis]))
    };
    let ((left, right), (front, back)) = (reach(0), reach(1));
    let (x, y) = match machine.origin {
        Corner::FrontLeft => (left, front),
        Corner::FrontRight => (right, front),
        Corner::BackLeft => (left, back),
        Corner::BackRight => (right, back),
    };
    Ok(P2::new(x - offset[0], y - offset[1]))
}

/// What the machine permits, in work coordinates as they are now. Where it does not know its place, only how large a job may be is known, which is
/// for the preflight to look at.
///
/// # Errors
/// None where it does not know its place.
pub(super) fn settings_here(talk: &Talk, machine: &Machine) -> Result<CheckSettings, Failure> {
    if !talk.board.knows_place() {
        return Ok(anywhere(machine));
    }
    let mut settings = job::check_settings(machine, None);
    let by: V2 = corner(talk, machine)? - P2::origin();
    for area in settings.keep_outs.iter_mut().map(|(_, area)| area).chain([&mut settings.work_area]) {
        (area.min, area.max) = (area.min + by, area.max + by);
    }
    Ok(settings)
}

/// What the machine permits wherever its work zero lies.
pub(super) fn anywhere(machine: &Machine) -> CheckSettings {
    let settings = job::check_settings(machine, None);
    let [x, y, _] = machine.controller.max_travel_mm;
    CheckSettings { work_area: settings.work_area.grown(x.max(y)), keep_outs: Vec::new(), ..settings }
}

/// Drives to where the crosses should be and has the head moved onto each. `None` when the user has stopped it.
fn by_hand(
    planned: [P2; 2],
    talk: &mut Talk,
    machine: &Machine,
    keyboard: Option<&Keyboard>,
) -> Result<Option<[P2; 2]>, Failure> {
    let nobody =
        || Failure::config("nobody is there to move the head onto the crosses; give their places: --align=X1,Y1,X2,Y2");
    let keyboard = keyboard.ok_or_else(nobody)?;
    let mut found = [P2::origin(); 2];
    for (k, name) in ["first", "second"].into_iter().enumerate() {
        let shift = if k == 1 { found[0] - planned[0] } else { V2::zeros() };
        if drive_to(talk, machine, planned[k] + shift)? != Outcome::Done {
            return Ok(None);
        }
        let mut question = format!(
            "{}\nmove the head onto the {name} cross: how far, in mm (0.5 -1.2), then Enter; Enter alone when it is there",
            talk.place()
        );
        loop {
            let Some(line) = keyboard.answer(talk, || eprintln!("{question}"))? else { return Ok(None) };
            let way: Vec<f64> = line.split([' ', ',']).filter_map(|number| number.parse().ok()).collect();
            match way[..] {
                _ if line.trim().is_empty() => break,
                [dx, dy] => {
                    let [dx_mm, dy_mm] = jog::clamped(talk, machine, [dx, dy]);
                    talk.on_interrupt(OnInterrupt::CancelJog);
                    talk.insist(Command::Jog { dx_mm, dy_mm, feed_mm_per_min: NUDGE_MM_PER_MIN })?;
                    talk.wait_for_rest()?;
                    talk.on_interrupt(OnInterrupt::Heed);
                    if talk.interrupted() {
                        return Ok(None);
                    }
                    question = talk.place();
                }
                _ => "two numbers, along X and along Y: 0.5 -1.2".clone_into(&mut question),
            }
        }
        found[k] = head(talk)?;
    }
    Ok(Some(found))
}

/// Travels to a place in work coordinates with the beam off, at a height when the tool has one.
///
/// # Errors
/// A way the machine must not go, or one that does not obey.
pub(super) fn drive_to(talk: &mut Talk, machine: &Machine, place: P2) -> Result<Outcome, Failure> {
    connection::require_idle(&talk.status)?;
    let settings = settings_here(talk, machine)?;
    // A head that stands outside comes in by the shortest way.
    let Rect { min, max } = settings.work_area;
    let from = head(talk).map_or(place, |head| head.sup(&min).inf(&max));
    if let Some(why) = objection(from, place, &settings) {
        return Err(refused(format!("the head is not driven to X{:.3} Y{:.3}: {why}", place.x, place.y)));
    }
    talk.on_interrupt(OnInterrupt::Stop);
    let outcome = drive(talk, Frame::way_to([place.x, place.y], machine.up_mm()))?;
    talk.on_interrupt(OnInterrupt::Leave);
    if let Outcome::Failed(trouble) = outcome {
        return Err(connection::machine_failure(trouble));
    }
    talk.wait_for_rest()?;
    Ok(outcome)
}

/// What is wrong with a dark way between two places in work coordinates.
fn objection(from: P2, to: P2, settings: &CheckSettings) -> Option<String> {
    let lift = |p: P2| P3::new(p.x, p.y, 0.0);
    let way = Move {
        line: 1,
        action: Action::Rapid,
        from: lift(from),
        to: lift(to),
        feed_mm_per_min: 0.0,
        power_s: 0.0,
        beam: Beam::Off,
        feeding: false,
        bytes: 0,
    };
    check_moves(&[way], 1, settings).errors.into_iter().next().map(|finding| finding.message)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Library;

    #[test]
    fn a_dark_way_keeps_within_the_machine_and_off_what_stands_on_its_bed() {
        let mut settings = job::check_settings(&Library::built_in().machine("diode-400").unwrap(), None);
        settings.keep_outs = vec![("clamp".to_owned(), Rect { min: P2::new(40.0, 40.0), max: P2::new(60.0, 60.0) })];
        let way = |to: [f64; 2]| objection(P2::new(10.0, 50.0), P2::from(to), &settings);
        assert_eq!(way([200.0, 300.0]), None);
        assert!(way([401.0, 50.0]).unwrap().contains("leaves the work area by 1.000 mm"));
        assert!(way([200.0, 50.0]).unwrap().contains("clamp"));
    }

    #[test]
    fn places_of_crosses_are_four_numbers() {
        assert_eq!("1,2.5, -3,4".parse(), Ok(Crosses([P2::new(1.0, 2.5), P2::new(-3.0, 4.0)])));
        for text in ["", "1,2,3", "1,2,3,x", "1,2,3,nan", "1 2 3 4"] {
            assert!(text.parse::<Crosses>().is_err(), "{text}");
        }
    }
}
