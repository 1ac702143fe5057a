// The quadrant of a workgroup, of those that share a dispatch.

#import methods/holographic/sweep

@group(0) @binding(1) var<uniform> sweeps: array<Sweep, 4>;

// That of the workgroup's quadrant.
var<private> sweep: Sweep;

// Selects the quadrant of a workgroup. Along z they take turns; returns which of a quadrant's own it is.
fn select_quadrant(z: u32) -> u32 {
    let quadrants = sweeps[0].quadrants;
    sweep = sweeps[z % quadrants];
    return z / quadrants;
}
