//! Triangles back to quads: undoes what exporters to glTF do to a quad cage.
//!
//! Two triangles may become a quad when they share an edge, lie nearly in one plane, agree about group, material and texture
//! coordinates, and the quad is convex. Every such edge gets a *quality* in 0..=1: flatness times squareness.
//!
//! ```text
//!    a ──── d        1. Exporters write a quad's halves one after the other, as (a b c)(a c d) or
//!    │ \    │           (a b d)(b c d). Runs of such neighbours are matched best, by dynamic programming.
//!    │   \  │        2. The rest is matched greedily: first what is good and far better than its rivals.
//!    │     \│        3. Two single triangles with a quad between them become two quads where they can:
//!    b ──── c           A  B=C  D  ->  A=B  C=D.
//! ```
//!
//! A mesh of true triangles pairs too, only badly: its triangles fit several partners about as well. The *confidence* says
//! so; a caller should ask before it uses a result below [`ASK_BELOW`].
//!
//! Edges are found by two counting sorts, so all but the sort of the rest by quality is linear.
//! The limits on fold and shape follow the "tris to quads" tools of modelling programs.

use crate::order;
use crate::soup::{NONE, Soup};

/// Cosine of the largest fold between two triangles that may become a quad (45 degrees).
const FOLD: f64 = 0.707;

/// The same for two triangles written as an exporter writes a quad's halves (about 75 degrees).
const WRITTEN_FOLD: f64 = 0.26;

/// The cosine of a corner, in magnitude, from which a quad's shape is worth nothing (about 26 and 154 degrees).
const SKEW: f64 = 0.9;

/// The lead in quality over all other partners at which a pair counts as beyond doubt.
const LEAD: f64 = 0.3;

/// Below this confidence the triangles are likely meant as triangles.
pub const ASK_BELOW: f32 = 0.5;

/// What [`pair_triangles`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PairReport {
    /// Quads made of two triangles each.
    pub quads: usize,
    /// Triangles without a partner.
    pub triangles_left: usize,
    /// How likely the triangles come from quads, in 0..=1; 0 if there are none.
    ///
    /// The mean over all triangles of what each is worth: nothing without a partner, else the pair's quality, down to half of
    /// it where one of the two had another partner as good. Triangulated quad cages reach 0.6 to 1, true triangle meshes
    /// stay below 0.5.
    pub confidence: f32,
}

/// Two triangles that may become a quad. With quality 0 they do so only where an exporter's order says it.
#[derive(Clone, Copy)]
struct Pair {
    /// The triangles, the lower face number first.
    faces: [u32; 2],
    /// In each, the corner at which the shared edge begins.
    corners: [u8; 2],
    quality: f64,
}

/// Joins pairs of triangles to quads, in deterministic order.
///
/// A quad takes the place of its first triangle and begins at that triangle's first corner, so that a triangulated cage of
/// quads comes back corner for corner. Faces of other degrees stay as they are; so do positions, colours and all corner data.
///
/// Edges are shared by position index: weld first where a format splits vertices at seams. Edges with more than two
/// triangles, or two that turn opposite ways, and triangles without area are left alone. Cost: linear, but for a sort of the
/// triangles whose halves are not next to each other.
///
/// ```
/// use limn_mesh::{pair::pair_triangles, shapes, triangulate::triangulate_soup};
/// let torus = (shapes::shape("torus").unwrap().build)();
/// let (quads, report) = pair_triangles(&triangulate_soup(&torus).0);
/// assert_eq!((report.quads, report.triangles_left), (128, 0));
/// assert_eq!(quads, torus);
/// ```
pub fn pair_triangles(soup: &Soup) -> (Soup, PairReport) {
    let pairs = candidates(soup);
    let triangles = (0..soup.face_count()).filter(|&f| is_triangle(soup, f)).count();
    let mut matching = Matching::new(soup.face_count(), &pairs);
    matching.match_neighbours(soup);
    matching.match_greedily();
    matching.improve();
    let chosen = &matching.chosen;

    let quads = chosen.iter().filter(|&&p| p != NONE).count() / 2;
    let worth = matching.worth();
    let report = PairReport {
        quads,
        triangles_left: triangles - 2 * quads,
        confidence: if triangles == 0 { 0.0 } else { (worth / triangles as f64) as f32 },
    };
    (rebuild(soup, &pairs, chosen), report)
}

