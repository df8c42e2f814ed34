//! Designs that come with the program: the strips of the paper's load tests (section 5.2, figure 16), on any machine and material.

/// Two layers of 30 mm, rungs of 52.8 mm.
const DEFAULT: &str = r#"# The paper's load-test strip: 486 mm long with its end tabs
schema = 1
machine = ""
material = ""

[[part]]
name = "A"
stack = { layers = 2, inner_mm = 52.8, outer_mm = 47.1239 } # loops are half circles, 30 mm high
width_mm = 80
"#;

/// Rungs of 106.7 mm.
const WIDE: &str = r#"# The paper's wide load-test strip: 749 mm long with its end tabs
schema = 1
machine = ""
material = ""

[[part]]
name = "A"
stack = { layers = 2, inner_mm = 106.7, outer_mm = 47.1239 } # loops are half circles, 30 mm high
width_mm = 80
"#;

/// The first with its four loops densified.
const DENSE: &str = r#"# The paper's dense load-test strip: 797 mm long with its end tabs
schema = 1
machine = ""
material = ""

[[part]]
name = "A"
stack = { layers = 2, inner_mm = 52.8, outer_mm = 47.1239 } # loops are half circles, 30 mm high
width_mm = 80

# The four loops.
[[edit]]
do = "densify"
part = "A"
sections = [1, 3, 5, 7]

# Rungs and diagonals, so that the strip is as long as the paper's table says.
[[edit]]
do = "length"
part = "A"
sections = [0, 1, 7, 8, 14, 15, 21, 22]
factor = 0.87
"#;

/// Text of the design file of that name, for no machine and no material yet; `None` for a name that is not built in.
pub fn built_in(name: &str) -> Option<&'static str> {
    match name {
        "paper-default" => Some(DEFAULT),
        "paper-wide" => Some(WIDE),
        "paper-dense" => Some(DENSE),
        _ => None,
    }
}
