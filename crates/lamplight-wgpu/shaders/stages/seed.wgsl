// The seed map: occupied cells hold their own position, others NO_SEED.

#import shared/class
#import shared/uniforms

override NO_SEED: u32;

@group(0) @binding(1) var matter: texture_2d<f32>;
@group(0) @binding(2) var<storage, read_write> seeds: array<u32>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let own = id.x | (id.y << 16u);
    seeds[index(id.xy)] = select(NO_SEED, own, occupied(textureLoad(matter, id.xy, 0)));
}
