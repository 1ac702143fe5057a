// The exact march, and with it `raymarch` by edges.

#import methods/raymarch/gather
#import shared/class
#import shared/inflow
#import shared/packet
#import shared/surfaces
#import shared/uniforms

// True if cells that are not solid may stop rays: those that changed, and media if emission fades with
// distance. Rays cross them one by one.
override STOPS: bool;

// Radiance that arrives along a ray that starts in an open cell; in `w` 1 if it met a change.
fn march(start: vec2f, first: vec2f, direction: vec2f, from_face: bool) -> vec4f {
    let heading = heading(direction);
    var ray = ray_from(start, first);
    var i = index(vec2u(first));
    var square = square_at(i, heading);
    var invalidated = 0.0;
    var alone = false;
    for (var steps = frame.steps; steps > 0u; steps--) {
        if STOPS && square == 0u {
            alone = true;
            invalidated = max(invalidated, extinction[i].w);
            square = select(1u, 1u | HAS_MEDIUM, class_of(source[i]) == MEDIUM);
        }
        if TRACKS && square >= HAS_MEDIUM {
            invalidated = max(invalidated, extinction[i].w);
        }
        _ = skip(&ray, heading, i, square, 0.0);
        if is_spent(ray) {
            break;
        }
        if has_left(ray) {
            ray.light += ray.transmittance * entering_along(ray.at, direction);
            break;
        }
        i = index(vec2u(ray.cell));
        square = square_at(i, heading);
        if square == 0u && STOPS && class_of(source[i]) != SOLID {
            // On the CPU a packet of rays is split at the first, and each ray has all its steps again.
            steps = select(frame.steps + 1u, steps, alone);
        } else if square == 0u {
            let side = face(ray.along_x, direction);
            if TRACKS && (extinction[i].w > 0.0 || wall_invalidated(i, side)) {
                invalidated = 1.0;
            }
            ray.light += ray.transmittance * fade(wall(i, side), ray.travelled);
            break;
        }
    }
    return vec4f(ray.light, invalidated);
}
