//! Draws a few models in both themes to PNG files under the target folder, for looking at with one's own eyes.
//!
//! `cargo run -p limn-render --example look`

#[path = "../tests/common/mod.rs"]
mod common;

use common::{cube, frame, jack, orthographic, perspective, renderer, shoot, torus};
use limn_render::{Background, Edges, Faces, Shading, Style, SurfaceData};

fn main() {
    let Some(mut r) = renderer() else { return };
    println!("{}", r.gpu().describe());
    let (w, h) = (1200, 800);
    let aspect = w as f32 / h as f32;
    let models = [("jack", jack()), ("torus", torus(12, 6, 0.42)), ("cube", cube())];
    for (name, cage) in &models {
        let fine = cage.levels(3);
        let normals = fine.normals();
        let mut data = SurfaceData::new(&fine.points, &normals, Faces::Quads(&fine.quads));
        data.parents = fine.parents;
        r.set_surface(&data).unwrap();
        r.set_cage(&cage.points, &cage.edges(), &[]).unwrap();
        let size = r.bounds().unwrap().max[0];
        let camera = perspective([2.9 * size, 2.0 * size, 3.7 * size], [0.0; 3], aspect, 3.0 * size);
        for (theme, style) in [("light", Style::light()), ("dark", Style::dark())] {
            shoot(&mut r, &frame(camera, style.clone()), w, h).save(&format!("{name}-{theme}"));
            let bold = Style { edges: Edges::Bold, cage: true, ..style.clone() };
            shoot(&mut r, &frame(camera, bold), w, h).save(&format!("{name}-{theme}-bold-cage"));
            if *name == "jack" {
                let style = style.clone();
                let wire = Style { edges: Edges::Wire, ..style.clone() };
                shoot(&mut r, &frame(camera, wire), w, h).save(&format!("{name}-{theme}-wire"));
                let points = Style { points: true, edges: Edges::On, ..style.clone() };
                shoot(&mut r, &frame(camera, points), w, h).save(&format!("{name}-{theme}-points"));
                let flat = Style { shading: Shading::Flat, ..style.clone() };
                shoot(&mut r, &frame(camera, flat), w, h).save(&format!("{name}-{theme}-flat"));
                let clear = Style { background: Background::Transparent, ..style };
                let flatly = orthographic([5.0, 3.5, 6.5], [0.0; 3], aspect, 2.6, 6.0);
                shoot(&mut r, &frame(flatly, clear), w, h).save(&format!("{name}-{theme}-transparent"));
            }
        }
    }
}
