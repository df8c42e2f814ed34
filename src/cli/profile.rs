//! `furbelow profile list | show | check | set | schema`

use serde_json::json;

use super::output::{checklist, fact, json, line, number, own_folder, percent, read_argument, table};
use super::{Failure, files, profile_set};
use crate::config::{
    self, Grain, Joint, Kind, Library, ProcessKind, ProcessRow, Profile, Stock, StockGrain, ToolClass, Verdict,
};

/// What to do with profiles.
#[derive(Debug, clap::Subcommand)]
pub enum Command {
    #[command(flatten)]
    Files(files::Command),
    /// Write values into a profile of your own, comments kept
    Set(profile_set::Args),
}

pub(super) fn run(command: Command) -> Result<(), Failure> {
    let library = Library::open();
    match command {
        Command::Files(files::Command::List { json }) => list(&library, json),
        Command::Files(files::Command::Show { name, json }) => show(&library.profile(&name)?, json),
        Command::Files(files::Command::Check { file }) => check(&library, &file),
        Command::Files(files::Command::Schema) => json(&config::schema(Kind::Profile)),
        Command::Set(args) => profile_set::run(&args, &library),
    }
}

fn list(library: &Library, as_json: bool) -> Result<(), Failure> {
    let mut rows = vec![["NAME", "WHAT", "STOCK", "TOOLS", "FROM"].map(str::to_owned).to_vec()];
    let mut objects = Vec::new();
    for listed in library.names(Kind::Profile)? {
        let from = listed.place.to_string();
        match library.profile(&listed.name) {
            Ok(profile) => {
                let stock: Vec<&str> = profile.stock.iter().map(|stock| stock.name.as_str()).collect();
                rows.push(vec![listed.name, profile.title.clone(), stock.join(" "), tools(&profile), from.clone()]);
                let tool = |class: ToolClass| (class.word().to_owned(), verdict(&profile, class).into());
                objects.push(json!({
                    "name": profile.name, "title": profile.title, "from": from, "stock": stock,
                    "thickness_mm": profile.thickness_mm, "grammage_g_per_m2": profile.grammage_g_per_m2,
                    "allowed": serde_json::Map::from_iter(ToolClass::ALL.map(tool)), "problem": null,
                }));
            }
            // One bad file of the user's must not hide the others.
            Err(error) => {
                let hint = format!("not in order: furbelow profile check {}", listed.name);
                rows.push(vec![listed.name.clone(), hint, String::new(), String::new(), from.clone()]);
                objects.push(json!({ "name": listed.name, "from": from, "problem": error.to_string() }));
            }
        }
    }
    if as_json {
        return json(&json!({ "profiles": objects }));
    }
    line(&table(&rows))?;
    own_folder(library, Kind::Profile)
}

/// The verdict's word; a tool the profile does not name has to be tested.
fn verdict(profile: &Profile, class: ToolClass) -> &'static str {
    profile.allowed.for_tool(class).0.unwrap_or(Verdict::Test).word()
}

/// "diode co2 knife(test)": what may touch the material.
fn tools(profile: &Profile) -> String {
    let words = ToolClass::ALL.into_iter().filter_map(|class| match verdict(profile, class) {
        "yes" => Some(class.word().to_owned()),
        "test" => Some(format!("{}(test)", class.word())),
        _ => None,
    });
    words.collect::<Vec<_>>().join(" ")
}

fn show(profile: &Profile, as_json: bool) -> Result<(), Failure> {
    if as_json {
        return json(profile);
    }
    line(&format!("{}: {}\nsource: {}\n", profile.name, profile.title, profile.source))?;
    line(&table(&sheet_facts(profile)))?;
    line("\nallowed tools")?;
    let tools = ToolClass::ALL.map(|class| {
        let reason = profile.allowed.for_tool(class).1.unwrap_or_default();
        vec![format!("  {}", class.title()), verdict(profile, class).into(), reason.into()]
    });
    line(&table(&tools))?;
    line("\nprocess, one row per tool and power")?;
    let heading = [
        "  TOOL",
        "DOES",
        "W",
        "FEED MM/MIN",
        "MM/S",
        "POWER",
        "J/MM",
        "KERF MM",
        "AIR",
        "PASSES",
        "BRIDGES",
        "SOURCE",
    ];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    rows.extend(profile.process.iter().map(process_row));
    line(&table(&rows))?;
    joint("joint for lasers", &profile.joint.laser)?;
    joint("joint for knives", &profile.joint.knife)?;
    checklist(&profile.setup)
}

