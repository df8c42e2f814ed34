//! A machine meets a profile: is the pair allowed, and with which feed and power is it cut.
//!
//! Laser values are carried from the reference laser to this one at equal energy per length: what burns through a sheet of a given
//! material at moderate speed is joules per millimetre, E = 60 p W / F (p share of power, W optical watts, F mm/min). That holds within
//! about a factor of two in W; beyond it the spot, the heat flow and the tube's behaviour differ too much.

use crate::progress::Warning;

use super::error::Error;
use super::joint::Dashes;
use super::machine::{Machine, ToolClass};
use super::profile::{Air, Blade, Bridges, ProcessKind, ProcessRow, Profile, Verdict};

/// How far the machine's power may lie from the row's, as a factor either way.
const RESCALE_FACTOR: f64 = 2.0;

/// How a material is cut (and labelled) on a machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Pairing {
    /// Through the sheet.
    pub cut: Process,
    /// Labels and marks on its surface; `None` where this tool leaves nothing legible or cuts through.
    pub engrave: Option<Process>,
    /// Drawing with the machine's pen, where it has one beside the tool or in its place.
    pub pen: Option<Process>,
    /// What the user should know: "test this pair first", "uncalibrated".
    pub warnings: Vec<Warning>,
}

/// Settings for one operation, valid for this machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Process {
    /// Full width of what the cut removes, mm; 0 for blades and for engraving.
    pub kerf_mm: f64,
    /// Speed along the path, mm/min; never above what both axes can run.
    pub feed_mm_per_min: f64,
    /// Share of full power: from the tool's floor to 1 for a laser, 0 for blades.
    pub power: f64,
    /// Air assist.
    pub air: Air,
    /// Share of `power` in every pass, one entry a pass; never empty.
    pub pass_power: Vec<f64>,
    /// How much lower the tool is set for each pass after the first, mm.
    pub z_step_mm: f64,
    /// Lead-in and lead-out, mm, when the profile says.
    pub lead_mm: Option<f64>,
    /// How far closed contours run on over their start, mm, when the profile says.
    pub overcut_mm: Option<f64>,
    /// Least distance of a cut's start from the last one's end, mm.
    pub cool_mm: f64,
    /// Dashes instead of lines.
    pub perforation: Option<Dashes>,
    /// Uncut stretches that hold the pieces, if the material wants any.
    pub bridges: Option<Bridges>,
    /// The blade and its pressure, for drag knives.
    pub blade: Option<Blade>,
    /// True when the values were measured on this very machine, and for a pen, which needs none.
    pub calibrated: bool,
    /// Where the values come from, in the profile's words.
    pub source: String,
}

impl Machine {
    /// Finds out how `profile` is cut on this machine.
    ///
    /// Errors: [`Error::Forbidden`] when the profile says never, [`Error::NoProcess`] when it has no row for the tool,
    /// [`Error::NeedsCalibration`] and [`Error::TooStrong`] when its values cannot be carried over.
    pub fn pair(&self, profile: &Profile) -> Result<Pairing, Error> {
        self.pair_within(profile, RESCALE_FACTOR)
    }

    /// What to begin measuring with: as [`Machine::pair`], but the values of a laser of any power are carried over.
    pub fn trial(&self, profile: &Profile) -> Result<Pairing, Error> {
        self.pair_within(profile, f64::INFINITY)
    }

    fn pair_within(&self, profile: &Profile, factor: f64) -> Result<Pairing, Error> {
        if self.tool.class == ToolClass::Scissors {
            let cut = by_hand();
            return Ok(Pairing { engrave: Some(cut.clone()), cut, pen: None, warnings: Vec::new() });
        }
        let mut warnings = Vec::new();
        match profile.allowed.for_tool(self.tool.class) {
            (Some(Verdict::Never), reason) => {
                return Err(Error::Forbidden {
                    machine: self.name.clone(),
                    profile: profile.name.clone(),
                    class: self.tool.class,
                    reason: reason.unwrap_or("the profile gives no reason").to_owned(),
                });
            }
            (Some(Verdict::Yes), _) => {}
            (Some(Verdict::Test), reason) => warnings.push(test_first(self, profile, reason.unwrap_or_default())),
            (None, _) => warnings.push(test_first(self, profile, "the profile does not say whether that works")),
        }
        let pen = self.tool.class == ToolClass::Pen;
        let cuts = if pen { ProcessKind::Engrave } else { ProcessKind::Cut };
        let row = nearest_row(self, profile, cuts).ok_or_else(|| no_process(self, profile))?;
        let mut cut = carry_over(self, profile, row, factor)?;
        if pen {
            // Nothing of a line needs measuring first.
            cut.calibrated = true;
            let message = format!("{} draws the lines and cuts nothing: cut by hand along them", self.name);
            warnings.push(Warning::new("drawn-only", message));
        }
        let engrave =
            match nearest_row(self, profile, ProcessKind::Engrave).map(|row| carry_over(self, profile, row, factor)) {
                Some(Ok(engrave)) => Some(engrave),
                // Labels can be written by hand: no reason to refuse the job.
                Some(Err(error)) => {
                    warnings.push(Warning::new("no-engraving", format!("nothing will be engraved: {error}")));
                    None
                }
                None => None,
            };
        if !cut.calibrated {
            warnings.push(Warning::new(
                "uncalibrated",
                format!(
                    "UNCALIBRATED: nobody measured {} on {} (values {}); until `calibrate` has, cut a small test piece first",
                    profile.name, self.name, cut.source
                ),
            ));
        }
        let pen = drawn(self, profile)?;
        Ok(Pairing { cut, engrave, pen, warnings })
    }
}

