//! `furbelow machine list | show | check | schema | probe`

use serde_json::json;

use super::files;
use super::output::{checklist, fact, json, line, number, own_folder, percent, read_argument, table};
use super::{Failure, machine_probe};
use crate::config::{self, Kind, Library, Machine};

/// What to do with machines.
#[derive(Debug, clap::Subcommand)]
pub enum Command {
    #[command(flatten)]
    Files(files::Command),
    /// Ask a board what it is, and make a machine file of it
    Probe(machine_probe::Args),
}

pub(super) fn run(command: Command) -> Result<(), Failure> {
    let library = Library::open();
    match command {
        Command::Files(files::Command::List { json }) => list(&library, json),
        Command::Files(files::Command::Show { name, json }) => show(&library.machine(&name)?, json),
        Command::Files(files::Command::Check { file }) => check(&library, &file),
        Command::Files(files::Command::Schema) => json(&config::schema(Kind::Machine)),
        Command::Probe(args) => machine_probe::run(&args, &library),
    }
}

fn list(library: &Library, as_json: bool) -> Result<(), Failure> {
    let mut rows = vec![["NAME", "WHAT", "AREA MM", "TOOL", "W", "FROM"].map(str::to_owned).to_vec()];
    let mut objects = Vec::new();
    for listed in library.names(Kind::Machine)? {
        let from = listed.place.to_string();
        match library.machine(&listed.name) {
            Ok(machine) => {
                rows.push(vec![
                    listed.name,
                    machine.title.clone(),
                    area(&machine),
                    machine.tool.class.title().into(),
                    machine.tool.optical_power_w.map(number).unwrap_or_default(),
                    from.clone(),
                ]);
                let reach = machine.reach_mm();
                objects.push(json!({
                    "name": machine.name, "title": machine.title, "from": from, "tool": machine.tool.class.word(),
                    "optical_power_w": machine.tool.optical_power_w, "width_mm": reach[0], "height_mm": reach[1],
                    "problem": null,
                }));
            }
            // One bad file of the user's must not hide the others.
            Err(error) => {
                let hint = format!("not in order: furbelow machine check {}", listed.name);
                rows.push(vec![listed.name.clone(), hint, String::new(), String::new(), String::new(), from.clone()]);
                objects.push(json!({ "name": listed.name, "from": from, "problem": error.to_string() }));
            }
        }
    }
    if as_json {
        return json(&json!({ "machines": objects }));
    }
    line(&table(&rows))?;
    own_folder(library, Kind::Machine)
}

fn area(machine: &Machine) -> String {
    let [width, height] = machine.reach_mm().map(number);
    if machine.roll.is_some() { format!("roll {width} x {height}") } else { format!("{width} x {height}") }
}

fn show(machine: &Machine, as_json: bool) -> Result<(), Failure> {
    if as_json {
        return json(machine);
    }
    line(&format!("{}: {}\nsource: {}\n", machine.name, machine.title, machine.source))?;
    let mut facts = tool_facts(machine);
    if machine.controller.is_none() {
        facts.push(fact("controller", "none: nothing can be sent to it"));
    } else {
        facts.extend(controller_facts(machine));
    }
    line(&table(&facts))?;
    for keep_out in &machine.keep_outs {
        let [x, y, width, height, rise] =
            [keep_out.x_mm, keep_out.y_mm, keep_out.width_mm, keep_out.height_mm, keep_out.rise_mm].map(number);
        line(&format!("keep out: {} at {x}, {y}: {width} x {height} mm, {rise} mm high", keep_out.name))?;
    }
    checklist(&machine.setup)
}

fn tool_facts(machine: &Machine) -> Vec<Vec<String>> {
    let tool = &machine.tool;
    let mut facts = vec![
        fact("tool", tool.class.title()),
        fact("area", format!("{} mm", area(machine))),
        fact("X0 Y0", machine.origin.title()),
        fact("homing", machine.homing.map_or("no switches", |corner| corner.title())),
    ];
    if let Some(watts) = tool.optical_power_w {
        facts.push(fact("optical power", format!("{} W", number(watts))));
    }
    if let Some(spot) = tool.spot_mm {
        facts.push(fact("spot", format!("{} mm", number(spot))));
    }
    if tool.class.is_laser() {
        facts.push(fact("least power", percent(tool.power_floor)));
        let frame = tool.frame_power_max.map_or("beam off".to_owned(), |p| format!("at most {}", percent(p)));
        facts.push(fact("tracing the border", frame));
    }
    let air = machine.air.map_or("by hand".to_owned(), |air| format!("low {:?}, high {:?}", air.low, air.high));
    facts.push(fact("air", air));
    facts
}

fn controller_facts(machine: &Machine) -> Vec<Vec<String>> {
    let c = &machine.controller;
    let axes = |values: [f64; 3]| values.map(number).join(" / ");
    vec![
        fact("controller", format!("{} at {} baud", c.dialect.title(), c.baud)),
        fact("S words ($30, $31)", format!("{} to {}", number(c.min_s), number(c.max_s))),
        fact("laser mode ($32)", if c.laser_mode { "on" } else { "off" }),
        fact("fastest feed ($110-$112)", format!("{} mm/min", axes(c.max_rate_mm_per_min))),
        fact("acceleration ($120-$122)", format!("{} mm/s2", axes(c.acceleration_mm_per_s2))),
        fact("travel ($130-$132)", format!("{} mm", axes(c.max_travel_mm))),
        fact("junction deviation ($11)", format!("{} mm", number(c.junction_deviation_mm))),
        fact("arc tolerance ($12)", format!("{} mm", number(c.arc_tolerance_mm))),
        fact(
            "look-ahead",
            format!("{} moves, {} bytes, {} ms a line", c.planner_blocks, c.rx_bytes, number(c.line_ms)),
        ),
    ]
}

fn check(library: &Library, file: &str) -> Result<(), Failure> {
    let machine = match read_argument(file)? {
        Some((name, text)) => library.machine_in(name, text)?,
        None => library.machine(file)?,
    };
    line(&format!("OK: machine {}", machine.name))
}
