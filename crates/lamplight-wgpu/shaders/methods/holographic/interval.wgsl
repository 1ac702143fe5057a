// Stored intervals, as on the CPU: 8 significant bits of radiance, 15 fractional bits of transmittance.

#import shared/interval

// 32-bit words of a stored interval: 2, or 3 if matter tints.
override WORDS: u32;
const ONE: u32 = 1u << 15u;

fn pack(i: Interval) -> vec3u {
    let light = bitcast<vec3u>(i.light) + 0x8000u;
    let transmittance = vec3u(i.transmittance * f32(ONE) + 0.5);
    return vec3u(
        (light.r & 0xffff0000u) | (light.g >> 16u),
        (light.b & 0xffff0000u) | transmittance.r,
        (transmittance.g << 16u) | transmittance.b,
    );
}

fn unpack(words: vec3u) -> Interval {
    let light = vec3u(words.x & 0xffff0000u, words.x << 16u, words.y & 0xffff0000u);
    let first = words.y & 0xffffu;
    let transmittance =
        select(vec3u(first), vec3u(first, words.z >> 16u, words.z & 0xffffu), WORDS == 3u);
    return Interval(bitcast<vec3f>(light), vec3f(transmittance) * (1.0 / f32(ONE)));
}
