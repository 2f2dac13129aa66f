// What a row's point is moved by: three numbers each, times the scale of all.

@group(0) @binding(3) var<storage, read> moves: array<f32>;
@group(1) @binding(2) var<storage, read> scale: array<f32>;

fn moved(i: u32) -> vec4<f32> {
    return scale[0] * vec4(moves[3u * i], moves[3u * i + 1u], moves[3u * i + 2u], 0.0);
}
