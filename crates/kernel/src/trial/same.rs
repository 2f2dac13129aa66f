//! Whether two refinements are the same surface, whatever their numbering.
//!
//! Points are sorted along a direction in which symmetric meshes are not, and each takes the nearest of the other's that
//! is still free. The same again with the faces' centroids, so that equal points with other faces do not pass.
//! Cost: about n log n. Limit: it says that there is such a pairing, not that neighbours correspond.
#![expect(clippy::indexing_slicing, reason = "numbers of points are checked first, all others are made here")]

/// Points and faces, as they are compared.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// One a vertex.
    pub points: Vec<[f32; 3]>,
    /// How many corners each face has.
    pub counts: Vec<u32>,
    /// The corners of all faces in a row.
    pub corners: Vec<u32>,
}

/// A surface as it is compared: its points and its faces' centroids along the direction. Memory: 80 B a face.
pub struct Sorted {
    vertices: usize,
    faces: usize,
    points: Vec<Keyed>,
    centroids: Vec<Keyed>,
}

/// Where a point lies along the direction, and the point.
type Keyed = (f64, [f32; 3]);

impl Sorted {
    /// Sorts a surface.
    ///
    /// # Errors
    /// One sentence, if a corner names no vertex.
    pub fn new(surface: &Surface) -> Result<Sorted, String> {
        let Surface { points, counts, corners } = surface;
        let total: u64 = counts.iter().map(|&n| u64::from(n)).sum();
        if total != corners.len() as u64 || corners.iter().any(|&v| v as usize >= points.len()) {
            return Err("a corner names no vertex".to_owned());
        }
        let (vertices, faces) = (points.len(), counts.len());
        Ok(Sorted { vertices, faces, points: sorted(points.iter().copied()), centroids: sorted(centroids(surface)) })
    }

    /// How far the farthest pair of points or centroids lies apart, or in one sentence why there is no such pairing. With an
    /// infinite tolerance only the counts are compared.
    ///
    /// # Errors
    /// One sentence that says how the other one differs.
    pub fn distance(&self, other: &Sorted, tolerance: f64) -> Result<f64, String> {
        if (self.vertices, self.faces) != (other.vertices, other.faces) {
            let (v, f, w, g) = (self.vertices, self.faces, other.vertices, other.faces);
            return Err(format!("{v} vertices and {f} faces, and the other has {w} and {g}"));
        }
        if tolerance.is_infinite() {
            return Ok(0.0);
        }
        let points = pairing(&self.points, &other.points, tolerance).map_err(|d| format!("a point is {d:.1e} off"))?;
        let faces =
            pairing(&self.centroids, &other.centroids, tolerance).map_err(|d| format!("a face is {d:.1e} off"))?;
        Ok(points.max(faces))
    }
}

fn centroids(s: &Surface) -> impl Iterator<Item = [f32; 3]> {
    let mut corners = s.corners.iter();
    s.counts.iter().map(move |&n| {
        let mut sum = [0.0; 3];
        for &v in corners.by_ref().take(n as usize) {
            (0..3).for_each(|k| sum[k] += f64::from(s.points[v as usize][k]));
        }
        sum.map(|x| (x / f64::from(n)) as f32)
    })
}

fn sorted(points: impl Iterator<Item = [f32; 3]>) -> Vec<Keyed> {
    let along = |[x, y, z]: [f32; 3]| 0.538_196 * f64::from(x) + 0.317_811 * f64::from(y) + 0.780_623 * f64::from(z);
    let mut keyed: Vec<Keyed> = points.map(|p| (along(p), p)).collect();
    keyed.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    keyed
}

/// The largest distance of a pair; or how far the first point without a partner is from all others.
fn pairing(a: &[Keyed], b: &[Keyed], tolerance: f64) -> Result<f64, f64> {
    let mut free = vec![true; b.len()];
    let (mut first, mut worst) = (0, 0.0f64);
    // Along the direction points within the tolerance in each coordinate differ by no more than this.
    let reach = 2.0 * tolerance;
    for (key, p) in a {
        while first < b.len() && b[first].0 < key - reach {
            first += 1;
        }
        let apart = |i: usize| (0..3).map(|k| (f64::from(p[k]) - f64::from(b[i].1[k])).abs()).fold(0.0, f64::max);
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

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(a: &Surface, b: &Surface, tolerance: f64) -> Result<f64, String> {
        Sorted::new(a)?.distance(&Sorted::new(b)?, tolerance)
    }

    fn quad(points: [[f32; 3]; 4], corners: [u32; 4]) -> Surface {
        Surface { points: points.to_vec(), counts: vec![4], corners: corners.to_vec() }
    }

    #[test]
    fn another_numbering_is_the_same_surface_and_a_moved_point_is_not() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.25], [0.0, 1.0, 0.0]];
        let a = quad(square, [0, 1, 2, 3]);
        let turned = quad([square[2], square[3], square[0], square[1]], [2, 3, 0, 1]);
        assert_eq!(distance(&a, &turned, 1e-5), Ok(0.0));
        let mut moved = a.clone();
        moved.points[2][2] += 1e-3;
        assert_eq!(distance(&a, &moved, 1e-5), Err("a point is 1.0e-3 off".to_owned()));
        assert!(distance(&a, &moved, 2e-3).is_ok_and(|d| (d - 1e-3).abs() < 1e-6));
    }

    #[test]
    fn the_same_points_with_other_faces_are_another_surface() {
        let two = |corners: [u32; 6]| Surface {
            points: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
            counts: vec![3, 3],
            corners: corners.to_vec(),
        };
        let said = distance(&two([0, 1, 2, 0, 2, 3]), &two([0, 1, 3, 1, 2, 3]), 1e-5);
        assert!(said.is_err_and(|why| why.starts_with("a face is")));
        let fewer = quad([[0.0; 3]; 4], [0, 1, 2, 3]);
        let said = distance(&two([0, 1, 2, 0, 2, 3]), &fewer, f64::INFINITY);
        assert_eq!(said, Err("4 vertices and 2 faces, and the other has 4 and 1".to_owned()));
        assert!(distance(&two([0, 1, 2, 0, 2, 3]), &two([0, 1, 2, 0, 2, 4]), 1.0).is_err(), "there is no vertex 4");
    }
}
