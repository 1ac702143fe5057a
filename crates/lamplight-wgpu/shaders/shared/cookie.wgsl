// The cookies of lamps: pictures on the plane, which multiply light (`cookie.rs` of the library).
//
// The importing shader binds `cookies`: the texels of all pictures, one after the other in rows.

#import shared/lamps

fn cookie_size(lamp: Lamp) -> vec2i {
    return vec2i(vec2u(lamp.cookie_size & 0xffffu, lamp.cookie_size >> 16u));
}

// A texel of a lamp's cookie; 0 outside.
fn cookie_texel(lamp: Lamp, at: vec2i) -> vec3f {
    let size = cookie_size(lamp);
    if any(at < vec2i(0)) || any(at >= size) {
        return vec3f(0.0);
    }
    let place = lamp.cookie_first + u32(at.y * size.x + at.x);
    let columns = textureDimensions(cookies).x;
    return textureLoad(cookies, vec2u(place % columns, place / columns), 0).rgb;
}

// The factors on a lamp's light at an offset from it.
fn in_cookie(lamp: Lamp, off: vec2f) -> vec3f {
    if lamp.cookie_size == 0u {
        return vec3f(1.0);
    }
    let size = vec2f(cookie_size(lamp));
    let axis = lamp.cookie_axis;
    // In texels from the middle of the first.
    let turned = vec2f(axis.x * off.x + axis.y * off.y, axis.x * off.y - axis.y * off.x);
    let at = turned + (0.5 * size - 0.5);
    if any(at <= vec2f(-1.0)) || any(at >= size) {
        return vec3f(0.0);
    }
    let low = floor(at);
    let part = at - low;
    let first = vec2i(low);
    let right = vec2i(1, 0);
    let below = vec2i(0, 1);
    let upper = mix(cookie_texel(lamp, first), cookie_texel(lamp, first + right), part.x);
    let lower =
        mix(cookie_texel(lamp, first + below), cookie_texel(lamp, first + below + right), part.x);
    return mix(upper, lower, part.y);
}
