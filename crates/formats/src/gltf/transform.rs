//! Node transforms, in f64: a rotation-scale part and a translation.
//!
//! A file gives each node sixteen numbers in columns, or a translation, a quaternion and a scale. The product along the
//! path from the root is applied to positions once, so nothing is rounded twice; where it is exactly the identity, the
//! positions' bits stay as they are.

use gltf::json::Value;

use super::document::numbers;

/// An affine map: three columns and a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Transform {
    pub columns: [[f64; 3]; 4],
}

impl Transform {
    pub const IDENTITY: Transform = Transform { columns: [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [0., 0., 0.]] };

    /// The transform of a node relative to its parent.
    pub fn of_node(node: &Value) -> Result<Self, String> {
        if let Some(m) = numbers::<16>(node, "matrix")? {
            let [a, b, c, e, f, g, h, i, j, k, l, n, x, y, z, w] = m;
            if [e, i, n] != [0.0; 3] || w != 1.0 {
                return Err("its matrix is not affine: the last row must be 0 0 0 1".to_owned());
            }
            return Ok(Transform { columns: [[a, b, c], [f, g, h], [j, k, l], [x, y, z]] });
        }
        let translation = numbers(node, "translation")?.unwrap_or([0.0; 3]);
        let rotation = numbers(node, "rotation")?.unwrap_or([0.0, 0.0, 0.0, 1.0]);
        let scale = numbers(node, "scale")?.unwrap_or([1.0; 3]);
        Ok(Self::from_parts(translation, rotation, scale))
    }

    /// Scale, then a rotation by the quaternion x y z w (normalised here), then a translation.
    pub fn from_parts(translation: [f64; 3], [x, y, z, w]: [f64; 4], [sx, sy, sz]: [f64; 3]) -> Self {
        let size = x * x + y * y + z * z + w * w;
        let s = if size > 0.0 { 2.0 / size } else { 0.0 };
        Transform {
            columns: [
                [1.0 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)].map(|c| c * sx),
                [s * (x * y - w * z), 1.0 - s * (x * x + z * z), s * (y * z + w * x)].map(|c| c * sy),
                [s * (x * z + w * y), s * (y * z - w * x), 1.0 - s * (x * x + y * y)].map(|c| c * sz),
                translation,
            ],
        }
    }

    fn linear(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [a, b, c, _] = self.columns;
        std::array::from_fn(|i| {
            let at = |column: [f64; 3]| column.get(i).copied().unwrap_or(0.0);
            at(a) * x + at(b) * y + at(c) * z
        })
    }

    /// The image of a point.
    pub fn point(&self, p: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = self.linear(p);
        let [_, _, _, [tx, ty, tz]] = self.columns;
        [x + tx, y + ty, z + tz]
    }

    /// `self` after `inner`.
    pub fn after(&self, inner: &Transform) -> Transform {
        let [a, b, c, t] = inner.columns;
        Transform { columns: [self.linear(a), self.linear(b), self.linear(c), self.point(t)] }
    }

    /// Whether faces turn inside out.
    pub fn mirrors(&self) -> bool {
        let [[a, b, c], [d, e, f], [g, h, i], _] = self.columns;
        a * (e * i - f * h) - d * (b * i - c * h) + g * (b * f - c * e) < 0.0
    }

    /// The bits, for telling equal transforms.
    pub fn key(&self) -> [[u64; 3]; 4] {
        self.columns.map(|c| c.map(f64::to_bits))
    }
}
