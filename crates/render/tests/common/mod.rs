//! Small models and a camera for pictures: made here, so that the renderer needs no sibling.
//!
//! The subdivision is a plain Catmull-Clark on closed all-quad meshes with hash maps; it only has to give the
//! vertex order (old, faces, edges) and quads in the order (old, edge, face, edge).
#![allow(dead_code)]

use std::collections::HashMap;

use glam::{Mat4, Vec3};
use limn_render::{Camera, Frame, Gpu, Renderer, Style, Tier};

pub type V = [f32; 3];

/// An all-quad mesh.
#[derive(Clone)]
pub struct Quads {
    pub points: Vec<V>,
    pub quads: Vec<u32>,
    pub parents: Option<[u32; 2]>,
}

impl Quads {
    pub fn normals(&self) -> Vec<V> {
        let mut n = vec![Vec3::ZERO; self.points.len()];
        for q in self.quads.chunks(4) {
            let p: Vec<Vec3> = q.iter().map(|&v| Vec3::from(self.points[v as usize])).collect();
            let a = (p[2] - p[0]).cross(p[3] - p[1]);
            for &v in q {
                n[v as usize] += a;
            }
        }
        n.into_iter().map(|v| v.normalize_or_zero().into()).collect()
    }

    pub fn subdivide(&self) -> Quads {
        let n = self.points.len();
        let f = self.quads.len() / 4;
        let p = |v: u32| Vec3::from(self.points[v as usize]);
        let face: Vec<Vec3> = self.quads.chunks(4).map(|q| q.iter().map(|&v| p(v)).sum::<Vec3>() / 4.0).collect();
        let mut edges: HashMap<(u32, u32), (u32, Vec3)> = HashMap::new();
        let mut order = Vec::new();
        for (i, q) in self.quads.chunks(4).enumerate() {
            for k in 0..4 {
                let (a, b) = (q[k], q[(k + 1) % 4]);
                let e = edges.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    order.push((a.min(b), a.max(b)));
                    (order.len() as u32 - 1, Vec3::ZERO)
                });
                e.1 += face[i];
            }
        }
        let (mut q_sum, mut r_sum, mut val) = (vec![Vec3::ZERO; n], vec![Vec3::ZERO; n], vec![0.0f32; n]);
        for (i, q) in self.quads.chunks(4).enumerate() {
            for &v in q {
                q_sum[v as usize] += face[i];
            }
        }
        for &(a, b) in &order {
            let m = (p(a) + p(b)) / 2.0;
            for v in [a, b] {
                r_sum[v as usize] += m;
                val[v as usize] += 1.0;
            }
        }
        let mut points: Vec<V> = (0..n)
            .map(|v| {
                let k = val[v];
                ((q_sum[v] / k + 2.0 * r_sum[v] / k + (k - 3.0) * p(v as u32)) / k).into()
            })
            .collect();
        points.extend(face.iter().map(|&v| V::from(v)));
        points.extend(order.iter().map(|&(a, b)| V::from((p(a) + p(b) + edges[&(a, b)].1) / 4.0)));
        let mut quads = Vec::new();
        for (i, q) in self.quads.chunks(4).enumerate() {
            let edge = |a: u32, b: u32| edges[&(a.min(b), a.max(b))].0 + (n + f) as u32;
            for k in 0..4 {
                let (prev, v, next) = (q[(k + 3) % 4], q[k], q[(k + 1) % 4]);
                quads.extend([v, edge(v, next), (n + i) as u32, edge(prev, v)]);
            }
        }
        Quads { points, quads, parents: Some([n as u32, (n + f) as u32]) }
    }

    pub fn levels(&self, n: usize) -> Quads {
        (0..n).fold(self.clone(), |m, _| m.subdivide())
    }

    pub fn edges(&self) -> Vec<[u32; 2]> {
        limn_render::overlay::edges(limn_render::Faces::Quads(&self.quads))
    }
}

/// The cube of half side 1.
pub fn cube() -> Quads {
    let points = (0..8).map(|i| [0, 1, 2].map(|b| if i >> b & 1 == 0 { -1.0 } else { 1.0 })).collect();
    let quads = vec![0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5];
    Quads { points, quads, parents: None }
}

