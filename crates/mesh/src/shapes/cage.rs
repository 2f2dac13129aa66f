//! A modeller's bench for closed quad cages: pull faces out, refine once. Not for files: it trusts its input.
//!
//! ```text
//!   +───+───+───+          +───+───+───+     `extrude` takes a block of faces off along its border, keeps them as
//!   │   │ a │   │   ──>    │ \ +─+ / │       a lid, and closes the gap with a band of quads: as many as the border
//!   +───+───+───+          +──+│a│+──+       has edges. Positions are the caller's business.
//!   │   │   │   │          │ / +─+ \ │
//! ```

use crate::order;
use crate::soup::Soup;

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
        let border: Vec<(u32, u32)> = edges.iter().filter(|&&(a, b)| !edges.contains(&(b, a))).copied().collect();
        let after = |v: u32| border.iter().find(|e| e.0 == v).map_or(anchor, |e| e.1);
        let mut old = vec![anchor];
        let mut at = after(anchor);
        while at != anchor {
            old.push(at);
            at = after(at);
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
        let corners: Vec<u32> = faces.iter().flat_map(|&f| self.quads[f]).collect();
        for (_, &v) in corners.iter().enumerate().filter(|(i, v)| !corners[..*i].contains(v)) {
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
        let length = (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]).sqrt();
        sum.map(|x| x / length)
    }

    /// One Catmull–Clark step. Vertices: old, faces, edges; child `4 f + c` is (corner c, edge after, face, edge before).
    pub fn refined(&self) -> Cage {
        let mean = |ps: &[[f64; 3]]| [0, 1, 2].map(|k| ps.iter().map(|p| p[k]).sum::<f64>() / ps.len() as f64);
        let faces: Vec<[f64; 3]> = self.quads.iter().map(|q| mean(&q.map(|v| self.points[v as usize]))).collect();
        // The sides of all faces by their ends: an edge is a run of two. Edges are numbered as their first sides come.
        let ends = self.quads.iter().flat_map(|q| (0..4).map(|i| (q[i], q[(i + 1) % 4])));
        let mut sides: Vec<(u64, u32)> =
            ends.enumerate().map(|(h, (a, b))| (order::key(a.min(b), a.max(b)), h as u32)).collect();
        order::sort(&mut sides);
        let edges: Vec<&[(u64, u32)]> = sides.chunk_by(|a, b| a.0 == b.0).collect();
        let mut first = vec![0; sides.len()];
        edges.iter().for_each(|run| run.iter().for_each(|side| first[side.1 as usize] = run[0].1 as usize));
        let mut number = vec![0; sides.len()];
        let mut count = 0;
        for h in 0..first.len() {
            number[h] = if first[h] == h { count } else { number[first[h]] };
            count += usize::from(first[h] == h);
        }
        let (n, m) = (self.points.len(), faces.len());
        let mut points = vec![[0.0; 3]; n + m + count];
        points[n..n + m].copy_from_slice(&faces);
        // A vertex of k edges goes to (k - 2) / k of itself, 1 / k of its neighbours' mean and 1 / k of its faces' mean.
        let mut valence = vec![0.0; n];
        let ends = || edges.iter().map(|run| order::parts(run[0].0));
        ends().flatten().for_each(|v| valence[v as usize] += 1.0);
        for (v, k) in valence.iter().enumerate() {
            points[v] = self.points[v].map(|x| x * (k - 2.0) / k);
        }
        let mut give = |v: u32, p: [f64; 3]| {
            let k: f64 = valence[v as usize];
            (0..3).for_each(|i| points[v as usize][i] += p[i] / (k * k));
        };
        for [a, b] in ends() {
            give(a, self.points[b as usize]);
            give(b, self.points[a as usize]);
        }
        for (f, q) in self.quads.iter().enumerate() {
            q.iter().for_each(|&v| give(v, faces[f]));
        }
        for (run, [a, b]) in edges.iter().zip(ends()) {
            let mut around = vec![self.points[a as usize], self.points[b as usize]];
            around.extend(run.iter().map(|side| faces[side.1 as usize / 4]));
            points[n + m + number[run[0].1 as usize]] = mean(&around);
        }
        let edge = |f: usize, c: usize| (n + m + number[4 * f + c]) as u32;
        let mut quads = Vec::with_capacity(4 * m);
        for (f, q) in self.quads.iter().enumerate() {
            for (c, &v) in q.iter().enumerate() {
                quads.push([v, edge(f, c), (n + f) as u32, edge(f, (c + 3) % 4)]);
            }
        }
        Cage { points, quads }
    }

    /// The cage in single precision.
    pub fn into_soup(self) -> Soup {
        Soup::from_faces(self.points.iter().map(|p| p.map(|x| x as f32)).collect(), &self.quads)
    }
}
