// The grid as the published cascades read it: emitted radiance, and in `w` the class of each cell. `bounce`
// adds what they scatter of the light of the solve before; `bounce_compared` also measures the change.

#import shared/change
#import shared/class
#import shared/normal
#import shared/uniforms

@group(0) @binding(1) var emission: texture_2d<f32>;
@group(0) @binding(2) var albedo: texture_2d<f32>;
@group(0) @binding(3) var matter: texture_2d<f32>;
@group(0) @binding(4) var<storage, read> light: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> source: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> changes: array<Change>;

fn matter_class(at: vec2u) -> u32 {
    return classify(textureLoad(matter, at, 0), 0.0);
}

fn put(at: vec2u, added: vec3f) {
    source[index(at)] = vec4f(textureLoad(emission, at, 0).rgb + added, f32(matter_class(at)));
}

fn scattered(at: vec2u) -> vec3f {
    return textureLoad(albedo, at, 0).rgb * light[index(at)].rgb;
}

// Returns whether a cell is a medium that scatters light.
fn scatters(at: vec2u) -> bool {
    return matter_class(at) == MEDIUM && any(textureLoad(albedo, at, 0).rgb != vec3f(0.0));
}

// Returns whether a cell is solid and has an open face.
fn is_wall(at: vec2u) -> bool {
    var seen = false;
    for (var face = 0u; face < 4u; face++) {
        let front = vec2i(at) + normal(face);
        seen = seen || (inside(front) && matter_class(vec2u(front)) != SOLID);
    }
    return seen && matter_class(at) == SOLID;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if !outside(id.xy) {
        put(id.xy, vec3f(0.0));
    }
}

@compute @workgroup_size(8, 8)
fn bounce(@builtin(global_invocation_id) id: vec3u) {
    if !outside(id.xy) {
        put(id.xy, scattered(id.xy));
    }
}

// The change, and the sum, is that of solid cells and of scattering media, with their emission; the mean is
// over walls and those media.
@compute @workgroup_size(SIDE, SIDE)
fn bounce_compared(thread: TileThread) {
    let id = thread.id;
    var own: Change;
    if !outside(id.xy) {
        let old = source[index(id.xy)];
        put(id.xy, scattered(id.xy));
        let scatters = scatters(id.xy);
        if class_of(old) == SOLID || scatters {
            own = change_of(old.rgb, source[index(id.xy)].rgb);
            own.count = select(0.0, 3.0, scatters || is_wall(id.xy));
        }
    }
    let all = over_group(own, thread.lane);
    if thread.lane == 0u {
        changes[tile_index(thread.tile)] = all;
    }
}
