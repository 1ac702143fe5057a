// Radiance in eight bytes: 19 bits per channel and a shared exponent, within 2e-6 of the brightest channel.

// Stands in the second face of a medium whose scattered radiance, in the first, is kept for the next frame. No
// radiance is packed with its exponent.
const KEPT_MEDIUM: vec2u = vec2u(~0u);

fn pack_rgb(rgb: vec3f) -> vec2u {
    let most = max(max(rgb.r, rgb.g), max(rgb.b, 1e-18));
    // The power of two above it; 2^-60 and less counts as 2^-60.
    let exponent = clamp(i32(bitcast<u32>(most) >> 23u) - 126, -60, 66);
    let scale = bitcast<f32>(u32(146 - exponent) << 23u);
    let mantissas = vec3u(min(rgb * scale + 0.5, vec3f(524287.0)));
    return vec2u(
        mantissas.r | (mantissas.g << 19u),
        (mantissas.g >> 13u) | (mantissas.b << 6u) | (u32(exponent + 60) << 25u),
    );
}

fn unpack_rgb(word: vec2u) -> vec3f {
    let exponent = i32(word.y >> 25u) - 60;
    let scale = bitcast<f32>(u32(exponent + 108) << 23u);
    let green = (word.x >> 19u) | ((word.y & 63u) << 13u);
    return vec3f(vec3u(word.x & 0x7ffffu, green, (word.y >> 6u) & 0x7ffffu)) * scale;
}
