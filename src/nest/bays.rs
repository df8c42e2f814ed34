//! Containers become bays: margins taken off, and what is blocked as bodies that never move.

use super::item::flaw;
use super::scene::{Bay, Body, Pose, Scene};
use super::shape::Shape;
use super::{Container, Error, Settings};
use crate::geom::{P2, Rect, V2, signed_area};
use std::rc::Rc;

/// Frame around a sheet that stands for everything outside it, mm: wider than any round-off.
const FRAME_MM: f64 = 1.0;

/// A container made ready.
pub(super) struct Ground {
    /// Its bay, empty.
    pub(super) bay: Bay,
    /// Area of the bay that is not blocked, mm2.
    pub(super) area: f64,
    pub(super) cost: f64,
    pub(super) count: Option<u32>,
    /// What is blocked, in its place.
    blocked: Vec<Rc<[Shape]>>,
}

/// All containers, made ready.
pub(super) struct Grounds {
    pub(super) grounds: Vec<Ground>,
    /// From a bay's corner to the container's.
    pub(super) offset: V2,
}

impl Grounds {
    /// Checks the containers and takes the margins off. Boxes carry half the spacing on every side, so bays are larger by as much.
    pub(super) fn new(containers: &[Container], settings: &Settings, within: f64) -> Result<Grounds, Error> {
        let half = 0.5 * settings.spacing_mm;
        let offset = V2::repeat(settings.margin_mm - half);
        let ready = containers.iter().enumerate().map(|(k, container)| {
            check(container)?;
            let size = container.size_mm() - 2.0 * offset;
            let (outline, blocked) = container.flaws();
            let mut area = size.x.max(0.0) * size.y.max(0.0);
            let mut shapes: Vec<Shape> =
                blocked.iter().map(|b| Shape::new(std::slice::from_ref(b), within, half)).collect();
            area -= blocked.iter().map(|b| signed_area(b).abs()).sum::<f64>();
            if !outline.is_empty() {
                area = area.min(signed_area(outline).abs());
                shapes.push(Shape::new(&[frame(container), outline.to_vec()], within, offset.x.max(0.0)));
            }
            let bay = Bay { container: k, width: size.x, height: size.y };
            let blocked = shapes.into_iter().map(|s| Rc::from(vec![s])).collect();
            Ok(Ground { bay, area, cost: container.cost(), count: container.count(), blocked })
        });
        Ok(Grounds { grounds: ready.collect::<Result<_, Error>>()?, offset })
    }

    /// Opens another bay.
    pub(super) fn open(&self, scene: &mut Scene, container: usize) -> usize {
        let ground = &self.grounds[container];
        let bay = scene.bays.len();
        scene.bays.push(ground.bay);
        for turns in &ground.blocked {
            let at = turns[0].origin - self.offset;
            scene.bodies.push(Body { turns: turns.clone(), fixed: true });
            scene.poses.push(Pose { turn: 0, bay, x: at.x, y: at.y });
        }
        bay
    }

    /// Whether there is one more of a container than the scene uses.
    pub(super) fn has_more(&self, scene: &Scene, container: usize) -> bool {
        let used = scene.bays.iter().filter(|b| b.container == container).count();
        self.grounds[container].count.is_none_or(|count| used < count as usize)
    }
}

fn frame(container: &Container) -> Vec<P2> {
    let size = container.size_mm();
    let Rect { min, max } = Rect::from_size(size.x, size.y).grown(FRAME_MM);
    vec![min, P2::new(max.x, min.y), max, P2::new(min.x, max.y)]
}

fn check(container: &Container) -> Result<(), Error> {
    let size = container.size_mm();
    let name = || container.name().to_string();
    if !size.iter().all(|v| v.is_finite() && *v > 0.0) {
        return Err(Error::ContainerSize { container: name(), width_mm: size.x, height_mm: size.y });
    }
    let cost = container.cost();
    if !(cost.is_finite() && cost >= 0.0) {
        return Err(Error::Cost { container: name(), cost });
    }
    let (outline, blocked) = container.flaws();
    let loops = (!outline.is_empty()).then_some(outline).into_iter().chain(blocked.iter().map(Vec::as_slice));
    match loops.filter_map(flaw).next() {
        Some(flaw) => Err(Error::ContainerShape { container: name(), flaw }),
        None => Ok(()),
    }
}
