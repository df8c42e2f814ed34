//! Writes the models of tests/models: `cargo run --example models`. The same bytes every time.

mod shapes;

use std::path::Path;

fn main() -> std::io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models");
    for (name, shape) in shapes::all() {
        let text = shape.to_obj(name.trim_end_matches(".obj"));
        println!("{name}: {} bytes", text.len());
        std::fs::write(folder.join(name), text)?;
    }
    Ok(())
}
