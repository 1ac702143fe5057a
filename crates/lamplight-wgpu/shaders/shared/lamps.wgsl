// The lamps of a frame, as src/lamps.rs writes them.

#import shared/angle
#import shared/cone

struct Lamp {
    position: vec2f,
    // Length of its rays within the grid, px.
    reach: f32,
    range: f32,
    // Colour times intensity; below 0 the lamp takes light away.
    strength: vec3f,
    size: f32,
    falloff: u32,
    // Its first ray among those of all lamps, and their number.
    first: u32,
    count: u32,
    per_radian: f32,
    // As shared/cone.wgsl reads it.
    cone: vec3f,
    // Radius of the lamp in rays × px, 0 for hard edges.
    spread: f32,
    // The layers that it lights, a bit each.
    mask: u32,
    // Its place in the list.
    number: u32,
    // Values of the cone's brightness from edge to edge, and their number; none if it is even.
    profile_count: u32,
    // Height above the plane, px; 0 if its light has the elevation of all light.
    height: f32,
    // The direction of its cookie's rows, as long as there are texels per px.
    cookie_axis: vec2f,
    // Columns of the cookie, and rows times 2¹⁶; 0 without one.
    cookie_size: u32,
    // Its first texel among those of all cookies.
    cookie_first: u32,
    profile: array<vec4f, 4>,
}

struct Lamps {
    count: u32,
    // Rays of all lamps, each lamp padded to whole workgroups.
    rays: u32,
    // True if other direct light is added to that of these lamps.
    more_follows: u32,
    list: array<Lamp>,
}

@group(0) @binding(1) var<storage, read> lamps: Lamps;

const LINEAR: u32 = 0u;
const SMOOTH: u32 = 1u;

// The lamp of a ray.
fn lamp_of(ray: u32) -> u32 {
    var low = 0u;
    var high = lamps.count;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if lamps.list[middle].first <= ray {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

// A thread of a kernel that runs over rays, 64 per workgroup.
struct RayThread {
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
}

// The number of the first ray of a workgroup.
fn first_ray(group: vec3u, groups: vec3u) -> u32 {
    return (group.y * groups.x + group.x) * 64u;
}

// A ray: its index among those of all lamps, its lamp, and its number among that lamp's.
struct LampRay {
    index: u32,
    lamp: u32,
    number: u32,
    // False for padding behind the last ray of a lamp, and of all.
    exists: bool,
}

// The ray of a thread.
fn ray_of(thread: RayThread) -> LampRay {
    let ray = first_ray(thread.group, thread.groups) + thread.lane;
    if ray >= lamps.rays {
        return LampRay();
    }
    let lamp = lamp_of(ray);
    let number = ray - lamps.list[lamp].first;
    return LampRay(ray, lamp, number, number < lamps.list[lamp].count);
}

// The fraction of a lamp's light that arrives at an unoccluded distance: linear; smooth; or that of a
// disc, `asin(size/d)/π`, under the window of Karis (2013).
fn falloff(lamp: Lamp, distance: f32) -> f32 {
    let u = distance / lamp.range;
    let square = u * u;
    switch lamp.falloff {
        case LINEAR: {
            return max(1.0 - u, 0.0);
        }
        case SMOOTH: {
            let v = max(1.0 - square, 0.0);
            return v * v;
        }
        default: {
            let window = max(1.0 - square * square, 0.0);
            let sine = lamp.size / max(distance, lamp.size);
            let seen = angle(vec2f(sqrt(max(1.0 - sine * sine, 0.0)), sine)) * 0.31830989;
            return seen * window * window;
        }
    }
}

// The fraction of a lamp's light that leaves along ray `i` of `n`.
fn in_cone(lamp: Lamp, i: u32, n: u32) -> f32 {
    return lamp_share(lamp, TURN * (f32(i) / f32(n)));
}

fn profile_value(lamp: Lamp, i: u32) -> f32 {
    // Read from the list: an index into a copy would keep all of it in registers.
    return lamps.list[lamp.number].profile[i / 4u][i % 4u];
}

// The brightness of a cone at an angle from its axis.
fn profile_at(lamp: Lamp, beside: f32) -> f32 {
    let place = clamp(0.5 * beside / lamp.cone.y + 0.5, 0.0, 1.0) * f32(lamp.profile_count - 1u);
    let first = min(u32(place), lamp.profile_count - 2u);
    let low = profile_value(lamp, first);
    return low + (profile_value(lamp, first + 1u) - low) * (place - f32(first));
}

// The fraction of a lamp's light that leaves at an angle from −π to 2π.
fn lamp_share(lamp: Lamp, at: f32) -> f32 {
    let share = cone_share(lamp.cone, at);
    if share == 0.0 || lamp.profile_count == 0u {
        return share;
    }
    return share * profile_at(lamp, beside_axis(lamp.cone, at));
}
