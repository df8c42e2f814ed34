//! What a program says of itself: `; key: value` before its first word. `sheets` writes it, whoever shows or sends a program reads it here.

use std::io::BufRead;

use crate::config::Machine;
use crate::gcode::{Program, read_lines};
use crate::geom::{Motion, V2};
use crate::progress::Warning;

/// A head longer than this many lines is none: that of ours has a dozen.
const MAX_HEAD_LINES: usize = 200;

/// The head of a program; all `None` for one that is not ours.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Label {
    /// Name of the machine it was made for.
    pub machine: Option<String>,
    /// Name of the material it was made for.
    pub material: Option<String>,
    /// What it is cut from.
    pub sheet: Option<SheetLabel>,
    /// Middles of the two alignment crosses, mm in work coordinates; `None` where there are none.
    pub crosses_mm: Option<[[f64; 2]; 2]>,
    /// How the sheet lies on the machine: from its frame to the work frame; `None` when its lower left corner lies at work zero.
    pub lies: Option<Motion>,
    /// How the grain must lie: "along X"; `None` where the material has none.
    pub grain: Option<String>,
    /// What it is made with where that is not the machine's own tool: "pen".
    pub tool: Option<String>,
    /// Why its values are not to be trusted on its machine; `None` when they were measured there.
    pub uncalibrated: Option<String>,
}

/// One sheet of a job.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetLabel {
    /// Which it is, from 1.
    pub number: usize,
    /// Of how many.
    pub of: usize,
    /// What it is called: "A4".
    pub stock: String,
    /// Along x, mm.
    pub width_mm: f64,
    /// Along y, mm.
    pub height_mm: f64,
}

impl Label {
    /// Reads the head of a file, and no more of it.
    ///
    /// # Errors
    /// Those of `input`.
    pub fn read(input: impl BufRead) -> std::io::Result<Label> {
        let mut label = Label::default();
        for line in read_lines(input).take(MAX_HEAD_LINES) {
            let line = line?;
            match line.trim().strip_prefix(';') {
                Some(comment) => label.take(comment),
                None if line.trim().is_empty() => {}
                None => break,
            }
        }
        Ok(label)
    }

    /// Reads the head of a program held in memory.
    pub(super) fn of(program: &Program) -> Label {
        let mut label = Label::default();
        let head = program.lines.iter().take_while(|line| line.words.is_empty());
        head.filter_map(|line| line.comment.as_deref()).for_each(|comment| label.take(comment));
        label
    }

    /// Takes a comment; of two that say the same the first counts.
    fn take(&mut self, comment: &str) {
        let Some((key, value)) = comment.split_once(':') else { return };
        let place = match key.trim() {
            "machine" => &mut self.machine,
            "material" => &mut self.material,
            "grain" => &mut self.grain,
            "tool" => &mut self.tool,
            "UNCALIBRATED" => &mut self.uncalibrated,
            "crosses" => {
                self.crosses_mm = self.crosses_mm.or_else(|| read_crosses(value.trim()));
                return;
            }
            "sheet lies" => {
                self.lies = self.lies.or_else(|| read_motion(value.trim()));
                return;
            }
            "sheet" => {
                self.sheet = self.sheet.take().or_else(|| SheetLabel::parse(value.trim()));
                return;
            }
            _ => return,
        };
        place.get_or_insert_with(|| value.trim().to_owned());
    }

    /// What to know before it is sent to a machine, of its values and where they come from.
    pub fn doubts(&self, machine: &Machine) -> Vec<Warning> {
        let name = &machine.name;
        let material = self.material.as_deref().unwrap_or("its material");
        let uncalibrated = |why: String| {
            let way_out = "cut a small test piece first, until `calibrate` has measured it";
            Warning::new(
                "uncalibrated",
                format!("UNCALIBRATED: nobody measured {material} on {name} ({why}); {way_out}"),
            )
        };
        match (&self.machine, &self.uncalibrated) {
            (None, _) => vec![Warning::new(
                "unlabelled",
                format!(
                    "the file does not say what it was made for: be sure that its powers and feeds suit {name} and the material"
                ),
            )],
            (Some(made_for), _) if made_for != name => {
                vec![uncalibrated(format!("the values are those for {made_for}"))]
            }
            (Some(_), Some(why)) => {
                // The file goes on with advice that is given here anyway.
                vec![uncalibrated(why.split(';').next().unwrap_or(why).to_owned())]
            }
            (Some(_), None) => Vec::new(),
        }
    }
}

impl SheetLabel {
    /// Reads "1/2 A4 297 x 210 mm".
    fn parse(text: &str) -> Option<SheetLabel> {
        let (place, rest) = text.strip_suffix(" mm")?.split_once(' ')?;
        let (number, of) = place.split_once('/')?;
        let (front, height) = rest.rsplit_once(" x ")?;
        let (stock, width) = front.rsplit_once(' ')?;
        let size = |text: &str| text.parse::<f64>().ok().filter(|v| v.is_finite() && *v > 0.0);
        Some(SheetLabel {
            number: number.parse().ok()?,
            of: of.parse().ok()?,
            stock: stock.to_owned(),
            width_mm: size(width)?,
            height_mm: size(height)?,
        })
    }
}

