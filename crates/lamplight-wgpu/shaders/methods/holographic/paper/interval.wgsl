// Intervals of the published cascades, in whole floats: by plane, ray, word and row. Level n has planes at
// x = j·2ⁿ, and from each cell of a plane the rays `v_n(k) = (2ⁿ, 2k − 2ⁿ)`, k = 0 … 2ⁿ.

#import methods/holographic/sweep
#import shared/interval

@group(0) @binding(1) var<uniform> sweep: Sweep;

// Floats of an interval: three of radiance; one of transmittance, or three if matter tints.
override WORDS: u32;

// The result of a dispatch.
@group(0) @binding(2) var<storage, read_write> made: array<f32>;

// The number of rays of a level from a cell.
fn rays(level: u32) -> u32 {
    return (1u << level) + 1u;
}

// Rows from one end of a ray to the other.
fn rise(level: u32, ray: u32) -> i32 {
    return 2i * i32(ray) - (1i << level);
}

// The index of the first float of an interval. The next one lies `sweep.rows` floats further.
fn place(level: u32, plane: u32, ray: u32, row: u32) -> u32 {
    return (plane * rays(level) + ray) * WORDS * sweep.rows + row;
}

fn store(at: u32, interval: Interval) {
    made[at] = interval.light.r;
    made[at + sweep.rows] = interval.light.g;
    made[at + 2u * sweep.rows] = interval.light.b;
    made[at + 3u * sweep.rows] = interval.transmittance.r;
    if WORDS == 6u {
        made[at + 4u * sweep.rows] = interval.transmittance.g;
        made[at + 5u * sweep.rows] = interval.transmittance.b;
    }
}
