//! limn-mesh: the kernel.
pub mod shapes;
pub mod soup;
pub mod triangulate;
