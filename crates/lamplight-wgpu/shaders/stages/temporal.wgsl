// The mean over frames: `mean += (light − mean) / min(age, HISTORY_LENGTH)`, restarted near cells that see
// a change.

#import shared/moment
#import shared/uniforms

override HISTORY_LENGTH: f32;
// True if `traced` holds anything.
override TRACED: bool;
// True if changes end history.
override REJECTS: bool;
// True if any change ends it everywhere: rays do not report which cells see it.
override EVERYWHERE: bool;
// Radius, in px, around a cell that sees a change.
override REACH: i32;
// Number of frames in which history is rejected after a change.
override REJECTED_FRAMES: u32;

@group(0) @binding(1) var<storage, read_write> light: array<vec4f>;
// Variance of the light's noise; 1 if what the cell sees changed.
@group(0) @binding(2) var<storage, read_write> traced: array<vec2f>;
// The mean, and its number of frames.
@group(0) @binding(3) var<storage, read_write> history: array<vec4f>;
// Number of frames in which history is still rejected.
@group(0) @binding(4) var<storage, read_write> rejected: array<u32>;
// True if a change is seen in a cell's column, within REACH.
@group(0) @binding(5) var<storage, read_write> columns: array<u32>;
@group(0) @binding(6) var<storage, read> any_changed: u32;

// The mean of each component of the first moment, if it is found.
@group(0) @binding(7) var<storage, read_write> history_x: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> history_y: array<vec4f>;

@compute @workgroup_size(8, 8)
fn spread(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let at = vec2i(id.xy);
    let last = i32(frame.size.y) - 1;
    var seen = false;
    for (var y = max(at.y - REACH, 0); y <= min(at.y + REACH, last); y++) {
        seen = seen || traced[index(vec2u(id.x, u32(y)))].y > 0.0;
    }
    columns[index(id.xy)] = u32(seen);
}

fn is_rejected(at: vec2i) -> bool {
    if !REJECTS {
        return false;
    }
    if EVERYWHERE {
        return any_changed != 0u;
    }
    let last = i32(frame.size.x) - 1;
    for (var x = max(at.x - REACH, 0); x <= min(at.x + REACH, last); x++) {
        if columns[index(vec2u(u32(x), u32(at.y)))] != 0u {
            return true;
        }
    }
    return false;
}

@compute @workgroup_size(8, 8)
fn accumulate(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    let valid = frame.history == HISTORY_FULL;
    var left = select(0u, rejected[i], valid);
    if is_rejected(vec2i(id.xy)) {
        left = REJECTED_FRAMES;
    }
    let age = min(select(0.0, history[i].w, valid && left == 0u) + 1.0, HISTORY_LENGTH);
    rejected[i] = max(left, 1u) - 1u;
    var mean = light[i].rgb;
    if age > 1.0 {
        let before = history[i].rgb;
        mean = before + (mean - before) / age;
    }
    history[i] = vec4f(mean, age);
    light[i] = vec4f(mean, 1.0);
    if MOMENT {
        let x = moment_index(0u, i);
        let y = moment_index(1u, i);
        if age > 1.0 {
            light[x] = history_x[i] + (light[x] - history_x[i]) / age;
            light[y] = history_y[i] + (light[y] - history_y[i]) / age;
        }
        history_x[i] = light[x];
        history_y[i] = light[y];
    }
    if TRACED {
        traced[i].x /= age;
    }
}
