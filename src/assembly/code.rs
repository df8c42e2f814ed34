//! The square code (QR, ISO/IEC 18004) that ties a sheet of paper to its job.

use super::page::Page;
use crate::geom::{P2, Rect, V2};
use qrcodegen::{QrCode, QrCodeEcc};

/// Light modules a reader needs around the code.
const QUIET: i32 = 4;

/// Draws the code of `text` into a square, as rows of dark runs. A text too long for any code is left out: a name of two thousand letters.
pub(super) fn draw(page: &mut Page, square: &Rect, text: &str) {
    let Ok(code) = QrCode::encode_text(text, QrCodeEcc::Medium) else { return };
    let n = code.size();
    let module = square.width() / f64::from(n + 2 * QUIET);
    for row in 0..n {
        let mut column = 0;
        while column < n {
            let run = (column..n).take_while(|c| code.get_module(*c, row)).count() as i32;
            if run > 0 {
                let left = square.min.x + f64::from(column + QUIET) * module;
                let bottom = square.max.y - f64::from(row + 1 + QUIET) * module;
                let min = P2::new(left, bottom);
                page.block(&Rect { min, max: min + V2::new(f64::from(run), 1.0) * module }, 0.0);
            }
            column += run.max(1);
        }
    }
}
