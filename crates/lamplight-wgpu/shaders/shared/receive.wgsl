// The entry point `receive`: gathers what each face of a solid cell, and each medium, scatters.
//
// The importing shader binds `albedo` and `light`, and defines `reflect_face(slot, albedo, at, face)` for faces
// and `scatter(slot, albedo, at)` for media, which write to `light[slot]`.

#import shared/class
#import shared/surfaces
#import shared/uniforms

@compute @workgroup_size(8, 8)
fn receive(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    let cell_class = class_of(source[i]);
    let own = textureLoad(albedo, id.xy, 0).rgb;
    let scatters = any(own != vec3f(0.0));
    for (var face = 0u; face < 4u; face++) {
        let slot = 4u * i + face;
        if scatters && cell_class == SOLID && exposed(id.xy, face) {
            reflect_face(slot, own, id.xy, face);
        } else if scatters && cell_class == MEDIUM && face == 0u {
            scatter(slot, own, id.xy);
        } else {
            light[slot] = vec4f(0.0);
        }
    }
}
