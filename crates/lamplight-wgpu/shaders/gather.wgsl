// Rays added up: their mean, how noisy it is, and whether any of them met news.

// Rays whose noise is taken together.
override SECTOR: u32;
// Whether anybody asks for the variance.
override VARIES: bool = false;

struct Sum {
    light: vec3f,
    changed: f32,
    // Luminance of even rays less that of odd ones, over the sector at hand.
    alternating: f32,
    // Sum of its squares over the sectors before.
    squares: f32,
}

struct Mean {
    light: vec3f,
    changed: f32,
    // Variance of the luminance's noise: Σ (A − B)² / rays² over sectors, A and B the sums over every
    // other ray.
    variance: f32,
}

// Adds ray by ray, in order.
fn add(sum: ptr<function, Sum>, ray: u32, seen: vec4f) {
    (*sum).light += seen.rgb;
    (*sum).changed = max((*sum).changed, seen.w);
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
    return Mean(sum.light / rays, sum.changed, variance);
}
