//! Every WGSL kernel is valid as it is handed to a device: its parts joined, with the constants of its variant before them.

use naga::valid::{Capabilities, ValidationFlags, Validator};

/// Every variant of every kernel that refines, as it is handed to the device.
#[test]
fn every_kernel_validates() {
    let kernels = limn_compute::shaders();
    assert!(kernels.len() > 30);
    for (name, source) in kernels {
        let module =
            naga::front::wgsl::parse_str(&source).unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(&source)));
        Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(&source)));
    }
}
