//! From a primitive's indices to polygons.
//!
//! ```text
//!   list    0 1 2 | 3 4 5            strip   0 1 2 | 1 3 2 | 2 3 4        fan   0 1 2 | 0 2 3 | 0 3 4
//!   FB_ngon_encoding: a list in which each run of triangles with one first vertex is a polygon's fan
//! ```
//!
//! Strips use repeated vertices to jump; such triangles have no area and are left out. Source: glTF 2.0, section 3.7.2.1,
//! and the FB_ngon_encoding extension.

/// What the indices of a primitive mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    /// Every three.
    List,
    /// Every consecutive three, alternating in direction.
    Strip,
    /// The first with every consecutive two.
    Fan,
    /// Fans in a list.
    Polygons,
}

/// Calls `face` with every polygon's corners. Gives back whether indices were left over (fewer than a triangle), and
/// whether a run of a polygon list was no fan (then its triangles come out one by one).
pub(super) fn polygons(mode: Mode, indices: &[u32], mut face: impl FnMut(&[u32])) -> (bool, bool) {
    match mode {
        Mode::List => {
            let triangles = indices.chunks_exact(3);
            let leftover = !triangles.remainder().is_empty();
            triangles.for_each(face);
            (leftover, false)
        }
        Mode::Strip => {
            for (i, window) in indices.windows(3).enumerate() {
                let &[a, b, c] = window else { continue };
                if a != b && b != c && c != a {
                    face(&if i % 2 == 0 { [a, b, c] } else { [a, c, b] });
                }
            }
            (indices.len() < 3, false)
        }
        Mode::Fan => {
            let hub = indices.first().copied().unwrap_or(0);
            for pair in indices.get(1..).unwrap_or_default().windows(2) {
                let &[b, c] = pair else { continue };
                if hub != b && b != c && c != hub {
                    face(&[hub, b, c]);
                }
            }
            (indices.len() < 3, false)
        }
        Mode::Polygons => {
            let triangles = indices.chunks_exact(3);
            let leftover = !triangles.remainder().is_empty();
            let mut broken = false;
            let mut polygon: Vec<u32> = Vec::new();
            for triangle in triangles {
                let &[a, b, c] = triangle else { continue };
                if polygon.first() == Some(&a) && polygon.last() == Some(&b) {
                    polygon.push(c);
                    continue;
                }
                broken |= polygon.first() == Some(&a);
                if !polygon.is_empty() {
                    face(&polygon);
                }
                polygon.clear();
                polygon.extend([a, b, c]);
            }
            if !polygon.is_empty() {
                face(&polygon);
            }
            (leftover, broken)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(mode: Mode, indices: &[u32]) -> (Vec<Vec<u32>>, bool, bool) {
        let mut faces = Vec::new();
        let (leftover, broken) = polygons(mode, indices, |f| faces.push(f.to_vec()));
        (faces, leftover, broken)
    }

    #[test]
    fn every_mode() {
        assert_eq!(all(Mode::List, &[0, 1, 2, 3, 4, 5, 6]), (vec![vec![0, 1, 2], vec![3, 4, 5]], true, false));
        assert_eq!(
            all(Mode::Strip, &[0, 1, 2, 3, 4]),
            (vec![vec![0, 1, 2], vec![1, 3, 2], vec![2, 3, 4]], false, false)
        );
        // Two strips joined by repeated vertices.
        assert_eq!(all(Mode::Strip, &[0, 1, 2, 2, 5, 5, 6, 7]).0, [[0, 1, 2], [5, 7, 6]]);
        assert_eq!(all(Mode::Fan, &[9, 1, 2, 3, 3]), (vec![vec![9, 1, 2], vec![9, 2, 3]], false, false));
        assert_eq!(all(Mode::Fan, &[]), (vec![], true, false));
        assert_eq!(all(Mode::Fan, &[1, 2]), (vec![], true, false));
        assert_eq!(
            all(Mode::Polygons, &[0, 1, 2, 0, 2, 3, 0, 3, 4, 5, 4, 3, 6, 7, 8]),
            (vec![vec![0, 1, 2, 3, 4], vec![5, 4, 3], vec![6, 7, 8]], false, false)
        );
        assert_eq!(all(Mode::Polygons, &[0, 1, 2, 0, 5, 3]), (vec![vec![0, 1, 2], vec![0, 5, 3]], false, true));
    }
}
