// The visible part of a light, exactly: what no solid cell hides of it (`penumbra.rs` of the library derives it,
// and has the same numbers).
//
// Solid cells are taken block by block from the packed classes, nearest first, and in a block row by row. There is
// no shadow map: most blocks of a triangle are empty, and a word says so.

#import shared/traverse
#import shared/transmittance

// Intervals of the light that are this near belong to one wall.
const TOUCHING: f32 = 1e-4;
// Distance ahead of the pixel from which on cells are in its way, px.
const AHEAD: f32 = 1e-6;
// The smallest part of a lamp, −1 to 1, that may stand for the whole.
const SMALLEST_PART: f32 = 1e-3;
// Steps from the middle of a lamp to its rim in which the part is told apart before which media count.
const STEPS: f32 = 256.0;
// The place of corners beside and behind the pixel: far outside of the light.
const BESIDE: f32 = 1e6;
// Distance of a point on a face from its wall, px: in the open for rounding's sake.
const OUTSIDE_OF_WALL: f32 = 1e-3;
// Most gaps between walls that are told apart.
const GAPS: u32 = 16u;
// Fewest and most points across the light to which rays are cast through media, one per px, and their number in
// place of one where media differ from those before a point beside it.
const FEWEST_RAYS: u32 = 8u;
const MOST_RAYS: u32 = 48u;
const FINER: u32 = 4u;
// Half the width of a fan that five rays do not leave a pane of 2 px between them, px.
const NARROW: f32 = 4.0;
// The difference of transmittance from which on they differ, and that up to which all media are even.
const DIFFERENT: f32 = 0.05;
const EVEN: f32 = 0.003;

const VISITS_EMPTY: bool = false;

// The rays from a pixel to all points of a light, from −1 to 1.
struct Fan {
    pixel: vec2f,
    // The direction of the middle of the light.
    ahead: vec2f,
    // The distance of the light, px; FAR for a sun.
    distance: f32,
    // Half the width of the fan per px ahead.
    slope: f32,
    // The distance ahead up to which walls may be in the way, px.
    until: f32,
}

// A lamp, or the eye of a viewer, as pixels see it.
struct LampDisc {
    center: vec2f,
    radius: f32,
}

// The hidden parts of the light in hand.
var<private> parts: array<vec2f, GAPS>;
var<private> part_count: u32;
// The part of a light that stands for the whole: its middle, and half of its width.
const WHOLE = vec2f(0.0, 1.0);
// That of the lamp in hand, which its centre sees. The rest is hidden, too.
var<private> stands: vec2f;
// True if there are media in the blocks of its fan.
var<private> meets_media: bool;

fn hide_nothing() {
    part_count = 0u;
    stands = WHOLE;
    meets_media = false;
}

// Hides an interval.
fn hide(interval: vec2f) {
    var joined = clamp(interval, vec2f(-1.0), vec2f(1.0));
    if joined.x >= joined.y {
        return;
    }
    var kept = 0u;
    for (var k = 0u; k < part_count; k++) {
        let part = parts[k];
        // Where there is no room for one more, it joins the last.
        let full = k + 1u == GAPS;
        if full || (part.x <= joined.y + TOUCHING && part.y >= joined.x - TOUCHING) {
            joined = vec2f(min(joined.x, part.x), max(joined.y, part.y));
        } else {
            parts[kept] = part;
            kept++;
        }
    }
    parts[kept] = joined;
    part_count = kept + 1u;
}

// Returns whether a point of the light is hidden.
fn is_hidden(at: f32) -> bool {
    for (var k = 0u; k < part_count; k++) {
        if parts[k].x <= at && at < parts[k].y {
            return true;
        }
    }
    return false;
}

fn all_is_hidden() -> bool {
    return part_count == 1u && all(parts[0] == vec2f(-1.0, 1.0));
}

// The middle of the widest part that is seen.
fn widest_gap() -> f32 {
    var widest = vec2f(0.0);
    for (var k = 0u; k <= part_count; k++) {
        var gap = vec2f(-1.0, 1.0);
        if k < part_count {
            gap.x = parts[k].y;
        }
        for (var ahead = 0u; ahead < part_count; ahead++) {
            if parts[ahead].y > gap.x {
                gap.y = min(gap.y, parts[ahead].x);
            }
        }
        if gap.y - gap.x > widest.y - widest.x {
            widest = gap;
        }
    }
    return 0.5 * (widest.x + widest.y);
}

