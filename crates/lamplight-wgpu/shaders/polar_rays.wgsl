// Pass A of `polar`: the rays of all lamps, one a thread. Each keeps how far it comes and which wall
// it meets, and where in a common store its knots of fog lie.

@group(0) @binding(5) var<storage, read_write> hits: array<vec2u>;
@group(0) @binding(6) var<storage, read_write> stretches: array<vec2u>;
@group(0) @binding(7) var<storage, read_write> knots: array<vec4f>;
// Knots in use, of all rays.
@group(0) @binding(8) var<storage, read_write> used: atomic<u32>;

var<private> storing: bool;
var<private> first_knot: u32;

fn keep(knot: Knot, number: u32) {
    if storing {
        knots[first_knot + number] = knot;
    }
}

// Where so many knots may lie; beyond the store where it is full, and then pixels find them anew.
fn store_for(count: u32) -> u32 {
    let most = arrayLength(&knots);
    // A full store counts no further, so that the count never runs over.
    if count > most || atomicLoad(&used) >= most {
        return most;
    }
    let first = atomicAdd(&used, count);
    return select(most, first, first <= most - count);
}

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let ray = ray_of(group, groups, lane);
    if !ray.is_one {
        return;
    }
    let lamp = lamps.list[ray.lamp];
    begin_knots(lamp);
    let hit = send(lamp, ray.number);
    end_knots();
    hits[ray.place] = vec2u(bitcast<u32>(hit.length), hit.cell);
    if !TRANSLUCENT {
        return;
    }
    // Only who crosses fog walks again, to store what it found.
    let count = kept;
    if count > 0u {
        first_knot = store_for(count);
        storing = first_knot < arrayLength(&knots);
        if storing {
            begin_knots(lamp);
            _ = send(lamp, ray.number);
            end_knots();
        }
    }
    stretches[ray.place] = vec2u(first_knot, count);
}