/// How fast a person cuts along a line with knife and scissors, mm/min: from practice.
const HAND_MM_PER_MIN: f64 = 400.0;

/// A printer draws labels and lines; a person cuts on the line.
fn by_hand() -> Process {
    Process {
        kerf_mm: 0.0,
        feed_mm_per_min: HAND_MM_PER_MIN,
        power: 0.0,
        air: Air::Off,
        pass_power: vec![1.0],
        z_step_mm: 0.0,
        lead_mm: None,
        overcut_mm: None,
        cool_mm: 0.0,
        perforation: None,
        bridges: None,
        blade: None,
        calibrated: true,
        source: "by hand".to_owned(),
    }
}

impl Process {
    /// Energy per length that `watts` of light leave behind at this feed and power, J/mm, per pass.
    pub fn energy_j_per_mm(&self, watts: f64) -> f64 {
        energy_j_per_mm(self.power, watts, self.feed_mm_per_min)
    }
}

fn energy_j_per_mm(power: f64, watts: f64, feed_mm_per_min: f64) -> f64 {
    power * watts * 60.0 / feed_mm_per_min
}

fn test_first(machine: &Machine, profile: &Profile, reason: &str) -> Warning {
    let message = format!("cut a test piece of {} on {} first: {reason}", profile.name, machine.name);
    Warning::new("test-first", message)
}

fn no_process(machine: &Machine, profile: &Profile) -> Error {
    let mut tools: Vec<_> =
        profile.process.iter().filter(|r| r.operation == ProcessKind::Cut).map(|r| r.tool).collect();
    tools.sort_unstable();
    tools.dedup();
    let tools: Vec<_> = tools.into_iter().map(|tool| tool.title()).collect();
    Error::NoProcess {
        machine: machine.name.clone(),
        profile: profile.name.clone(),
        class: machine.tool.class,
        tools: tools.join(" or "),
    }
}

/// The row for this tool and operation: one measured on this machine, else the one whose power is nearest as a ratio. Of equals the first.
pub(super) fn nearest_row<'a>(
    machine: &Machine,
    profile: &'a Profile,
    operation: ProcessKind,
) -> Option<&'a ProcessRow> {
    let distance = |row: &ProcessRow| match (row.reference_power_w, machine.tool.optical_power_w) {
        (Some(reference), Some(actual)) => (reference / actual).ln().abs(),
        _ => 0.0,
    };
    let key = |row: &ProcessRow| (!measured_here(machine, row), distance(row));
    profile
        .process
        .iter()
        .filter(|row| row.tool == machine.tool.class && row.operation == operation)
        .min_by(|a, b| key(a).0.cmp(&key(b).0).then(key(a).1.total_cmp(&key(b).1)))
}

/// How the machine's pen draws, if it has one and the material takes it.
fn drawn(machine: &Machine, profile: &Profile) -> Result<Option<Process>, Error> {
    let (verdict, _) = profile.allowed.for_tool(ToolClass::Pen);
    if machine.pen.is_none() || verdict == Some(Verdict::Never) {
        return Ok(None);
    }
    let row = profile.process.iter().find(|r| r.tool == ToolClass::Pen && r.operation == ProcessKind::Engrave);
    row.map(|row| carry_over(machine, profile, row, RESCALE_FACTOR)).transpose()
}

fn measured_here(machine: &Machine, row: &ProcessRow) -> bool {
    row.measured_on.as_deref() == Some(machine.name.as_str())
}

