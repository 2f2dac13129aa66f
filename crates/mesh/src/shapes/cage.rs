//! A modeller's bench for closed quad cages: pull faces out, refine once. Not for files: it trusts its input.
//!
//! ```text
//!   +───+───+───+          +───+───+───+     `extrude` takes a block of faces off along its border, keeps them as
//!   │   │ a │   │   ──>    │ \ +─+ / │       a lid, and closes the gap with a band of quads: as many as the border
//!   +───+───+───+          +──+│a│+──+       has edges. Positions are the caller's business.
//!   │   │   │   │          │ / +─+ \ │
//! ```

use crate::soup::Soup;
use std::collections::BTreeMap;

/// Points and quads.
#[derive(Clone, Debug, Default)]
pub(super) struct Cage {
    pub points: Vec<[f64; 3]>,
    pub quads: Vec<[u32; 4]>,
}

impl Cage {
    /// Pulls a block of faces off: returns the vertices of its new border, in order, `anchor`'s copy first. They lie where the
    /// old ones do. The band's faces come last, face `i` between border vertices `i` and `i + 1`, as (old, old, new, new).
    pub fn extrude(&mut self, faces: &[usize], anchor: u32) -> Vec<u32> {
        // The border runs along edges whose other side is not in the block.
        let edges: Vec<(u32, u32)> = faces
            .iter()
            .flat_map(|&f| (0..4).map(move |i| (f, i)))
            .map(|(f, i)| (self.quads[f][i], self.quads[f][(i + 1) % 4]))
            .collect();
        let border: BTreeMap<u32, u32> = edges.iter().filter(|&&(a, b)| !edges.contains(&(b, a))).copied().collect();
        let mut old = vec![anchor];
        let mut at = border[&anchor];
        while at != anchor {
            old.push(at);
            at = border[&at];
        }
        let first = self.points.len() as u32;
        let new: Vec<u32> = (first..first + old.len() as u32).collect();
        for &v in &old {
            self.points.push(self.points[v as usize]);
        }
        for &f in faces {
            for v in &mut self.quads[f] {
                if let Some(i) = old.iter().position(|o| o == v) {
                    *v = new[i];
                }
            }
        }
        for i in 0..old.len() {
            let j = (i + 1) % old.len();
            self.quads.push([old[i], old[j], new[j], new[i]]);
        }
        new
    }

    /// Pulls a block of faces off, shrinks it about its middle and moves it.
    pub fn pull(&mut self, faces: &[usize], scale: f64, by: [f64; 3]) {
        let middle = self.middle(faces);
        // A vertex of the first face that is on the border: in a row or a square of faces, one of its corners is.
        let inner = |v: u32| faces.iter().filter(|&&f| self.quads[f].contains(&v)).count() > 2;
        let anchor = self.quads[faces[0]].into_iter().find(|&v| !inner(v)).unwrap_or(self.quads[faces[0]][0]);
        self.extrude(faces, anchor);
        let mut moved: Vec<u32> = faces.iter().flat_map(|&f| self.quads[f]).collect();
        moved.sort_unstable();
        moved.dedup();
        for v in moved {
            let p = &mut self.points[v as usize];
            *p = [0, 1, 2].map(|k| middle[k] + scale * (p[k] - middle[k]) + by[k]);
        }
    }

    /// The mean of the faces' corners.
    pub fn middle(&self, faces: &[usize]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for v in faces.iter().flat_map(|&f| self.quads[f]) {
            (0..3).for_each(|k| sum[k] += self.points[v as usize][k]);
        }
        sum.map(|x| x / (4 * faces.len()) as f64)
    }

    /// The unit vector along the faces' summed area vectors.
    pub fn normal(&self, faces: &[usize]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for &f in faces {
            let [a, b, c, d] = self.quads[f].map(|v| self.points[v as usize]);
            let (p, q) = ([0, 1, 2].map(|k| c[k] - a[k]), [0, 1, 2].map(|k| d[k] - b[k]));
            (0..3).for_each(|k| sum[k] += p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3]);
        }
        let length = libm::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
        sum.map(|x| x / length)
    }

    /// One Catmull–Clark step. Vertices: old, faces, edges; child `4 f + c` is (corner c, edge after, face, edge before).
    pub fn refined(&self) -> Cage {
        let mean = |ps: &[[f64; 3]]| [0, 1, 2].map(|k| ps.iter().map(|p| p[k]).sum::<f64>() / ps.len() as f64);
        let faces: Vec<[f64; 3]> = self.quads.iter().map(|q| mean(&q.map(|v| self.points[v as usize]))).collect();
        // Each edge's number and its two faces.
        let mut edges: BTreeMap<(u32, u32), (usize, Vec<usize>)> = BTreeMap::new();
        for (f, q) in self.quads.iter().enumerate() {
            for i in 0..4 {
                let (a, b) = (q[i], q[(i + 1) % 4]);
                let next = edges.len();
                edges.entry((a.min(b), a.max(b))).or_insert((next, Vec::new())).1.push(f);
            }
        }
        let (n, m) = (self.points.len(), faces.len());
        let mut points = vec![[0.0; 3]; n + m + edges.len()];
        points[n..n + m].copy_from_slice(&faces);
        // A vertex of k edges goes to (k - 2) / k of itself, 1 / k of its neighbours' mean and 1 / k of its faces' mean.
        let mut valence = vec![0.0; n];
        edges.keys().for_each(|&(a, b)| [a, b].iter().for_each(|&v| valence[v as usize] += 1.0));
        for (v, k) in valence.iter().enumerate() {
            points[v] = self.points[v].map(|x| x * (k - 2.0) / k);
        }
        let mut give = |v: u32, p: [f64; 3]| {
            let k: f64 = valence[v as usize];
            (0..3).for_each(|i| points[v as usize][i] += p[i] / (k * k));
        };
        for &(a, b) in edges.keys() {
            give(a, self.points[b as usize]);
            give(b, self.points[a as usize]);
        }
        for (f, q) in self.quads.iter().enumerate() {
            q.iter().for_each(|&v| give(v, faces[f]));
        }
        for (&(a, b), (e, sides)) in &edges {
            let mut around = vec![self.points[a as usize], self.points[b as usize]];
            around.extend(sides.iter().map(|&f| faces[f]));
            points[n + m + e] = mean(&around);
        }
        let edge = |a: u32, b: u32| (n + m + edges[&(a.min(b), a.max(b))].0) as u32;
        let mut quads = Vec::with_capacity(4 * m);
        for (f, q) in self.quads.iter().enumerate() {
            for c in 0..4 {
                quads.push([q[c], edge(q[c], q[(c + 1) % 4]), (n + f) as u32, edge(q[(c + 3) % 4], q[c])]);
            }
        }
        Cage { points, quads }
    }

    /// The cage in single precision.
    pub fn into_soup(self) -> Soup {
        Soup::from_faces(self.points.iter().map(|p| p.map(|x| x as f32)).collect(), &self.quads)
    }
}