fn sheet_facts(profile: &Profile) -> Vec<Vec<String>> {
    let mm = |value: f64| format!("{} mm", number(value));
    let rigidity_source = profile.flexural_rigidity_source.as_ref().unwrap_or(&profile.source);
    let grain = match profile.grain {
        Grain::None => "none: pieces lie at any angle",
        Grain::Directional => "directional: all strips of an object lie the same way",
    };
    let stock: Vec<String> = profile.stock.iter().map(|stock| stock_text(profile, stock)).collect();
    vec![
        fact("thickness", mm(profile.thickness_mm)),
        fact("grammage", format!("{} g/m2", number(profile.grammage_g_per_m2))),
        fact(
            "flexural rigidity",
            format!(
                "{} N mm along, {} across the grain  ({rigidity_source})",
                number(profile.flexural_rigidity_md_n_mm),
                number(profile.flexural_rigidity_cd_n_mm)
            ),
        ),
        fact(
            "membrane stiffness",
            format!("{} N/mm  ({})", number(profile.membrane_stiffness_n_per_mm), profile.membrane_stiffness_source),
        ),
        fact("grain", grain),
        fact("tightest bend", format!("{} radius", mm(profile.min_bend_radius_mm))),
        fact("narrowest void", mm(profile.min_void_mm)),
        fact("least letters", mm(profile.min_label_height_mm)),
        fact("spacing, margin", format!("{}, {}", mm(profile.spacing_mm), mm(profile.margin_mm))),
        fact(
            "splice",
            format!(
                "{}, lap of {}  ({})",
                profile.splice_kind().word(),
                mm(profile.splice.lap_mm),
                profile.splice.source
            ),
        ),
        fact("stock", stock.join("; ")),
    ]
}

fn stock_text(profile: &Profile, stock: &Stock) -> String {
    let size = match (stock.size_mm, stock.roll_width_mm) {
        (Some([width, height]), _) => format!("{} ({} x {} mm)", stock.name, number(width), number(height)),
        (None, width) => format!("{} (roll {} mm)", stock.name, number(width.unwrap_or_default())),
    };
    let count = stock.count.map(|count| format!(", {count} sheets")).unwrap_or_default();
    let grain = match (profile.grain, stock.grain) {
        (Grain::None, _) => "",
        (_, StockGrain::Long) => ", long grain",
        (_, StockGrain::Short) => ", short grain",
        (_, StockGrain::Unknown) => ", grain unknown",
    };
    size + &count + grain
}

fn process_row(row: &ProcessRow) -> Vec<String> {
    let optional = |value: Option<f64>| value.map(number).unwrap_or_default();
    let energy = row.power.zip(row.reference_power_w).map(|(power, watts)| power * watts * 60.0 / row.feed_mm_per_min);
    let bridges = row.bridges.map(|b| format!("{} every {}", number(b.width_mm), number(b.pitch_mm)));
    let blade = row.blade.map(|blade| {
        let [angle, offset, force] = [blade.angle_deg, blade.offset_mm, blade.force_gf].map(number);
        format!("{angle} deg, offset {offset} mm, {force} gf; ")
    });
    vec![
        format!("  {}", row.tool.word()),
        row.operation.word().into(),
        optional(row.reference_power_w),
        number(row.feed_mm_per_min),
        number((row.feed_mm_per_min / 6.0).round() / 10.0),
        row.power.map(percent).unwrap_or_default(),
        energy.map(|e| format!("{e:.2}")).unwrap_or_default(),
        if row.operation == ProcessKind::Cut { optional(row.kerf_mm) } else { String::new() },
        row.air.word().into(),
        row.passes.to_string(),
        bridges.unwrap_or_default(),
        blade.unwrap_or_default() + &row.source,
    ]
}

fn joint(heading: &str, joint: &Joint) -> Result<(), Failure> {
    let mm = |value: f64| format!("{} mm", number(value));
    let or_none = |value: Option<f64>| value.map_or("none".to_owned(), mm);
    let slit = joint.slit_width_mm.map_or("a plain line".to_owned(), |width| format!("a slot {} wide", mm(width)));
    let hinge = joint.hinge.map_or("not weakened".to_owned(), |hinge| {
        format!("dashes of {}, {} left", mm(hinge.cut_mm), mm(hinge.gap_mm))
    });
    let facts = [
        fact("  strip", format!("at least {}, good from {}", mm(joint.min_width_mm), mm(joint.good_width_mm))),
        fact("  neck, head", format!("{}, {} over the barbs", mm(joint.neck_mm), mm(joint.head_mm()))),
        fact("  lengths", format!("neck {}, head {}", mm(joint.neck_length_mm), mm(joint.head_length_mm))),
        fact("  tip", format!("{} wide, radius {}", mm(joint.tip_width_mm), mm(joint.tip_radius_mm))),
        fact(
            "  shoulder",
            format!("undercut {} deg, radius {}", number(joint.shoulder_undercut_deg), mm(joint.corner_radius_mm)),
        ),
        fact(
            "  slit",
            format!("{} long, {slit}, relief {}", mm(joint.slit_length_mm()), or_none(joint.slit_relief_mm)),
        ),
        fact("  hold, play", format!("{} on each side, {}", mm(joint.retention_mm()), mm(joint.play_mm()))),
        fact("  hinge", format!("{hinge}, hook {}", or_none(joint.hook_radius_mm))),
        fact("  slit ahead", mm(joint.slit_ahead_mm)),
        fact("  clear of", format!("edge {}, other cuts {}", mm(joint.edge_distance_mm), mm(joint.cut_distance_mm))),
        fact("  end tab", mm(joint.end_tab_mm)),
    ];
    line(&format!("\n{heading}  ({})\n{}", joint.source, table(&facts)))
}

fn check(library: &Library, file: &str) -> Result<(), Failure> {
    let profile = match read_argument(file)? {
        Some((name, text)) => library.profile_in(name, text)?,
        None => library.profile(file)?,
    };
    line(&format!("OK: profile {}", profile.name))
}