// The fraction of the light that is seen, of the part that stands for it.
fn seen() -> f32 {
    var hidden = 0.0;
    for (var k = 0u; k < part_count; k++) {
        hidden += parts[k].y - parts[k].x;
    }
    return max(1.0 - 0.5 * hidden, 0.0) / stands.y;
}

// The mean place across the light of what is seen of it, −1 to 1.
fn seen_middle() -> f32 {
    var moment = 0.0;
    var hidden = 0.0;
    for (var k = 0u; k < part_count; k++) {
        moment += 0.25 * (parts[k].y * parts[k].y - parts[k].x * parts[k].x);
        hidden += parts[k].y - parts[k].x;
    }
    let left = 1.0 - 0.5 * hidden;
    return select(0.0, clamp(-moment / left - stands.x, -1.0, 1.0), left > 0.0);
}

// One of `count` points across a light.
fn point(number: u32, count: u32) -> f32 {
    return f32(2u * number + 1u) / f32(count) - 1.0;
}

// The interval that a rectangle of solid cells hides.
fn hidden_by(fan: Fan, low: vec2f, high: vec2f) -> vec2f {
    let beside = vec2f(fan.ahead.y, -fan.ahead.x);
    let scale = 1.0 / fan.slope;
    let corners = array(low, vec2f(high.x, low.y), high, vec2f(low.x, high.y));
    let nothing = vec2f(BESIDE, -BESIDE);
    var interval = nothing;
    var nearest = fan.distance;
    var before = vec2f(dot(corners[3] - fan.pixel, fan.ahead), dot(corners[3] - fan.pixel, beside));
    for (var i = 0u; i < 4u; i++) {
        let off = corners[i] - fan.pixel;
        // Px ahead of the pixel, and beside the line of sight.
        let corner = vec2f(dot(off, fan.ahead), dot(off, beside));
        let steps = (before.y - corner.y) / (before.x - corner.x);
        nearest = min(nearest, corner.x);
        if (corner.x > AHEAD) != (before.x > AHEAD) {
            // The rectangle goes on beside the pixel, to this side.
            let side = corner.y + steps * (AHEAD - corner.x);
            let at = select(BESIDE, -BESIDE, side < 0.0);
            interval = vec2f(min(interval.x, at), max(interval.y, at));
        }
        if (corner.x > fan.distance) != (before.x > fan.distance) {
            let at = (corner.y + steps * (fan.distance - corner.x)) * scale / fan.distance;
            interval = vec2f(min(interval.x, at), max(interval.y, at));
        }
        if corner.x > AHEAD && corner.x <= fan.distance {
            let at = corner.y * scale / corner.x;
            interval = vec2f(min(interval.x, at), max(interval.y, at));
        }
        before = corner;
    }
    // What touches the light from behind hides nothing of it.
    return select(interval, nothing, nearest == fan.distance);
}

// Hides what the solid cells of a block hide, a bit each.
fn hide_behind_block(fan: Fan, block: vec2u, solid: u32) {
    let start = vec2f(4u * block);
    if solid == 0x55555555u {
        hide(hidden_by(fan, start, start + 4.0));
        return;
    }
    for (var row = 0u; row < 4u; row++) {
        // Two bits per cell, so that runs are runs of bits.
        var cells = ((solid >> (8u * row)) & 0x55u) * 3u;
        while cells != 0u {
            let first = firstTrailingBit(cells);
            let length = firstTrailingBit(~(cells >> first));
            let low = start + vec2f(f32(first) * 0.5, f32(row));
            hide(hidden_by(fan, low, low + vec2f(f32(length) * 0.5, 1.0)));
            cells &= ~(((1u << length) - 1u) << first);
        }
    }
}

