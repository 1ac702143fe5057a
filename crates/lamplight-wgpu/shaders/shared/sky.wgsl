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

// The mean of a strip between two columns, or what is there if they are the same. Radiance is linear from a column to the
// next: each texel counts by its share of the way.
fn mean_of_columns(strip: u32, columns: vec2f) -> vec3f {
    let length = columns.y - columns.x;
    var place = on_strip(strip, floor(columns.x));
    var mean = vec3f(0.0);
    for (var column = floor(columns.x); column <= floor(columns.y) + 1.0; column += 1.0) {
        let begin = columns.x - column;
        let share = select((share_before(begin + length) - share_before(begin)) / length, 1.0 - abs(begin), length == 0.0);
        mean += share * textureLoad(panorama, place, 0).rgb;
        place = next_on_strip(strip, place);
    }
    return mean;
}

// The share of a texel in the radiance of all columns before a place, counted from its own.
fn share_before(place: f32) -> f32 {
    let near = clamp(place, -1.0, 1.0);
    return 0.5 + near - 0.5 * near * abs(near);
}

// The radiance of a gradient along a ray whose direction has the y component `dy`.
fn gradient(dy: f32) -> vec3f {
    return mix(frame.horizon, select(frame.ground, frame.zenith, dy < 0.0), abs(dy));
}

// The place of an angle on the strip, in columns from the middle of the first.
fn sky_place(at: f32) -> f32 {
    return frame.sky_origin + at / RADIANS_PER_TURN * f32(frame.sky_columns);
}

// The texel of a column, which may lie on another turn around the circle.
fn on_strip(strip: u32, column: f32) -> vec2i {
    let count = i32(frame.sky_columns);
    let first = i32(column) - count * i32(floor(column / f32(count)));
    return vec2i(count * i32(strip / STRIPS) + first, i32(strip % STRIPS));
}

// The texel after another one of a strip, around the circle.
fn next_on_strip(strip: u32, place: vec2i) -> vec2i {
    let begin = i32(frame.sky_columns * (strip / STRIPS));
    let next = place.x + 1;
    return vec2i(select(next, begin, next == begin + i32(frame.sky_columns)), place.y);
}
