//! A machine file out of what a board tells, and where the two differ.

use serde_json::Value;
use toml_edit::DocumentMut;

use crate::config::{Corner, Lift, Machine, ToolClass};
use crate::stream::Board;

/// Keys of a machine file that a board can tell, and the setting that does.
const TOLD: [(&str, &str); 11] = [
    ("junction_deviation_mm", "$11"),
    ("arc_tolerance_mm", "$12"),
    ("max_s", "$30"),
    ("min_s", "$31"),
    ("laser_mode", "$32"),
    ("max_rate_mm_per_min", "$110-$112"),
    ("acceleration_mm_per_s2", "$120-$122"),
    ("max_travel_mm", "$130-$132"),
    ("planner_blocks", "$I"),
    ("rx_bytes", "$I"),
    ("baud", "the speed it answered at"),
];

/// How a pen is lifted where only the board is known: by a z axis, which more plotters have than a servo.
const USUAL_LIFT: Lift = Lift { down_mm: 0.0, up_mm: 3.0, feed_mm_per_min: 800.0, dwell_s: 0.0 };

/// A value that is one thing in a machine file and another on the board.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Difference {
    /// The key in the file: `controller.max_rate_mm_per_min.0`.
    pub key: String,
    /// What the file says; null when it does not.
    pub file: Value,
    /// What the board says; null when it does not.
    pub board: Value,
}

/// The machine a board says it drives. What it cannot tell (the tool, air, what to do before a job) is that of `base`; the beam stays off while borders
/// are traced, because that is the owner's to allow. A board without laser mode is taken for a plotter's, its pen lifted by z. Values a machine cannot
/// have (a feed of 0) are those of `base` too.
pub fn probed(board: &Board, base: &Machine, name: &str) -> Machine {
    let mut machine = base.clone();
    let told = |number: u16| board.settings.get(&number).copied();
    let positive = |number: u16, otherwise: f64| told(number).filter(|v| *v > 0.0).unwrap_or(otherwise);
    let axes = |first: u16, base: [f64; 3]| std::array::from_fn(|k| positive(first + k as u16, base[k]));
    let c = &mut machine.controller;
    c.junction_deviation_mm = positive(11, c.junction_deviation_mm);
    c.arc_tolerance_mm = positive(12, c.arc_tolerance_mm);
    c.max_s = positive(30, c.max_s);
    c.min_s = told(31).filter(|s| (0.0..c.max_s).contains(s)).unwrap_or(0.0);
    c.laser_mode = board.switch(32).unwrap_or(c.laser_mode);
    c.max_rate_mm_per_min = axes(110, c.max_rate_mm_per_min);
    c.acceleration_mm_per_s2 = axes(120, c.acceleration_mm_per_s2);
    c.max_travel_mm = axes(130, c.max_travel_mm);
    c.planner_blocks = u32::try_from(board.blocks).unwrap_or(c.planner_blocks);
    c.rx_bytes = u32::try_from(board.rx_bytes).unwrap_or(c.rx_bytes);
    let [x_mm, y_mm, _] = c.max_travel_mm;
    if let Some(area) = &mut machine.work_area {
        (area.width_mm, area.height_mm) = (x_mm, y_mm);
    }
    if let Some(homes) = board.switch(22) {
        machine.homing = homes.then(|| home_corner(told(23).unwrap_or(0.0) as u32));
    }
    if !machine.controller.laser_mode && machine.tool.class.is_laser() {
        machine.tool.class = ToolClass::Pen;
        machine.tool.lift = Some(USUAL_LIFT);
        (machine.tool.optical_power_w, machine.tool.spot_mm, machine.tool.power_floor) = (None, None, 0.0);
        machine.setup.clear();
    }
    machine.tool.frame_power_max = None;
    machine.inherits = None;
    machine.name = name.to_owned();
    let firmware = board.firmware.title();
    machine.title = format!("{firmware} board, {x_mm} x {y_mm} mm");
    let version = &board.version;
    machine.source = format!(
        "controller: told by the board ({firmware} {version}); tool, air and setup: {}'s, to be checked",
        base.name
    );
    machine
}

/// GRBL homes to the right and the back; each bit of $23 turns one axis round (limits.c, limits_go_home).
fn home_corner(mask: u32) -> Corner {
    match (mask & 1 != 0, mask & 2 != 0) {
        (false, false) => Corner::BackRight,
        (true, false) => Corner::BackLeft,
        (false, true) => Corner::FrontRight,
        (true, true) => Corner::FrontLeft,
    }
}

