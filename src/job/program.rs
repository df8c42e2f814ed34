//! One program: planned, written, read back and checked.

use super::label::motion_told;
use super::order::StartFrom;
use super::settings::Setup;
use super::{Error, minutes};
use crate::config::Grain;
use crate::drawing::Drawing;
use crate::gcode::{self, CheckSettings, Header, Move, Program};
use crate::geom::{Rect, V2};
use crate::toolpath::{self, Toolpath};

/// A program and what it comes to.
#[derive(Debug, Clone)]
pub(super) struct Written {
    /// What the tool follows.
    pub toolpath: Toolpath,
    /// What the machine reads.
    pub text: String,
    /// What that makes it do.
    pub moves: Vec<Move>,
    /// Planned time, s.
    pub time_s: f64,
}

/// Plans one program; `file` is what messages call it.
pub(super) fn planned(
    file: &str,
    drawings: &[Drawing],
    [width_mm, height_mm]: [f64; 2],
    settings: &toolpath::Settings,
) -> Result<Toolpath, Error> {
    toolpath::plan(drawings, width_mm, height_mm, settings)
        .map_err(|source| Error::Toolpath { sheet: file.to_owned(), source })
}

/// Plans, writes, reads back and checks one program.
pub(super) fn written(
    file: &str,
    drawings: &[Drawing],
    size_mm: [f64; 2],
    settings: &toolpath::Settings,
    header: &dyn Fn(&Toolpath, toolpath::Tool, f64) -> Header,
    setup: &Setup,
    start: &StartFrom,
) -> Result<Written, Error> {
    let sheet = || file.to_owned();
    let toolpath = planned(file, drawings, size_mm, settings)?;
    let refused = |source| Error::Gcode { sheet: sheet(), source };
    let checked = check_settings(setup, start, settings.tool, &toolpath);
    let (text, moves, findings) = if let Some(plotter) = setup.plotter(settings.tool) {
        let text = gcode::emit_plot(&toolpath, &plotter).map_err(refused)?;
        let feed_mm_per_min = setup.machine.max_feed_mm_per_min();
        let moves =
            gcode::trace_plot(&text, feed_mm_per_min).map_err(|source| Error::Plot { file: sheet(), source })?;
        let findings = gcode::check_moves(&moves, text.lines().count(), &checked).errors;
        (text, moves, findings)
    } else {
        let write =
            |header: &Header| gcode::emit(&toolpath, header, &setup.dialect(start, settings.tool)).map_err(refused);
        let read = |program: &Program| gcode::trace(program).map_err(|source| Error::Trace { sheet: sheet(), source });
        // The header tells the planned time, which is known once the moves are.
        let time_s = gcode::estimate(&read(&write(&Header::default())?)?, &setup.limits()).total_s;
        let program = write(&header(&toolpath, settings.tool, time_s))?;
        let moves = read(&program)?;
        (program.to_string(), moves, gcode::check(&program, &checked).errors)
    };
    if let Some(finding) = findings.into_iter().next() {
        return Err(Error::Check { sheet: sheet(), finding });
    }
    let time_s = gcode::estimate(&moves, &setup.limits()).total_s;
    Ok(Written { toolpath, text, moves, time_s })
}

/// What the machine permits. A job placed by hand lies nobody knows where: it is only checked for its size.
fn check_settings(setup: &Setup, start: &StartFrom, tool: toolpath::Tool, toolpath: &Toolpath) -> CheckSettings {
    let mut settings = setup.check();
    settings.laser &= !setup.is_second(tool);
    match start {
        StartFrom::Absolute => settings,
        StartFrom::Origin(_) | StartFrom::Current(_) => {
            let least = toolpath.bounds().with(toolpath.park).min;
            let size = V2::new(settings.work_area.width(), settings.work_area.height());
            CheckSettings { work_area: Rect { min: least, max: least + size }, keep_outs: Vec::new(), ..settings }
        }
    }
}

/// The head of a program: what its caller says first, then what holds for all.
pub(super) fn header(
    mut entries: Vec<(&str, String)>,
    toolpath: &Toolpath,
    tool: toolpath::Tool,
    time_s: f64,
    setup: &Setup,
) -> Header {
    let bounds = toolpath.bounds();
    let cut = &setup.pairing.cut;
    entries.extend(motion_told(&toolpath.motion).map(|told| ("sheet lies", told)));
    entries.extend([("machine", setup.machine.name.clone()), ("material", setup.profile.name.clone())]);
    if setup.is_second(tool) {
        let turn = "before the program of the same name in sheets/, from the same zero";
        entries.extend([("tool", "pen".to_owned()), ("turn", turn.to_owned())]);
    } else {
        let length = format!("{:.0} mm", toolpath.cut_mm());
        entries.extend([("kerf", format!("{} mm", cut.kerf_mm)), ("cut at", setup.cut_told()), ("cut length", length)]);
    }
    entries.extend([
        (
            "bounds",
            format!("X{:.3} Y{:.3} to X{:.3} Y{:.3} mm", bounds.min.x, bounds.min.y, bounds.max.x, bounds.max.y),
        ),
        ("planned time", minutes(time_s)),
    ]);
    if let [a, b] = toolpath.crosses[..] {
        entries.push(("crosses", format!("X{:.3} Y{:.3} and X{:.3} Y{:.3} mm", a.x, a.y, b.x, b.y)));
    }
    if setup.profile.grain == Grain::Directional {
        entries.push(("grain", if setup.turned() { "along Y" } else { "along X" }.to_owned()));
    }
    if !cut.calibrated && !setup.is_second(tool) {
        entries.push(("UNCALIBRATED", format!("values {}; cut a test piece first", cut.source)));
    }
    Header { entries: entries.into_iter().map(|(k, v)| (k.to_owned(), v)).collect() }
}
