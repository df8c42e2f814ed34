//! What a profile may say: ranges of values, joints that hold, verdicts with a reason, and a process for every tool that is allowed.

use super::check::Checker;
use super::joint::Joint;
use super::machine::ToolClass;
use super::profile::{Grain, ProcessKind, ProcessRow, Profile, Stock, Verdict};

/// A blade cannot turn a smaller radius (materials practice: details below are torn, not cut).
const LEAST_KNIFE_RADIUS_MM: f64 = 1.0;

/// Sheets up to this thick, mm, are cut in one pass by a laser (materials practice).
const ONE_PASS_MM: f64 = 0.3;

pub(super) fn check(profile: &Profile, checker: &mut Checker<'_>) {
    checker.schema(profile.schema);
    checker.name("name", &profile.name);
    checker.text("title", &profile.title);
    checker.text("source", &profile.source);
    sheet(profile, checker);
    checker.require(!profile.stock.is_empty(), "stock", "no stock: add a [[stock]] with a name and size_mm");
    for (index, stock) in profile.stock.iter().enumerate() {
        check_stock(profile, stock, index, checker);
    }
    joint(&profile.joint.laser, "joint.laser", checker);
    joint(&profile.joint.knife, "joint.knife", checker);
    knife_joint(&profile.joint.knife, checker);
    checker.positive("joint.holes.diameter_mm", profile.joint.holes.diameter_mm);
    let hole = profile.joint.holes;
    let message = "a hole this close to the edge breaks out of it: more than its radius";
    checker.require(hole.edge_mm > 0.5 * hole.diameter_mm, "joint.holes.edge_mm", message);
    checker.positive("splice.lap_mm", profile.splice.lap_mm);
    checker.positive("splice.connection_mm", profile.splice.connection_mm);
    checker.positive("splice.rows_mm", profile.splice.rows_mm);
    let message = "the rows lie outside the lap: less than `lap_mm`";
    checker.require(profile.splice.rows_mm < profile.splice.lap_mm, "splice.rows_mm", message);
    checker.positive_if_given("splice.thread_hole_mm", profile.splice.thread_hole_mm);
    checker.text("splice.source", &profile.splice.source);
    for (index, row) in profile.process.iter().enumerate() {
        process(row, &format!("process.{index}"), checker);
        let again = row.tool.is_laser() && row.operation == ProcessKind::Cut && row.passes > 1;
        checker.require(
            profile.thickness_mm > ONE_PASS_MM || !again,
            &format!("process.{index}.passes"),
            "a sheet this thin is cut in one pass: what hangs loose catches fire in a second; lower the feed instead",
        );
        if profile.process[..index].iter().any(|other| same_case(other, row)) {
            checker.problem(
                &format!("process.{index}"),
                format!("a second row for {} {} at the same power and machine", row.tool.word(), row.operation.word()),
            );
        }
    }
    allowed(profile, checker);
}

fn sheet(profile: &Profile, checker: &mut Checker<'_>) {
    checker.positive("thickness_mm", profile.thickness_mm);
    checker.positive("grammage_g_per_m2", profile.grammage_g_per_m2);
    checker.positive("flexural_rigidity_md_n_mm", profile.flexural_rigidity_md_n_mm);
    checker.positive("flexural_rigidity_cd_n_mm", profile.flexural_rigidity_cd_n_mm);
    checker.positive("membrane_stiffness_n_per_mm", profile.membrane_stiffness_n_per_mm);
    checker.text("membrane_stiffness_source", &profile.membrane_stiffness_source);
    checker.positive("min_bend_radius_mm", profile.min_bend_radius_mm);
    checker.positive("min_void_mm", profile.min_void_mm);
    checker.positive("min_label_height_mm", profile.min_label_height_mm);
    checker.at_least("spacing_mm", profile.spacing_mm, 0.0);
    let message = "shared edges need spacing_mm = 0: pieces further apart share none";
    checker.require(!profile.common_edges || profile.spacing_mm == 0.0, "common_edges", message);
    checker.at_least("margin_mm", profile.margin_mm, 0.0);
    let same = profile.flexural_rigidity_md_n_mm == profile.flexural_rigidity_cd_n_mm;
    checker.require(
        profile.grain == Grain::Directional || same,
        "flexural_rigidity_cd_n_mm",
        "the two flexural rigidities differ, so the sheet has a grain: say grain = \"directional\"",
    );
}