fn is_triangle(soup: &Soup, f: usize) -> bool {
    let range = soup.face_range(f);
    range.len() == 3 && range.end <= soup.corners.len()
}

/// All pairs of triangles that may become a quad, in the order of their edges' vertices.
fn candidates(soup: &Soup) -> Vec<Pair> {
    // The edges of all triangles as (lower vertex, upper vertex, face, corner).
    let mut edges: Vec<[u32; 4]> = Vec::new();
    for f in (0..soup.face_count()).filter(|&f| is_triangle(soup, f)) {
        let t = soup.face(f);
        let known = t.iter().all(|&v| (v as usize) < soup.positions.len());
        if known && t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
            for i in 0..3 {
                let (a, b) = (t[i], t[(i + 1) % 3]);
                edges.push([a.min(b), a.max(b), f as u32, i as u32]);
            }
        }
    }
    let edges = counting_sort(&counting_sort(&edges, 1, soup.positions.len()), 0, soup.positions.len());
    let mut pairs = Vec::new();
    for group in edges.chunk_by(|a, b| a[..2] == b[..2]) {
        if let [first, second] = group {
            pairs.extend(judge(soup, [first[2], second[2]], [first[3] as u8, second[3] as u8]));
        }
    }
    pairs
}

/// Sorts rows by one column whose entries lie below `bound`; stable.
fn counting_sort(rows: &[[u32; 4]], column: usize, bound: usize) -> Vec<[u32; 4]> {
    let mut starts = vec![0u32; bound + 1];
    for row in rows {
        starts[row[column] as usize + 1] += 1;
    }
    for i in 0..bound {
        starts[i + 1] += starts[i];
    }
    let mut sorted = vec![[0; 4]; rows.len()];
    for row in rows {
        let place = &mut starts[row[column] as usize];
        sorted[*place as usize] = *row;
        *place += 1;
    }
    sorted
}

/// The pair over an edge shared by two triangles, if they may become a quad.
fn judge(soup: &Soup, faces: [u32; 2], corners: [u8; 2]) -> Option<Pair> {
    let [f, g] = faces.map(|f| f as usize);
    let (i, j) = (corners[0] as usize, corners[1] as usize);
    let (t, u) = (soup.face(f), soup.face(g));
    // The shared edge runs from a to c in the first triangle and back in the second; b and d lie across it.
    let (a, c, b) = (t[i], t[(i + 1) % 3], t[(i + 2) % 3]);
    let d = u[(j + 2) % 3];
    if u[j] != c || u[(j + 1) % 3] != a || b == d {
        return None;
    }
    let same = |list: &[u32]| list.get(f) == list.get(g);
    if !same(&soup.face_groups) || !same(&soup.face_materials) {
        return None;
    }
    let uv = |face: usize, corner: usize| {
        let index = soup.uv_corners.get(soup.face_range(face).start + corner % 3);
        index.map(|&index| soup.uvs.get(index as usize).copied())
    };
    if uv(f, i) != uv(g, j + 1) || uv(f, i + 1) != uv(g, j) {
        return None;
    }

    let at = |v: u32| soup.positions[v as usize].map(f64::from);
    // Round the quad: c, b, a, d.
    let p = [at(c), at(b), at(a), at(d)];
    let normal = |x: [f64; 3], y: [f64; 3], z: [f64; 3]| unit(cross(sub(y, x), sub(z, x)));
    let (m, n) = (normal(p[0], p[1], p[2])?, normal(p[0], p[2], p[3])?);
    let flat = (dot(m, n) - FOLD) / (1.0 - FOLD);
    let middle = [m[0] + n[0], m[1] + n[1], m[2] + n[2]];
    let mut worst: f64 = 0.0;
    for k in 0..4 {
        let before = unit(sub(p[k], p[(k + 3) % 4]))?;
        let after = unit(sub(p[(k + 1) % 4], p[k]))?;
        if dot(cross(before, after), middle) <= 0.0 {
            return None;
        }
        worst = worst.max(dot(before, after).abs());
    }
    let square = 1.0 - (worst / SKEW) * (worst / SKEW);
    let quality = if flat > 0.0 && square > 0.0 { flat.min(1.0) * square } else { 0.0 };
    (dot(m, n) > WRITTEN_FOLD).then_some(Pair { faces, corners, quality })
}

