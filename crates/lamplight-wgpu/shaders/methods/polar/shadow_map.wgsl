// The shadow maps of all lamps, one ray per thread. Each ray keeps its length and the solid cell that it
// meets, and where the corners of its transmittance curve lie in a common store.

#import methods/polar/shadow_ray

@group(0) @binding(5) var<storage, read_write> hits: array<vec2u>;
// The first corner of each ray, and their number.
@group(0) @binding(6) var<storage, read_write> curves: array<vec2u>;
@group(0) @binding(7) var<storage, read_write> corners: array<vec4f>;
// Corners in use, of all rays.
@group(0) @binding(8) var<storage, read_write> used: atomic<u32>;

var<private> storing: bool;
var<private> first_corner: u32;

fn keep(corner: Corner, number: u32) {
    if storing {
        corners[first_corner + number] = corner;
    }
}

// Reserves room in the store. Returns an index beyond it if it is full; pixels then trace the ray again.
fn reserve(count: u32) -> u32 {
    let most = arrayLength(&corners);
    // The counter of a full store stops, so that it never overflows.
    if count > most || atomicLoad(&used) >= most {
        return most;
    }
    let first = atomicAdd(&used, count);
    return select(most, first, first <= most - count);
}

@compute @workgroup_size(64)
fn main(thread: RayThread) {
    let ray = ray_of(thread);
    if !ray.exists {
        return;
    }
    let lamp = lamps.list[ray.lamp];
    begin_curve(lamp);
    let hit = trace(lamp, ray.number);
    end_curve();
    hits[ray.index] = vec2u(bitcast<u32>(hit.length), hit.cell);
    if !TRANSLUCENT {
        return;
    }
    // Only a ray through a medium is traced twice, the second time to store its curve.
    let count = kept;
    if count > 0u {
        first_corner = reserve(count);
        storing = first_corner < arrayLength(&corners);
        if storing {
            begin_curve(lamp);
            _ = trace(lamp, ray.number);
            end_curve();
        }
    }
    curves[ray.index] = vec2u(first_corner, count);
}
