//! What a machine file may say: ranges of values, and values that must agree.

use super::check::Checker;
use super::machine::{Dialect, Lift, Machine, SecondPen, Servo, Tool, ToolClass};

pub(super) fn check(machine: &Machine, checker: &mut Checker<'_>) {
    checker.schema(machine.schema);
    checker.name("name", &machine.name);
    checker.text("title", &machine.title);
    checker.text("source", &machine.source);
    let needs_board = machine.tool.class != ToolClass::Scissors;
    if !machine.controller.is_none() {
        controller(machine, checker);
    } else if needs_board {
        checker.problem("", "`controller` is missing");
    }
    reach(machine, checker);
    tool(&machine.tool, checker);
    lift(machine, checker);
    let laser_mode = machine.controller.laser_mode || !machine.tool.class.is_laser();
    checker.require(
        laser_mode,
        "controller.laser_mode",
        "a laser needs laser_mode = true ($32=1): without it the beam stays on at rest and every S word stops the motion",
    );
    for (index, keep_out) in machine.keep_outs.iter().enumerate() {
        checker.text(&format!("keep_outs.{index}.name"), &keep_out.name);
        checker.positive(&format!("keep_outs.{index}.width_mm"), keep_out.width_mm);
        checker.positive(&format!("keep_outs.{index}.height_mm"), keep_out.height_mm);
        checker.positive(&format!("keep_outs.{index}.rise_mm"), keep_out.rise_mm);
    }
}

fn controller(machine: &Machine, checker: &mut Checker<'_>) {
    let c = &machine.controller;
    checker.within("controller.baud", f64::from(c.baud), 1200.0, 4_000_000.0);
    checker.positive("controller.junction_deviation_mm", c.junction_deviation_mm);
    checker.positive("controller.arc_tolerance_mm", c.arc_tolerance_mm);
    checker.positive("controller.max_s", c.max_s);
    checker.at_least("controller.min_s", c.min_s, 0.0);
    if c.min_s >= c.max_s {
        checker.problem("controller.min_s", format!("`min_s` is {}, it must lie below max_s = {}", c.min_s, c.max_s));
    }
    checker.all_positive("controller.max_rate_mm_per_min", &c.max_rate_mm_per_min);
    checker.all_positive("controller.acceleration_mm_per_s2", &c.acceleration_mm_per_s2);
    checker.all_positive("controller.max_travel_mm", &c.max_travel_mm);
    checker.at_least("controller.planner_blocks", f64::from(c.planner_blocks), 1.0);
    // GRBL refuses longer lines than 79 characters, so a smaller buffer could not hold one.
    checker.at_least("controller.rx_bytes", f64::from(c.rx_bytes), 80.0);
    checker.at_least("controller.line_ms", c.line_ms, 0.0);
}

fn reach(machine: &Machine, checker: &mut Checker<'_>) {
    match (&machine.work_area, &machine.roll) {
        (Some(area), None) => {
            checker.positive("work_area.width_mm", area.width_mm);
            checker.positive("work_area.height_mm", area.height_mm);
            let travel = match machine.controller.is_none() {
                true => [f64::INFINITY; 3],
                false => machine.controller.max_travel_mm,
            };
            for (path, value, travel) in
                [("work_area.width_mm", area.width_mm, travel[0]), ("work_area.height_mm", area.height_mm, travel[1])]
            {
                let message = format!("the work area is {value} mm here, beyond max_travel_mm = {travel}");
                checker.require(value <= travel, path, &message);
            }
        }
        (None, Some(roll)) => {
            checker.positive("roll.media_width_mm", roll.media_width_mm);
            checker.within("roll.pinch_margin_mm", roll.pinch_margin_mm, 0.0, roll.media_width_mm / 2.0);
            checker.positive("roll.max_length_mm", roll.max_length_mm);
            checker.positive("roll.window_mm", roll.window_mm);
        }
        (Some(_), Some(_)) => checker.problem("roll", "a machine has `work_area` or `roll`, not both"),
        (None, None) => checker.problem("work_area", "neither `work_area` nor `roll`: what does the tool reach?"),
    }
}