// Hides what solid cells hide of a light.
fn hide_behind_walls(fan: Fan) {
    // Blocks in columns, or in rows, from the pixel on.
    let steep = abs(fan.ahead.y) > abs(fan.ahead.x);
    let pixel = select(fan.pixel, fan.pixel.yx, steep);
    let ahead = select(fan.ahead, fan.ahead.yx, steep);
    let side = fan.slope * select(vec2f(fan.ahead.y, -fan.ahead.x), vec2f(-fan.ahead.x, fan.ahead.y), steep);
    let size = vec2i(select(frame.size, frame.size.yx, steep));
    let ends = array(pixel + fan.until * (ahead - side), pixel + fan.until * (ahead + side));
    let lines = vec2f(min(min(ends[0].x, ends[1].x), pixel.x), max(max(ends[0].x, ends[1].x), pixel.x));
    let bounds = vec2f(min(min(ends[0].y, ends[1].y), pixel.y), max(max(ends[0].y, ends[1].y), pixel.y));
    var slopes: array<f32, 2>;
    for (var i = 0u; i < 2u; i++) {
        // A side of the triangle that runs across the lines meets one of them only.
        let along = ends[i].x - pixel.x;
        slopes[i] = select((ends[i].y - pixel.y) / along, 0.0, abs(along) < 1e-3);
    }
    let last_block = (size - 1) / 4;
    let range = clamp(vec2i(floor(lines)) / 4, vec2i(0), vec2i(last_block.x));
    for (var k = range.x; k <= range.y; k++) {
        let line = select(range.x + range.y - k, k, ahead.x > 0.0);
        // Between the sides of the triangle, within the line.
        var within = vec2f(FAR, -FAR);
        for (var i = 0u; i < 4u; i++) {
            let edge = clamp(4.0 * f32(line + i32(i & 1u)), lines.x, lines.y);
            let at = pixel.y + slopes[i >> 1u] * (edge - pixel.x);
            within = vec2f(min(within.x, at), max(within.y, at));
        }
        // Steep sides leave the triangle beyond its corners.
        within = select(clamp(within, bounds.xx, bounds.yy), bounds, fan.slope > 0.5);
        let blocks = clamp(vec2i(floor(within)) / 4, vec2i(0), vec2i(last_block.y));
        for (var other = blocks.x; other <= blocks.y; other++) {
            let block = vec2u(select(vec2i(line, other), vec2i(other, line), steep));
            let word = word_at(4u * block);
            let media = word & ~(word >> 1u) & 0x55555555u;
            let solid = ((word >> 1u) & ~word & 0x55555555u) | select(media, 0u, TRANSLUCENT);
            meets_media |= TRANSLUCENT && media != 0u;
            if solid != 0u {
                hide_behind_block(fan, block, solid);
            }
        }
        if all_is_hidden() {
            return;
        }
    }
}

// The direction from the centre of a lamp to its rim, forwards or backwards across the line of sight.
fn to_rim(across: vec2f, sign: f32) -> Direction {
    let way = sign * across;
    return direction(abs(way), select(vec2f(1.0), vec2f(-1.0), way < vec2f(0.0)));
}

// The ends of what the centre of a lamp sees of it, before and after itself on the line `across` the line of sight, 0 to 1:
// up to a wall, or to the border of the grid, unless all of it lies beyond, at a corner.
fn seen_by_center(lamp: LampDisc, across: vec2f) -> vec2f {
    let to_borders = min(lamp.center, vec2f(frame.size) - lamp.center);
    var ends = vec2f(1.0);
    if min(to_borders.x, to_borders.y) >= 0.0 {
        let back = span(lamp.center, to_rim(across, -1.0)).y;
        ends = min(vec2f(back, span(lamp.center, to_rim(across, 1.0)).y) / lamp.radius, vec2f(1.0));
    }
    if ends.x + ends.y <= SMALLEST_PART {
        ends = vec2f(1.0);
    }
    for (var side = 0u; side < 2u; side++) {
        let sign = select(1.0, -1.0, side == 0u);
        let wall = traverse(lamp.center, to_rim(across, sign), lamp.radius, false, false).length;
        ends[side] = min(wall / lamp.radius, ends[side]);
    }
    return ends;
}

// The part of a light between two ends, before and after its middle.
fn part_between(ends: vec2f) -> vec2f {
    return 0.5 * vec2f(ends.y - ends.x, ends.x + ends.y);
}

// The place across a light of a point across a part of it, −1 to 1 both.
fn across_part(part: vec2f, point: f32) -> f32 {
    return part.x + part.y * point;
}

// Hides the parts of a lamp that its centre does not see.
fn hide_unseen_parts(ends: vec2f) {
    for (var side = 0u; side < 2u; side++) {
        let sign = select(1.0, -1.0, side == 0u);
        if ends[side] < 1.0 {
            hide(vec2f(min(sign * ends[side], sign), max(sign * ends[side], sign)));
        }
    }
    // Nothing stands for a lamp whose centre is in a wall.
    if ends.x + ends.y > SMALLEST_PART {
        stands = part_between(ends);
    }
}

// The rays to a lamp from a pixel at `off`.
fn fan_of(lamp: LampDisc, off: vec2f) -> Fan {
    let distance = length(off);
    return Fan(lamp.center + off, -off / distance, distance, lamp.radius / distance, distance);
}

// The direction across the line of sight.
fn across(fan: Fan) -> vec2f {
    return -fan.ahead.yx * vec2f(-1.0, 1.0);
}

