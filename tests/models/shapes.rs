//! The shapes of this folder's OBJ files: closed, facing outward, mm, y up. The program that writes the files and the test that reads them
//! share this.

use std::f64::consts::{PI, TAU};

/// A point, mm: x to the right, y up, z toward the viewer.
type Point = [f64; 3];

/// A surface of triangles.
#[derive(Default)]
pub struct Shape {
    vertices: Vec<Point>,
    triangles: Vec<[usize; 3]>,
}

/// Every model: file name and shape.
pub fn all() -> Vec<(&'static str, Shape)> {
    vec![
        ("cuboid.obj", cuboid()),
        ("stool.obj", stool()),
        ("teddy.obj", teddy()),
        ("lampshade.obj", lampshade()),
        ("shell.obj", shell()),
    ]
}

impl Shape {
    /// The shape as an OBJ file: micrometres are written, `title` is a comment.
    pub fn to_obj(&self, title: &str) -> String {
        let mut text = format!("# {title}, mm, y up; written by make.rs\n");
        // Adding 0 turns -0 into 0.
        let number = |x: f64| format!("{}", (x * 1000.0).round() / 1000.0 + 0.0);
        for [x, y, z] in &self.vertices {
            text += &format!("v {} {} {}\n", number(*x), number(*y), number(*z));
        }
        for [a, b, c] in &self.triangles {
            text += &format!("f {} {} {}\n", a + 1, b + 1, c + 1);
        }
        text
    }

    fn vertex(&mut self, p: Point) -> usize {
        self.vertices.push(p);
        self.vertices.len() - 1
    }

    /// Two triangles, cut along the shorter diagonal.
    fn quad(&mut self, [a, b, c, d]: [usize; 4]) {
        let length =
            |i: usize, k: usize| (0..3).map(|n| (self.vertices[i][n] - self.vertices[k][n]).powi(2)).sum::<f64>();
        // Ties, which symmetry makes common, go by a margin so that rounding cannot decide them.
        if length(a, c) <= length(b, d) * 1.000001 {
            self.triangles.extend([[a, b, c], [a, c, d]]);
        } else {
            self.triangles.extend([[b, c, d], [b, d, a]]);
        }
    }

    fn add(&mut self, other: Shape) {
        let shift = self.vertices.len();
        self.vertices.extend(other.vertices);
        self.triangles.extend(other.triangles.into_iter().map(|t| t.map(|i| i + shift)));
    }
}

/// Closed rings of equally many points, bottom to top, each counter-clockwise seen from above, closed by a point below and a point above.
fn stacked(bottom: Point, rings: &[Vec<Point>], top: Point) -> Shape {
    let mut shape = Shape::default();
    let n = rings.first().map_or(0, Vec::len);
    let bottom = shape.vertex(bottom);
    let ids: Vec<Vec<usize>> = rings.iter().map(|ring| ring.iter().map(|p| shape.vertex(*p)).collect()).collect();
    let top = shape.vertex(top);
    for i in 0..n {
        let next = (i + 1) % n;
        shape.triangles.push([bottom, ids[0][next], ids[0][i]]);
        for pair in ids.windows(2) {
            shape.quad([pair[0][i], pair[0][next], pair[1][next], pair[1][i]]);
        }
        shape.triangles.push([ids[ids.len() - 1][i], ids[ids.len() - 1][next], top]);
    }
    shape
}

/// The height field `y(x, z)` over a grid, on a flat floor at y = 0.
fn block(xs: &[f64], zs: &[f64], height: impl Fn(f64, f64) -> f64) -> Shape {
    let mut shape = Shape::default();
    let (nx, nz) = (xs.len(), zs.len());
    for z in zs {
        for x in xs {
            shape.vertex([*x, height(*x, *z), *z]);
        }
    }
    for z in zs {
        for x in xs {
            shape.vertex([*x, 0.0, *z]);
        }
    }
    let up = |i: usize, k: usize| k * nx + i;
    let down = |i: usize, k: usize| nx * nz + k * nx + i;
    for k in 0..nz - 1 {
        for i in 0..nx - 1 {
            shape.quad([up(i, k), up(i, k + 1), up(i + 1, k + 1), up(i + 1, k)]);
            shape.quad([down(i, k), down(i + 1, k), down(i + 1, k + 1), down(i, k + 1)]);
        }
    }
    for i in 0..nx - 1 {
        shape.quad([down(i, nz - 1), down(i + 1, nz - 1), up(i + 1, nz - 1), up(i, nz - 1)]);
        shape.quad([down(i + 1, 0), down(i, 0), up(i, 0), up(i + 1, 0)]);
    }
    for k in 0..nz - 1 {
        shape.quad([down(nx - 1, k + 1), down(nx - 1, k), up(nx - 1, k), up(nx - 1, k + 1)]);
        shape.quad([down(0, k), down(0, k + 1), up(0, k + 1), up(0, k)]);
    }
    shape
}

/// `count` + 1 values from `from` to `to`.
fn steps(from: f64, to: f64, count: u32) -> Vec<f64> {
    (0..=count).map(|i| from + (to - from) * f64::from(i) / f64::from(count)).collect()
}

/// 100 wide, 100 high, 60 deep.
fn cuboid() -> Shape {
    block(&[-50.0, 50.0], &[-30.0, 30.0], |_, _| 100.0)
}

