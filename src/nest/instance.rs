//! Nesting instances and solutions as JSON: the format of jagua-rs 1.x, which reads and writes the strips and bins that research is measured on (ESICUP's
//! sets among them), and its 0.x form with `allowed_orientations`. Lengths have no unit there and count as mm.

use super::format::{
    File, FileBin, FileFixed, FileItem, FileLayout, FilePlacement, FileTransformation, Orientation, Rotation, Shape,
    Solution,
};
use super::{Container, Fixed, Item, Layout, Layouts};
use crate::geom::{P2, Rect, V2};

/// "Any angle" is tried in steps of this, degrees.
const FREE_STEP_DEG: f64 = 15.0;

/// Why a text is no instance.
#[derive(Debug, thiserror::Error)]
pub enum InstanceError {
    /// Not JSON, or not of this form.
    #[error(
        "no nesting instance (jagua-rs JSON: items with id, demand, orientation and shape; strip_height or bins): {0}"
    )]
    Json(#[from] serde_json::Error),
    /// Neither a strip nor bins, or both.
    #[error("an instance needs either strip_height or bins")]
    Containers,
    /// An item that nobody asks for.
    #[error("item {id} is asked for 0 times; give a demand of 1 or more, or leave it out")]
    Demand {
        /// The item's id.
        id: u64,
    },
    /// Nothing to place.
    #[error("the instance has no items; give at least one")]
    Empty,
    /// A step of angles that is none.
    #[error("item {id}: a step of {step} degrees is none to turn by; give 1 to 360")]
    Step {
        /// The item's id.
        id: u64,
        /// What was given, degrees.
        step: f64,
    },
}

/// Items and what they are to be placed on.
#[derive(Debug, Clone, PartialEq)]
pub struct Instance {
    /// What it is called.
    pub name: String,
    /// Distance asked for between items, and to the border, mm.
    pub spacing_mm: f64,
    /// What to place; names are the ids.
    pub items: Vec<Item>,
    /// A roll that is long enough, or sheets.
    pub containers: Vec<Container>,
    /// Where each container has its lower left corner in the file, mm.
    corners: Vec<V2>,
}

impl Instance {
    /// Reads an instance of strip or bin packing.
    pub fn parse(text: &str) -> Result<Instance, InstanceError> {
        let file: File = serde_json::from_str(text)?;
        let mut items = file.items.iter().map(item).collect::<Result<Vec<Item>, _>>()?;
        if items.is_empty() {
            return Err(InstanceError::Empty);
        }
        let (containers, corners) = match (file.strip_height, file.bins) {
            (Some(width_mm), None) => {
                let longest = |i: &Item| {
                    let bounds = Rect::around(&i.polygon);
                    (bounds.max - bounds.min).norm() + file.min_item_separation
                };
                let ends = 2.0 * file.min_item_separation + 1.0;
                let max_length_mm = ends + items.iter().map(|i| f64::from(i.copies) * longest(i)).sum::<f64>();
                (vec![Container::Roll { name: "strip".into(), width_mm, max_length_mm }], vec![V2::zeros()])
            }
            (None, Some(bins)) => bins.iter().map(container).unzip(),
            _ => return Err(InstanceError::Containers),
        };
        for fixed in items.iter_mut().filter_map(|item| item.fixed.as_mut()) {
            fixed.shift -= corners.get(fixed.container).copied().unwrap_or_default();
        }
        Ok(Instance { name: file.name, spacing_mm: file.min_item_separation, items, containers, corners })
    }

    /// Items and containers as an instance. The first roll becomes the strip; else sheets become bins.
    pub fn new(name: &str, items: &[Item], containers: &[Container], spacing_mm: f64) -> Instance {
        let corners = vec![V2::zeros(); containers.len()];
        Instance { name: name.into(), spacing_mm, items: items.to_vec(), containers: containers.to_vec(), corners }
    }

