//! The rules of a scheme as pictures: which points with which weights make a new one, on a small patch that shows it.
//!
//! ```text
//!    . ---- . ---- .       One step is recorded on a patch around a vertex v, and every new point in the triangle of v, the
//!    |      | \  x |       middle of an edge and the middle of a face is shown: by symmetry that is every rule there is,
//!    . ---- v -x-- .       once. x: an edge point, a face point. Then the same places beside an extraordinary vertex (a
//!    |      |      |       face, for dual schemes) and on a boundary, where the weights are others.
//! ```
//!
//! Nothing is drawn by hand and nothing is known here about any scheme: weights are what [`evaluate`] makes of unit
//! vectors, later passes multiplied out. Limit: what a rule adds beside the weights (a fractal's displacement) is left out, and
//! so is what a later step does otherwise (the boundaries of √3). Cost: about a millisecond.

use crate::mesh::Mesh;
use crate::plan::Plan;
use crate::refine::evaluate;
use crate::scheme::{Accepts, Boundary, Entry, Family, Params};
use crate::soup::Soup;
use crate::weld::Weld;
use std::f64::consts::TAU;

/// The valences that can be asked for.
pub const VALENCES: std::ops::RangeInclusive<u32> = 3..=8;

/// Rings of faces around the middle: more than any scheme's rules reach.
const RINGS: usize = 4;
/// Weights smaller than this are none.
const NOTHING: f64 = 1e-12;
/// Unit vectors that are refined at once.
const WIDE: usize = 8;

/// A rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Stencil {
    /// "Edge point", "Vertex of valence 5".
    pub title: String,
    /// The patch's points in the plane, an edge at the middle about 1 long.
    pub points: Vec<[f64; 2]>,
    /// Its faces: numbers of points, in order round each.
    pub faces: Vec<Vec<u32>>,
    /// Points and their weights, which add up to one.
    pub weights: Vec<(u32, f64)>,
    /// Where the new point comes to lie.
    pub target: [f64; 2],
}

/// A patch, and the triangle that holds every rule: a vertex, the middle of an edge, the middle of a face.
struct Patch {
    points: Vec<[f64; 2]>,
    faces: Vec<Vec<u32>>,
    corner: [[f64; 2]; 3],
}

/// A new point: where it is, and its weights.
struct New {
    at: [f64; 2],
    weights: Vec<(u32, f64)>,
}

/// The rules of a scheme: on a regular patch, then what is different at an extraordinary vertex (a face of dual schemes) of
/// `valence`, clamped to [`VALENCES`], then what is different on a boundary.
///
/// Empty where this build has no rules of the scheme.
pub fn stencils(entry: &'static Entry, params: Params, valence: u32) -> Vec<Stencil> {
    let info = &entry.info;
    let triangles = info.accepts == Accepts::Triangles;
    let dual = info.family == Family::Dual;
    let home = Patch::around(if triangles { 6 } else { 4 }, 0, triangles);
    let Some(news) = home.refine(entry, params) else { return Vec::new() };
    // Places of the rules, as weights of the triangle's corners.
    let mut places: Vec<([f64; 3], New)> = Vec::new();
    for new in news {
        let place = home.place(new.at);
        if place.iter().all(|w| *w > -1e-9) {
            places.push((place, new));
        }
    }
    // From the vertex outwards.
    places.sort_by(|a, b| b.0[0].total_cmp(&a.0[0]).then(b.0[1].total_cmp(&a.0[1])));
    let mut out: Vec<Stencil> = Vec::new();
    for (place, new) in &places {
        out.push(home.picture(name(*place, dual), new));
    }
    let valence = valence.clamp(*VALENCES.start(), *VALENCES.end());
    let odd = if dual { Patch::face(valence) } else { Patch::around(valence, 0, triangles) };
    let rim = Patch::around(0, if triangles { 3 } else { 2 }, triangles);
    let what = if dual { format!("face of {valence} corners") } else { format!("valence {valence}") };
    for (patch, what) in [(odd, what), (rim, "boundary".to_owned())] {
        let Some(news) = patch.refine(entry, params) else { continue };
        for (place, regular) in &places {
            let goal = patch.at(*place);
            // Near to the same place, and with about the same weights there: a patch that is not regular is bent by its rules.
            let far = |n: &New| distance(n.at, goal) + 0.5 * home.unlike(regular, &patch, n);
            let near = news.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
            let Some(new) = near.filter(|n| far(n) < 0.6 && !alike(&n.weights, &regular.weights)) else { continue };
            out.push(patch.picture(format!("{}, {what}", name(*place, dual)), new));
        }
    }
    out
}

