//! From items and containers to layouts: starts, fewer sheets, shorter ones, checked.

use super::bays::Grounds;
use super::gather::{gather, settle};
use super::item::{self, Prepared};
use super::look::Look;
use super::scene::{Body, Pose, Scene};
use super::separate::Separator;
use super::shorten::Shorten;
use super::start;
use super::watch::Watch;
use super::{Container, Error, Item, Layouts, Settings, validate};
use crate::progress::Observer;

/// Starts may take this share of the effort; the first is always made.
const START_SHARE: f64 = 0.1;
/// Share of the effort for getting by with less stock.
const FEWER_SHARE: f64 = 0.6;
/// More are refused: every two of them have a weight and a depth to remember, 150 MB by then.
const MOST_PIECES: u64 = 3000;
/// Should a layout fail validation, everything is made once more with so much more room around items, mm.
const MORE_ROOM_MM: f64 = 1e-3;

/// Places every item on the least stock this method finds, then on the shortest length of the layout that is used least.
///
/// Stock is preferred in the order given where it costs the same. The observer is called all along; when it stops the search, the best so far is
/// returned. Items that find no place are in [`Layouts::unplaced`] with the reason, those of lowest priority first.
///
/// # Errors
/// Distances, containers or items that make no sense, and fixed items that lie where they must not. Whatever [`validate`] finds wrong with a layout is an
/// error too: such a layout never leaves this function.
pub fn nest(
    items: &[Item],
    containers: &[Container],
    settings: &Settings,
    observer: &mut dyn Observer,
) -> Result<Layouts, Error> {
    for (name, value_mm) in [("spacing", settings.spacing_mm), ("margin", settings.margin_mm)] {
        if !(value_mm.is_finite() && value_mm >= 0.0) {
            return Err(Error::Distance { name, value_mm });
        }
    }
    if containers.is_empty() {
        return Err(Error::NoContainer);
    }
    let pieces: u64 = items.iter().map(|item| u64::from(item.copies)).sum();
    if pieces > MOST_PIECES {
        return Err(Error::TooMany { pieces, most: MOST_PIECES });
    }
    let mut outcome = made(items, containers, settings, observer, 0.0)?;
    if outcome.1.is_err() {
        outcome = made(items, containers, settings, observer, MORE_ROOM_MM)?;
    }
    outcome.1.map(|()| outcome.0)
}

/// Layouts, and what validation says of them.
fn made(
    items: &[Item],
    containers: &[Container],
    settings: &Settings,
    observer: &mut dyn Observer,
    more_room_mm: f64,
) -> Result<(Layouts, Result<(), Error>), Error> {
    let ready = item::prepared(items, 0.5 * settings.spacing_mm + more_room_mm)?;
    let grounds = Grounds::new(containers, settings, item::roughness(items))?;
    let copies = items.iter().enumerate().flat_map(|(i, item)| (0..item.copies).map(move |copy| (i, copy))).collect();
    let job = Job { items, containers, settings, ready, grounds, copies };
    let layouts = job.run(observer)?;
    let verdict = validate(items, containers, &layouts, settings);
    Ok((layouts, verdict))
}

/// Which comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    BoxArea,
    LongSide,
    ShortSide,
}

/// How good a layout is, the smallest best: bodies without a place, cost, bays, index of stock, used length.
type Score = (usize, f64, usize, usize, f64);

/// Everything given, made ready.
pub(super) struct Job<'a> {
    pub(super) items: &'a [Item],
    pub(super) containers: &'a [Container],
    settings: &'a Settings,
    pub(super) ready: Vec<Prepared>,
    pub(super) grounds: Grounds,
    /// Item and copy of every body that is one; they come first.
    pub(super) copies: Vec<(usize, u32)>,
}