    /// The instance as jagua-rs 1.x reads it; items are numbered in their order.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        let items = self.items.iter().enumerate().map(|(k, item)| FileItem {
            id: k as u64,
            demand: item.copies,
            orientation: Some(Orientation {
                rotation: Rotation::Discrete { angles: item.angles_deg.clone() },
                reflection_axes: if item.mirror { vec![0.0] } else { Vec::new() },
            }),
            allowed_orientations: None,
            priority: item.priority,
            set: item.set,
            fixed: item.fixed.map(|f| {
                let at = f.shift + self.corners.get(f.container).copied().unwrap_or_default();
                FileFixed { container_id: f.container, rotation: f.rotation_deg, translation: at.into() }
            }),
            shape: Shape::SimplePolygon(item.polygon.iter().map(|p| [p.x, p.y]).collect()),
        });
        let strip_height = self.containers.iter().find_map(|c| match c {
            Container::Roll { width_mm, .. } => Some(*width_mm),
            Container::Sheet { .. } => None,
        });
        let bins = self.containers.iter().enumerate().map(|(k, c)| self.bin(k, c));
        let file = File {
            name: self.name.clone(),
            min_item_separation: self.spacing_mm,
            items: items.collect(),
            strip_height,
            bins: strip_height.is_none().then(|| bins.collect()),
        };
        serde_json::to_string(&file)
    }

    fn bin(&self, k: usize, container: &Container) -> FileBin {
        let size = container.size_mm();
        let (outline, blocked) = container.flaws();
        let points = |points: &[P2]| points.iter().map(|p| [p.x, p.y]).collect::<Vec<_>>();
        let rectangle = [[0.0, 0.0], [size.x, 0.0], [size.x, size.y], [0.0, size.y]].to_vec();
        let shape = match (outline.is_empty(), blocked.is_empty()) {
            (true, true) => Shape::Rectangle { x_min: 0.0, y_min: 0.0, width: size.x, height: size.y },
            (false, true) => Shape::SimplePolygon(points(outline)),
            (empty, false) => Shape::Polygon {
                outer: if empty { rectangle } else { points(outline) },
                inner: blocked.iter().map(|b| points(b)).collect(),
            },
        };
        let pieces: u32 = self.items.iter().map(|i| i.copies).sum();
        FileBin { id: k as u64, stock: Some(container.count().unwrap_or(pieces)), cost: container.cost(), shape }
    }

    /// Where an item's outline is moved in the file's coordinates, mm.
    pub fn shift(&self, layout: &Layout, shift: V2) -> V2 {
        shift + self.corners[layout.container]
    }

    /// The layouts as jagua-rs 1.x reads them.
    pub fn solution(&self, layouts: &Layouts) -> Solution {
        let placed = |layout: &Layout| FileLayout {
            container_id: layout.container,
            placed_items: layout
                .placements
                .iter()
                .map(|p| {
                    let shift = self.shift(layout, p.shift);
                    let translation = [shift.x, shift.y];
                    let transformation =
                        FileTransformation { reflected: p.mirrored, rotation: p.rotation_deg, translation };
                    FilePlacement { item_id: p.item as u64, transformation }
                })
                .collect(),
            density: layout.density,
        };
        let area = |l: &Layout| l.width_mm * l.height_mm;
        let all: f64 = layouts.layouts.iter().map(area).sum();
        let filled: f64 = layouts.layouts.iter().map(|l| l.density * area(l)).sum();
        let density = if all > 0.0 { filled / all } else { 0.0 };
        match (self.containers.first(), layouts.layouts.as_slice()) {
            (Some(Container::Roll { .. }), [one]) => Solution {
                strip_width: Some(one.width_mm),
                cost: None,
                layout: Some(placed(one)),
                layouts: None,
                density,
                run_time_sec: 0,
            },
            (_, many) => Solution {
                strip_width: None,
                cost: Some(many.iter().map(|l| self.containers[l.container].cost()).sum()),
                layout: None,
                layouts: Some(many.iter().map(placed).collect()),
                density,
                run_time_sec: 0,
            },
        }
    }
}

