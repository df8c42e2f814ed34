//! Programs as people look at them before they cut: ours with their sheet, foreign ones with what their comments tell.

use super::Error;
use super::label::{Label, SheetLabel};
use super::settings;
use super::sheets::CutSheet;
use super::stock::parse_stock;
use crate::config::{Grain, Library, Machine, Profile, StockGrain};
use crate::gcode::{self, Move, Program};
use crate::geom::{Motion, P2, Rect, V2};
use crate::preview::{self, Bed, ColorBy, Come, GrainRun, MAX_MOVES, Run, Stock, come_canvas, html, run_canvas};
use crate::progress::Warning;

/// The machine a program is shown on when neither the user nor the program names one.
const USUAL_MACHINE: &str = "diode-400";

/// The plotter a plot is shown on, which names none.
const USUAL_PLOTTER: &str = "roll-610";

/// The page of a job, in its folder.
pub(super) const PAGE: &str = "preview.html";

/// A program to look at.
#[derive(Debug, Clone, Copy)]
pub struct Look<'a> {
    /// What people call it: the file's name.
    pub name: &'a str,
    /// G-code, ours or foreign.
    pub text: &'a str,
    /// Name or path of the machine; else the one the program names.
    pub machine: Option<&'a str>,
    /// Name or path of the material; else the one the program names.
    pub material: Option<&'a str>,
}

/// What a dry run is written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// One page that plays it.
    Html,
    /// A drawing at true size.
    Svg,
    /// A picture of so many pixels on its longer side.
    Png(u32),
}

/// A dry run and what it took for granted.
#[derive(Debug, Clone, PartialEq)]
pub struct Looked {
    /// The file.
    pub bytes: Vec<u8>,
    /// Time the machine will take, s.
    pub time_s: f64,
    /// The machine it was planned for.
    pub machine: String,
    /// True when nobody named a machine.
    pub guessed: bool,
}

/// Shows a program on its machine.
///
/// # Errors
/// A machine or material that is not known, text that is no G-code, a program that GRBL would refuse, or one too large for a page.
pub fn look(order: &Look, library: &Library, form: Form, by: ColorBy) -> Result<Looked, Error> {
    drawn(order, library, |run, bed| match form {
        Form::Html => html(order.name, std::slice::from_ref(run), bed, by).map(String::into_bytes),
        Form::Svg => Ok(run_canvas(run, bed, by).to_svg().into_bytes()),
        Form::Png(longer_px) => run_canvas(run, bed, by).to_png(longer_px),
    })
}

/// Shows how far a program has come, as a PNG of so many pixels on its longer side, or as SVG.
///
/// # Errors
/// As [`look`].
pub fn look_back(order: &Look, library: &Library, come: Come, longer_px: Option<u32>) -> Result<Looked, Error> {
    drawn(order, library, |run, bed| {
        let canvas = come_canvas(run, bed, come);
        longer_px.map_or_else(|| Ok(canvas.to_svg().into_bytes()), |px| canvas.to_png(px))
    })
}

fn drawn(
    order: &Look,
    library: &Library,
    draw: impl FnOnce(&Run, &Bed) -> Result<Vec<u8>, preview::Error>,
) -> Result<Looked, Error> {
    let plot = gcode::is_plot(order.text);
    let program = if plot { Program::default() } else { parsed(order)? };
    let label = Label::of(&program);
    // A name in a comment may be of another computer's library; one on the command line must be known.
    let known = |name: Option<&str>| name.and_then(|n| library.machine(n).ok());
    let (machine, guessed) = match order.machine {
        Some(name) => (library.machine(name)?, false),
        None => match known(label.machine.as_deref()) {
            Some(machine) => (machine, false),
            None => (library.machine(if plot { USUAL_PLOTTER } else { USUAL_MACHINE })?, true),
        },
    };
    let moves = if plot {
        let feed_mm_per_min = machine.max_feed_mm_per_min();
        gcode::trace_plot(order.text, feed_mm_per_min)
            .map_err(|source| Error::Plot { file: order.name.into(), source })?
    } else {
        gcode::trace(&program).map_err(|source| Error::Trace { sheet: order.name.into(), source })?
    };
    let profile = match order.material {
        Some(name) => Some(library.profile(name)?),
        None => label.material.and_then(|name| library.profile(&name).ok()),
    };
    let motion = label.lies.unwrap_or_else(Motion::identity);
    let lying = |sheet: SheetLabel| stock(&sheet.stock, sheet.width_mm, sheet.height_mm, &motion, profile.as_ref());
    let stock = label.sheet.map(lying);
    let limits = settings::limits(&machine);
    let mut notes = Vec::new();
    notes.extend(profile.as_ref().map(|p| p.title.clone()));
    notes.extend(label.uncalibrated.map(|text| format!("UNCALIBRATED: {text}")));
    if guessed {
        notes.push(format!(
            "No machine was named: times and bed are those of {}. --machine says otherwise.",
            machine.name
        ));
    }
    let timing = gcode::estimate(&moves, &limits);
    let time_s = timing.total_s;
    let name = order.name.to_owned();
    let run = Run { name, text: order.text.into(), moves: &moves, timing, stock, labels: Vec::new(), notes };
    let mut bed = bed(&machine);
    // A pen beside a laser draws without light.
    bed.laser &= label.tool.is_none();
    let bytes = draw(&run, &bed).map_err(|source| Error::Picture { file: order.name.into(), source })?;
    Ok(Looked { bytes, time_s, machine: machine.name, guessed })
}