/// A torus around y.
pub fn torus(around: u32, across: u32, r: f32) -> Quads {
    let mut points = Vec::new();
    let mut quads = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let (a, b) = (i as f32 / around as f32, j as f32 / across as f32);
            let (a, b) = (a * std::f32::consts::TAU, b * std::f32::consts::TAU);
            let d = 1.0 + r * b.cos();
            points.push([d * a.cos(), r * b.sin(), d * a.sin()]);
            let at = |i: u32, j: u32| (i % around) * across + j % across;
            quads.extend([at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
    Quads { points, quads, parents: None }
}

/// Pieces of a cube pulled out to a knobbly thing: like a jack.
pub fn jack() -> Quads {
    // A cube whose faces are extruded: the faces' four side walls and a smaller cap.
    let c = cube();
    let mut points = c.points.clone();
    let mut quads = Vec::new();
    for (i, q) in c.quads.chunks(4).enumerate() {
        let p: Vec<Vec3> = q.iter().map(|&v| Vec3::from(c.points[v as usize])).collect();
        let m = (p[0] + p[1] + p[2] + p[3]) / 4.0;
        let base = points.len() as u32;
        let (long, wide) = if i % 2 == 0 { (2.4, 0.55) } else { (2.0, 0.8) };
        points.extend(p.iter().map(|&v| V::from(m * long + (v - m) * wide)));
        for k in 0..4u32 {
            let l = (k + 1) % 4;
            quads.extend([q[k as usize], q[l as usize], base + l, base + k]);
        }
        quads.extend([base, base + 1, base + 2, base + 3]);
    }
    Quads { points, quads, parents: None }
}

/// Looks at `target` from `eye`; 30 degrees high, near and far around `radius`.
pub fn perspective(eye: V, target: V, aspect: f32, radius: f32) -> Camera {
    let (eye, target) = (Vec3::from(eye), Vec3::from(target));
    let d = eye.distance(target);
    let (near, far) = ((d - radius).max(d * 0.01), d + radius);
    let f = 1.0 / (15.0f32.to_radians()).tan();
    let proj = Mat4::from_cols_array_2d(&[
        [f / aspect, 0.0, 0.0, 0.0],
        [0.0, f, 0.0, 0.0],
        [0.0, 0.0, far / (near - far), -1.0],
        [0.0, 0.0, near * far / (near - far), 0.0],
    ]);
    Camera { view: look(eye, target), proj, up: Vec3::Y }
}

/// The same without perspective; `half` is half the height that is seen.
pub fn orthographic(eye: V, target: V, aspect: f32, half: f32, radius: f32) -> Camera {
    let (eye, target) = (Vec3::from(eye), Vec3::from(target));
    let d = eye.distance(target);
    let (near, far) = (d - radius, d + radius);
    let proj = Mat4::from_cols_array_2d(&[
        [1.0 / (half * aspect), 0.0, 0.0, 0.0],
        [0.0, 1.0 / half, 0.0, 0.0],
        [0.0, 0.0, 1.0 / (near - far), 0.0],
        [0.0, 0.0, near / (near - far), 1.0],
    ]);
    Camera { view: look(eye, target), proj, up: Vec3::Y }
}

fn look(eye: Vec3, target: Vec3) -> Mat4 {
    let back = (eye - target).normalize();
    let up = if back.y.abs() > 0.999 { Vec3::NEG_Z } else { Vec3::Y };
    let right = up.cross(back).normalize();
    let rotation = glam::Mat3::from_cols(right, back.cross(right), back);
    Mat4::from_mat3(rotation.transpose()) * Mat4::from_translation(-eye)
}

pub fn frame(camera: Camera, style: Style) -> Frame<'static> {
    Frame { camera, style, pixel_ratio: 1.0, hidden_groups: &[] }
}

/// A headless renderer; none (with a sentence) where the machine has no Vulkan adapter, unless `LIMN_GPU=require`.
pub fn renderer() -> Option<Renderer> {
    let instance = Gpu::instance(Tier::Native);
    match pollster::block_on(Gpu::new(&instance, None, Tier::Native)) {
        Ok(gpu) => Some(Renderer::new(gpu, wgpu::TextureFormat::Rgba8Unorm)),
        Err(e) => {
            assert!(std::env::var("LIMN_GPU").as_deref() != Ok("require"), "{e}");
            println!("skipped: {e} (mesa-vulkan-drivers brings a software one)");
            None
        }
    }
}

/// A picture's bytes with its width.
pub struct Picture {
    pub width: u32,
    pub height: u32,
    pub rgba: Vec<u8>,
}

impl Picture {
    pub fn at(&self, x: u32, y: u32) -> [u8; 4] {
        let i = 4 * (y * self.width + x) as usize;
        self.rgba[i..i + 4].try_into().unwrap()
    }

    pub fn save(&self, name: &str) {
        // Beside the running test or example, in whichever target folder that is.
        let exe = std::env::current_exe().unwrap();
        let dir = exe.ancestors().nth(2).unwrap().join("pictures");
        std::fs::create_dir_all(&dir).unwrap();
        let file = std::fs::File::create(dir.join(format!("{name}.png"))).unwrap();
        let mut encoder = png::Encoder::new(file, self.width, self.height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.write_header().unwrap().write_image_data(&self.rgba).unwrap();
    }
}

pub fn shoot(renderer: &mut Renderer, frame: &Frame<'_>, width: u32, height: u32) -> Picture {
    let rgba = pollster::block_on(renderer.image(frame, width, height).unwrap()).unwrap();
    assert_eq!(renderer.gpu().take_errors(), [] as [String; 0]);
    Picture { width, height, rgba }
}
