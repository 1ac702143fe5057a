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

// The faces of a wall that look at cells that are not solid, left, right, top, bottom, a bit each.
fn exposed(cell: vec2i) -> u32 {
    var faces = 0u;
    for (var face = 0u; face < 4u; face++) {
        faces |= select(0u, 1u << face, open(cell + normal(face)));
    }
    return faces;
}

// What a cell receives from a lamp: an open one at its centre; a wall (with `faces`) on the mean over
// its exposed faces. Light of fluence φ from one direction is `½∫L cosθ dθ = π·φ·cosθ` on a face.
// Whether it arrives is asked at the centre of the open cell before the face: at the face itself
// every ray ends.
fn received(lamp: Lamp, off: vec2f, faces: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var face = 0u; face < select(4u, 1u, faces == 0u); face++) {
        var place = off;
        var share = 0.0;
        if faces == 0u {
            share = falloff(lamp, length_of(off));
        } else if ((faces >> face) & 1u) == 1u {
            let normal = vec2f(normal(face));
            let on_face = off + 0.5 * normal;
            let away = length_of(on_face);
            share = PI * -dot(normal, on_face) / max(away, LEAST) * falloff(lamp, away);
            place += normal;
        }
        if share > 0.0 {
            sum += share * arriving(lamp, place, length_of(place));
        }
    }
    return lamp.strength * sum / f32(max(countOneBits(faces), 1u));
}

@compute @workgroup_size(16, 16)
fn main(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let cell = vec2i(id.xy);
    var faces = 0u;
    if kind_at(cell) == WALL {
        faces = exposed(cell);
    }
    let lit = open(cell) || faces != 0u;
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
                if lit {
                    sum = blend(sum, received(lamp, off, faces));
                }
            }
        }
        workgroupBarrier();
    }
    if !outside(id.xy) {
        light[index(id.xy)] = vec4f(sum, 1.0);
    }
}