fn parsed(order: &Look) -> Result<Program, Error> {
    gcode::parse(order.text).map_err(|source| Error::Parse { file: order.name.into(), source })
}

/// The bed of a machine. Work X0 Y0 lies in the machine's origin corner.
pub(super) fn bed(machine: &Machine) -> Bed {
    let keep_outs = machine.keep_outs.iter().map(|k| {
        let min = P2::new(k.x_mm, k.y_mm);
        (k.name.clone(), Rect { min, max: min + V2::new(k.width_mm, k.height_mm) })
    });
    Bed {
        machine: machine.name.clone(),
        reach: settings::reach(machine),
        keep_outs: keep_outs.collect(),
        max_s: machine.controller.max_s,
        optical_power_w: machine.tool.optical_power_w,
        laser: machine.tool.class.is_laser(),
    }
}

/// A sheet as jobs lay it, with its grain along x of the sheet, moved to where it lies on the machine.
fn stock(name: &str, width_mm: f64, height_mm: f64, motion: &Motion, profile: Option<&Profile>) -> Stock {
    let lies = Rect::EMPTY.with(motion * P2::origin()).with(motion * P2::new(width_mm, height_mm));
    let directional = profile.filter(|p| p.grain == Grain::Directional);
    let grain = directional.map(|profile| {
        let known = parse_stock(name, profile).is_ok_and(|sheet| sheet.grain != StockGrain::Unknown);
        GrainRun { along_x: (motion.rotation * V2::x()).x.abs() > 0.5, known }
    });
    Stock { name: name.to_owned(), at: lies.min, width_mm: lies.width(), height_mm: lies.height(), grain }
}

/// A sheet of a job with its program, moves and the names of its pieces.
pub(super) fn run<'a>(sheet: &'a CutSheet, setup: &settings::Setup) -> Run<'a> {
    let cut = &setup.pairing.cut;
    let moves: &[Move] = &sheet.moves;
    let motion = &sheet.toolpath.motion;
    let names = sheet.drawings.iter().filter_map(|d| Some((motion * d.outline()?.bounds().center(), d.name.clone())));
    let mut notes = vec![format!("{}, kerf {} mm", setup.profile.title, cut.kerf_mm)];
    if !cut.calibrated {
        notes.push("UNCALIBRATED: cut a small test piece first".into());
    }
    Run {
        name: sheet.file.clone(),
        text: sheet.text.clone(),
        moves,
        timing: gcode::estimate(moves, &setup.limits()),
        stock: Some(stock(&sheet.stock, sheet.layout.width_mm, sheet.layout.height_mm, motion, Some(&setup.profile))),
        labels: names.collect(),
        notes,
    }
}

/// How many sheets, from the first, one page holds.
fn shown(moves: impl Iterator<Item = usize>) -> usize {
    let mut sum = 0;
    moves
        .take_while(|n| {
            sum += n;
            sum <= MAX_MOVES
        })
        .count()
}

/// What the user should know when not all sheets are on the page.
pub(super) fn warning(sheets: &[CutSheet]) -> Option<Warning> {
    let (shown, all) = (shown(sheets.iter().map(|s| s.moves.len())), sheets.len());
    let message = || {
        format!(
            "preview.html has room for {shown} of {all} sheets ({MAX_MOVES} moves); `furbelow preview` shows the others one by one as pictures or pages"
        )
    };
    (shown < all).then(|| Warning::new("preview-cut-short", message()))
}

