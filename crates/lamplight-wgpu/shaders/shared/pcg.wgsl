// PCG4D, a hash of four numbers to four pseudorandom ones (Jarzynski and Olano 2020).
fn pcg(key: vec4u) -> vec4u {
    var v = key * 1664525u + 1013904223u;
    for (var i = 0; i < 2; i++) {
        v.x += v.y * v.w;
        v.y += v.z * v.x;
        v.z += v.x * v.y;
        v.w += v.y * v.z;
        v ^= v >> vec4u(16u);
    }
    return v;
}