fn check_stock(profile: &Profile, stock: &Stock, index: usize, checker: &mut Checker<'_>) {
    let path = format!("stock.{index}");
    checker.text(&format!("{path}.name"), &stock.name);
    if profile.stock[..index].iter().any(|other| other.name.eq_ignore_ascii_case(&stock.name)) {
        checker.problem(&format!("{path}.name"), format!("a second stock called \"{}\"", stock.name));
    }
    let margins = 2.0 * profile.margin_mm;
    match (stock.size_mm, stock.roll_width_mm) {
        (Some(size), None) => {
            for (side, value) in size.iter().enumerate() {
                let message =
                    format!("a sheet of {value} mm leaves nothing inside two margins of {} mm", margins / 2.0);
                checker.require(*value > margins, &format!("{path}.size_mm.{side}"), &message);
            }
        }
        (None, Some(width)) => {
            let message = format!("a roll of {width} mm leaves nothing inside two margins of {} mm", margins / 2.0);
            checker.require(width > margins, &format!("{path}.roll_width_mm"), &message);
        }
        _ => checker.problem(&path, "stock is a sheet (`size_mm`) or a roll (`roll_width_mm`)"),
    }
    checker.require(stock.count != Some(0), &format!("{path}.count"), "`count` is 0: leave the stock out instead");
}

fn joint(joint: &Joint, path: &str, checker: &mut Checker<'_>) {
    let at = |key: &str| format!("{path}.{key}");
    checker.text(&at("source"), &joint.source);
    for (key, value) in [
        ("min_width_mm", joint.min_width_mm),
        ("neck_mm", joint.neck_mm),
        ("barb_mm", joint.barb_mm),
        ("neck_length_mm", joint.neck_length_mm),
        ("head_length_mm", joint.head_length_mm),
        ("tip_width_mm", joint.tip_width_mm),
    ] {
        checker.positive(&at(key), value);
    }
    for (key, value) in [
        ("good_width_mm", joint.good_width_mm - joint.min_width_mm),
        ("slit_extra_mm", joint.slit_extra_mm),
        ("tip_radius_mm", joint.tip_radius_mm),
        ("corner_radius_mm", joint.corner_radius_mm),
        ("slit_ahead_mm", joint.slit_ahead_mm),
        ("edge_distance_mm", joint.edge_distance_mm),
        ("cut_distance_mm", joint.cut_distance_mm),
        ("end_tab_mm", joint.end_tab_mm),
    ] {
        let message = match key {
            "good_width_mm" => "`good_width_mm` is below min_width_mm".to_owned(),
            _ => format!("`{key}` is {value}, it must be at least 0"),
        };
        checker.require(value >= 0.0, &at(key), &message);
    }
    checker.within(&at("shoulder_undercut_deg"), joint.shoulder_undercut_deg, 0.0, 45.0);
    checker.positive_if_given(&at("slit_width_mm"), joint.slit_width_mm);
    checker.positive_if_given(&at("hook_radius_mm"), joint.hook_radius_mm);
    checker.positive_if_given(&at("slit_relief_mm"), joint.slit_relief_mm);
    if let Some(hinge) = joint.hinge {
        checker.positive(&at("hinge.cut_mm"), hinge.cut_mm);
        checker.positive(&at("hinge.gap_mm"), hinge.gap_mm);
    }
    checker.positive(&at("min_retention_mm"), joint.min_retention_mm);
    let slot = joint.slit_relief_mm.unwrap_or(0.0) * 2.0;
    let message = format!("two reliefs of this size leave nothing of a slit {:.2} mm long", joint.slit_length_mm());
    checker.require(slot < joint.slit_length_mm(), &at("slit_relief_mm"), &message);
    let message = "a barb this small cannot be rounded so much: at most `barb_mm`";
    checker.require(joint.corner_radius_mm <= joint.barb_mm, &at("corner_radius_mm"), message);
    if joint.retention_mm() <= 0.0 {
        let (slit, head) = (joint.slit_length_mm(), joint.head_mm());
        checker.problem(
            &at("slit_extra_mm"),
            format!(
                "the joint falls open: a slit of {slit:.2} mm (neck + slit_extra) does not hold a head of {head:.2} mm \
                 (neck + 2 barbs); make the slit shorter or the barbs wider"
            ),
        );
    }
    let tab = joint.hook_radius_mm.unwrap_or(0.0) + joint.edge_distance_mm;
    if joint.end_tab_mm < tab {
        let message = format!("the hinge of the last joint would lie too near the strip's end: at least {tab:.2} mm");
        checker.problem(&at("end_tab_mm"), message);
    }
    let needed = joint.head_mm() + 2.0 * joint.edge_distance_mm;
    if joint.min_width_mm < needed {
        let message = format!("a strip this wide has no room for the head and two edges: at least {needed:.2} mm");
        checker.problem(&at("min_width_mm"), message);
    }
}

fn knife_joint(joint: &Joint, checker: &mut Checker<'_>) {
    let radii = [
        ("tip_radius_mm", Some(joint.tip_radius_mm)),
        ("corner_radius_mm", Some(joint.corner_radius_mm)),
        ("hook_radius_mm", joint.hook_radius_mm),
    ];
    for (key, radius) in radii {
        if let Some(radius) = radius.filter(|r| *r < LEAST_KNIFE_RADIUS_MM) {
            let message = format!("`{key}` is {radius}: a blade turns no radius below {LEAST_KNIFE_RADIUS_MM} mm");
            checker.problem(&format!("joint.knife.{key}"), message);
        }
    }
    let slit = "a blade cuts a slit as one plain line: leave this out";
    checker.require(joint.slit_width_mm.is_none(), "joint.knife.slit_width_mm", slit);
    checker.require(joint.slit_relief_mm.is_none(), "joint.knife.slit_relief_mm", slit);
}

