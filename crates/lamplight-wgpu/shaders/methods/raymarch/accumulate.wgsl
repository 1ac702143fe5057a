// Accumulates rays: mean, variance, and whether any ray met matter that changed.

#import shared/luminance
#import shared/uniforms

// Rays per sector. The noise is estimated sector by sector.
override SECTOR: u32;
// True if the variance is needed.
override VARIES: bool = false;

struct Sum {
    light: vec3f,
    invalidated: f32,
    // Σ L ω.
    moment_x: vec3f,
    moment_y: vec3f,
    // Luminance of even rays minus that of odd ones, over the current sector.
    alternating: f32,
    // Sum of the squares of `alternating` over the sectors before.
    squares: f32,
}

struct Mean {
    light: vec3f,
    invalidated: f32,
    // Variance of the luminance's noise: Σ (A − B)² / rays² over sectors, A and B the sums over every
    // other ray.
    variance: f32,
    moment_x: vec3f,
    moment_y: vec3f,
}

// Adds a ray; rays come in order. `seen.w` is 1 if it met a change.
fn add(sum: ptr<function, Sum>, ray: u32, seen: vec4f) {
    (*sum).light += seen.rgb;
    (*sum).invalidated = max((*sum).invalidated, seen.w);
    if VARIES {
        if ray % SECTOR == 0u {
            (*sum).squares += (*sum).alternating * (*sum).alternating;
            (*sum).alternating = 0.0;
        }
        (*sum).alternating += select(-1.0, 1.0, ray % 2u == 0u) * luminance(seen.rgb);
    }
}

fn mean(sum: Sum) -> Mean {
    let rays = f32(frame.rays);
    let variance = (sum.squares + sum.alternating * sum.alternating) / (rays * rays);
    return Mean(sum.light / rays, sum.invalidated, variance, sum.moment_x / rays, sum.moment_y / rays);
}
