// Pass B of `polar`: every pixel in reach of a lamp looks its ray up (`canvas.rs` of the library).
//
// A workgroup is a tile. It takes the lamps 256 at a time: each thread asks whether one of them
// reaches the tile, then all pixels go through those that do, in the lamps' order, so that blending
// does not depend on how the work was shared.

override BLEND: u32;
const ADD: u32 = 0u;
const MAX: u32 = 1u;
const PI: f32 = 3.1415927;
const TILE: u32 = 16u;

@group(0) @binding(9) var<storage, read_write> light: array<vec4f>;

var<workgroup> reaching: array<atomic<u32>, 8>;

// Whether any pixel of a tile may be within reach; a px more on all sides, and one for the faces
// of walls.
fn reaches(lamp: u32, tile: vec2u) -> bool {
    let from_ = vec2f(tile * TILE);
    let position = lamps.list[lamp].position;
    let away = position - clamp(position, from_, from_ + f32(TILE));
    let reach = lamps.list[lamp].reach + 2.0;
    return dot(away, away) <= reach * reach;
}

fn blend(sum: vec3f, more: vec3f) -> vec3f {
    if BLEND == ADD {
        return sum + more;
    }
    if BLEND == MAX {
        return max(sum, more);
    }
    let share = min(more, vec3f(1.0));
    return sum + share - sum * share;
}

fn in_open(lamp: Lamp, off: vec2f) -> vec3f {
    let distance = sqrt(off.x * off.x + off.y * off.y);
    let share = falloff(lamp, distance);
    if share <= 0.0 {
        return vec3f(0.0);
    }
    return lamp.strength * (share * arriving(lamp, off, distance));
}

// The faces of a wall that look at cells that are not solid, left, right, top, bottom, a bit each.
fn exposed(cell: vec2i) -> u32 {
    var faces = 0u;
    for (var face = 0u; face < 4u; face++) {
        let kind = kind_at(cell + normal(face));
        faces |= select(0u, 1u << face, kind == EMPTY || kind == FOG);
    }
    return faces;
}

fn normal(face: u32) -> vec2i {
    let away = select(1i, -1i, (face & 1u) == 0u);
    return select(vec2i(0i, away), vec2i(away, 0i), face < 2u);
}

// What the exposed faces of a wall receive, on the mean. Light of fluence φ from one direction is
// `½∫L cosθ dθ = π·φ·cosθ` on a face. Whether it arrives is asked at the centre of the open cell
// before the face: at the face itself every ray ends.
fn on_wall(lamp: Lamp, off: vec2f, faces: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var face = 0u; face < 4u; face++) {
        if (faces >> face & 1u) == 0u {
            continue;
        }
        let normal = vec2f(normal(face));
        let at = off + 0.5 * normal;
        let away = sqrt(at.x * at.x + at.y * at.y);
        let cosine = -dot(normal, at) / max(away, LEAST);
        let arrives = PI * cosine * falloff(lamp, away);
        if arrives > 0.0 {
            let before_face = off + normal;
            let distance = sqrt(before_face.x * before_face.x + before_face.y * before_face.y);
            sum += arrives * arriving(lamp, before_face, distance);
        }
    }
    return lamp.strength * sum / f32(countOneBits(faces));
}

@compute @workgroup_size(16, 16)
fn main(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let cell = vec2i(id.xy);
    let kind = kind_at(cell);
    var faces = 0u;
    if kind == WALL {
        faces = exposed(cell);
    }
    var sum = vec3f(0.0);
    for (var first = 0u; first < lamps.count; first += 256u) {
        if lane < 8u {
            atomicStore(&reaching[lane], 0u);
        }
        workgroupBarrier();
        if first + lane < lamps.count && reaches(first + lane, tile.xy) {
            atomicOr(&reaching[lane / 32u], 1u << (lane % 32u));
        }
        workgroupBarrier();
        for (var word = 0u; word < 8u; word++) {
            var left = atomicLoad(&reaching[word]);
            while left != 0u {
                let lamp = lamps.list[first + 32u * word + firstTrailingBit(left)];
                left &= left - 1u;
                let off = vec2f(id.xy) + 0.5 - lamp.position;
                if kind == EMPTY || kind == FOG {
                    sum = blend(sum, in_open(lamp, off));
                } else if faces != 0u {
                    sum = blend(sum, on_wall(lamp, off, faces));
                }
            }
        }
        workgroupBarrier();
    }
    if !outside(id.xy) {
        light[index(id.xy)] = vec4f(sum, 1.0);
    }
}
