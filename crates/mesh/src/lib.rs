//! limn-mesh: the kernel.
pub mod soup;
