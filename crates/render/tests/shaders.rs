//! Every WGSL module is valid, uses nothing that WebGL2 lacks, and translates to GLSL ES 3.00 with every entry point.

use naga::valid::{Capabilities, ValidationFlags, Validator};

#[test]
fn every_module_validates_and_translates_for_webgl2() {
    let modules = limn_render::shaders();
    assert!(modules.len() >= 6);
    for (name, source) in modules {
        let module =
            naga::front::wgsl::parse_str(&source).unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(&source)));
        let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(&source)));
        for entry in &module.entry_points {
            let options = naga::back::glsl::Options {
                version: naga::back::glsl::Version::Embedded { version: 300, is_webgl: true },
                ..Default::default()
            };
            let pipeline = naga::back::glsl::PipelineOptions {
                shader_stage: entry.stage,
                entry_point: entry.name.clone(),
                multiview: None,
            };
            let mut glsl = String::new();
            naga::back::glsl::Writer::new(
                &mut glsl,
                &module,
                &info,
                &options,
                &pipeline,
                naga::proc::BoundsCheckPolicies::default(),
            )
            .and_then(|mut w| w.write())
            .unwrap_or_else(|e| panic!("{name} {}: {e}", entry.name));
            if entry.name == "vs_shared" {
                assert!(glsl.contains("invariant gl_Position"), "{glsl}");
                assert!(glsl.contains("centroid"), "{glsl}");
            }
        }
    }
}

#[test]
fn the_uniform_has_the_size_that_the_shaders_expect() {
    let (_, source) = limn_render::shaders().remove(0);
    let module = naga::front::wgsl::parse_str(&source).unwrap();
    let size = module
        .types
        .iter()
        .find_map(|(_, t)| match (&t.name, &t.inner) {
            (Some(name), naga::TypeInner::Struct { span, .. }) if name == "Globals" => Some(*span),
            _ => None,
        })
        .unwrap();
    assert_eq!(size as usize, limn_render::uniform_bytes());
}
