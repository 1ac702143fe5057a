// Packs the light of two neighbouring cones at a row into twelve bytes: per cone 14 bits per channel and a shared exponent,
// within 1.3e-4 of the brightest channel. The first word has the low bits of the first, the second the high bits of both, the
// third the low bits of the second; each word lies a row of words after the one before.
//
// Six bits of exponent reach from steps of 2^-41, for dim scenes, to 2^66, the brightest of packed_rgb.wgsl: beyond 2^26
// exponents are 4 apart, so that very bright light is rounded more, to 1e-3 at worst.
//
// The rounding is dithered by cone and row, with the R2 sequence (Roberts 2018). Errors that all cones share would add up
// over bounces; errors that differ are averaged away.

struct LightPair {
    first: vec3f,
    second: vec3f,
}

const PAIR_WORDS: u32 = 3u;

// The exponent of code 0, the last of those that are 1 apart, and the last.
const LEAST: i32 = -27;
const FINE: i32 = 26;
const MOST: i32 = 66;
const FINE_CODE: u32 = u32(FINE - LEAST);

fn exponent_of(code: u32) -> i32 {
    return i32(code + 3u * (max(code, FINE_CODE) - FINE_CODE)) + LEAST;
}

// The low 32 bits of a light, and the high 16; `dither` lies between 0 and 1.
fn pack_light(rgb: vec3f, dither: f32) -> vec2u {
    let most = max(rgb.r, max(rgb.g, rgb.b));
    // The power of two above it.
    let exponent = clamp(i32(bitcast<u32>(most) >> 23u) - 126, LEAST, MOST);
    let code = u32(min(exponent, FINE) - LEAST + (max(exponent, FINE) - FINE + 3) / 4);
    let scale = bitcast<f32>(u32(141 - exponent_of(code)) << 23u);
    let mantissas = vec3u(min(rgb * scale + dither, vec3f(16383.0)));
    return vec2u(
        mantissas.r | (mantissas.g << 14u) | (mantissas.b << 28u),
        (mantissas.b >> 4u) | (code << 10u),
    );
}

fn unpack_light(low: u32, high: u32) -> vec3f {
    let scale = bitcast<f32>(u32(exponent_of(high >> 10u) + 113) << 23u);
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
