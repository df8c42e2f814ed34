//! Finds the section lengths at which a strip costs least: a projected quasi-Newton descent (BFGS, Nocedal and Wright 2006, chapter 6) over lengths within bounds and a
//! shift to the side.

use super::Error;
use super::shape::Shape;
use crate::progress::Observer;
use nalgebra::{DMatrix, DVector};

/// What a descent may change, and how long it may go on.
#[derive(Debug, Clone)]
pub(super) struct Limits {
    /// Shortest and longest of each section, mm; the same where its length is not to change.
    pub bounds_mm: Vec<[f64; 2]>,
    /// Whether the whole may shift to the side.
    pub shift: bool,
    /// Steps at most.
    pub steps: usize,
    /// A run that wins less than this share of the outline's area a step ends.
    pub least_gain: f64,
}

/// Longest change of a section in one step, as a share of the outline's size (6 mm of 100).
const LONGEST_STEP: f64 = 0.06;
/// What moving a millimetre of border by a millimetre is taken to change its slope by at first, mm² per mm: a first step goes for the border to move by a millimetre or
/// two where all it sweeps is won.
const FIRST_CURVATURE: f64 = 2.0;
/// What a change of length costs by itself, against what it does to the shape.
const LENGTH_WEIGHT: f64 = 0.3;
/// What a run wins is judged over so many steps.
const JUDGED_STEPS: usize = 8;
/// Runs of a descent.
const RUNS: usize = 2;
/// Sufficient decrease (Armijo 1966).
const ARMIJO: f64 = 1e-4;
/// Shares of a step that are tried.
const SHARES: [f64; 6] = [1.0, 0.4, 0.12, 0.03, 0.008, 0.002];

/// Lowers the shape's cost. Once it hardly falls any more, what was learned of its curvature is dropped and the descent begins anew, once: touching loops bend the
/// cost too much for one picture of it. Returns early when the observer asked to stop.
pub(super) fn descend(shape: &mut Shape, limits: &Limits, observer: &mut dyn Observer) -> Result<(), Error> {
    let mut steps = limits.steps;
    for _ in 0..RUNS {
        steps = run(shape, limits, steps, observer)?;
    }
    Ok(())
}

/// One run of at most `steps` steps, until the cost hardly falls; returns how many are left.
fn run(shape: &mut Shape, limits: &Limits, mut steps: usize, observer: &mut dyn Observer) -> Result<usize, Error> {
    let n = limits.bounds_mm.len();
    let area_mm2 = shape.judge.area_mm2();
    let (Some(mut slope), Some(mut inverse)) = (slopes(shape, limits)?, natural(shape)?) else { return Ok(0) };
    let mut is_fresh = true;
    let mut costs = vec![shape.cost];
    while steps > 0 {
        let lengths: Vec<f64> = (0..n).map(|s| shape.ruffle.section_length(s)).collect();
        let step = direction(&inverse, &slope, &lengths, limits, LONGEST_STEP * area_mm2.sqrt());
        let Some(moved) = walk(shape, limits, &lengths, &slope, &step, observer)? else {
            if is_fresh {
                break;
            }
            let Some(fresh) = natural(shape)? else { return Ok(0) };
            (inverse, is_fresh) = (fresh, true);
            continue;
        };
        steps -= 1;
        costs.push(shape.cost);
        if let Some(before) = costs.len().checked_sub(1 + JUDGED_STEPS)
            && costs[before] - shape.cost < limits.least_gain * JUDGED_STEPS as f64 * area_mm2
        {
            break;
        }
        let Some(next) = slopes(shape, limits)? else { return Ok(0) };
        let change = &next - &slope;
        if is_fresh {
            // The first step has shown how fast slopes change (Nocedal and Wright, equation 6.20).
            let (curvature, bent) = (moved.dot(&change), change.dot(&(&inverse * &change)));
            if curvature > 0.0 && bent > 0.0 {
                inverse *= curvature / bent;
            }
        }
        is_fresh = !update(&mut inverse, &moved, &change) && is_fresh;
        slope = next;
    }
    Ok(steps)
}