/// What a scheme makes of the rim of an open mesh, in a few words: told from the weights of its new points there.
pub fn boundary(entry: &'static Entry, params: Params) -> &'static str {
    let info = &entry.info;
    let triangles = info.accepts == Accepts::Triangles;
    let rim = Patch::around(0, if triangles { 3 } else { 2 }, triangles);
    let on = |v: u32| rim.points[v as usize][1].abs() < 1e-9;
    let rows: Vec<Vec<f64>> = (rim.refine(entry, params).unwrap_or_default().into_iter())
        // Those that read the rim alone, near its middle.
        .filter(|n| n.at[0].abs() < 1.1 && n.weights.iter().all(|w| on(w.0)))
        .map(|n| {
            let mut weights: Vec<f64> = n.weights.iter().map(|w| w.1).collect();
            weights.sort_by(|a, b| b.total_cmp(a));
            weights
        })
        .collect();
    let has = |mask: &[f64]| {
        rows.iter().any(|r| r.len() == mask.len() && r.iter().zip(mask).all(|(a, b)| (a - b).abs() < 1e-9))
    };
    match () {
        () if has(&[0.75, 0.125, 0.125]) && has(&[0.5, 0.5]) => "a cubic B-spline of the rim's vertices alone",
        () if has(&[0.5625, 0.5625, -0.0625, -0.0625]) && has(&[1.0]) => {
            "the four-point curve, which passes through the rim's vertices"
        }
        () if has(&[0.75, 0.25]) => "Chaikin's curve, a quadratic B-spline of the rim's vertices alone",
        () if has(&[1.0]) && (has(&[0.5, 0.5]) || rows.iter().all(|r| r.len() == 1)) => {
            "kept: straight edges stay straight"
        }
        () if rows.is_empty() => "it follows from the faces beside it, as below",
        () => "a curve of the rim's vertices alone, as below",
    }
}

/// A weight as people write it: a fraction where it is one of a small denominator, else three digits.
pub fn fraction(weight: f64) -> String {
    // Weights of valences have their squares below the bar; masks that are multiplied out have powers of two.
    for q in (1..=400u32).chain([512, 1024, 2048, 4096]) {
        let p = weight * f64::from(q);
        if (p - p.round()).abs() < 1e-9 {
            let (p, sign) = (p.round().abs(), if p < -0.5 { "−" } else { "" });
            return if q == 1 { format!("{sign}{p}") } else { format!("{sign}{p}/{q}") };
        }
    }
    format!("{weight:.3}").replace('-', "−")
}

/// What stands at a place of the triangle (vertex, middle of the edge, middle of the face).
fn name(place: [f64; 3], dual: bool) -> String {
    let [v, e, f] = place.map(|w| w > 1.0 - 1e-6);
    let plain = match (v, e, f) {
        (true, ..) => "Vertex point",
        (_, true, _) => "Edge point",
        (.., true) => "Face point",
        _ if dual => "Corner of a face",
        _ if place[2].abs() < 1e-6 => return format!("Point at {} of an edge", fraction(place[1] / 2.0)),
        _ => "Inner point",
    };
    plain.to_owned()
}

/// Whether the two have the same weights in any order.
fn alike(a: &[(u32, f64)], b: &[(u32, f64)]) -> bool {
    let sorted = |weights: &[(u32, f64)]| {
        let mut w: Vec<f64> = weights.iter().map(|w| w.1).collect();
        w.sort_by(f64::total_cmp);
        w
    };
    a.len() == b.len() && sorted(a).iter().zip(sorted(b)).all(|(a, b)| (a - b).abs() < 1e-9)
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let [x, y] = [a[0] - b[0], a[1] - b[1]];
    (x * x + y * y).sqrt()
}

fn mean<'a>(points: impl IntoIterator<Item = &'a [f64; 2]>) -> [f64; 2] {
    let (mut sum, mut n) = ([0.0; 2], 0.0);
    for p in points {
        (sum, n) = ([sum[0] + p[0], sum[1] + p[1]], n + 1.0);
    }
    sum.map(|x| x / n)
}