impl std::fmt::Display for SheetLabel {
    /// "1/2 A4 297 x 210 mm", as it stands in the head of a program.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let SheetLabel { number, of, stock, width_mm, height_mm } = self;
        write!(f, "{number}/{of} {stock} {width_mm:.0} x {height_mm:.0} mm")
    }
}

/// Reads "X10.000 Y5.000 and X287.000 Y205.000 mm".
fn read_crosses(text: &str) -> Option<[[f64; 2]; 2]> {
    let (first, second) = text.strip_suffix(" mm")?.split_once(" and ")?;
    Some([read_place(first)?, read_place(second)?])
}

/// Reads "X10.000 Y5.000".
fn read_place(text: &str) -> Option<[f64; 2]> {
    let (x, y) = text.strip_prefix('X')?.split_once(" Y")?;
    Some([read_number(x)?, read_number(y)?])
}

fn read_number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|v: &f64| v.is_finite())
}

/// How a program says where its sheet lies: "X-297 Y0 turned 90".
pub(super) fn motion_told(motion: &Motion) -> Option<String> {
    let (shift, turn) = (motion.translation.vector, motion.rotation.angle().to_degrees());
    let plain = shift.norm() < 1e-6 && turn.abs() < 1e-6;
    (!plain).then(|| format!("X{:.3} Y{:.3} turned {turn:.0}", shift.x + 0.0, shift.y + 0.0))
}

fn read_motion(text: &str) -> Option<Motion> {
    let (place, turn) = text.split_once(" turned ")?;
    Some(Motion::new(V2::from(read_place(place)?), read_number(turn)?.to_radians()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Library;

    const OURS: &str = "; furbelow 0.1.0\n; sheet: 1/2 A4 297 x 210 mm\n; machine: k40\n; material: paper-160\n; grain: along X\n; UNCALIBRATED: values from practice, uncalibrated; cut a test piece first\nG21G90M4S0\n; machine: later\nM5\n";

    #[test]
    fn a_head_is_read_up_to_the_first_word_from_a_file_as_from_memory() {
        let label = Label::read(OURS.as_bytes()).unwrap();
        assert_eq!(label, Label::of(&crate::gcode::parse(OURS).unwrap()));
        assert_eq!((label.machine.as_deref(), label.grain.as_deref()), (Some("k40"), Some("along X")));
        assert_eq!(label.sheet.unwrap().to_string(), "1/2 A4 297 x 210 mm");
        assert_eq!(Label::read("G0X1\n; machine: k40".as_bytes()).unwrap(), Label::default());
        assert_eq!(Label::read("(by hand)\n".as_bytes()).unwrap(), Label::default());
    }

    #[test]
    fn crosses_are_read_where_there_are_two() {
        let crosses = |text: &str| Label::read(format!("; crosses: {text}\n").as_bytes()).unwrap().crosses_mm;
        assert_eq!(crosses("X10.000 Y5.500 and X287.000 Y-0.125 mm"), Some([[10.0, 5.5], [287.0, -0.125]]));
        for text in ["X1 Y2 mm", "X1 Y2 and X3 mm", "X1 Ynan and X3 Y4 mm", ""] {
            assert_eq!(crosses(text), None, "{text}");
        }
    }

    #[test]
    fn where_a_sheet_lies_is_told_and_read_back() {
        let turned = Motion::new(V2::new(570.0, 0.0), std::f64::consts::FRAC_PI_2);
        let told = motion_told(&turned).unwrap();
        assert_eq!(told, "X570.000 Y0.000 turned 90");
        let read = Label::read(format!("; sheet lies: {told}\n").as_bytes()).unwrap().lies.unwrap();
        let p = crate::geom::P2::new(10.0, 0.0);
        assert!((read * p - turned * p).norm() < 1e-9);
        assert_eq!(motion_told(&Motion::identity()), None);
    }

    #[test]
    fn sheet_lines_are_read_and_others_left_alone() {
        let big = SheetLabel::parse("2/2 my big sheet 500 x 300 mm").unwrap();
        assert_eq!((big.number, big.of, big.stock.as_str(), big.height_mm), (2, 2, "my big sheet", 300.0));
        for text in ["A4", "1/2 A4 297 x nan mm", "1/1 -3 x 4 mm", "x/y A4 1 x 1 mm", ""] {
            assert_eq!(SheetLabel::parse(text), None, "{text}");
        }
    }

    #[test]
    fn values_not_measured_on_this_machine_are_called_so_wherever_they_come_from() {
        let library = Library::built_in();
        let machines = ["k40", "diode-400"].map(|name| library.machine(name).unwrap());
        let label = Label::read(OURS.as_bytes()).unwrap();
        let doubts = |label: &Label, k: usize| label.doubts(&machines[k]).into_iter().next().map(|w| w.message);
        let here = doubts(&label, 0).unwrap();
        assert!(
            here.starts_with("UNCALIBRATED: nobody measured paper-160 on k40 (values from practice, uncalibrated)"),
            "{here}"
        );
        let measured = Label { uncalibrated: None, ..label };
        assert_eq!(doubts(&measured, 0), None);
        assert!(doubts(&measured, 1).unwrap().contains("the values are those for k40"));
        assert!(doubts(&Label::default(), 0).unwrap().contains("does not say what it was made for"));
    }
}