/// Goes the largest share of a step at which the strip comes to rest at a lower cost, and returns how far that was; nothing where there is none.
fn walk(
    shape: &mut Shape,
    limits: &Limits,
    lengths: &[f64],
    slope: &DVector<f64>,
    step: &DVector<f64>,
    observer: &mut dyn Observer,
) -> Result<Option<DVector<f64>>, Error> {
    let (n, fall) = (lengths.len(), -slope.dot(step));
    if fall <= 0.0 {
        return Ok(None);
    }
    for share in SHARES {
        let to: Vec<f64> = (0..n).map(|s| clamped(lengths[s] + share * step[s], limits.bounds_mm[s])).collect();
        let limit = shape.cost - ARMIJO * share * fall;
        if shape.take(&to, share * step[n], limit, observer)? {
            return Ok(Some(DVector::from_fn(n + 1, |i, _| if i < n { to[i] - lengths[i] } else { share * step[n] })));
        }
    }
    Ok(None)
}

/// The inverse Hessian to begin with: that of the square of the distance that border nodes move. So the first step is the steepest in the shape, not in the lengths: a
/// stack so soft that a millimetre of length tips it gets small steps.
fn natural(shape: &mut Shape) -> Result<Option<DMatrix<f64>>, Error> {
    let Some(mut metric) = shape.metric()? else { return Ok(None) };
    let segment_mm = shape.ruffle.strip_length() / shape.ruffle.rest_lengths.len() as f64;
    for i in 0..metric.nrows() {
        metric[(i, i)] += LENGTH_WEIGHT;
    }
    metric *= FIRST_CURVATURE * segment_mm;
    Ok(metric.try_inverse())
}

fn clamped(value: f64, [low, high]: [f64; 2]) -> f64 {
    value.max(low).min(high)
}

fn slopes(shape: &mut Shape, limits: &Limits) -> Result<Option<DVector<f64>>, Error> {
    let Some((by_length, by_shift)) = shape.slopes()? else { return Ok(None) };
    let shift = if limits.shift { by_shift } else { 0.0 };
    Ok(Some(DVector::from_iterator(by_length.len() + 1, by_length.into_iter().chain([shift]))))
}

/// The step, with lengths that would leave their bounds left as they are, none longer than `longest_mm`.
fn direction(
    inverse: &DMatrix<f64>,
    slope: &DVector<f64>,
    lengths: &[f64],
    limits: &Limits,
    longest_mm: f64,
) -> DVector<f64> {
    let mut free = slope.clone();
    for (s, [low, high]) in limits.bounds_mm.iter().copied().enumerate() {
        let stuck = lengths[s] <= low && slope[s] > 0.0 || lengths[s] >= high && slope[s] < 0.0 || low >= high;
        if stuck {
            free[s] = 0.0;
        }
    }
    let mut step = -(inverse * &free);
    for (i, f) in free.iter().enumerate() {
        if *f == 0.0 {
            step[i] = 0.0;
        }
    }
    let longest = step.amax();
    if longest > longest_mm {
        step *= longest_mm / longest;
    }
    step
}

/// Takes in what a step has shown about the curvature; false where it curves down.
fn update(inverse: &mut DMatrix<f64>, moved: &DVector<f64>, change: &DVector<f64>) -> bool {
    let curvature = moved.dot(change);
    if curvature <= 1e-8 * moved.norm() * change.norm() {
        return false;
    }
    let bent = &*inverse * change;
    let scale = (curvature + change.dot(&bent)) / (curvature * curvature);
    *inverse += moved * moved.transpose() * scale;
    *inverse -= (&bent * moved.transpose() + moved * bent.transpose()) / curvature;
    true
}
