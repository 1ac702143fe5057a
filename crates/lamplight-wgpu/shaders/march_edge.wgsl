// The exact march.

// Whether there may be cells that are closed and no walls: those that changed, and fog where light fades
// with distance. Rays cross them one by one.
override STOPS: bool;

// Radiance that arrives along a ray that starts in an open cell; 1 where it met a change.
fn march(start: vec2f, first: vec2f, way: vec2f, from_face: bool) -> vec4f {
    let heading = heading(way);
    var ray = ray_from(start, first);
    var i = index(vec2u(first));
    var square = square_at(i, heading);
    var changed = 0.0;
    var alone = false;
    for (var steps = frame.steps; steps > 0u; steps--) {
        if STOPS && square == 0u {
            alone = true;
            changed = max(changed, logs[i].w);
            square = select(1u, 1u | MATTER, source[i].w == MEDIUM);
        }
        if TRACKS && square >= MATTER {
            changed = max(changed, logs[i].w);
        }
        _ = leap(&ray, heading, i, square, 0.0);
        if is_spent(ray) {
            break;
        }
        if has_left(ray) {
            ray.light += ray.through * sky(way.y);
            break;
        }
        i = index(vec2u(ray.cell));
        square = square_at(i, heading);
        if square == 0u && STOPS && source[i].w != SOLID {
            // On the CPU packets of rays come apart at the first, and each has all its steps again.
            steps = select(frame.steps + 1u, steps, alone);
        } else if square == 0u {
            let side = face(ray.along_x, way);
            if TRACKS && (logs[i].w > 0.0 || wall_changed(i, side)) {
                changed = 1.0;
            }
            ray.light += ray.through * fade(wall(i, side), ray.travelled);
            break;
        }
    }
    return vec4f(ray.light, changed);
}
