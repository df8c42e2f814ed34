//! Status reports: `<Idle|MPos:0.000,0.000,0.000|Bf:15,128|FS:0,0|WCO:0.000,0.000,0.000>`.

/// Millimetres in an inch.
const INCH_MM: f64 = 25.4;

/// What the machine is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// At rest, ready for lines.
    Idle,
    /// Carries out a program.
    Run,
    /// Held: 0 at rest, 1 still braking.
    Hold(u8),
    /// Jogs.
    Jog,
    /// Locked until unlocked or homed.
    Alarm,
    /// Door open: 0 closed again and ready to resume, 1 at rest, 2 braking, 3 resuming.
    Door(u8),
    /// Reads lines without moving.
    Check,
    /// Seeks its switches.
    Home,
    /// Asleep: swallows lines until a reset.
    Sleep,
    /// A word of another firmware, such as grblHAL's `Tool`.
    Other,
}

/// One report. Fields a report leaves out are `None`: boards send some of them only now and then.
#[derive(Debug, Clone, PartialEq)]
pub struct Status {
    /// What the machine is doing.
    pub state: State,
    /// Position in machine coordinates, mm.
    pub machine_mm: Option<[f64; 3]>,
    /// Position in work coordinates, mm.
    pub work_mm: Option<[f64; 3]>,
    /// Free planner blocks and free bytes of the receive buffer.
    pub free: Option<(usize, usize)>,
    /// True feed, mm/min.
    pub feed_mm_per_min: f64,
    /// S word in effect; 0 where the board does not tell.
    pub power_s: f64,
    /// Switches that are closed: "XY", "P", "D". Empty when none is.
    pub pins: String,
    /// Where work zero lies in machine coordinates, mm.
    pub offset_mm: Option<[f64; 3]>,
    /// Feed, rapid and spindle override, %.
    pub overrides: Option<[u16; 3]>,
}

impl State {
    /// True where nothing moves and no line is being carried out.
    pub fn at_rest(self) -> bool {
        matches!(self, State::Idle | State::Hold(0) | State::Alarm | State::Door(0 | 1) | State::Check | State::Sleep)
    }

    /// The word people and scripts read.
    pub fn word(self) -> &'static str {
        match self {
            State::Idle => "idle",
            State::Run => "run",
            State::Hold(_) => "hold",
            State::Jog => "jog",
            State::Alarm => "alarm",
            State::Door(_) => "door",
            State::Check => "check",
            State::Home => "home",
            State::Sleep => "sleep",
            State::Other => "other",
        }
    }

    fn parse(text: &str) -> Option<State> {
        let (word, digit) = match text.split_once(':') {
            Some((word, digit)) => (word, digit.parse::<u8>().ok()?),
            None => (text, 0),
        };
        if word.is_empty() || !word.bytes().all(|b| b.is_ascii_alphabetic()) {
            return None;
        }
        Some(match word {
            "Idle" => State::Idle,
            "Run" => State::Run,
            "Hold" => State::Hold(digit),
            "Jog" => State::Jog,
            "Alarm" => State::Alarm,
            "Door" => State::Door(digit),
            "Check" => State::Check,
            "Home" => State::Home,
            "Sleep" => State::Sleep,
            _ => State::Other,
        })
    }
}

impl Status {
    /// Reads a report, with its angle brackets; `inches` when the board reports in inches ($13 = 1). `None` for anything that is no whole
    /// report: a torn or garbled one tells nothing.
    pub fn parse(text: &str, inches: bool) -> Option<Status> {
        let unit_mm = if inches { INCH_MM } else { 1.0 };
        let mut fields = text.strip_prefix('<')?.strip_suffix('>')?.split('|');
        let mut status = Status {
            state: State::parse(fields.next()?)?,
            machine_mm: None,
            work_mm: None,
            free: None,
            feed_mm_per_min: 0.0,
            power_s: 0.0,
            pins: String::new(),
            offset_mm: None,
            overrides: None,
        };
        for field in fields {
            let (key, value) = field.split_once(':')?;
            match key {
                "MPos" => status.machine_mm = Some(axes(value, unit_mm)?),
                "WPos" => status.work_mm = Some(axes(value, unit_mm)?),
                "WCO" => status.offset_mm = Some(axes(value, unit_mm)?),
                "Bf" => {
                    let (blocks, bytes) = value.split_once(',')?;
                    status.free = Some((blocks.parse().ok()?, bytes.parse().ok()?));
                }
                "F" => status.feed_mm_per_min = number(value)? * unit_mm,
                "FS" => {
                    let mut parts = value.split(',');
                    status.feed_mm_per_min = number(parts.next()?)? * unit_mm;
                    status.power_s = number(parts.next()?)?;
                }
                "Ov" => {
                    let parts: Vec<u16> = value.split(',').map(|v| v.parse().ok()).collect::<Option<_>>()?;
                    status.overrides = Some(parts.try_into().ok()?);
                }
                "Pn" => status.pins = value.to_owned(),
                // Line numbers, accessories, and what other firmware adds.
                _ => {}
            }
        }
        Some(status)
    }
}

fn number(text: &str) -> Option<f64> {
    text.parse::<f64>().ok().filter(|v| v.is_finite())
}

/// The first three axes; machines with fewer leave the rest at 0.
fn axes(text: &str, unit_mm: f64) -> Option<[f64; 3]> {
    let mut axes = [0.0; 3];
    for (axis, value) in text.split(',').enumerate() {
        let value = number(value)? * unit_mm;
        if let Some(slot) = axes.get_mut(axis) {
            *slot = value;
        }
    }
    Some(axes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_of_grbl_is_read_field_by_field() {
        let text = "<Hold:1|MPos:29.725,-2.025,0.000|Bf:14,120|FS:2000,500|Pn:XP|WCO:-401.702,-415.034,-2.000>";
        let status = Status::parse(text, false).unwrap();
        assert_eq!(status.state, State::Hold(1));
        assert_eq!(status.machine_mm, Some([29.725, -2.025, 0.0]));
        assert_eq!((status.free, status.feed_mm_per_min, status.power_s), (Some((14, 120)), 2000.0, 500.0));
        assert_eq!((status.pins.as_str(), status.overrides), ("XP", None));
        assert_eq!(status.offset_mm, Some([-401.702, -415.034, -2.0]));
        assert_eq!(
            Status::parse("<Idle|MPos:0,0,0|FS:0,0|Ov:110,100,90>", false).unwrap().overrides,
            Some([110, 100, 90])
        );
    }

    #[test]
    fn inches_become_millimetres_but_power_does_not() {
        let status = Status::parse("<Run|WPos:1.0,2.0,0.0|FS:10.0,500>", true).unwrap();
        assert_eq!(status.work_mm, Some([25.4, 50.8, 0.0]));
        assert_eq!((status.feed_mm_per_min, status.power_s), (254.0, 500.0));
    }

    #[test]
    fn torn_and_garbled_reports_tell_nothing() {
        for text in [
            "<Idle|MPos:0.000,0.0",
            "Idle|MPos:0,0,0>",
            "<Id\u{fffd}e|MPos:0,0,0>",
            "<Idle|MPos:0.0.0,1,2>",
            "<Run|Bf:15>",
            "<>",
        ] {
            assert_eq!(Status::parse(text, false), None, "{text}");
        }
    }

    #[test]
    fn what_another_firmware_adds_is_passed_over() {
        let status = Status::parse("<Tool|MPos:1,2,3,4|SD:12.5,job.nc|H:1>", false).unwrap();
        assert_eq!((status.state, status.machine_mm), (State::Other, Some([1.0, 2.0, 3.0])));
    }
}
