//! The files of a job.

use super::output::Stage;
use super::settings::Setup;
use super::sheets::Sheets;
use super::strips::Strips;
use super::{Error, Order, Realised, assembly, dry_run, offcuts, pictures, ruffle_json};
use crate::drawing::{self, Drawing};
use crate::preview::{Canvas, Run};
use crate::progress::{Observer, Progress};
use crate::toolpath;

/// Room around a piece in its own drawing, mm.
const PIECE_MARGIN_MM: f64 = 5.0;

/// Stages every file but report.json.
pub(super) fn write(
    stage: &mut Stage,
    order: &Order,
    setup: &Setup,
    realised: &Realised,
    strips: &Strips,
    sheets: &Sheets,
    observer: &mut dyn Observer,
) -> Result<(), Error> {
    let total = (realised.parts.len() + sheets.sheets.len()) as u64;
    let mut done = 0;
    let mut wrote = |note: &str| {
        let progress = Progress { stage: super::WRITING, done, total, note: note.to_owned() };
        let _ = observer.step(progress);
        done += 1;
    };
    stage.write("design.toml", order.text_for(stage.target())?.as_bytes())?;
    stage.write("ruffle.json", ruffle_json::ruffle_json(&realised.parts, setup).as_bytes())?;
    for part in &realised.parts {
        wrote(&part.name);
        let canvas = pictures::part(part);
        stage.write(&format!("parts/{}.svg", part.name), canvas.to_svg().as_bytes())?;
        png(stage, &format!("parts/{}.png", part.name), &canvas, pictures::PART_PX)?;
    }
    for piece in &strips.pieces {
        let svg = drawing::piece_svg(&piece.drawing, PIECE_MARGIN_MM);
        stage.write(&format!("strips/{}.svg", piece.name), svg.as_bytes())?;
        let dxf = drawing::dxf(std::slice::from_ref(&piece.drawing));
        stage.write(&format!("strips/{}.dxf", piece.name), dxf.as_bytes())?;
        if order.svg_kerf {
            let source = |source| Error::Toolpath { sheet: piece.name.clone(), source };
            let drawn = toolpath::compensated(&piece.drawing, setup.pairing.cut.kerf_mm).map_err(source)?;
            let svg = drawing::piece_svg(&drawn, PIECE_MARGIN_MM);
            stage.write(&format!("strips/{}-kerf.svg", piece.name), svg.as_bytes())?;
        }
    }
    let runs: Vec<Run> = sheets.sheets.iter().map(|sheet| dry_run::run(sheet, setup)).collect();
    for (sheet, run) in sheets.sheets.iter().zip(&runs) {
        wrote(&sheet.file);
        let name = |ending: &str| format!("sheets/{}.{ending}", sheet.file);
        let svg = drawing::sheet_svg(sheet.layout.width_mm, sheet.layout.height_mm, &sheet.drawings);
        stage.write(&name("svg"), svg.as_bytes())?;
        if order.svg_kerf {
            let source = |source| Error::Toolpath { sheet: sheet.file.clone(), source };
            let with_kerf = |d: &Drawing| toolpath::compensated(d, setup.pairing.cut.kerf_mm);
            let drawn = sheet.drawings.iter().map(with_kerf).collect::<Result<Vec<Drawing>, _>>().map_err(source)?;
            let svg = drawing::sheet_svg(sheet.layout.width_mm, sheet.layout.height_mm, &drawn);
            stage.write(&format!("sheets/{}-kerf.svg", sheet.file), svg.as_bytes())?;
        }
        stage.write(&name("dxf"), drawing::dxf(&sheet.drawings).as_bytes())?;
        if let Some(rest) = &sheet.offcut {
            let (file, svg) = offcuts::file(&sheet.file, rest);
            stage.write(&file, svg.as_bytes())?;
        }
        if let Some(pen) = &sheet.pen {
            stage.write(&format!("pen/{}.{}", sheet.file, sheet.ending), pen.as_bytes())?;
        }
        if !setup.by_hand() {
            stage.write(&name(sheet.ending), sheet.text.as_bytes())?;
            png(stage, &name("png"), &pictures::sheet(sheet, run, setup), pictures::SHEET_PX)?;
        }
    }
    for (name, bytes) in assembly::files(order, setup, realised, strips, sheets) {
        stage.write(name, &bytes)?;
    }
    let page = if setup.by_hand() { None } else { dry_run::page(&order.name, &runs, setup)? };
    if let Some(page) = page {
        stage.write(dry_run::PAGE, page.as_bytes())?;
    }
    Ok(())
}

fn png(stage: &mut Stage, file: &str, canvas: &Canvas, longer_px: u32) -> Result<(), Error> {
    let bytes = canvas.to_png(longer_px).map_err(|source| Error::Picture { file: file.to_owned(), source })?;
    stage.write(file, &bytes)
}
