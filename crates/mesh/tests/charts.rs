//! Texture coordinates through every scheme: away from seams they are refined as points are, every face lies in one chart,
//! seams stay seams and fit on both sides, and within a chart there are no cracks.

mod common;

use common::{build, gallery};
use limn_mesh::{
    Boundary, Entry, FaceVarying, Job, Mesh, Params, Plan, Refined, Run, SCHEMES, Soup, predict, refine,
    triangulate_soup,
};
use std::collections::BTreeMap;
use std::sync::Arc;

type Uv = [f32; 2];

fn schemes(mesh: &Mesh) -> impl Iterator<Item = &'static Entry> {
    let shape = mesh.face_shape();
    SCHEMES.iter().filter(move |e| e.info.split(shape, Boundary::EdgeOnly, &Params::default().of(&e.info)).is_some())
}

/// Those that move points by their weights alone: what is random moves nothing else.
fn steady(mesh: &Mesh) -> impl Iterator<Item = &'static Entry> {
    schemes(mesh).filter(|e| !e.info.is_random())
}

/// Schemes whose weights are never negative, so that what they make lies between what it was made from.
fn is_convex(entry: &Entry) -> bool {
    entry.info.group != "interpolating" && entry.info.id != "j-spline"
}

fn corner_uv(level: &Refined, corner: usize) -> Uv {
    let uv = level.uv.as_ref().unwrap();
    uv.values[uv.corners[corner] as usize]
}

/// A grid of `n` by `m` unit squares; the ones right of column `cut` have a chart of their own, `shift` further right.
fn grid(n: u32, m: u32, cut: u32, shift: f32) -> Soup {
    let at = |x: u32, y: u32| x * (m + 1) + y;
    let places = (0..=n).flat_map(|x| (0..=m).map(move |y| (x, y)));
    // Not flat, so that positions and texture coordinates differ.
    let positions = places.clone().map(|(x, y)| [x as f32, y as f32, ((x * y) % 3) as f32 * 0.3]).collect();
    let cells: Vec<(u32, u32)> = (0..n).flat_map(|x| (0..m).map(move |y| (x, y))).collect();
    let faces: Vec<[u32; 4]> =
        cells.iter().map(|&(x, y)| [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]).collect();
    let mut soup = Soup::from_faces(positions, &faces);
    let coordinate = |(x, y): (u32, u32)| [x as f32, y as f32];
    soup.uvs =
        places.clone().map(coordinate).chain(places.map(|p| [coordinate(p)[0] + shift, coordinate(p)[1]])).collect();
    let half = (n + 1) * (m + 1);
    soup.uv_corners =
        faces.iter().zip(&cells).flat_map(|(f, c)| f.map(|v| if c.0 >= cut { half + v } else { v })).collect();
    soup
}

/// A torus of `n` by `m` quads, unwrapped to the unit square with one seam each way.
fn torus(n: u32, m: u32) -> Soup {
    let tau = std::f32::consts::TAU;
    let point = |x: u32, y: u32| {
        let (a, b) = (tau * x as f32 / n as f32, tau * y as f32 / m as f32);
        [(3.0 + b.cos()) * a.cos(), (3.0 + b.cos()) * a.sin(), b.sin()]
    };
    let mut soup =
        Soup { positions: (0..n).flat_map(|x| (0..m).map(move |y| point(x, y))).collect(), ..Soup::default() };
    soup.uvs = (0..=n).flat_map(|x| (0..=m).map(move |y| [x as f32 / n as f32, y as f32 / m as f32])).collect();
    for (x, y) in (0..n).flat_map(|x| (0..m).map(move |y| (x, y))) {
        let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
        soup.push_face(&corners.map(|(x, y)| (x % n) * m + y % m));
        soup.uv_corners.extend(corners.map(|(x, y)| x * (m + 1) + y));
    }
    soup
}

/// A cube whose faces have squares of their own, side 1, three units apart.
fn boxed() -> Soup {
    let mut soup = (limn_mesh::shape("cube").unwrap().build)();
    soup.uvs = (0..6)
        .flat_map(|f| [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|p: Uv| [p[0] + 3.0 * f as f32, p[1]]))
        .collect();
    soup.uv_corners = (0..24).collect();
    soup
}

