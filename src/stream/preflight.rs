//! What stands between a program and the board in front of it, before the first line is sent.

use super::board::Board;
use crate::gcode::{Beam, Move};
use crate::geom::{Rect, tolerance};

/// Settings decide nothing finer than this share of their value: boards print three decimals.
const SETTING_SHARE: f64 = 1e-3;

/// `$10`: reports tell how full the buffers are.
const REPORT_BUFFERS: u16 = 2;

/// What the machine file says of the board.
#[derive(Debug, Clone, PartialEq)]
pub struct Expected {
    /// The machine's name, as job files carry it.
    pub machine: String,
    /// The tool burns.
    pub laser: bool,
    /// Board settings by number (`$30`, `$32`, `$110` ...), in the board's units.
    pub settings: Vec<(u16, f64)>,
}

/// What a program asks of the machine, added up move by move.
#[derive(Debug, Clone, PartialEq)]
pub struct Demand {
    /// Box around all moves, mm in work coordinates; empty when nothing moves.
    pub bounds: Rect,
    /// Line of the first cut with a constant beam (M3), from 1.
    pub constant_beam: Option<usize>,
    /// The greatest S word in effect with the beam on.
    pub max_s: f64,
    /// Something moves.
    pub moves: bool,
}

/// What to do about a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weight {
    /// The job must not be sent.
    Refusal,
    /// The user should know.
    Warning,
}

/// One objection.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What to do about it.
    pub weight: Weight,
    /// Stable word for scripts.
    pub code: &'static str,
    /// What is wrong, the limit, and the way out.
    pub message: String,
    /// The line that would set the board right.
    pub fix: Option<String>,
}

impl Default for Demand {
    /// Nothing is asked for.
    fn default() -> Demand {
        Demand { bounds: Rect::EMPTY, constant_beam: None, max_s: 0.0, moves: false }
    }
}

impl Demand {
    /// What these moves ask for.
    pub fn of<'a>(moves: impl IntoIterator<Item = &'a Move>) -> Demand {
        let mut demand = Demand::default();
        moves.into_iter().for_each(|m| demand.add(m));
        demand
    }

    /// Takes the next move. The first travel starts where the tool happens to stand, so only its end counts.
    pub fn add(&mut self, m: &Move) {
        if m.goes() {
            self.bounds = self.bounds.with(m.to.xy());
            if std::mem::replace(&mut self.moves, true) {
                self.bounds = self.bounds.union(m.bounds());
            }
        }
        if m.beam != Beam::Off {
            self.max_s = self.max_s.max(m.power_s);
        }
        if m.burns() && m.beam == Beam::Constant {
            self.constant_beam.get_or_insert(m.line);
        }
    }
}

/// Objections to sending a program to this board, refusals first. `made_for` is the machine the file names, when it names one.
pub fn preflight(demand: &Demand, made_for: Option<&str>, board: &Board, expected: &Expected) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut add =
        |weight, code, message: String, fix: Option<String>| findings.push(Finding { weight, code, message, fix });
    if let Some(name) = made_for.filter(|name| *name != expected.machine) {
        let message =
            format!("the job was made for {name}, not for {}: make it again, or send it anyway", expected.machine);
        add(Weight::Refusal, "other-machine", message, None);
    }
    if board.settings.is_empty() {
        let message =
            "the board does not tell its settings ($$): power scale, laser mode and travel are not checked".to_owned();
        add(Weight::Warning, "settings-unknown", message, None);
    }
    compare_settings(board, expected, &mut add);
    if board.inches() {
        let message = "the board reports in inches ($13=1); they are converted, other programs may not".to_owned();
        add(Weight::Warning, "reports-inches", message, Some("$13=0".to_owned()));
    }
    if let Some(mask) = board.settings.get(&10).map(|v| *v as u16)
        && mask & REPORT_BUFFERS == 0
    {
        let message = format!("the board does not report its buffers ($10={mask}): lost lines are noticed later");
        add(Weight::Warning, "buffers-hidden", message, Some(format!("$10={}", mask | REPORT_BUFFERS)));
    }
    if let Some(line) = demand.constant_beam.filter(|_| expected.laser) {
        let message = format!(
            "line {line} cuts with a constant beam (M3): if cable or computer fail, the laser stays ON where it stands; stay beside it, or use M4"
        );
        add(Weight::Warning, "constant-beam", message, None);
    }
    if let Some(full) = board.settings.get(&30).filter(|full| demand.max_s > **full) {
        let message = format!(
            "the job asks for S{} and full power is S{full} ($30): it would cut too strongly elsewhere; make it for this board",
            demand.max_s
        );
        add(Weight::Refusal, "power-above-max", message, None);
    }
    check_place(demand, board, expected, &mut add);
    findings.sort_by_key(|finding| finding.weight == Weight::Warning);
    findings
}

