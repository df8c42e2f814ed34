//! Pages become a file (PDF 1.7, ISO 32000-1). No dates, no font data, nothing compressed: the same pages give the same bytes.

use super::letters::Face;
use super::page::{POINT_MM, Page};
use pdf_writer::{Finish, Name, Pdf, Rect, Ref, TextStr};

/// The file's bytes.
pub(super) fn file(title: &str, pages: Vec<Page>) -> Vec<u8> {
    let mut pdf = Pdf::new();
    let mut next = 0;
    let mut fresh = || {
        next += 1;
        Ref::new(next)
    };
    let (catalog, tree, info) = (fresh(), fresh(), fresh());
    let fonts = Face::ALL.map(|face| (face, fresh()));
    let leaves: Vec<(Ref, Ref, Page)> = pages.into_iter().map(|page| (fresh(), fresh(), page)).collect();
    pdf.catalog(catalog).pages(tree);
    pdf.document_info(info).title(TextStr(title)).producer(TextStr("furbelow"));
    for (face, id) in fonts {
        pdf.type1_font(id).base_font(Name(face.base_font())).encoding_predefined(Name(b"WinAnsiEncoding"));
    }
    pdf.pages(tree).kids(leaves.iter().map(|leaf| leaf.0)).count(leaves.len() as i32);
    for (id, content, page) in leaves {
        let size = page.area.max / POINT_MM;
        let mut leaf = pdf.page(id);
        leaf.media_box(Rect::new(0.0, 0.0, size.x as f32, size.y as f32)).parent(tree).contents(content);
        let mut resources = leaf.resources();
        let mut named = resources.fonts();
        for (face, font) in fonts {
            named.pair(Name(face.resource()), font);
        }
        named.finish();
        resources.finish();
        leaf.finish();
        pdf.stream(content, &page.finish());
    }
    pdf.finish()
}
