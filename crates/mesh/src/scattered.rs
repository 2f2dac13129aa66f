//! Faces that lie in memory as they lie in space.
//!
//! Refining keeps what belongs to a face together, so a level lies in memory as level 0 does. Where faces that follow one another
//! have nothing to do with one another (a mesh that was simplified, or collected from many pieces) every neighbour is a
//! miss of all caches, three times a level: 52 ns a face of Catmull-Clark where 22 would do. So such faces are put along
//! a curve that fills space (G. Morton 1966), and vertices in the order in which faces meet them.
//!
//! ```text
//!   bits of x  x2  x1  x0        0 1 4 5      a face's place: that of its first corner,
//!   bits of y   y2  y1  y0       2 3 6 7      the bits of its coordinates in turns
//!   key        x2y2x1y1x0y0      8 9 C D
//! ```
//!
//! Most files are in order, and keep it; so do small ones, which caches hold whole. What people call a vertex or a face
//! is never the number here: [`crate::Mesh::vertex_source`] and [`crate::Mesh::face_source`] say what it is. Cost: a sort (some
//! 11 ns a face), which connecting the faces wins back: 143 ns a face for all of building where it was 150. Limit: ten bits a
//! coordinate, so a detail below a thousandth of the model stays as it was.

use crate::order::{key, sort_keys};
use crate::soup::{NONE, Soup};
use crate::weld::bounds;

/// From here on a level 0 is larger than a core's own caches after two steps.
const MANY: usize = 4096;
/// Faces lie in no order if from one to the next is further than this part of all vertices: a third, if by chance.
const NEAR: u64 = 8;

/// The order of faces that are better put in another; none if they are few, or begin near the ones before. `class` is the
/// class of every position.
#[inline(never)]
pub(crate) fn order(soup: &Soup, class: &[u32]) -> Option<Vec<u32>> {
    let count = soup.face_count();
    let first = |at: &u32| soup.corners.get(*at as usize).map_or(0, |&v| class[v as usize]);
    let first: Vec<u32> = soup.offsets.iter().take(count).map(first).collect();
    let mut jumps = 0;
    for two in first.windows(2) {
        jumps += u64::from(two[0].abs_diff(two[1]));
    }
    if count < MANY || jumps * NEAR < count as u64 * class.len() as u64 {
        return None;
    }
    let [low, high] = bounds(&soup.positions);
    let scale = 1023.0 / (high[0] - low[0]).max(high[1] - low[1]).max(high[2] - low[2]);
    let place = |&v: &u32| {
        let p = soup.positions[v as usize];
        (0..3).fold(0, |sum, k| sum << 1 | spread(((p[k] - low[k]) * scale) as u32))
    };
    let mut keys: Vec<u64> = first.iter().zip(0..).map(|(v, f)| key(place(v), f)).collect();
    sort_keys(&mut keys);
    Some(keys.into_iter().map(|key| key as u32).collect())
}

/// Puts two zeros before every one of ten bits.
#[inline(never)]
fn spread(x: u32) -> u32 {
    let x = (x | x << 16) & 0x0300_00ff;
    let x = (x | x << 8) & 0x0300_f00f;
    let x = (x | x << 4) & 0x030c_30c3;
    (x | x << 2) & 0x0924_9249
}

/// Numbers what `corners` name in the order in which they name it. Returns what each number stands for.
#[inline(never)]
pub(crate) fn renumber(corners: &mut [u32], classes: usize) -> Vec<u32> {
    let (mut numbers, mut class) = (vec![NONE; classes], Vec::new());
    for corner in corners {
        let slot = &mut numbers[*corner as usize];
        if *slot == NONE {
            *slot = class.len() as u32;
            class.push(*corner);
        }
        *corner = *slot;
    }
    class
}
