// Relative luminance, with the library's weights.

override LUMINANCE_RED: f32;
override LUMINANCE_GREEN: f32;
override LUMINANCE_BLUE: f32;

fn luminance(rgb: vec3f) -> f32 {
    return LUMINANCE_RED * rgb.r + LUMINANCE_GREEN * rgb.g + LUMINANCE_BLUE * rgb.b;
}
