// Shows the light of pixels, smoothed by a cross that removes the checkerboard of planes of odd and even
// index (1, 4, 1 ÷ 8 as published, without cells of a different opacity); on solid cells the mean in front
// of their faces.

#import shared/uniforms

@group(0) @binding(1) var matter: texture_2d<f32>;
// Light of all directions, ∫L dω, three floats per cell.
@group(0) @binding(2) var<storage, read> total: array<f32>;
@group(0) @binding(3) var<storage, read_write> light: array<vec4f>;

const TAU: f32 = 6.2831855;

fn opacity(at: vec2i) -> f32 {
    return textureLoad(matter, at, 0).a;
}

// The cell to the left, right, top or bottom.
fn neighbour(at: vec2i, side: u32) -> vec2i {
    let away = select(1i, -1i, (side & 1u) == 0u);
    return at + select(vec2i(0i, away), vec2i(away, 0i), side < 2u);
}

fn sharp(at: vec2i) -> vec3f {
    let i = 3u * index(vec2u(at));
    return vec3f(total[i], total[i + 1u], total[i + 2u]) / TAU;
}

fn smoothed(at: vec2i) -> vec3f {
    let own = opacity(at);
    var sum = 4.0 * sharp(at);
    var weight = 4.0;
    for (var side = 0u; side < 4u; side++) {
        let beside = neighbour(at, side);
        if inside(beside) && opacity(beside) == own {
            sum += sharp(beside);
            weight += 1.0;
        }
    }
    return sum / weight;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let at = vec2i(id.xy);
    var seen = vec3f(0.0);
    if opacity(at) < 1.0 {
        seen = smoothed(at);
    } else {
        var faces = 0.0;
        for (var side = 0u; side < 4u; side++) {
            let front = neighbour(at, side);
            if inside(front) && opacity(front) < 1.0 {
                seen += smoothed(front);
                faces += 1.0;
            }
        }
        seen /= max(faces, 1.0);
    }
    light[index(id.xy)] = vec4f(seen, 1.0);
}
