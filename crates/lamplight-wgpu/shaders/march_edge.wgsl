// The exact march: from clear square to clear square, from cell edge to cell edge through fog.

override NEVER: f32;
override OPAQUE: f32;
override LONGEST: u32;
override MATTER: u32;
// Whether there may be cells that are closed and no walls: those that changed, and fog where light fades
// with distance. Rays cross them one by one.
override STOPS: bool;

// Logarithm of what a px lets through; 1 in the fourth place where matter changed.
@group(0) @binding(4) var<storage, read> logs: array<vec4f>;
@group(0) @binding(5) var<storage, read> squares: array<u32>;

// Radiance that arrives along a ray that starts in an open cell; 1 where it met a change.
fn march(start: vec2f, first: vec2f, way: vec2f, from_face: bool) -> vec4f {
    let inverse = 1.0 / select(way, vec2f(NEVER), abs(way) < vec2f(NEVER));
    let back = way < vec2f(0.0);
    let sign = select(vec2f(1.0), vec2f(-1.0), back);
    // An edge has the coordinate of the cell behind it, seen from the left or from above.
    let beyond = select(vec2f(0.0), vec2f(1.0), back);
    let shift = select(0u, 8u, back.x) + select(0u, 16u, back.y);
    let size = vec2f(frame.size);
    var at = start;
    var cell = first;
    var travelled = 0.0;
    var gathered = vec3f(0.0);
    var through = vec3f(1.0);
    var i = index(vec2u(cell));
    var square = squares[i] >> shift & 255u;
    var changed = 0.0;
    var alone = false;
    for (var steps = frame.steps; steps > 0u; steps--) {
        if STOPS && square == 0u {
            alone = true;
            changed = max(changed, logs[i].w);
            square = select(1u, 1u | MATTER, source[i].w == MEDIUM);
        }
        let next = cell + sign * f32(square & LONGEST);
        let edge = next + beyond;
        let t = (edge - at) * inverse;
        let length = min(t.x, t.y);
        let crosses = vec2<bool>(t.x < t.y, !(t.x < t.y));
        // Along the axis that it crosses a ray lands exactly on the edge; along the other it stays
        // within the square, whatever rounding says.
        let along = at + way * length;
        let last = next - sign;
        let within = clamp(floor(along), min(cell, last), max(cell, last));
        at = select(along, edge, crosses);
        cell = select(within, next, crosses);
        if square >= MATTER {
            if TRACKS {
                changed = max(changed, logs[i].w);
            }
            let passes = exp(logs[i].rgb * max(length, 0.0));
            gathered += through * (1.0 - passes) * fade(source[i].rgb, travelled);
            through *= passes;
            if max(through.r, max(through.g, through.b)) < OPAQUE {
                return vec4f(gathered, changed);
            }
        }
        travelled += length;
        if any(cell < vec2f(0.0)) || any(cell >= size) {
            return vec4f(gathered + through * sky(way.y), changed);
        }
        i = index(vec2u(cell));
        square = squares[i] >> shift & 255u;
        if square == 0u && STOPS && source[i].w != SOLID {
            // On the CPU packets of rays come apart at the first, and each has all its steps again.
            steps = select(frame.steps + 1u, steps, alone);
        } else if square == 0u {
            let side = face(crosses.x, way);
            if TRACKS && (logs[i].w > 0.0 || wall_changed(i, side)) {
                changed = 1.0;
            }
            return vec4f(gathered + through * fade(wall(i, side), travelled), changed);
        }
    }
    return vec4f(gathered, changed);
}