/// The paper's figure 7: one solid body, 160 wide, 100 high, 90 deep, with a waist and a seat that dips in the middle.
fn stool() -> Shape {
    let n = 48;
    // A rounded rectangle (superellipse) of the given half sizes.
    let ring = |a: f64, b: f64, y: f64| -> Vec<Point> {
        (0..n)
            .map(|i| {
                let turn = TAU * f64::from(i) / f64::from(n);
                let round = |x: f64| x.signum() * x.abs().powf(0.5);
                seated([a * round(turn.cos()), y, -b * round(turn.sin())])
            })
            .collect()
    };
    // Half width and height of the side, with rounded rims.
    let rim = 6.0;
    let side = |y: f64| {
        let waist = 1.0 - 0.22 * (PI * (y - rim) / (100.0 - 2.0 * rim)).sin().powi(2);
        (80.0 * waist, 45.0 * (1.0 - 0.5 * (1.0 - waist)))
    };
    let mut rings = Vec::new();
    for inset in [0.25, 0.5, 0.75] {
        rings.push(ring(inset * (80.0 - rim), inset * (45.0 - rim), 0.0));
    }
    for turn in steps(0.0, PI / 2.0, 4) {
        let inward = rim * (1.0 - turn.sin());
        rings.push(ring(80.0 - inward, 45.0 - inward, rim * (1.0 - turn.cos())));
    }
    for y in &steps(rim, 100.0 - rim, 16)[1..] {
        let (a, b) = side(*y);
        rings.push(ring(a, b, *y));
    }
    for turn in &steps(0.0, PI / 2.0, 4)[1..] {
        let inward = rim * (1.0 - turn.cos());
        rings.push(ring(80.0 - inward, 45.0 - inward, 100.0 - rim * (1.0 - turn.sin())));
    }
    for inset in [0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1] {
        rings.push(ring(inset * (80.0 - rim), inset * (45.0 - rim), 100.0));
    }
    stacked([0.0, 0.0, 0.0], &rings, seated([0.0, 100.0, 0.0]))
}

/// The stool's seat: lower in the middle by 12 mm, level with the rims at both ends; the body below follows.
fn seated([x, y, z]: Point) -> Point {
    let dip = 12.0 * (0.5 * PI * x / 80.0).cos().powi(2);
    [x, y * (1.0 - dip / 100.0), z]
}

/// An ellipsoid of half sizes `size`, leaning by `lean_deg` toward +x.
fn ball(center: Point, size: Point, lean_deg: f64) -> Shape {
    let (n, bands) = (28, 16);
    let (sin, cos) = lean_deg.to_radians().sin_cos();
    let place = |[x, y, z]: Point| {
        let [x, y, z] = [x * size[0], y * size[1], z * size[2]];
        [center[0] + x * cos + y * sin, center[1] - x * sin + y * cos, center[2] + z]
    };
    let rings: Vec<Vec<Point>> = (1..bands)
        .map(|band| {
            let polar = PI * f64::from(band) / f64::from(bands);
            (0..n)
                .map(|i| {
                    let turn = TAU * f64::from(i) / f64::from(n);
                    place([polar.sin() * turn.cos(), -polar.cos(), -polar.sin() * turn.sin()])
                })
                .collect()
        })
        .collect();
    stacked(place([0.0, -1.0, 0.0]), &rings, place([0.0, 1.0, 0.0]))
}

/// The paper's figures 1 and 8: 180 high, eight closed bodies that overlap; it faces +z and holds its arms out.
fn teddy() -> Shape {
    let mut shape = ball([0.0, 66.0, 0.0], [42.0, 48.0, 34.0], 0.0);
    shape.add(ball([0.0, 134.0, 1.0], [39.0, 35.0, 33.0], 0.0));
    for side in [-1.0, 1.0] {
        shape.add(ball([side * 31.0, 165.0, -2.0], [15.0, 15.0, 9.0], 0.0));
        shape.add(ball([side * 54.0, 88.0, 2.0], [33.0, 14.5, 14.0], side * -14.0));
        shape.add(ball([side * 26.0, 23.0, 5.0], [21.0, 23.0, 24.0], 0.0));
    }
    shape
}

/// A solid of revolution, 150 high: wide below the middle, narrow at the top.
fn lampshade() -> Shape {
    let n = 56;
    let radius = |y: f64| 38.0 + 14.0 * (1.0 - y / 150.0) + 26.0 * (PI * (y / 150.0).powf(0.8)).sin();
    let ring = |r: f64, y: f64| -> Vec<Point> {
        (0..n)
            .map(|i| {
                let turn = TAU * f64::from(i) / f64::from(n);
                [r * turn.cos(), y, -r * turn.sin()]
            })
            .collect()
    };
    let mut rings = vec![ring(0.5 * radius(0.0), 0.0)];
    rings.extend(steps(0.0, 150.0, 30).into_iter().map(|y| ring(radius(y), y)));
    rings.push(ring(0.5 * radius(150.0), 150.0));
    stacked([0.0; 3], &rings, [0.0, 150.0, 0.0])
}

/// Formwork for a vault: a shallow shell, curved both ways, on a base block; 200 wide, 90 high, 120 deep.
fn shell() -> Shape {
    let mut xs = vec![-100.0];
    xs.extend(steps(-90.0, 90.0, 36));
    xs.push(100.0);
    let base = 20.0;
    block(&xs, &steps(-60.0, 60.0, 16), |x, z| {
        let across = (1.0 - (x / 90.0_f64).powi(2)).max(0.0);
        base + 70.0 * across * (1.0 - 0.3 * (z / 60.0_f64).powi(2))
    })
}
