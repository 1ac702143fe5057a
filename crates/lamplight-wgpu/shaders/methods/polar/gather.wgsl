// Lights every pixel in reach of a lamp from the lamp's shadow map (`gather.rs` of the library).

#import methods/polar/lookup
#import shared/class
#import shared/class_at
#import shared/cookie
#import shared/layers
#import shared/moment
#import shared/normal
#import shared/reaching
#import shared/towards
#import shared/uniforms

override BLEND: u32;
const ADD: u32 = 0u;
const MAX: u32 = 1u;
const PI: f32 = 3.1415927;

@group(0) @binding(9) var<storage, read_write> light: array<vec4f>;
@group(0) @binding(10) var masks: texture_2d<f32>;
@group(0) @binding(11) var cookies: texture_2d<f32>;

fn blend(sum: vec3f, more: vec3f) -> vec3f {
    // What takes light away takes it from the sum, whatever that is made of.
    if BLEND == ADD || any(more < vec3f(0.0)) {
        return sum + more;
    }
    if BLEND == MAX {
        return max(sum, more);
    }
    let capped = min(more, vec3f(1.0));
    return sum + capped - sum * capped;
}

// The first moment of the light so far.
var<private> moment: array<vec3f, 2>;

// Blends the moment of light that is added to a sum, by the shares of both in the light that stays.
fn blend_moment(sum: vec3f, more: vec3f, direction: vec2f) {
    var kept = vec3f(1.0);
    var taken = more;
    if any(more < vec3f(0.0)) {
        kept = vec3f(1.0);
    } else if BLEND == MAX {
        let wins = more > sum;
        kept = select(vec3f(1.0), vec3f(0.0), wins);
        taken = select(vec3f(0.0), more, wins);
    } else if BLEND != ADD {
        taken = min(more, vec3f(1.0));
        kept = 1.0 - taken;
    }
    moment[0] = kept * moment[0] + taken * direction.x;
    moment[1] = kept * moment[1] + taken * direction.y;
}

// The light of a lamp at a cell: of an open cell at its centre; of a solid one (with `faces`) the mean
// irradiance of its exposed faces. Light of mean radiance J from one direction is `E/2 = ½∫L cosθ dθ =
// π·J·cosθ` on a face. Visibility is tested at the centre of the open cell before the face: every ray ends
// at the face itself.
fn light_of(lamp: Lamp, off: vec2f, faces: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var face = 0u; face < select(4u, 1u, faces == 0u); face++) {
        var place = off;
        var receives = off;
        var weight = 0.0;
        if faces == 0u {
            weight = falloff(lamp, length_of(off));
        } else if ((faces >> face) & 1u) == 1u {
            let normal = vec2f(normal(face));
            let on_face = off + 0.5 * normal;
            let away = length_of(on_face);
            weight = PI * -dot(normal, on_face) / max(away, MIN_POSITIVE) * falloff(lamp, away);
            receives = on_face;
            place += normal;
        }
        if weight > 0.0 {
            let picture = weight * in_cookie(lamp, receives);
            if any(picture > vec3f(0.0)) {
                sum += picture * arriving(lamp, place, length_of(place));
            }
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
    if class_at(cell) == SOLID {
        faces = exposed_faces(cell);
    }
    let lit = open(cell) || faces != 0u;
    let layers = layers_of(id.xy);
    var sum = vec3f(0.0);
    for (var first = 0u; first < lamps.count; first += 256u) {
        find_reaching(first, tile.xy, lane);
        for (var word = 0u; word < 8u; word++) {
            var left = atomicLoad(&reaching[word]);
            while left != 0u {
                let lamp = lamps.list[first + 32u * word + firstTrailingBit(left)];
                left &= left - 1u;
                let off = vec2f(id.xy) + 0.5 - lamp.position;
                if lit && (lamp.mask & layers) != 0u {
                    let more = light_of(lamp, off, faces);
                    // Nothing would still raise a sum that is below 0 to the maximum of both.
                    if all(more == vec3f(0.0)) {
                        continue;
                    }
                    if MOMENT && faces == 0u {
                        blend_moment(sum, more, towards(lamp, off, seen_place));
                    }
                    sum = blend(sum, more);
                }
            }
        }
    }
    if !outside(id.xy) {
        let i = index(id.xy);
        if lamps.more_follows == 0u {
            // Lamps take no more light than there is.
            sum = max(sum, vec3f(0.0));
            moment = limited(moment, sum);
        }
        light[i] = vec4f(sum, 1.0);
        if MOMENT {
            light[moment_index(0u, i)] = vec4f(moment[0], 1.0);
            light[moment_index(1u, i)] = vec4f(moment[1], 1.0);
        }
    }
}
