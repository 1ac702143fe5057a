// Packs the light of two neighbouring cones at a row into twelve bytes: per cone 14 bits per channel and a shared exponent,
// within 1.3e-4 of the brightest channel. The first word has the low bits of the first, the second the high bits of both, the
// third the low bits of the second; each word lies a row of words after the one before.
//
// The rounding is dithered by cone and row, with the R2 sequence (Roberts 2018). Errors that all cones share would add up
// over bounces; errors that differ are averaged away.

struct LightPair {
    first: vec3f,
    second: vec3f,
}

const PAIR_WORDS: u32 = 3u;

// The low 32 bits of a light, and the high 16; `dither` lies between 0 and 1.
fn pack_light(rgb: vec3f, dither: f32) -> vec2u {
    let most = max(rgb.r, max(rgb.g, rgb.b));
    // The power of two above it; 2^-27 and less counts as 2^-27.
    let exponent = clamp(i32(bitcast<u32>(most) >> 23u) - 126, -27, 36);
    let scale = bitcast<f32>(u32(141 - exponent) << 23u);
    let mantissas = vec3u(min(rgb * scale + dither, vec3f(16383.0)));
    return vec2u(
        mantissas.r | (mantissas.g << 14u) | (mantissas.b << 28u),
        (mantissas.b >> 4u) | (u32(exponent + 27) << 10u),
    );
}

fn unpack_light(low: u32, high: u32) -> vec3f {
    let scale = bitcast<f32>(((high >> 10u) + 86u) << 23u);
    let blue = (low >> 28u) | ((high & 0x3ffu) << 4u);
    return vec3f(vec3u(low & 0x3fffu, (low >> 14u) & 0x3fffu, blue)) * scale;
}

fn pack_pair(lights: LightPair, pair: u32, row: u32) -> vec3u {
    // The sequence's two steps, as fractions of 2^32.
    let place = pair * 3242174889u + row * 2447445414u;
    let dithers = vec2f(vec2u(place, place + 0x80000000u) >> vec2u(8u)) / 16777216.0;
    let first = pack_light(lights.first, dithers.x);
    let second = pack_light(lights.second, dithers.y);
    return vec3u(first.x, first.y | (second.y << 16u), second.x);
}

fn unpack_pair(words: vec3u) -> LightPair {
    return LightPair(unpack_light(words.x, words.y & 0xffffu), unpack_light(words.z, words.y >> 16u));
}