fn tool(tool: &Tool, checker: &mut Checker<'_>) {
    checker.positive_if_given("tool.optical_power_w", tool.optical_power_w);
    checker.positive_if_given("tool.spot_mm", tool.spot_mm);
    checker.within("tool.power_floor", tool.power_floor, 0.0, 1.0);
    if tool.class.is_laser() {
        let message = "a laser needs `optical_power_w`: the light that leaves the lens, not the watts on the box";
        checker.require(tool.optical_power_w.is_some(), "tool.optical_power_w", message);
        checker.require(tool.spot_mm.is_some(), "tool.spot_mm", "a laser needs `spot_mm`");
    }
    if let Some(power) = tool.frame_power_max {
        checker.within("tool.frame_power_max", power, 0.0, 0.05);
        let message = "a CO2 beam is invisible and burns even when weak: the border is traced with the beam off";
        checker.require(tool.class != ToolClass::Co2, "tool.frame_power_max", message);
    }
}

fn lift(machine: &Machine, checker: &mut Checker<'_>) {
    let laser = machine.tool.class.is_laser();
    let speaks_grbl = machine.controller.dialect == Dialect::Grbl;
    checker.require(
        !laser || speaks_grbl,
        "controller.dialect",
        "HP-GL knows no power: a laser needs dialect = \"grbl\"",
    );
    match machine.pen {
        Some(_) if matches!(machine.tool.class, ToolClass::Pen | ToolClass::Scissors) => {
            checker.problem("pen", "a second pen beside a laser or a knife; this machine draws with its own tool: leave this out");
        }
        Some(SecondPen { lift: None, .. }) if laser => checker.problem(
            "pen",
            "a pen beside a laser needs `lift` = { down_mm, up_mm, feed_mm_per_min }: how does it come down? (a servo would take the laser's own output)",
        ),
        Some(SecondPen { lift: Some(lift), .. }) => z_lift("pen.lift", lift, checker),
        Some(SecondPen { lift: None, .. }) | None => {}
    }
    checker.at_least("tool.clearance_mm", machine.tool.clearance_mm, 0.0);
    checker.at_least("tool.head_radius_mm", machine.tool.head_radius_mm, 0.0);
    match (machine.tool.servo, machine.tool.lift) {
        (None, None) if laser || !speaks_grbl => {}
        (None, None) => checker.problem(
            "tool",
            "a knife or a pen needs `servo` = { down_s, up_s, dwell_s } or `lift` = { down_mm, up_mm, feed_mm_per_min }: how does it come down?",
        ),
        (Some(_), _) if laser => checker.problem("tool.servo", "a laser is not lifted: leave this out"),
        (_, Some(_)) if laser => checker.problem("tool.lift", "a laser is not lifted: leave this out"),
        (Some(_), Some(_)) => checker.problem("tool.lift", "a tool has `servo` or `lift`, not both"),
        (Some(Servo { down_s, up_s, dwell_s }), None) => {
            checker.within("tool.servo.down_s", down_s, 0.0, machine.controller.max_s);
            checker.within("tool.servo.up_s", up_s, 0.0, machine.controller.max_s);
            checker.at_least("tool.servo.dwell_s", dwell_s, 0.0);
            checker.require(down_s != up_s, "tool.servo.up_s", "up and down are the same");
            let message = "a servo needs laser_mode = false ($32=0): in laser mode its output is off on every travel";
            checker.require(!machine.controller.laser_mode, "controller.laser_mode", message);
        }
        (None, Some(lift)) => z_lift("tool.lift", lift, checker),
    }
}

fn z_lift(path: &str, lift: Lift, checker: &mut Checker<'_>) {
    checker.require(lift.up_mm > lift.down_mm, &format!("{path}.up_mm"), "`up_mm` must lie above down_mm");
    checker.positive(&format!("{path}.feed_mm_per_min"), lift.feed_mm_per_min);
    checker.at_least(&format!("{path}.dwell_s"), lift.dwell_s, 0.0);
}
