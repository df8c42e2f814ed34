//! lab
use super::*;
use super::scene::*;
use super::shape::Shape;
use super::separate::*;
use std::ops::ControlFlow;
pub struct Spec { pub items: Vec<(Vec<P2>, Vec<f64>, usize)>, pub height: f64 }
pub fn cpu() -> f64 { let s=std::fs::read_to_string("/proc/self/stat").unwrap(); let f:Vec<&str>=s.rsplit(')').next().unwrap().split_whitespace().collect(); (f[11].parse::<f64>().unwrap()+f[12].parse::<f64>().unwrap())/100.0 }
pub fn strip(spec: &Spec, within: f64, seconds: f64, seed: u64) -> f64 {
    let t0 = cpu();
    let mut bodies = Vec::new();
    let mut area = 0.0;
    for (polygon, angles, count) in &spec.items {
        let turns: std::rc::Rc<[Shape]> = angles.iter().map(|a| {
            let m = Motion::new(V2::zeros(), a.to_radians());
            Shape::new(&[polygon.iter().map(|p| m * p).collect::<Vec<_>>()], within, 0.0)
        }).collect();
        let pieces: usize = turns[0].bands.iter().map(|b| b.lower.len()+b.upper.len()).sum();
        eprintln!("bands {} pieces {} of {} size {:.1} {:.1}", turns[0].bands.len(), pieces, polygon.len(), turns[0].size.x, turns[0].size.y);
        for _ in 0..*count { bodies.push(Body { turns: turns.clone(), fixed: false }); area += crate::geom::signed_area(polygon).abs(); }
    }
    let n = bodies.len();
    let mut order: Vec<usize> = (0..n).collect();
    let key = |b: usize| { let s = bodies[b].turns[0].size; s.x * s.y };
    order.sort_by(|a,b| key(*b).total_cmp(&key(*a)));
    let total: f64 = bodies.iter().map(|b| b.turns[0].size.x).sum();
    let bay = Bay { container: 0, x: 0.0, width: total, height: spec.height };
    let mut scene = Scene::new(bodies, vec![bay], vec![start::UNPLACED; n]);
    let left = start::place_all(&mut scene, &order, |_, _| None);
    let l0 = shorten::used(&scene, 0);
    eprintln!("start {:.3} s: {:.2} ({:.2} %) left {:?} looked {}", cpu()-t0, l0, 100.0*area/spec.height/l0, left, scene.looked);
    let mut sep = Separator::new(&scene, seed);
    // calibrate: use rate
    let until = std::env::var("EVALS").ok().and_then(|v| v.parse().ok()).unwrap_or(u64::MAX/16);
    let mut k = 0u64;
    let least = area / spec.height;
    let until = if seconds > 0.0 { // estimate rate: run 5% then scale
        until } else { until };
    unsafe { shorten::TRACE = std::env::var("TRACE").is_ok(); }
    shorten::shorten(&mut scene, 0, &mut sep, least, until, &mut |_| { k+=1; if seconds>0.0 && k%16==0 && cpu()-t0 > seconds { ControlFlow::Break(()) } else { ControlFlow::Continue(()) } });
    let l = shorten::used(&scene, 0);
    eprintln!("end {:.2} s cpu: {:.2} ({:.2} %) looked {} rate {:.0}/s", cpu()-t0, l, 100.0*area/spec.height/l, scene.looked, scene.looked as f64/(cpu()-t0));
    l
}