fn carry_over(machine: &Machine, profile: &Profile, row: &ProcessRow, factor: f64) -> Result<Process, Error> {
    let limit = machine.max_feed_mm_per_min();
    let (feed_mm_per_min, power) = match (row.power, row.reference_power_w, machine.tool.optical_power_w) {
        (Some(power), Some(reference), Some(actual)) if row.tool.is_laser() => {
            rescale(machine, profile, row, [power, reference, actual], factor)?
        }
        _ => (row.feed_mm_per_min.min(limit), row.power.unwrap_or(0.0)),
    };
    Ok(Process {
        kerf_mm: row.kerf_mm.unwrap_or(0.0),
        feed_mm_per_min,
        power,
        air: row.air,
        pass_power: if row.pass_power.is_empty() {
            vec![1.0; row.passes.max(1) as usize]
        } else {
            row.pass_power.clone()
        },
        z_step_mm: row.z_step_mm,
        lead_mm: row.lead_mm,
        overcut_mm: row.overcut_mm,
        cool_mm: row.cool_mm,
        perforation: row.perforation,
        bridges: row.bridges,
        blade: row.blade,
        calibrated: measured_here(machine, row),
        source: row.source.clone(),
    })
}

/// Feed and power that leave the row's energy per length, for watts within `factor` of the row's: the row's feed where it can be had, another where power would leave floor..1.
fn rescale(
    machine: &Machine,
    profile: &Profile,
    row: &ProcessRow,
    [power, reference_power_w, power_w]: [f64; 3],
    factor: f64,
) -> Result<(f64, f64), Error> {
    let ratio = power_w / reference_power_w;
    // A hair beyond the factor is rounding, not another laser.
    if !(1.0 / factor - 1e-9..=factor + 1e-9).contains(&ratio) {
        return Err(Error::NeedsCalibration {
            machine: machine.name.clone(),
            profile: profile.name.clone(),
            power_w,
            reference_power_w,
        });
    }
    let energy = energy_j_per_mm(power, reference_power_w, row.feed_mm_per_min);
    let feed_at = |power: f64| power * power_w * 60.0 / energy;
    let limit = machine.max_feed_mm_per_min();
    let floor = machine.tool.power_floor;
    let feed = row.feed_mm_per_min.min(limit);
    // Same feed, same watts: exactly the row's own power, without rounding.
    let wanted = power / ratio * (feed / row.feed_mm_per_min);
    if wanted > 1.0 {
        return Ok((feed_at(1.0), 1.0));
    }
    if wanted >= floor {
        return Ok((feed, wanted));
    }
    let feed = feed_at(floor);
    if feed <= limit {
        return Ok((feed, floor));
    }
    Err(Error::TooStrong {
        machine: machine.name.clone(),
        profile: profile.name.clone(),
        operation: row.operation.word(),
        power_floor: floor,
        feed_mm_per_min: feed,
        limit_mm_per_min: limit,
    })
}

#[cfg(test)]
mod tests {
    use super::super::library::Library;
    use super::*;

    fn machine(name: &str) -> Machine {
        Library::built_in().machine(name).expect("built in")
    }

    fn profile(name: &str) -> Profile {
        Library::built_in().profile(name).expect("built in")
    }