/// A machine as the text of a file, with a comment on what the board told and on what it cannot. `answers` are kept at its end, word for word.
pub fn machine_file(machine: &Machine, answers: &[String]) -> String {
    let text = toml::to_string(machine).expect("a machine holds what TOML has: texts, numbers, tables and lists");
    let mut document: DocumentMut = text.parse().expect("written by the line above");
    if let Some(setup) = document.get_mut("setup").and_then(toml_edit::Item::as_array_mut) {
        // A step a line, as in the files that come with the program.
        setup.iter_mut().for_each(|step| step.decor_mut().set_prefix("\n  "));
        setup.set_trailing("\n");
        setup.set_trailing_comma(true);
    }
    let mut note = |table: &str, key: &str, note: &str| {
        let value = document.get_mut(table).and_then(|t| t.get_mut(key)).and_then(toml_edit::Item::as_value_mut);
        if let Some(value) = value {
            value.decor_mut().set_suffix(format!("   # {note}"));
        }
    };
    TOLD.iter().for_each(|(key, setting)| note("controller", key, setting));
    note("controller", "line_ms", "not told: about 270 lines/s on an AVR, more on other boards");
    note(
        "tool",
        "class",
        if machine.tool.class.is_laser() { "not told: check" } else { "not told: laser mode ($32) is off" },
    );
    note("tool", "optical_power_w", "not told: the light that leaves the lens, not the watts on the box");
    note("tool", "spot_mm", "not told: check");
    note("tool", "power_floor", "not told: check");
    let mut file = document.to_string();
    file += "\n# The beam stays off while borders are traced; for a diode, frame_power_max = 0.01 under [tool] allows 1 % while it moves.\n";
    if !answers.is_empty() {
        file += "#\n# What the board answered ($I, $$, $#, $G):\n";
        let plain = |line: &String| line.chars().filter(|c| !c.is_control()).collect::<String>();
        answers.iter().for_each(|line| file += &format!("#   {}\n", plain(line)));
    }
    file
}

/// Where a machine file and a board differ, in what a board can tell.
pub fn differences(file: &Machine, board: &Machine) -> Vec<Difference> {
    let mut found = Vec::new();
    let tell = |m: &Machine| {
        let c = serde_json::to_value(&m.controller);
        let rest = [serde_json::to_value(m.homing), serde_json::to_value(m.work_area)];
        let [homing, area] = rest.map(Result::unwrap_or_default);
        serde_json::json!({ "controller": c.unwrap_or_default(), "homing": homing, "work_area": area })
    };
    compare(String::new(), &tell(file), &tell(board), &mut found);
    found
}

fn compare(key: String, file: &Value, board: &Value, found: &mut Vec<Difference>) {
    let under = |name: &str| if key.is_empty() { name.to_owned() } else { format!("{key}.{name}") };
    match (file, board) {
        (Value::Object(a), Value::Object(b)) => {
            for (name, value) in a {
                compare(under(name), value, b.get(name).unwrap_or(&Value::Null), found);
            }
        }
        (Value::Array(a), Value::Array(b)) => {
            for (index, (a, b)) in a.iter().zip(b).enumerate() {
                compare(under(&index.to_string()), a, b, found);
            }
        }
        (a, b) if a == b => {}
        (a, b) => found.push(Difference { key, file: a.clone(), board: b.clone() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Library;

    fn board(settings: &[(u16, f64)]) -> Board {
        Board { settings: settings.iter().copied().collect(), version: "1.1h".into(), ..Board::default() }
    }

    fn base() -> Machine {
        Library::built_in().machine("diode-400").unwrap()
    }

    #[test]
    fn a_probed_machine_survives_being_written_and_read() {
        let told = board(&[
            (22, 1.0),
            (23, 1.0),
            (30, 255.0),
            (31, 3.0),
            (32, 1.0),
            (110, 6000.0),
            (120, 2200.0),
            (130, 300.0),
            (131, 0.0),
        ]);
        let machine = probed(&told, &base(), "mine");
        let answers = ["[VER:1.1h:\u{1}]".to_owned(), "$130=300.000".to_owned()];
        let text = machine_file(&machine, &answers);
        assert_eq!(Library::built_in().machine_in("mine.toml", text.clone()).unwrap(), machine, "{text}");
        assert!(text.contains("max_s = 255.0   # $30") && text.contains("#   $130=300.000\n"), "{text}");
        assert_eq!(machine.homing, Some(Corner::BackLeft));
        let area = machine.work_area.unwrap();
        assert_eq!((area.width_mm, area.height_mm), (300.0, 400.0), "a travel of 0 is no travel");
        assert_eq!(machine.controller.max_rate_mm_per_min, [6000.0, 10000.0, 3000.0]);
        assert_eq!(machine.tool.frame_power_max, None);
    }

    #[test]
    fn a_board_without_laser_mode_is_no_lasers() {
        let machine = probed(&board(&[(32, 0.0)]), &base(), "plotter");
        assert_eq!(machine.tool.class, ToolClass::Pen);
        let text = machine_file(&machine, &[]);
        assert_eq!(Library::built_in().machine_in("plotter.toml", text).unwrap(), machine);
    }

    #[test]
    fn only_what_differs_is_told_and_by_its_key() {
        let same: Vec<_> = crate::job::expected(&base()).settings;
        assert_eq!(differences(&base(), &probed(&board(&same), &base(), "mine")), []);
        let other = probed(&board(&[(111, 4000.0), (22, 1.0)]), &base(), "mine");
        let keys: Vec<_> = differences(&base(), &other).into_iter().map(|d| d.key).collect();
        assert_eq!(keys, ["controller.max_rate_mm_per_min.1", "homing"]);
    }
}