impl Patch {
    /// Rings of triangles or quads around a vertex: all round with `closed` sectors, or half round with `open` ones.
    fn around(closed: u32, open: u32, triangles: bool) -> Patch {
        let (sectors, turn) = if open > 0 { (open, TAU / 2.0) } else { (closed, TAU) };
        let spoke = |k: u32| {
            let angle = turn * f64::from(k) / f64::from(sectors);
            [libm::cos(angle), libm::sin(angle)]
        };
        let mut points: Vec<[f64; 2]> = Vec::new();
        let mut faces = Vec::new();
        for k in 0..sectors {
            let (u, v) = (spoke(k), spoke(k + 1));
            let mut vertex = |i: usize, j: usize| {
                let (i, j) = (i as f64, j as f64);
                let p = [i * u[0] + j * v[0], i * u[1] + j * v[1]];
                points.iter().position(|q| distance(*q, p) < 1e-6).unwrap_or_else(|| {
                    points.push(p);
                    points.len() - 1
                }) as u32
            };
            for i in 0..RINGS {
                for j in 0..RINGS {
                    if !triangles {
                        faces.push(vec![vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                    } else if i + j < RINGS {
                        faces.push(vec![vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)]);
                        if i + j + 1 < RINGS {
                            faces.push(vec![vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                        }
                    }
                }
            }
        }
        Patch::with(points, faces)
    }

    /// A face of `n` corners with a ring of quads around it, four faces at each of its corners.
    fn face(n: u32) -> Patch {
        let radius = 0.5 / libm::sin(TAU / f64::from(2 * n));
        let middle = [0.0, radius];
        let on = |k: u32, r: f64| {
            let angle = TAU * (f64::from(k % n) / f64::from(n) - 0.25);
            [middle[0] + r * libm::cos(angle), middle[1] + r * libm::sin(angle)]
        };
        let mut points: Vec<[f64; 2]> = (0..n).map(|k| on(k, radius)).collect();
        let mut faces = vec![(0..n).collect::<Vec<u32>>()];
        let outward = |k: u32| {
            let (a, b) = (on(k, 1.0), on(k + 1, 1.0));
            let d = [a[0] + b[0] - 2.0 * middle[0], a[1] + b[1] - 2.0 * middle[1]];
            let length = libm::hypot(d[0], d[1]);
            d.map(|x| x / length)
        };
        // Of each corner: outward across the edge after it and the edge before it, and the tip between the two.
        for k in 0..n {
            let (p, a, b) = (points[k as usize], outward(k), outward(k + n - 1));
            points.push([p[0] + a[0], p[1] + a[1]]);
            points.push([p[0] + b[0], p[1] + b[1]]);
            points.push([p[0] + a[0] + b[0], p[1] + a[1] + b[1]]);
        }
        for k in 0..n {
            let (own, next) = (n + 3 * k, n + 3 * ((k + 1) % n));
            faces.push(vec![k, own, next + 1, (k + 1) % n]);
            faces.push(vec![k, own + 1, own + 2, own]);
        }
        Patch::with(points, faces)
    }

    /// The triangle is that of the first face's first corner, and of the edge that follows it.
    fn with(points: Vec<[f64; 2]>, faces: Vec<Vec<u32>>) -> Patch {
        let first = &faces[0];
        let at = |i: usize| points[first[i] as usize];
        let centre = mean(first.iter().map(|&v| &points[v as usize]));
        let corner = [at(0), mean([&at(0), &at(1)]), centre];
        Patch { points, faces, corner }
    }

    /// All new points of one step; none where this build has no rules of the scheme.
    fn refine(&self, entry: &'static Entry, params: Params) -> Option<Vec<New>> {
        let positions = self.points.iter().map(|p| [p[0] as f32, p[1] as f32, 0.0]).collect();
        let (mesh, _) = Mesh::build(&Soup::from_faces(positions, &self.faces), Weld::Off).ok()?;
        let plan = Plan { params, ..Plan::new(entry, Boundary::default(), 1) };
        let count = self.points.len();
        let mut news: Vec<New> = Vec::new();
        for from in (0..count).step_by(WIDE) {
            let unit = |v: u32| {
                let mut unit = [0.0; WIDE];
                if let Some(slot) = (mesh.vertex_source[v as usize] as usize).checked_sub(from)
                    && slot < WIDE
                {
                    unit[slot] = 1.0;
                }
                unit
            };
            let values: Vec<[f64; WIDE]> = (0..mesh.positions.len() as u32).map(unit).collect();
            let refined = evaluate(&mesh, &plan, &values, |_| ()).ok()?;
            news.resize_with(refined.len(), || New { at: [0.0; 2], weights: Vec::new() });
            for (new, row) in news.iter_mut().zip(refined) {
                for (slot, weight) in row.into_iter().enumerate().filter(|w| w.1.abs() > NOTHING) {
                    let p = self.points[from + slot];
                    new.at = [new.at[0] + weight * p[0], new.at[1] + weight * p[1]];
                    new.weights.push(((from + slot) as u32, weight));
                }
            }
        }
        Some(news)
    }

    /// A point as weights of the triangle's corners.
    fn place(&self, p: [f64; 2]) -> [f64; 3] {
        let [a, b, c] = self.corner;
        let area =
            |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let whole = area(a, b, c);
        [area(p, b, c) / whole, area(a, p, c) / whole, area(a, b, p) / whole]
    }

    /// The inverse of [`Self::place`].
    fn at(&self, [u, v, w]: [f64; 3]) -> [f64; 2] {
        let [a, b, c] = self.corner;
        [u * a[0] + v * b[0] + w * c[0], u * a[1] + v * b[1] + w * c[1]]
    }

    /// How much two rules differ at the first face's first corner and the two beside it.
    fn unlike(&self, own: &New, patch: &Patch, other: &New) -> f64 {
        let weight = |new: &New, v: u32| new.weights.iter().find(|w| w.0 == v).map_or(0.0, |w| w.1);
        let ends = |face: &[u32]| [face[0], face[1], face[face.len() - 1]];
        let pairs = ends(&self.faces[0]).into_iter().zip(ends(&patch.faces[0]));
        pairs.map(|(a, b)| (weight(own, a) - weight(other, b)).abs()).sum()
    }

    /// The part of the patch that a rule reads, and the faces around its target.
    fn picture(&self, title: String, new: &New) -> Stencil {
        let reads = |v: &u32| new.weights.iter().any(|w| w.0 == *v);
        let near = |v: &u32| reads(v) && distance(self.points[*v as usize], new.at) < 0.4;
        let all = |face: &[u32]| face.iter().all(reads);
        let some = |face: &[u32]| face.iter().filter(|v| reads(v)).count() > 1 || face.iter().any(near);
        // Faces that are read whole where those hold all that is read, else those that meet along it.
        let whole = new.weights.iter().all(|w| self.faces.iter().any(|f| f.contains(&w.0) && all(f)));
        let mut number = vec![u32::MAX; self.points.len()];
        let mut points = Vec::new();
        let mut faces = Vec::new();
        for face in self.faces.iter().filter(|f| if whole { all(f) } else { some(f) }) {
            let corner = |v: &u32| {
                let slot = &mut number[*v as usize];
                if *slot == u32::MAX {
                    *slot = points.len() as u32;
                    points.push(self.points[*v as usize]);
                }
                *slot
            };
            faces.push(face.iter().map(corner).collect());
        }
        let weights = new.weights.iter().map(|&(v, w)| (number[v as usize], w)).filter(|w| w.0 != u32::MAX).collect();
        Stencil { title, points, faces, weights, target: new.at }
    }
}