fn item(given: &FileItem) -> Result<Item, InstanceError> {
    if given.demand == 0 {
        return Err(InstanceError::Demand { id: given.id });
    }
    let mut angles_deg = match (&given.orientation, &given.allowed_orientations) {
        (Some(Orientation { rotation: Rotation::Discrete { angles }, .. }), _) => angles.clone(),
        (Some(Orientation { rotation: Rotation::Stepped { step }, .. }), _) => match *step {
            step if (1.0..=360.0).contains(&step) => steps(step),
            step => return Err(InstanceError::Step { id: given.id, step }),
        },
        (Some(Orientation { rotation: Rotation::Continuous {}, .. }), _) => steps(FREE_STEP_DEG),
        (None, Some(angles)) => angles.clone(),
        (None, None) => vec![0.0],
    };
    angles_deg.sort_by(f64::total_cmp);
    angles_deg.dedup();
    // Turned over about an axis at a degrees is turned over about x, then turned by 2 a: allowed here where that turn is allowed anyway.
    let axes = given.orientation.as_ref().map_or(&[][..], |o| &o.reflection_axes);
    let over = |a: &f64| angles_deg.iter().all(|b| angles_deg.contains(&((b + 2.0 * a) % 360.0)));
    let mirror = axes.iter().any(over);
    let (polygon, _) = outline(&given.shape);
    let fixed = given.fixed.map(|f| Fixed {
        container: f.container_id,
        rotation_deg: f.rotation,
        shift: V2::from(f.translation),
    });
    let (priority, set) = (given.priority, given.set);
    let item = Item::new(given.id.to_string(), polygon, angles_deg);
    Ok(Item { copies: given.demand, mirror, priority, set, fixed, ..item })
}

fn steps(step: f64) -> Vec<f64> {
    (0..(360.0 / step).round().max(1.0) as u32).map(|k| f64::from(k) * step).collect()
}

/// Border and holes of a shape, the last point not repeated.
fn outline(shape: &Shape) -> (Vec<P2>, Vec<Vec<P2>>) {
    let points = |points: &[[f64; 2]]| {
        let mut points: Vec<P2> = points.iter().map(|p| P2::new(p[0], p[1])).collect();
        if points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        points.dedup();
        points
    };
    match shape {
        Shape::Rectangle { x_min, y_min, width, height } => {
            let (x, y) = (x_min + width, y_min + height);
            (points(&[[*x_min, *y_min], [x, *y_min], [x, y], [*x_min, y]]), Vec::new())
        }
        Shape::SimplePolygon(outer) => (points(outer), Vec::new()),
        Shape::Polygon { outer, inner } => (points(outer), inner.iter().map(|hole| points(hole)).collect()),
    }
}