/// The sides of the faces: for each its faces' corners, first where the side begins in the first face.
fn sides(level: &Refined) -> Vec<[[usize; 2]; 2]> {
    let mut seen: BTreeMap<(u32, u32), [usize; 2]> = BTreeMap::new();
    let mut out = Vec::new();
    for f in 0..level.faces.count() {
        let range = level.faces.range(f);
        for c in range.clone() {
            let d = if c + 1 == range.end { range.start } else { c + 1 };
            let [v, w] = [c, d].map(|c| level.faces.corners()[c]);
            match seen.remove(&(w, v)) {
                Some([x, y]) => out.push([[c, y], [d, x]]),
                None => drop(seen.insert((v, w), [c, d])),
            }
        }
    }
    out
}

/// Mid-edge joins faces at points, where seams may pinch a chart into more parts; what fits is not promised then.
fn pinches(entry: &Entry) -> bool {
    entry.info.id == "mid-edge"
}

/// Whether it has as many parts as charts, or more where they may be pinched.
fn is_whole(level: &Refined, entries: &[&Entry], charts: usize) -> bool {
    let pinches = entries.iter().any(|e| pinches(e));
    let parts = parts(level);
    parts == charts || pinches && parts > charts
}

/// Parts of the surface that are joined by sides with the same coordinates.
fn parts(level: &Refined) -> usize {
    let uv = level.uv.as_ref().unwrap();
    let mut face_of = vec![0; level.faces.corners().len()];
    (0..level.faces.count()).for_each(|f| face_of[level.faces.range(f)].fill(f));
    let mut root: Vec<usize> = (0..level.faces.count()).collect();
    fn find(root: &mut [usize], mut f: usize) -> usize {
        while root[f] != f {
            root[f] = root[root[f]];
            f = root[f];
        }
        f
    }
    for [a, b] in sides(level) {
        if uv.corners[a[0]] == uv.corners[a[1]] && uv.corners[b[0]] == uv.corners[b[1]] {
            let (x, y) = (find(&mut root, face_of[a[0]]), find(&mut root, face_of[a[1]]));
            root[x] = y;
        }
    }
    (0..root.len()).filter(|&f| root[f] == f).count()
}

/// Texture coordinates that are the first two coordinates of the points, without seams, are refined as the points are.
#[test]
fn without_seams_they_are_points() {
    let mut compared = std::collections::BTreeSet::new();
    for (name, soup) in gallery() {
        if soup.face_count() > 300 {
            continue;
        }
        let mut soup = soup;
        soup.uvs = soup.positions.iter().map(|p| [p[0], p[1]]).collect();
        soup.uv_corners = soup.corners.clone();
        let mesh = build(&soup);
        for (entry, level) in steady(&mesh).flat_map(|e| (1..=3).map(move |l| (e, l))) {
            for (boundary, rule) in
                [(Boundary::EdgeAndCorner, FaceVarying::CornersPlus1), (Boundary::EdgeOnly, FaceVarying::None)]
            {
                let mut plan = Plan::new(entry, boundary, level);
                plan.rules.face_varying = rule;
                let refined = refine(&mesh, &plan, u64::MAX).unwrap();
                for (c, &v) in refined.faces.corners().iter().enumerate() {
                    let (uv, p) = (corner_uv(&refined, c), refined.points[v as usize]);
                    let off = (uv[0] - p[0]).abs().max((uv[1] - p[1]).abs());
                    assert!(off < 4e-6, "{name}, {}, level {level}, {boundary:?}: {uv:?} at {p:?}", entry.info.id);
                }
            }
            compared.insert(entry.info.id);
        }
    }
    assert_eq!(compared.len(), SCHEMES.iter().filter(|e| !e.info.is_random()).count());
}

