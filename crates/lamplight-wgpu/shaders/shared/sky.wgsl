// The sky: a gradient over the sine of the elevation, or a panorama over the angle (crates/lamplight/src/panorama.rs),
// which the importing shader binds as `panorama`, one texel per column.

#import shared/angle
#import shared/uniforms

const RADIANS_PER_TURN: f32 = 6.2831855;

// The radiance of the sky along a ray of this direction.
fn sky(direction: vec2f) -> vec3f {
    if frame.sky_columns == 0u {
        return gradient(direction.y);
    }
    let at = sky_place(angle(direction));
    return between_columns(floor(at), at - floor(at));
}

// The mean radiance of the sky between two angles, over which the mean of the sine is `sine`.
fn sky_between(sine: f32, first: f32, last: f32) -> vec3f {
    if frame.sky_columns == 0u {
        return gradient(sine);
    }
    let start = sky_place(first);
    let end = sky_place(last);
    var sum = vec3f(0.0);
    for (var column = floor(start); column < end; column += 1.0) {
        let enter = max(start, column) - column;
        let leave = min(end, column + 1.0) - column;
        // Radiance is linear here: its mean is that in the middle.
        sum += (leave - enter) * between_columns(column, 0.5 * (enter + leave));
    }
    return sum / (end - start);
}

// The radiance of a gradient along a ray whose direction has the y component `dy`.
fn gradient(dy: f32) -> vec3f {
    return mix(frame.horizon, select(frame.ground, frame.zenith, dy < 0.0), abs(dy));
}

// The place of an angle on the strip, in columns from the middle of the first.
fn sky_place(at: f32) -> f32 {
    return frame.sky_origin + at / RADIANS_PER_TURN * f32(frame.sky_columns);
}

// The radiance between a column and the next, at a fraction of the way.
fn between_columns(column: f32, past: f32) -> vec3f {
    let count = i32(frame.sky_columns);
    // The remainder has the sign of the column.
    let first = (i32(column) % count + count) % count;
    let second = select(first + 1, 0, first + 1 == count);
    let a = textureLoad(panorama, vec2i(first, 0), 0).rgb;
    let b = textureLoad(panorama, vec2i(second, 0), 0).rgb;
    return mix(a, b, past);
}
