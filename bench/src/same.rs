//! Whether two refinements are the same surface, whatever their numbering.
//!
//! Points are sorted along a direction in which symmetric meshes are not, and each takes the nearest of the other's that
//! is still free. The same again with the faces' centroids, so that equal points with other faces do not pass.
//! Cost: about n log n. Limit: it says that there is such a pairing, not that neighbours correspond.

/// Points and faces, as they are compared.
pub struct Surface {
    /// One a vertex.
    pub points: Vec<[f32; 3]>,
    /// How many corners each face has.
    pub counts: Vec<u32>,
    /// The corners of all faces in a row.
    pub corners: Vec<u32>,
}

/// How far the farthest pair of points or centroids lies apart, or in one sentence why there is no such pairing. With an
/// infinite tolerance only the counts are compared.
pub fn distance(a: &Surface, b: &Surface, tolerance: f64) -> Result<f64, String> {
    if (a.points.len(), a.counts.len()) != (b.points.len(), b.counts.len()) {
        let (v, f, w, g) = (a.points.len(), a.counts.len(), b.points.len(), b.counts.len());
        return Err(format!("{v} vertices and {f} faces, and the other has {w} and {g}"));
    }
    if tolerance.is_infinite() {
        return Ok(0.0);
    }
    let wide = |s: &Surface| s.points.iter().map(|p| p.map(f64::from)).collect();
    let points = pairing(wide(a), wide(b), tolerance).map_err(|d| format!("a point is {d:.1e} off"))?;
    let faces = pairing(centroids(a), centroids(b), tolerance).map_err(|d| format!("a face is {d:.1e} off"))?;
    Ok(points.max(faces))
}

fn centroids(s: &Surface) -> Vec<[f64; 3]> {
    let mut corners = s.corners.iter();
    s.counts
        .iter()
        .map(|&n| {
            let mut sum = [0.0; 3];
            for &v in corners.by_ref().take(n as usize) {
                (0..3).for_each(|k| sum[k] += f64::from(s.points[v as usize][k]));
            }
            sum.map(|x| x / f64::from(n))
        })
        .collect()
}

/// The largest distance of a pair; or how far the first point without a partner is from all others.
fn pairing(a: Vec<[f64; 3]>, b: Vec<[f64; 3]>, tolerance: f64) -> Result<f64, f64> {
    let along = |p: &[f64; 3]| 0.538_196 * p[0] + 0.317_811 * p[1] + 0.780_623 * p[2];
    let sorted = |points: Vec<[f64; 3]>| {
        let mut keyed: Vec<_> = points.into_iter().map(|p| (along(&p), p)).collect();
        keyed.sort_by(|x, y| x.0.total_cmp(&y.0));
        keyed
    };
    let (a, b) = (sorted(a), sorted(b));
    let mut free = vec![true; b.len()];
    let (mut first, mut worst) = (0, 0.0f64);
    // Along the direction points within the tolerance in each coordinate differ by no more than this.
    let reach = 2.0 * tolerance;
    for (key, p) in a {
        while first < b.len() && b[first].0 < key - reach {
            first += 1;
        }
        let apart = |i: usize| (0..3).map(|k| (p[k] - b[i].1[k]).abs()).fold(0.0, f64::max);
        let window = (first..b.len()).take_while(|&i| b[i].0 <= key + reach);
        let nearest = window.filter(|&i| free[i]).map(|i| (apart(i), i)).min_by(|x, y| x.0.total_cmp(&y.0));
        match nearest {
            Some((d, i)) if d <= tolerance => {
                free[i] = false;
                worst = worst.max(d);
            }
            _ => return Err((0..b.len()).filter(|&i| free[i]).map(apart).fold(f64::INFINITY, f64::min)),
        }
    }
    Ok(worst)
}