impl Job<'_> {
    fn run(&self, observer: &mut dyn Observer) -> Result<Layouts, Error> {
        let effort = self.settings.effort;
        let mut watch = Watch::new(observer, effort);
        let mut scene = self.started(&mut watch)?;
        let mut separator = Separator::new(&scene, self.settings.seed);
        let share = |share: f64| (effort as f64 * share) as u64;
        self.house_all(&mut scene, &mut separator, &mut watch, share(FEWER_SHARE));
        self.fewer(&mut scene, &mut separator, &mut watch, share(FEWER_SHARE));
        self.shorter(&mut scene, &mut separator, &mut watch, effort);
        let sets: Vec<Option<u32>> = self.copies.iter().map(|(item, _)| self.items[*item].set).collect();
        gather(&mut scene, &sets);
        if effort > 0 {
            settle(&mut scene);
        }
        Ok(self.layouts(&scene, watch.stopped))
    }

    /// The best of some starts.
    fn started(&self, watch: &mut Watch) -> Result<Scene, Error> {
        let empty = self.with_fixed()?;
        let mut best: Option<(Score, Scene)> = None;
        let mut looked = 0;
        'starts: for largest_stock in [false, true] {
            for order in [Order::BoxArea, Order::LongSide, Order::ShortSide] {
                if best.is_some() && (looked as f64 > START_SHARE * self.settings.effort as f64 || watch.stopped) {
                    break 'starts;
                }
                let mut scene = empty.clone();
                let order = self.ordered(&scene, order);
                start::place(&mut scene, &order, watch, |scene, body| self.opened(scene, body, largest_stock));
                looked += scene.looked;
                let score = self.score(&scene);
                if best.as_ref().is_none_or(|(b, _)| score < *b) {
                    best = Some((score, scene));
                }
            }
        }
        let (_, mut scene) = best.expect("the first start is always made");
        scene.looked = looked;
        watch.tell(self.note(&scene));
        Ok(scene)
    }

    /// Only what is fixed, on the first sheet of its kind.
    fn with_fixed(&self) -> Result<Scene, Error> {
        let body = |(item, _): &(usize, u32)| Body {
            turns: self.ready[*item].shapes.clone(),
            fixed: self.items[*item].fixed.is_some(),
        };
        let mut scene = Scene::new(self.copies.iter().map(body).collect());
        for (body, (item, _)) in self.copies.iter().enumerate() {
            let Some(fixed) = self.items[*item].fixed else { continue };
            if fixed.container >= self.containers.len() {
                return Err(Error::Dangling { layout: 1, what: "container", index: fixed.container });
            }
            let open = scene.bays.iter().position(|b| b.container == fixed.container);
            let bay = open.unwrap_or_else(|| self.grounds.open(&mut scene, fixed.container));
            let at = scene.shape(body, 0).origin + fixed.shift - self.grounds.offset;
            scene.poses[body] = Pose { turn: 0, bay, x: at.x, y: at.y };
        }
        Ok(scene)
    }

    fn ordered(&self, scene: &Scene, order: Order) -> Vec<usize> {
        let key = |b: usize| {
            let (long, short) = scene.sides(b);
            match order {
                Order::BoxArea => long * short,
                Order::LongSide => long,
                Order::ShortSide => short,
            }
        };
        let priority = |b: usize| self.items[self.copies[b].0].priority;
        let mut bodies = scene.homeless();
        bodies.sort_by(|a, b| priority(*b).cmp(&priority(*a)).then(key(*b).total_cmp(&key(*a))));
        bodies
    }

    /// Opens a bay for a body: the first kind of stock that holds it, or the one with most room for its cost.
    fn opened(&self, scene: &mut Scene, body: usize, largest: bool) -> Option<Pose> {
        let mut kinds: Vec<usize> = (0..self.containers.len()).filter(|k| self.grounds.has_more(scene, *k)).collect();
        if largest {
            let worth = |k: usize| self.grounds.grounds[k].area / self.grounds.grounds[k].cost;
            kinds.sort_by(|a, b| worth(*b).total_cmp(&worth(*a)));
        }
        let mut look = Look::default();
        kinds.into_iter().find_map(|kind| {
            let bay = self.grounds.open(scene, kind);
            let pose = start::leftmost(scene, &mut look, body, bay);
            if pose.is_none() {
                scene.close(bay);
            }
            pose
        })
    }

    fn score(&self, scene: &Scene) -> Score {
        let cost = scene.bays.iter().map(|b| self.grounds.grounds[b.container].cost).sum();
        let index = scene.bays.iter().map(|b| b.container).sum();
        let used = (0..scene.bays.len()).map(|b| scene.used(b, self.copies.len())).sum();
        (scene.homeless().len(), cost, scene.bays.len(), index, used)
    }

    /// Shortens the bay with the least on it.
    fn shorter(&self, scene: &mut Scene, separator: &mut Separator, watch: &mut Watch, until: u64) {
        let n = self.copies.len();
        let emptiest = (0..scene.bays.len()).min_by(|a, b| scene.used(*a, n).total_cmp(&scene.used(*b, n)));
        let Some(bay) = emptiest else { return };
        let widest = |b: usize| {
            let own = scene.bodies[b].turns.iter().filter(|t| t.size.y <= scene.bays[bay].height + super::NARROW_MM);
            own.map(|t| t.size.x).fold(f64::INFINITY, f64::min)
        };
        let movable: Vec<usize> = scene.movable(bay).collect();
        let fixed = (0..n).filter(|b| scene.bodies[*b].fixed && scene.poses[*b].bay == bay).map(|b| scene.right(b));
        let alone = if scene.bays.len() == 1 { self.area() / scene.bays[bay].height } else { 0.0 };
        let least = movable.iter().map(|b| widest(*b)).chain(fixed).fold(alone, f64::max);
        if movable.is_empty() {
            return;
        }
        Shorten { scene, separator, watch, bay, items: n, least }.run(until, |scene| self.note(scene));
    }

    /// Area of all items, mm2.
    pub(super) fn area(&self) -> f64 {
        self.copies.iter().map(|(item, _)| self.ready[*item].area).sum()
    }

    /// "3 sheets, 71 % filled".
    pub(super) fn note(&self, scene: &Scene) -> String {
        let sheets = scene.bays.len();
        let used: f64 = (0..sheets).map(|b| scene.used(b, self.copies.len()) * scene.bays[b].height).sum();
        let filled = if used > 0.0 { 100.0 * self.area() / used } else { 0.0 };
        format!("{sheets} {}, {filled:.1} % filled", if sheets == 1 { "sheet" } else { "sheets" })
    }
}