/// A matching of faces over candidate pairs.
struct Matching<'a> {
    pairs: &'a [Pair],
    /// The pairs of each face: `of_face[starts[f]..starts[f + 1]]`, at most three.
    starts: Vec<u32>,
    of_face: Vec<u32>,
    /// The pair that each face is in, or [`NONE`].
    chosen: Vec<u32>,
}

impl<'a> Matching<'a> {
    fn new(faces: usize, pairs: &'a [Pair]) -> Self {
        let mut starts = vec![0u32; faces + 1];
        pairs.iter().flat_map(|p| p.faces).for_each(|f| starts[f as usize + 1] += 1);
        for f in 0..faces {
            starts[f + 1] += starts[f];
        }
        let mut fill = starts.clone();
        let mut of_face = vec![0; 2 * pairs.len()];
        for (i, pair) in pairs.iter().enumerate() {
            for f in pair.faces {
                of_face[fill[f as usize] as usize] = i as u32;
                fill[f as usize] += 1;
            }
        }
        Matching { pairs, starts, of_face, chosen: vec![NONE; faces] }
    }

    fn pairs_of(&self, f: u32) -> &[u32] {
        &self.of_face[self.starts[f as usize] as usize..self.starts[f as usize + 1] as usize]
    }

    fn is_free(&self, f: u32) -> bool {
        self.chosen[f as usize] == NONE
    }

    fn choose(&mut self, pair: u32) {
        self.pairs[pair as usize].faces.iter().for_each(|&f| self.chosen[f as usize] = pair);
    }

    /// Matches faces that follow each other as an exporter writes a quad's halves.
    ///
    /// In a run of faces, each with such a link to the next, the most pairs win, then the best: `best[k]` is the best for the
    /// first `k` faces.
    fn match_neighbours(&mut self, soup: &Soup) {
        let faces = self.chosen.len();
        let link = |f: usize| -> Option<u32> {
            let pair = self
                .pairs_of(f as u32)
                .iter()
                .copied()
                .find(|&p| self.pairs[p as usize].faces == [f as u32, f as u32 + 1])?;
            let (t, u) = (soup.face(f), soup.face(f + 1));
            // (a b c)(a c d), or (a b d)(b c d).
            ((t[0] == u[0] && t[2] == u[1]) || (t[1] == u[0] && t[2] == u[2])).then_some(pair)
        };
        let links: Vec<Option<u32>> = (0..faces.saturating_sub(1)).map(link).collect();
        let mut start = 0;
        while start < links.len() {
            let length = links[start..].iter().take_while(|l| l.is_some()).count();
            let run: Vec<u32> = links[start..start + length].iter().flatten().copied().collect();
            let mut best = vec![0.0; length + 2];
            for k in 2..length + 2 {
                best[k] = f64::max(best[k - 1], best[k - 2] + self.weight(run[k - 2]));
            }
            let mut k = length + 1;
            while k > 1 {
                if best[k] > best[k - 1] {
                    self.choose(run[k - 2]);
                    k -= 1;
                }
                k -= 1;
            }
            start += length + 1;
        }
    }

    /// What a pair counts in a run: one more pair is worth more than better ones, within reason.
    fn weight(&self, pair: u32) -> f64 {
        2.0 + self.pairs[pair as usize].quality
    }

    /// Matches what is left, by quality plus lead; ties by the lowest faces.
    fn match_greedily(&mut self) {
        let free = |p: &Pair| p.quality > 0.0 && p.faces.iter().all(|&f| self.is_free(f));
        let pairs = self.pairs;
        // First by faces, so that the second sort, whose ties fall by number, has their rank for one.
        let mut ranks: Vec<(u64, u32)> = (0..pairs.len() as u32)
            .filter(|&i| free(&pairs[i as usize]))
            .map(|i| (order::key(pairs[i as usize].faces[0], pairs[i as usize].faces[1]), i))
            .collect();
        order::sort(&mut ranks);
        let score = |i: u32| pairs[i as usize].quality + self.lead(i);
        let mut rest: Vec<(u64, u32)> =
            ranks.iter().enumerate().map(|(rank, &(_, i))| (!order::float_key(score(i)), rank as u32)).collect();
        order::sort(&mut rest);
        for (_, rank) in rest {
            let i = ranks[rank as usize].1;
            if pairs[i as usize].faces.iter().all(|&f| self.is_free(f)) {
                self.choose(i);
            }
        }
    }

