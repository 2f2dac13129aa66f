// What every kernel of refinement begins with: the numbers of its dispatch, and which element an invocation works on.

struct Level {
    half_edges: u32,
    vertices: u32,
    faces: u32,
    first_face: u32, // child vertices on faces and on edges begin here
    first_edge: u32,
    owned: u32,      // edges from here on lie on the boundary and belong to the last side of their face
    middle: u32,     // triangles: half-edges from here on are of those in the middle of a face of the level before
    step: u32,       // the level's number
    corners: u32,    // whether boundary vertices of one face stay
    chaikin: u32,    // how creases soften
    marked: u32,     // vertices of level 0 that have marks; 0 if none has
    first: u32,      // what this dispatch works on: elements first .. end
    end: u32,
    a: f32,          // of the scheme
    b: f32,
    rest: u32,
};

@group(0) @binding(0) var<uniform> at: Level;

const GROUP = 256u;

// Which element this invocation works on: dispatches have two dimensions, because one ends at 65,535 groups.
fn element(id: vec3<u32>, groups: vec3<u32>) -> u32 {
    return at.first + id.x + id.y * groups.x * GROUP;
}