/// The same with creases: closed, crossing, ending and to the rim, and with another scheme before or after.
#[test]
fn on_creases_they_are_points() {
    let mut compared = 0;
    for (name, mut soup) in gallery() {
        if soup.face_count() > 300 || soup.face_count() < 8 {
            continue;
        }
        soup = triangulate_soup(&soup).0;
        soup.uvs = soup.positions.iter().map(|p| [p[0], p[1]]).collect();
        soup.uv_corners = soup.corners.clone();
        let sides = |f: usize| {
            let face = soup.face(f).to_vec();
            (0..3).map(move |k| [face[k], face[(k + 1) % 3]]).collect::<Vec<_>>()
        };
        // All around a face, one edge of another, and every seventh edge.
        let all: Vec<[u32; 2]> = (0..soup.face_count()).flat_map(sides).collect();
        for marked in [all[0..3].to_vec(), all[12..13].to_vec(), all.iter().copied().step_by(7).collect()] {
            soup.marks.creases = marked.iter().map(|&ends| (ends, 10.0)).collect();
            let mesh = build(&soup);
            const OTHER: &str = "interpolating-sqrt3";
            const ONE: &str = "sqrt3";
            let pairs = [[ONE, ONE], [OTHER, OTHER], [ONE, OTHER], [ONE, "loop"], ["loop", ONE], [ONE, "butterfly"]];
            for [first, second] in pairs.map(|ids| ids.map(|id| limn_mesh::scheme(id).unwrap())) {
                for level in 1..=4 {
                    let mut plan = Plan::new(first, Boundary::EdgeOnly, level);
                    plan.rules.face_varying = FaceVarying::None;
                    plan.later = vec![Run { from: 2, scheme: second, params: Params::default() }];
                    let refined = refine(&mesh, &plan, u64::MAX).unwrap();
                    let what = format!("{name}, {} then {}, level {level}", first.info.id, second.info.id);
                    for (c, &v) in refined.faces.corners().iter().enumerate() {
                        let (uv, p) = (corner_uv(&refined, c), refined.points[v as usize]);
                        let off = (uv[0] - p[0]).abs().max((uv[1] - p[1]).abs());
                        assert!(off < 4e-6, "{what}: {uv:?} at {p:?}");
                    }
                    // Where textures fit, they stay one.
                    assert_eq!(refined.uv.as_ref().unwrap().values.len(), refined.points.len(), "{what}");
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 500, "{compared}");
}

/// Creases that cross a seam, and lie on it: every face keeps its chart, and what fits goes on fitting.
#[test]
fn creases_and_seams() {
    let mut soup = triangulate_soup(&grid(8, 5, 4, 10.0)).0;
    let at = |x: u32, y: u32| x * 6 + y;
    for chain in [
        (0..8).map(|x| [at(x, 2), at(x + 1, 2)]).collect::<Vec<_>>(),
        (0..5).map(|y| [at(4, y), at(4, y + 1)]).collect(),
        (1..3).map(|y| [at(4, y), at(4, y + 1)]).chain([[at(3, 3), at(4, 3)]]).collect(),
    ] {
        soup.marks.creases = chain.into_iter().map(|ends| (ends, 10.0)).collect();
        let mesh = build(&soup);
        for (id, level) in ["sqrt3", "interpolating-sqrt3"].into_iter().flat_map(|id| (1..=4).map(move |l| (id, l))) {
            let what = format!("{id}, level {level}");
            let mut plan = Plan::new(limn_mesh::scheme(id).unwrap(), Boundary::EdgeAndCorner, level);
            plan.rules.face_varying = FaceVarying::Boundaries;
            let refined = refine(&mesh, &plan, u64::MAX).unwrap();
            assert!(is_whole(&refined, &[], 2), "{what}");
            let seams =
                fits(&what, &refined, |a, b| ((a[0] - b[0]).abs() - 10.0).abs() < 1e-4 && (a[1] - b[1]).abs() < 1e-4);
            assert!(seams >= 5, "{what}: {seams}");
            for f in 0..refined.faces.count() {
                let chart: Vec<Uv> = refined.faces.range(f).map(|c| corner_uv(&refined, c)).collect();
                let side = chart.iter().filter(|p| p[0] > 9.0).count();
                assert!(side == 0 || side == 3, "{what}: {chart:?}");
            }
        }
    }
}

/// Colours that are the points are refined as the points are.
#[test]
fn colours_are_points() {
    for (name, mut soup) in gallery() {
        soup.colors = soup.positions.iter().map(|p| [p[0], p[1], p[2], 1.0]).collect();
        let mesh = build(&soup);
        for (entry, level) in steady(&mesh).flat_map(|e| (1..=2).map(move |l| (e, l))) {
            let refined = refine(&mesh, &Plan::new(entry, Boundary::EdgeOnly, level), u64::MAX).unwrap();
            assert_eq!(refined.colors.len(), refined.points.len());
            for (c, p) in refined.colors.iter().zip(&refined.points) {
                let off = (0..3).map(|k| (c[k] - p[k]).abs()).fold((c[3] - 1.0).abs(), f32::max);
                assert!(off < 1e-5, "{name}, {}: {c:?} at {p:?}", entry.info.id);
            }
        }
    }
}

/// Every side of a level: joined, with the same bits on both of its faces, or on a seam; there `jump` says whether the two
/// coordinates are those of one point.
fn fits(what: &str, level: &Refined, jump: impl Fn(Uv, Uv) -> bool) -> usize {
    let uv = level.uv.as_ref().unwrap();
    let mut seams = 0;
    for ends in sides(level) {
        if ends.iter().all(|e| uv.corners[e[0]] == uv.corners[e[1]]) {
            continue;
        }
        seams += 1;
        for [a, b] in ends {
            let (x, y) = (corner_uv(level, a), corner_uv(level, b));
            assert!(jump(x, y), "{what}: {x:?} and {y:?} on a seam");
        }
    }
    seams
}

#[test]
fn a_seam_between_two_charts() {
    let soup = grid(8, 5, 4, 10.0);
    for soup in [soup.clone(), triangulate_soup(&soup).0] {
        let mesh = build(&soup);
        for (entry, level) in schemes(&mesh).flat_map(|e| (1..=3).map(move |l| (e, l))) {
            let what = format!("{}, level {level}", entry.info.id);
            // Straight seams: others are rounded where they meet the rim, in each chart by itself.
            let mut plan = Plan::new(entry, Boundary::EdgeAndCorner, level);
            plan.rules.face_varying = FaceVarying::Boundaries;
            let refined = refine(&mesh, &plan, u64::MAX).unwrap();
            assert!(is_whole(&refined, &[entry], 2), "{what}");
            let seams = fits(&what, &refined, |a, b| {
                let d = [(a[0] - b[0]).abs(), (a[1] - b[1]).abs()];
                pinches(entry) || (d[0] - 10.0).abs() < 1e-4 && d[1] < 1e-4
            });
            assert!(seams >= 5, "{what}: {seams} seams");
            if !is_convex(entry) {
                continue;
            }
            for f in 0..refined.faces.count() {
                let chart: Vec<Uv> = refined.faces.range(f).map(|c| corner_uv(&refined, c)).collect();
                let within =
                    |low: f32| chart.iter().all(|p| (low..=low + 4.0).contains(&p[0]) && (0.0..=5.0).contains(&p[1]));
                assert!(within(0.0) || within(14.0), "{what}: {chart:?}");
            }
        }
    }
}

/// Faces that are far from the seam do not feel it.
#[test]
fn away_from_a_seam_nothing_changes() {
    let (one, two) = (grid(12, 5, 12, 0.0), grid(12, 5, 6, 10.0));
    for (one, two) in [(one.clone(), two.clone()), (triangulate_soup(&one).0, triangulate_soup(&two).0)] {
        let (one, two) = (build(&one), build(&two));
        for (entry, level) in schemes(&one).flat_map(|e| (1..=3).map(move |l| (e, l))) {
            let plan = Plan::new(entry, Boundary::EdgeAndCorner, level);
            let [a, b] = [&one, &two].map(|m| refine(m, &plan, u64::MAX).unwrap());
            let mut far = 0;
            for c in 0..a.faces.corners().len() {
                let (x, y) = (corner_uv(&a, c), corner_uv(&b, c));
                if (x[0] - 6.0).abs() > 4.0 {
                    far += 1;
                    let y = [if x[0] > 6.0 { y[0] - 10.0 } else { y[0] }, y[1]];
                    let off = (x[0] - y[0]).abs().max((x[1] - y[1]).abs());
                    assert!(off < 1e-5, "{}, level {level}: {x:?}, {y:?}", entry.info.id);
                }
            }
            assert!(far > a.faces.corners().len() / 6);
        }
    }
}

#[test]
fn a_torus_with_one_seam_each_way() {
    let soup = torus(7, 6);
    for soup in [soup.clone(), triangulate_soup(&soup).0] {
        let mesh = build(&soup);
        for (entry, level) in schemes(&mesh).flat_map(|e| (1..=3).map(move |l| (e, l))) {
            let what = format!("{}, level {level}", entry.info.id);
            let refined = refine(&mesh, &Plan::new(entry, Boundary::EdgeAndCorner, level), u64::MAX).unwrap();
            assert!(is_whole(&refined, &[entry], 1), "{what}");
            let seams = fits(&what, &refined, |a, b| {
                let d = [(a[0] - b[0]).abs(), (a[1] - b[1]).abs()];
                pinches(entry) || d.iter().all(|d| d.min((d - 1.0).abs()) < 1e-5)
            });
            assert!(seams >= 13, "{what}: {seams} seams");
            let uv = refined.uv.as_ref().unwrap();
            let whole = -1e-6..=1.0 + 1e-6;
            assert!(!is_convex(entry) || uv.values.iter().flatten().all(|x| whole.contains(x)), "{what}");
            // No face reaches across.
            for f in 0..refined.faces.count() {
                let all: Vec<Uv> = refined.faces.range(f).map(|c| corner_uv(&refined, c)).collect();
                for k in 0..2 {
                    let (low, high) = all.iter().fold((f32::MAX, f32::MIN), |(l, h), p| (l.min(p[k]), h.max(p[k])));
                    assert!(high - low < 0.4, "{what}: {all:?}");
                }
            }
        }
    }
}

fn in_one_square(what: &str, level: &Refined) {
    for f in 0..level.faces.count() {
        let face: Vec<Uv> = level.faces.range(f).map(|c| corner_uv(level, c)).collect();
        let within = |square: usize| {
            let low = 3.0 * square as f32;
            let (x, y) = (low - 1e-6..=low + 1.0 + 1e-6, -1e-6..=1.0 + 1e-6);
            face.iter().all(|p| x.contains(&p[0]) && y.contains(&p[1]))
        };
        assert!((0..6).any(within), "{what}: {face:?}");
    }
}

#[test]
fn a_cube_with_six_squares() {
    for soup in [boxed(), triangulate_soup(&boxed()).0] {
        let mesh = build(&soup);
        for (entry, level) in schemes(&mesh).flat_map(|e| (1..=3).map(move |l| (e, l))) {
            for (boundary, rule) in [
                (Boundary::EdgeAndCorner, FaceVarying::CornersPlus1),
                (Boundary::EdgeOnly, FaceVarying::None),
                (Boundary::EdgeOnly, FaceVarying::Boundaries),
                (Boundary::EdgeOnly, FaceVarying::All),
            ] {
                let what = format!("{}, level {level}, {rule:?}", entry.info.id);
                let mut plan = Plan::new(entry, boundary, level);
                plan.rules.face_varying = rule;
                let refined = refine(&mesh, &plan, u64::MAX).unwrap();
                assert!(is_whole(&refined, &[entry], 6), "{what}");
                if is_convex(entry) {
                    in_one_square(&what, &refined);
                }
                // Within a square, a corner is a corner.
                let uv = refined.uv.as_ref().unwrap();
                for ends in sides(&refined).into_iter().filter(|_| !pinches(entry)) {
                    let square = |c: usize| (corner_uv(&refined, c)[0] / 3.0).round() as i32;
                    let [a, b] = ends;
                    if square(a[0]) == square(a[1]) && square(b[0]) == square(b[1]) {
                        assert!(ends.iter().all(|e| uv.corners[e[0]] == uv.corners[e[1]]), "{what}");
                    }
                }
            }
        }
    }
}

#[test]
fn plans_of_two_schemes_carry_them_in_any_slices() {
    for soup in [boxed(), triangulate_soup(&boxed()).0] {
        let mesh = build(&soup);
        for (first, second) in SCHEMES.iter().flat_map(|a| SCHEMES.iter().map(move |b| (a, b))) {
            let mut plan = Plan::new(first, Boundary::EdgeAndCorner, 3);
            plan.later = vec![
                Run { from: 1, scheme: second, params: Params::default() },
                Run { from: 2, scheme: limn_mesh::scheme("catmull-clark").unwrap(), params: Params::default() },
            ];
            let Ok(refined) = refine(&mesh, &plan, u64::MAX) else { continue };
            let what = format!("{} then {}", first.info.id, second.info.id);
            assert!(is_whole(&refined, &[first, second], 6), "{what}");
            if is_convex(first) && is_convex(second) {
                in_one_square(&what, &refined);
            }
            let uv = refined.uv.as_ref().unwrap();
            assert!(predict(&mesh, &plan).unwrap().unwrap().bytes >= 8 * uv.values.len() as u64);
            let mut job = Job::new(mesh.clone(), plan.clone(), u64::MAX).unwrap();
            let mut last = 0.0;
            while !job.step(41) {
                assert!(job.progress() >= last, "{what}");
                last = job.progress();
            }
            assert_eq!(job.progress(), 1.0);
            assert_eq!(job.finish().uv.as_ref(), Some(uv), "{what}");
        }
    }
}

/// Any seams on any mesh: a face's coordinates are mixed from those of one region.
#[test]
fn regions_do_not_mix() {
    for (name, soup) in gallery().into_iter().filter(|(_, s)| s.face_count() <= 60) {
        let soups = [soup.clone(), triangulate_soup(&soup).0];
        for (mut soup, busy) in soups.into_iter().flat_map(|s| [1u32, 3].map(|b| (s.clone(), b))) {
            // A chart a face number, some faces with their neighbours' numbers: values tell the chart.
            let chart = |f: usize| (f as u32 * 7 + f as u32 / 3) % (busy * 5);
            let charts = busy * 5;
            soup.uvs = (0..soup.positions.len() as u32 * charts)
                .map(|i| [10.0 * (i % charts) as f32 + (i / charts % 3) as f32 * 0.1, (i / charts % 7) as f32 * 0.1])
                .collect();
            soup.uv_corners = (0..soup.face_count())
                .flat_map(|f| soup.face(f).iter().map(move |v| v * charts + chart(f)).collect::<Vec<_>>())
                .collect();
            let mesh: Arc<Mesh> = build(&soup);
            for (entry, level) in schemes(&mesh).filter(|e| is_convex(e)).flat_map(|e| (1..=2).map(move |l| (e, l))) {
                for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner] {
                    let refined = refine(&mesh, &Plan::new(entry, boundary, level), u64::MAX).unwrap();
                    for f in 0..refined.faces.count() {
                        let face: Vec<Uv> = refined.faces.range(f).map(|c| corner_uv(&refined, c)).collect();
                        let chart = (face[0][0] / 10.0).floor() * 10.0;
                        let inside = |p: &Uv| {
                            (chart - 1e-4..=chart + 0.2001).contains(&p[0]) && (-1e-4..=0.6001).contains(&p[1])
                        };
                        assert!(face.iter().all(inside), "{name}, {}, level {level}: {face:?}", entry.info.id);
                    }
                }
            }
        }
    }
}

/// What dual schemes and those that turn edges do about seams: both sides move to the same place, however many seams meet.
#[test]
fn textures_that_fit_go_on_fitting() {
    for (name, soup) in gallery().into_iter().filter(|(_, s)| s.face_count() <= 60) {
        let soups = [soup.clone(), triangulate_soup(&soup).0];
        for (mut soup, few) in soups.into_iter().flat_map(|s| [false, true].map(|few| (s.clone(), few))) {
            let chart = |f: usize| if few { (f / 4) as u32 % 5 } else { f as u32 };
            let charts = if few { 5 } else { soup.face_count() as u32 };
            // Each chart is the same picture, 16 further on.
            let value = |v: u32, chart: u32| {
                let p = soup.positions[v as usize];
                [p[0] + 0.3 * p[2] + 16.0 * chart as f32, p[1]]
            };
            let vertices = soup.positions.len() as u32;
            soup.uvs = (0..vertices).flat_map(|v| (0..charts).map(move |c| value(v, c)).collect::<Vec<_>>()).collect();
            let corner = |f: usize| soup.face(f).iter().map(move |v| v * charts + chart(f)).collect::<Vec<_>>();
            soup.uv_corners = (0..soup.face_count()).flat_map(corner).collect();
            let mesh = build(&soup);
            for (entry, level) in schemes(&mesh).flat_map(|e| (1..=2).map(move |l| (e, l))) {
                if ["butterfly", "modified-butterfly", "kobbelt", "j-spline", "mid-edge"].contains(&entry.info.id) {
                    // Their curves look further along a seam than to where it bends; mid-edge may have no room to move.
                    continue;
                }
                let mut plan = Plan::new(entry, Boundary::EdgeAndCorner, level);
                plan.rules.face_varying = FaceVarying::Boundaries;
                let refined = refine(&mesh, &plan, u64::MAX).unwrap();
                fits(&format!("{name}, {}, level {level}, {few}", entry.info.id), &refined, |a, b| {
                    let d = (a[0] - b[0]).abs();
                    (d - (d / 16.0).round() * 16.0).abs() < 1e-3 && (a[1] - b[1]).abs() < 1e-4
                });
            }
        }
    }
}