/// The page of a whole job, as many sheets as it holds; `None` when it holds none.
pub(super) fn page(name: &str, runs: &[Run], setup: &settings::Setup) -> Result<Option<String>, Error> {
    let shown = shown(runs.iter().map(|run| run.moves.len()));
    if shown == 0 {
        return Ok(None);
    }
    let page = html(name, &runs[..shown], &bed(&setup.machine), ColorBy::Power);
    page.map(Some).map_err(|source| Error::Picture { file: PAGE.into(), source })
}

#[cfg(test)]
mod tests {
    use super::*;

    const OURS: &str = "; furbelow\n; sheet: 1/2 A4 297 x 210 mm\n; machine: k40\n; material: paper-160\nG21G90M4S0\nG1X10S500F1200\n; machine: later\nM5";

    fn looked(text: &str, machine: Option<&str>) -> Result<Looked, Error> {
        let order = Look { name: "job.nc", text, machine, material: None };
        look(&order, &Library::built_in(), Form::Html, ColorBy::Power)
    }

    #[test]
    fn a_program_tells_its_machine_sheet_and_grain_itself() {
        let looked = looked(OURS, None).unwrap();
        assert_eq!((looked.machine.as_str(), looked.guessed), ("k40", false));
        let page = String::from_utf8(looked.bytes).unwrap();
        assert!(page.contains(r#""width":297.0"#) && page.contains(r#""grain":"x""#));
    }

    #[test]
    fn the_users_word_goes_before_the_programs_and_a_foreign_program_needs_none() {
        assert_eq!(looked(OURS, Some("diode-400")).unwrap().machine, "diode-400");
        let foreign = looked("; machine: somebody-elses\nG0X1", None).unwrap();
        assert!(foreign.guessed && foreign.machine == USUAL_MACHINE);
        assert!(looked(OURS, Some("nothing")).is_err());
    }

    #[test]
    fn the_bed_lies_where_the_machines_zero_puts_it() {
        let library = Library::built_in();
        let machine = Machine { origin: crate::config::Corner::BackRight, ..library.machine("k40").unwrap() };
        let reach = bed(&machine).reach;
        assert_eq!((reach.min, reach.max), (P2::new(-300.0, -200.0), P2::origin()));
    }

    #[test]
    fn what_is_no_g_code_is_refused_with_file_and_line() {
        let message = looked("G0X1\n%%", None).unwrap_err().to_string();
        assert!(message.starts_with("job.nc: line 2"), "{message}");
    }

    #[test]
    fn a_page_holds_the_first_sheets_that_fit() {
        assert_eq!(shown([MAX_MOVES, 1].into_iter()), 1);
        assert_eq!(shown([MAX_MOVES - 1, 1, 0].into_iter()), 3);
        assert_eq!(shown([MAX_MOVES + 1].into_iter()), 0);
    }

    #[test]
    fn a_turned_sheet_is_shown_where_it_lies() {
        let turned = Motion::new(V2::new(570.0, 0.0), std::f64::consts::FRAC_PI_2);
        let lies = stock("roll", 800.0, 570.0, &turned, None).rect();
        assert!((lies.min - P2::origin()).norm() < 1e-9 && (lies.max - P2::new(570.0, 800.0)).norm() < 1e-9);
    }

    #[test]
    fn what_a_pen_beside_a_laser_draws_is_seen() {
        let program = "; machine: diode-400\n; tool: pen\nG21G90\nG0Z3\nX10\nG1Z0F600\nX60\nG0Z3\nM2";
        let drawn = |text: &str| {
            let order = Look { name: "pen.nc", text, machine: None, material: None };
            let looked = look(&order, &Library::built_in(), Form::Svg, ColorBy::Power).unwrap();
            // The way with the tool down is a path of its own.
            String::from_utf8(looked.bytes).unwrap().contains("d=\"M11.8 3.66 H61.8\"")
        };
        assert!(drawn(program) && !drawn(&program.replace("; tool: pen\n", "")));
    }

    #[test]
    fn a_plot_is_shown_on_a_plotter() {
        let looked = looked("IN;PA;SP1;\nPU40,40;\nPD4000,40;\nPU0,0;", None).unwrap();
        assert_eq!((looked.machine.as_str(), looked.guessed), ("roll-610", true));
        assert!(looked.time_s > 0.1);
    }
}