fn container(bin: &FileBin) -> (Container, V2) {
    let (outline, mut blocked) = outline(&bin.shape);
    let bounds = Rect::around(&outline);
    let corner = bounds.min.coords;
    let moved = |points: &[P2]| points.iter().map(|p| p - corner).collect::<Vec<_>>();
    blocked.iter_mut().for_each(|hole| *hole = moved(hole));
    let container = Container::Sheet {
        name: format!("bin {}", bin.id),
        width_mm: bounds.width(),
        height_mm: bounds.height(),
        count: bin.stock,
        cost: bin.cost,
        outline: if matches!(bin.shape, Shape::Rectangle { .. }) { Vec::new() } else { moved(&outline) },
        blocked,
    };
    (container, corner)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = r#"{"type": "simple_polygon", "data": [[0, 0], [10, 0], [10, 10], [0, 10], [0, 0]]}"#;

    fn parse(orientation: &str, stock: &str) -> Result<Instance, InstanceError> {
        Instance::parse(&format!(
            r#"{{"name": "n", "min_item_separation": 1.5, "items": [{{"id": 3, "demand": 2, {orientation} "shape": {SQUARE}}}], {stock}}}"#
        ))
    }

    fn angles(orientation: &str) -> Vec<f64> {
        parse(orientation, "\"strip_height\": 50").unwrap().items[0].angles_deg.clone()
    }

    #[test]
    fn strips_are_read_in_both_forms_and_corners_are_not_repeated() {
        let strip = parse(r#""allowed_orientations": [0, 180],"#, "\"strip_height\": 50").unwrap();
        let item = &strip.items[0];
        assert_eq!((item.name.as_str(), item.copies, item.polygon.len(), strip.spacing_mm), ("3", 2, 4, 1.5));
        assert!(
            matches!(strip.containers[0], Container::Roll { width_mm: 50.0, max_length_mm, .. } if max_length_mm > 30.0)
        );
        let rotation = |rotation: &str| angles(&format!(r#""orientation": {{"rotation": {rotation}}},"#));
        assert_eq!(rotation(r#"{"mode": "discrete", "angles": [0, 180]}"#), item.angles_deg);
        assert_eq!(rotation(r#"{"mode": "stepped", "step": 90}"#), [0.0, 90.0, 180.0, 270.0]);
        assert_eq!(rotation(r#"{"mode": "continuous"}"#).len(), 24);
        assert_eq!(angles(""), [0.0]);
        let error = parse(r#""orientation": {"rotation": {"mode": "stepped", "step": 0}},"#, "\"strip_height\": 50");
        assert!(matches!(error, Err(InstanceError::Step { id: 3, .. })));
        assert!(matches!(parse("", "\"x\": 1"), Err(InstanceError::Containers)));
    }

    #[test]
    fn bins_elsewhere_than_at_the_origin_are_answered_in_their_own_coordinates() {
        let shape = r#"{"type": "rectangle", "data": {"x_min": 100, "y_min": -5, "width": 40, "height": 20}}"#;
        let bins = parse("", &format!(r#""bins": [{{"id": 0, "stock": 3, "cost": 2, "shape": {shape}}}]"#)).unwrap();
        assert_eq!((bins.containers[0].size_mm(), bins.containers[0].count()), (V2::new(40.0, 20.0), Some(3)));
        let layout = Layout { container: 0, width_mm: 40.0, height_mm: 20.0, placements: Vec::new(), density: 0.0 };
        assert_eq!(bins.shift(&layout, V2::new(1.0, 1.0)), V2::new(101.0, -4.0));
        let fixed = r#""fixed": {"container_id": 0, "rotation": 0, "translation": [101, -4]},"#;
        let there = parse(fixed, &format!(r#""bins": [{{"id": 0, "shape": {shape}}}]"#)).unwrap();
        assert_eq!(there.items[0].fixed.unwrap().shift, V2::new(1.0, 1.0));
    }

    #[test]
    fn what_is_written_is_read_back() {
        let polygon = vec![P2::new(0.0, 0.0), P2::new(30.0, 0.0), P2::new(30.0, 8.0)];
        let some = Item { copies: 4, priority: -2, set: Some(7), ..Item::new("0", polygon.clone(), vec![0.0, 180.0]) };
        let fixed = Some(Fixed { container: 0, rotation_deg: 90.0, shift: V2::new(40.0, 10.0) });
        let items = [some, Item { fixed, ..Item::new("1", polygon.clone(), vec![90.0]) }];
        let mut stock = Container::sheet("bin 0", 200.0, 100.0, Some(2));
        let same = |stock: &Container| {
            let written = Instance::new("n", &items, std::slice::from_ref(stock), 2.0);
            Instance::parse(&written.to_json().unwrap()).unwrap() == written
        };
        assert!(same(&stock));
        if let Container::Sheet { outline, blocked, .. } = &mut stock {
            *outline = [[0.0, 0.0], [200.0, 0.0], [200.0, 100.0]].map(|[x, y]| P2::new(x, y)).to_vec();
            blocked.push(polygon.clone());
        }
        assert!(same(&stock));
    }
}