fn process(row: &ProcessRow, path: &str, checker: &mut Checker<'_>) {
    let at = |key: &str| format!("{path}.{key}");
    checker.text(&at("source"), &row.source);
    checker.positive(&at("feed_mm_per_min"), row.feed_mm_per_min);
    checker.at_least(&at("passes"), f64::from(row.passes), 1.0);
    if let Some(power) = row.power {
        checker.power(&at("power"), power);
    }
    checker.positive_if_given(&at("reference_power_w"), row.reference_power_w);
    if row.tool.is_laser() {
        checker.require(row.power.is_some(), &at("power"), "a laser's row needs `power`");
        let message = "a laser's row needs `reference_power_w`: the optical watts that `power` is a share of";
        checker.require(row.reference_power_w.is_some(), &at("reference_power_w"), message);
    }
    match (row.operation, row.kerf_mm) {
        (ProcessKind::Cut, None) => checker.problem(&at("kerf_mm"), "a cut needs `kerf_mm` (0 for a blade)"),
        (ProcessKind::Cut, Some(kerf)) if row.tool.is_laser() => checker.positive(&at("kerf_mm"), kerf),
        (ProcessKind::Cut, Some(kerf)) => checker.at_least(&at("kerf_mm"), kerf, 0.0),
        (ProcessKind::Engrave, Some(_)) => checker.problem(&at("kerf_mm"), "engraving removes no kerf: leave it out"),
        (ProcessKind::Engrave, None) => {}
    }
    if !row.pass_power.is_empty() {
        let message = format!("`pass_power` names {} passes and `passes` is {}", row.pass_power.len(), row.passes);
        checker.require(row.pass_power.len() == row.passes as usize, &at("pass_power"), &message);
        for (index, share) in row.pass_power.iter().enumerate() {
            checker.power(&at(&format!("pass_power.{index}")), *share);
        }
    }
    checker.at_least(&at("z_step_mm"), row.z_step_mm, 0.0);
    checker.at_least(&at("cool_mm"), row.cool_mm, 0.0);
    checker.at_least(&at("lead_mm"), row.lead_mm.unwrap_or(0.0), 0.0);
    checker.at_least(&at("overcut_mm"), row.overcut_mm.unwrap_or(0.0), 0.0);
    if let Some(dashes) = row.perforation {
        checker.positive(&at("perforation.cut_mm"), dashes.cut_mm);
        checker.positive(&at("perforation.gap_mm"), dashes.gap_mm);
    }
    if row.tool == ToolClass::Pen && row.operation == ProcessKind::Cut {
        checker.problem(&at("operation"), "a pen draws and cuts nothing: say operation = \"engrave\"");
    }
    if let Some(bridges) = row.bridges {
        checker.positive(&at("bridges.width_mm"), bridges.width_mm);
        let message = "`pitch_mm` must be greater than the bridge's width";
        checker.require(bridges.pitch_mm > bridges.width_mm, &at("bridges.pitch_mm"), message);
    }
    if let Some(blade) = row.blade {
        checker.within(&at("blade.angle_deg"), blade.angle_deg, 15.0, 75.0);
        checker.at_least(&at("blade.offset_mm"), blade.offset_mm, 0.0);
        checker.positive(&at("blade.force_gf"), blade.force_gf);
    }
}

fn same_case(a: &ProcessRow, b: &ProcessRow) -> bool {
    (a.tool, a.operation, a.reference_power_w, &a.measured_on)
        == (b.tool, b.operation, b.reference_power_w, &b.measured_on)
}

fn allowed(profile: &Profile, checker: &mut Checker<'_>) {
    for class in ToolClass::ALL {
        let (verdict, reason) = profile.allowed.for_tool(class);
        let path = format!("allowed.{}", class.word());
        if matches!(verdict, Some(Verdict::Test | Verdict::Never)) && reason.is_none_or(|r| r.trim().is_empty()) {
            checker.problem(&path, format!("say why in `{}_reason`", class.word()));
        }
        // A pen cuts nothing: it draws the lines. A person needs no numbers.
        let kind = if class == ToolClass::Pen { ProcessKind::Engrave } else { ProcessKind::Cut };
        let cuts = profile.process.iter().any(|r| r.tool == class && r.operation == kind);
        let needs_row = class != ToolClass::Scissors;
        if matches!(verdict, Some(Verdict::Yes | Verdict::Test)) && needs_row && !cuts {
            let does = if class == ToolClass::Pen { "draws on" } else { "cuts" };
            checker.problem(&path, format!("allowed, but no [[process]] says how a {} {does} it", class.title()));
        }
        if verdict == Some(Verdict::Never) && cuts {
            checker.problem(&path, format!("never, and yet a [[process]] says how a {} cuts it", class.title()));
        }
    }
}