    /// Where a single triangle A could take half of a quad B=C whose other half can join another single D, it does. Each
    /// exchange makes one quad more; of several the one with the best worse half is taken.
    fn improve(&mut self) {
        for a in 0..self.chosen.len() as u32 {
            if !self.is_free(a) {
                continue;
            }
            let mut best: Option<(f64, u32, u32)> = None;
            for &ab in self.pairs_of(a) {
                let b = self.other(ab, a);
                let bc = self.chosen[b as usize];
                if bc == NONE {
                    continue;
                }
                let c = self.other(bc, b);
                for &cd in self.pairs_of(c) {
                    let d = self.other(cd, c);
                    let quality = self.pairs[ab as usize].quality.min(self.pairs[cd as usize].quality);
                    if quality > 0.0 && d != a && self.is_free(d) && best.is_none_or(|(q, ..)| quality > q) {
                        best = Some((quality, ab, cd));
                    }
                }
            }
            if let Some((_, ab, cd)) = best {
                self.choose(ab);
                self.choose(cd);
            }
        }
    }

    fn other(&self, pair: u32, f: u32) -> u32 {
        let [a, b] = self.pairs[pair as usize].faces;
        if a == f { b } else { a }
    }

    /// The sum over all faces of what their pairs are worth, in fixed order.
    fn worth(&self) -> f64 {
        let mut sum = 0.0;
        for f in 0..self.chosen.len() as u32 {
            let pair = self.chosen[f as usize];
            if pair == NONE {
                continue;
            }
            sum += self.pairs[pair as usize].quality * (0.5 + 0.5 * (self.lead(pair) / LEAD).clamp(0.0, 1.0));
        }
        sum
    }

    /// By how much a pair is better than the best other pair of its two faces.
    fn lead(&self, pair: u32) -> f64 {
        let Pair { faces, quality, .. } = self.pairs[pair as usize];
        let others = faces.iter().flat_map(|&f| self.pairs_of(f)).filter(|&&p| p != pair);
        quality - others.map(|&p| self.pairs[p as usize].quality).fold(0.0, f64::max)
    }
}

/// The soup with the chosen pairs joined.
fn rebuild(soup: &Soup, pairs: &[Pair], chosen: &[u32]) -> Soup {
    let mut result = soup.vertices_only();
    let is_hole = soup.is_hole();
    for (f, &choice) in chosen.iter().enumerate() {
        let mut corners: Vec<usize> = soup.face_range(f).collect();
        if let Some(pair) = pairs.get(choice as usize) {
            if pair.faces[1] == f as u32 {
                continue;
            }
            // The second triangle's far corner goes in between the ends of the shared edge.
            let far = soup.face_range(pair.faces[1] as usize).start + (pair.corners[1] as usize + 2) % 3;
            corners.insert(pair.corners[0] as usize + 1, far);
        }
        let partner = pairs.get(choice as usize).map_or(f, |pair| pair.faces[1] as usize);
        if is_hole.get(f) == Some(&true) || is_hole.get(partner) == Some(&true) {
            result.marks.holes.push(result.face_count() as u32);
        }
        let positions: Vec<u32> = corners.iter().filter_map(|&c| soup.corners.get(c).copied()).collect();
        result.push_face(&positions);
        result.uv_corners.extend(corners.iter().filter_map(|&c| soup.uv_corners.get(c).copied()));
        result.face_groups.extend(soup.face_groups.get(f));
        result.face_materials.extend(soup.face_materials.get(f));
    }
    result
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The vector at length 1; none if it has no direction.
fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(v, v).sqrt();
    (length > 0.0 && length.is_finite()).then(|| v.map(|x| x / length))
}