// Hides what a pixel at `off` from a lamp does not see of it.
fn hide_from(lamp: LampDisc, off: vec2f) {
    hide_nothing();
    if any(off != vec2f(0.0)) {
        let fan = fan_of(lamp, off);
        hide_unseen_parts(seen_by_center(lamp, across(fan)));
        hide_behind_walls(fan);
    }
}

var<private> depth: vec3f;

fn visit(enter: f32, leave: f32, cell: vec2u, cell_class: u32) {
    depth += (leave - enter) * extinction_of(textureLoad(matter, cell, 0));
}

// The transmittance of media between a pixel and the point `at` across a light; in `w` 0 behind a wall.
fn through_media_to(fan: Fan, at: f32) -> vec4f {
    let way = fan.ahead + at * fan.slope * vec2f(fan.ahead.y, -fan.ahead.x);
    let length = sqrt(dot(way, way));
    let along = way / length;
    let sign = select(vec2f(1.0), vec2f(-1.0), along < vec2f(0.0));
    let reach = select(fan.distance * length, FAR, fan.distance == FAR);
    depth = vec3f(0.0);
    let hit = traverse(fan.pixel, direction(abs(along), sign), reach, false, true);
    return vec4f(exp(-depth), select(0.0, 1.0, hit.cell == NO_CELL));
}

fn differ(a: vec4f, b: vec4f, most: f32) -> bool {
    return a.w > 0.0 && b.w > 0.0 && any(abs(a.rgb - b.rgb) > vec3f(most));
}

// The mean transmittance of media between a pixel and the points that it sees of a part of a light.
fn through_media(fan: Fan, part: vec2f) -> vec3f {
    let half_width = fan.slope * fan.until;
    // Five rays and Simpson's rule are enough where media are smooth.
    var few: array<vec4f, 5>;
    for (var i = 0u; i < 5u; i++) {
        few[i] = through_media_to(fan, across_part(part, 0.5 * f32(i) - 1.0));
    }
    let middle = few[2];
    let coarse = (few[0] + 4.0 * middle + few[4]) / 6.0;
    let fine = (few[0] + 4.0 * (few[1] + few[3]) + 2.0 * middle + few[4]) / 12.0;
    // In `w` 1 if no ray ends at a wall, but for rounding.
    if half_width <= NARROW && fine.w > 0.999 && !differ(coarse, fine, EVEN) {
        return fine.rgb;
    }
    let rays = clamp(u32(2.0 * half_width), FEWEST_RAYS, MOST_RAYS);
    var sum = vec4f(0.0);
    var before = vec4f(0.0);
    var own = vec4f(0.0);
    // One ray ahead of the one that is added.
    for (var i = 0u; i <= rays; i++) {
        var after = vec4f(0.0);
        if i < rays {
            after = through_media_to(fan, across_part(part, point(i, rays)));
        }
        let uneven = differ(own, before, DIFFERENT) || differ(own, after, DIFFERENT);
        if i > 0u && uneven {
            for (var k = 0u; k < FINER; k++) {
                let finer = point(FINER * (i - 1u) + k, FINER * rays);
                let ray = through_media_to(fan, across_part(part, finer));
                sum += ray.w * vec4f(ray.rgb, 1.0);
            }
        } else if i > 0u {
            sum += f32(FINER) * own.w * vec4f(own.rgb, 1.0);
        }
        before = own;
        own = after;
    }
    if sum.w > 0.0 {
        return sum.rgb / sum.w;
    }
    // No ray arrives: one through the widest gap between walls.
    let through_gap = through_media_to(fan, widest_gap());
    if through_gap.w > 0.0 {
        return through_gap.rgb;
    }
    // A face sees the light, but not the place before it: up to the wall between them.
    depth = vec3f(0.0);
    let sign = select(vec2f(1.0), vec2f(-1.0), fan.ahead > vec2f(0.0));
    let back = direction(abs(fan.ahead), sign);
    _ = traverse(fan.pixel + fan.until * fan.ahead, back, fan.until, false, true);
    return exp(-depth);
}

// Like `through_media`, of a lamp from a pixel at `off`.
fn through_media_to_lamp(lamp: LampDisc, off: vec2f) -> vec3f {
    let fan = fan_of(lamp, off);
    // Rounded, so that rounding elsewhere does not move rays from one medium to another.
    let ends = floor(seen_by_center(lamp, across(fan)) * STEPS + 0.5) / STEPS;
    return through_media(fan, part_between(ends));
}