type Add<'a> = dyn FnMut(Weight, &'static str, String, Option<String>) + 'a;

fn compare_settings(board: &Board, expected: &Expected, add: &mut Add<'_>) {
    let mut differing = Vec::new();
    for (number, wanted) in &expected.settings {
        let Some(found) = board.settings.get(number) else { continue };
        if (found - wanted).abs() <= SETTING_SHARE * wanted.abs().max(SETTING_SHARE) {
            continue;
        }
        let fix = Some(format!("${number}={wanted}"));
        match number {
            30 => add(
                Weight::Refusal,
                "power-scale",
                format!(
                    "full power is S{found} on the board ($30) and S{wanted} in {}: all powers would be wrong",
                    expected.machine
                ),
                fix,
            ),
            32 if expected.laser => add(
                Weight::Refusal,
                "laser-mode",
                format!(
                    "laser mode is $32={found} on the board and must be $32={wanted}: without it the beam stays on at rest"
                ),
                fix,
            ),
            _ => differing.push(format!("${number}={found} (here {wanted})")),
        }
    }
    if !differing.is_empty() {
        let message =
            format!("the board differs from {}: {}; planned times may be off", expected.machine, differing.join(", "));
        add(Weight::Warning, "settings-differ", message, None);
    }
}

fn check_place(demand: &Demand, board: &Board, expected: &Expected, add: &mut Add<'_>) {
    if demand.bounds.is_empty() {
        return;
    }
    let (min, max) = (demand.bounds.min, demand.bounds.max);
    let homes = board.switch(22) == Some(true);
    let limited = board.homed || board.switch(20) == Some(true);
    for (axis, name) in ["X", "Y"].into_iter().enumerate() {
        let number = 130 + axis as u16;
        let in_file = expected.settings.iter().find(|(n, _)| *n == number).map(|(_, v)| *v);
        let Some(travel_mm) = board.settings.get(&number).copied().or(in_file) else { continue };
        if max[axis] - min[axis] > travel_mm + tolerance::LIMIT_SLACK_MM {
            let message = format!(
                "the job is {:.1} mm along {name} and the machine travels {travel_mm} mm (${number})",
                max[axis] - min[axis]
            );
            add(Weight::Refusal, "beyond-travel", message, None);
        } else if let Some(offset) = board.offset_mm.filter(|_| limited) {
            let (low, high) = (min[axis] + offset[axis], max[axis] + offset[axis]);
            let reach_mm = board.reach_mm(axis, travel_mm);
            let over_mm = (reach_mm.0 - low).max(high - reach_mm.1);
            if over_mm > tolerance::LIMIT_SLACK_MM {
                let message = format!(
                    "with work zero at machine {name}{:.3} the job leaves the travel by {over_mm:.1} mm along {name}: move the work zero",
                    offset[axis]
                );
                add(Weight::Refusal, "beyond-travel", message, None);
            }
        }
    }
    if homes && !board.homed {
        let message =
            "the machine has not been homed since it was connected: home it, or be sure that nobody moved the head"
                .to_owned();
        add(Weight::Warning, "not-homed", message, Some("$H".to_owned()));
    } else if !homes {
        let message = "the machine has no switches: work zero is right only if the head was zeroed at the sheet's corner since it was switched on".to_owned();
        add(Weight::Warning, "zeroed-by-hand", message, None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::{parse, trace};

    fn demand(text: &str) -> Demand {
        Demand::of(&trace(&parse(text).unwrap()).unwrap())
    }

    fn good() -> (Board, Expected) {
        let settings = vec![(30, 1000.0), (32, 1.0), (130, 400.0), (131, 400.0), (110, 10000.0)];
        let mut board = Board { homed: true, offset_mm: Some([-400.0, -400.0, 0.0]), ..Board::default() };
        board.settings = settings.iter().copied().chain([(10, 3.0), (13, 0.0), (20, 1.0), (22, 1.0)]).collect();
        (board, Expected { machine: "diode-400".into(), laser: true, settings })
    }

    fn codes(demand: &Demand, made_for: Option<&str>, (board, expected): &(Board, Expected)) -> Vec<&'static str> {
        preflight(demand, made_for, board, expected).into_iter().map(|f| f.code).collect()
    }

    const JOB: &str = "G21G90M4S0\nG0X10Y10\nG1X390S500F1000\nM5\nG0X0Y0\n";

    #[test]
    fn a_board_in_order_meets_no_objection() {
        assert!(codes(&demand(JOB), Some("diode-400"), &good()).is_empty());
    }

    #[test]
    fn each_wrong_setting_is_named_with_its_fix() {
        for (number, value, code, fix) in [
            (30, 255.0, "power-scale", "$30=1000"),
            (32, 0.0, "laser-mode", "$32=1"),
            (13, 1.0, "reports-inches", "$13=0"),
            (10, 1.0, "buffers-hidden", "$10=3"),
        ] {
            let (mut board, expected) = good();
            board.settings.insert(number, value);
            let found = preflight(&demand(JOB), None, &board, &expected);
            let finding = found.iter().find(|f| f.code == code).unwrap();
            assert_eq!(finding.fix.as_deref(), Some(fix));
            assert_eq!(finding.weight == Weight::Refusal, matches!(number, 30 | 32));
        }
        let mut setup = good();
        setup.0.settings.insert(110, 5000.0);
        assert_eq!(codes(&demand(JOB), None, &setup), ["settings-differ"]);
    }

    #[test]
    fn a_job_for_another_machine_is_refused() {
        assert_eq!(codes(&demand(JOB), Some("k40"), &good()), ["other-machine"]);
    }

    #[test]
    fn the_work_zero_decides_whether_the_job_fits() {
        let mut setup = good();
        setup.0.offset_mm = Some([-380.0, -400.0, 0.0]);
        let findings = preflight(&demand(JOB), None, &setup.0, &setup.1);
        assert!(findings[0].code == "beyond-travel" && findings[0].message.contains("10.0 mm along X"), "{findings:?}");
        // Without homing or soft limits the board's machine coordinates mean nothing, but the size still counts.
        (setup.0.homed, setup.0.offset_mm) = (false, Some([0.0; 3]));
        setup.0.settings.extend([(20, 0.0), (22, 0.0)]);
        assert_eq!(codes(&demand(JOB), None, &setup), ["zeroed-by-hand"]);
        assert_eq!(codes(&demand("G21G90G0X0Y0\nG0X401\n"), None, &setup), ["beyond-travel", "zeroed-by-hand"]);
    }

    #[test]
    fn a_machine_that_counts_up_from_its_switches_has_its_travel_above_them() {
        let mut setup = good();
        setup.0.settings.extend([(22, 43.0), (23, 3.0)]);
        setup.0.offset_mm = Some([0.0; 3]);
        assert!(codes(&demand(JOB), None, &setup).is_empty());
        setup.0.offset_mm = Some([-20.0, 0.0, 0.0]);
        let findings = preflight(&demand(JOB), None, &setup.0, &setup.1);
        assert!(findings[0].message.contains("leaves the travel by 20.0 mm along X"), "{findings:?}");
    }

    #[test]
    fn a_constant_beam_and_a_machine_not_homed_are_named() {
        let mut setup = good();
        setup.0.homed = false;
        assert_eq!(codes(&demand(&JOB.replace("M4", "M3")), None, &setup), ["constant-beam", "not-homed"]);
    }
}
