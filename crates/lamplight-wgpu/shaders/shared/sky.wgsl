// The sky: a gradient over the sine of the elevation, or a panorama over the angle (crates/lamplight/src/panorama.rs),
// which the importing shader binds as `panorama`, one texel per column; with INFLOW, one strip of them per border cell.

#import shared/angle
#import shared/uniforms

// True if light enters by place on the border, in place of the sky.
override INFLOW: bool = false;
// Strips that then lie one below the other; the next lie beside them.
override STRIPS: u32 = 1u;

const RADIANS_PER_TURN: f32 = 6.2831855;

// The radiance of the sky along a ray of this direction.
fn sky(direction: vec2f) -> vec3f {
    if frame.sky_columns == 0u {
        return gradient(direction.y);
    }
    return mean_of_columns(0u, vec2f(sky_place(angle(direction))));
}

// The mean radiance of the sky between two angles, over which the mean of the sine is `sine`.
fn sky_between(sine: f32, first: f32, last: f32) -> vec3f {
    if frame.sky_columns == 0u {
        return gradient(sine);
    }
    return mean_of_columns(0u, vec2f(sky_place(first), sky_place(last)));
}

// The mean of a strip between two columns, or what is there if they are the same.
fn mean_of_columns(strip: u32, columns: vec2f) -> vec3f {
    let start = columns.x;
    let end = columns.y;
    if start == end {
        return between_columns(strip, floor(start), start - floor(start));
    }
    var place = on_strip(strip, floor(start));
    var a = textureLoad(panorama, place, 0).rgb;
    var sum = vec3f(0.0);
    for (var column = floor(start); column < end; column += 1.0) {
        place = next_on_strip(strip, place);
        let b = textureLoad(panorama, place, 0).rgb;
        let enter = max(start, column) - column;
        let leave = min(end, column + 1.0) - column;
        // Radiance is linear here: its mean is that in the middle.
        sum += (leave - enter) * mix(a, b, 0.5 * (enter + leave));
        a = b;
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

// The radiance between a column of a strip and the next, at a fraction of the way.
fn between_columns(strip: u32, column: f32, past: f32) -> vec3f {
    let place = on_strip(strip, column);
    let a = textureLoad(panorama, place, 0).rgb;
    let b = textureLoad(panorama, next_on_strip(strip, place), 0).rgb;
    return mix(a, b, past);
}

// The texel of a column, which may lie on another turn around the circle.
fn on_strip(strip: u32, column: f32) -> vec2i {
    let count = i32(frame.sky_columns);
    // The remainder has the sign of the column.
    let first = (i32(column) % count + count) % count;
    return vec2i(count * i32(strip / STRIPS) + first, i32(strip % STRIPS));
}

// The texel after another one of a strip, around the circle.
fn next_on_strip(strip: u32, place: vec2i) -> vec2i {
    let begin = i32(frame.sky_columns * (strip / STRIPS));
    let next = place.x + 1;
    return vec2i(select(next, begin, next == begin + i32(frame.sky_columns)), place.y);
}