    fn diode(watts: f64) -> Machine {
        let mut machine = machine("diode-400");
        machine.tool.optical_power_w = Some(watts);
        machine
    }

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-9 * b.abs().max(1.0)
    }

    #[test]
    fn the_same_watts_take_the_row_as_it_stands() {
        let pair = machine("diode-400").pair(&profile("paper-160")).expect("allowed");
        assert_eq!((pair.cut.feed_mm_per_min, pair.cut.power, pair.cut.kerf_mm), (1200.0, 0.5, 0.15));
        let engrave = pair.engrave.expect("paper takes engraving");
        assert_eq!((engrave.feed_mm_per_min, engrave.power, engrave.kerf_mm), (1800.0, 0.08, 0.0));
        // 0.5 x 10 W at 20 mm/s
        assert!(near(pair.cut.energy_j_per_mm(10.0), 0.25));
        assert_eq!(diode(5.0).pair(&profile("paper-160")).expect("allowed").cut.power, 0.8);
    }

    #[test]
    fn other_watts_keep_the_joules_per_millimetre() {
        // 8 W lies nearest to the 10 W row (10/8 < 8/5): 1200 mm/min at 50 % x 10/8.
        let cut = diode(8.0).pair(&profile("paper-160")).expect("allowed").cut;
        assert!(near(cut.feed_mm_per_min, 1200.0) && near(cut.power, 0.625), "{cut:?}");
        // 3 W: the 5 W row wants 0.8 x 5/3 = 133 %; full power at 900 / 1.3333 mm/min instead.
        let cut = diode(3.0).pair(&profile("paper-160")).expect("allowed").cut;
        assert!(near(cut.feed_mm_per_min, 675.0) && cut.power == 1.0, "{cut:?}");
        assert!(near(cut.energy_j_per_mm(3.0), 0.8 * 5.0 * 60.0 / 900.0));
        // 60 W of CO2: 10 % x 40/60 lies below the strike at 10 %; 3600 x 1.5 mm/min instead.
        let mut co2 = machine("k40");
        co2.tool.optical_power_w = Some(60.0);
        let cut = co2.pair(&profile("paper-80")).expect("allowed").cut;
        assert!(near(cut.feed_mm_per_min, 5400.0) && cut.power == 0.10, "{cut:?}");
    }

    #[test]
    fn a_slow_machine_takes_less_power_at_its_own_limit() {
        let mut slow = machine("diode-400");
        slow.controller.max_rate_mm_per_min = [600.0, 900.0, 100.0];
        let pair = slow.pair(&profile("paper-160")).expect("allowed");
        assert!(near(pair.cut.feed_mm_per_min, 600.0) && near(pair.cut.power, 0.25), "{:?}", pair.cut);
        // Engraving at 600 mm/min would need 2.7 %, below the diode's floor: labels are left out, the job is not refused.
        assert!(pair.engrave.is_none());
        assert!(pair.warnings.iter().any(|w| w.code == "no-engraving"), "{:?}", pair.warnings);
    }

    #[test]
    fn beyond_a_factor_of_two_a_calibration_is_asked_for() {
        assert!(diode(20.0).pair(&profile("paper-160")).is_ok());
        assert!(diode(2.5).pair(&profile("paper-160")).is_ok());
        for watts in [2.4, 20.5] {
            let error = diode(watts).pair(&profile("paper-160")).expect_err("too far");
            assert!(matches!(error, Error::NeedsCalibration { .. }) && error.refuses_job(), "{error}");
        }
    }

    #[test]
    fn a_laser_that_cannot_be_gentle_enough_is_refused() {
        let mut strong = machine("k40");
        strong.tool.optical_power_w = Some(80.0);
        strong.controller.max_rate_mm_per_min[1] = 5000.0;
        match strong.pair(&profile("paper-80")).expect_err("too strong") {
            Error::TooStrong { feed_mm_per_min, limit_mm_per_min, .. } => {
                // 3600 mm/min at 10 % of 40 W is the same energy as 7200 at 10 % of 80 W; the y axis runs 5000.
                assert!(near(feed_mm_per_min, 7200.0) && limit_mm_per_min == 5000.0);
            }
            other => panic!("{other}"),
        }
    }

    #[test]
    fn a_row_measured_on_this_machine_wins_and_is_calibrated() {
        let mut paper = profile("paper-160");
        let mut measured = paper.process[0].clone();
        measured.measured_on = Some("diode-400".into());
        measured.feed_mm_per_min = 777.0;
        measured.reference_power_w = Some(9.0);
        paper.process.push(measured);
        let pair = diode(9.0).pair(&paper).expect("allowed");
        assert!(pair.cut.calibrated && pair.warnings.is_empty(), "{:?}", pair.warnings);
        assert_eq!(pair.cut.feed_mm_per_min, 777.0);
        let elsewhere = Machine { name: "other".into(), ..diode(10.0) }.pair(&paper).expect("allowed");
        assert!(!elsewhere.cut.calibrated);
        assert_eq!(elsewhere.warnings[0].code, "uncalibrated");
    }

    #[test]
    fn a_machine_with_a_pen_can_draw_what_it_cuts() {
        let mut roll = machine("roll-610");
        let pair = roll.pair(&profile("paper-160")).expect("allowed");
        assert!(pair.engrave.is_none() && pair.pen.is_some_and(|pen| pen.feed_mm_per_min == 4000.0));
        roll.pen = None;
        assert_eq!(roll.pair(&profile("paper-160")).expect("allowed").pen, None);
    }

    #[test]
    fn clear_film_on_a_diode_is_refused_with_the_reason() {
        let error = machine("diode-400").pair(&profile("polyester-0.1")).expect_err("never");
        assert!(error.refuses_job());
        let text = error.to_string();
        assert!(text.contains("polyester-0.1") && text.contains("450 nm"), "{text}");
        assert!(machine("k40").pair(&profile("paper-80")).expect("allowed").engrave.is_none());
    }

    #[test]
    fn an_untried_tool_is_a_test_and_one_without_values_an_error() {
        let mut knife = machine("diode-400");
        knife.tool.class = ToolClass::Knife;
        let pair = knife.pair(&profile("felt-stiff-1")).expect("test");
        assert_eq!(pair.warnings[0].code, "test-first");
        assert!(pair.warnings[0].message.contains("tears"), "{}", pair.warnings[0].message);
        assert_eq!((pair.cut.power, pair.cut.kerf_mm, pair.cut.pass_power.len()), (0.0, 0.0, 2));
        let mut silent = profile("paper-80");
        silent.allowed.knife = None;
        assert_eq!(knife.pair(&silent).expect("test").warnings[0].code, "test-first");
        silent.process.retain(|row| row.tool != ToolClass::Knife);
        let error = knife.pair(&silent).expect_err("no row").to_string();
        assert!(error.contains("diode laser or CO2 laser"), "{error}");
    }
}
