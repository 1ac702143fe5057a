//! Stages and methods have the same stems on the CPU, on the GPU's host side, and in shaders.

use std::collections::BTreeSet;
use std::path::Path;

/// Files that exist on one side only, or under another stem for now, with the reason. A path is the side, then
/// the method (or `stage`) and the stem.
const WITHOUT_TWIN: &[(&str, &str)] = &[
    // CPU only.
    ("cpu stage cast", "entry to the traversal for single rays"),
    ("cpu stage center_line", "shadow lines between centres; in denoise.wgsl"),
    ("cpu stage faces", "four values per cell on the GPU"),
    ("cpu stage pyramid", "blurs of walls.rs; in walls.wgsl"),
    ("cpu stage traverse", "shaders/shared/traverse.wgsl"),
    ("cpu cascades debug_view", "debug views exist on the CPU only"),
    ("cpu holographic debug_view", "debug views exist on the CPU only"),
    ("cpu polar debug_view", "debug views exist on the CPU only"),
    ("cpu stage estimate", "three lists of light and its noise; a buffer on the GPU"),
    ("cpu holographic axis_sweep", "SIMD over rows; a workgroup does that on the GPU"),
    ("cpu holographic fine_rows", "weights_of_points of gather.wgsl"),
    ("cpu holographic row_bits", "rows of a tile as a word; vectors of words in footprint.wgsl"),
    ("cpu holographic published", "the solver around the published cascades"),
    ("cpu polar lit_ranges", "bounds of shadow_bounds.wgsl; direct.wgsl has no shadow map"),
    ("cpu polar sun_map", "suns are in direct.wgsl, without a shadow map"),
    (
        "cpu polar solid_bits",
        "runs of empty columns that shadows skip; shadow_ray.wgsl steps through them",
    ),
    ("cpu polar sampling", "SIMD sampling; shaders/methods/polar/shadow_ray.wgsl"),
    ("cpu polar angle", "mathematics; shaders/shared/angle.wgsl"),
    ("cpu raymarch window", "the inflow of a window, which the CPU alone finds so far"),
    // The host side of a method is its `mod.rs`; these files plan it.
    ("host holographic tables", "lattice.rs as tables of numbers"),
    ("host holographic tiles", "sizes of workgroups"),
    ("host holographic traffic", "the cost of dispatches"),
    ("host holographic work", "the kinds of dispatches"),
    ("host raymarch bounce", "on the CPU stages/bounce.rs"),
    // Shaders of several dispatches that are one step on the CPU.
    ("wgsl stage add_direct", "in bounce.rs, and DirectLight::add_to"),
    ("wgsl stage compare", "part of bounce.rs"),
    ("wgsl stage convergence", "part of bounce.rs"),
    ("wgsl stage feedback", "part of bounce.rs"),
    ("wgsl stage invalidate", "in solver.rs on the CPU, where cells are compared"),
    ("wgsl stage reproject", "part of bounce.rs; the means of raymarch start anew"),
    ("wgsl stage matter_values", "reads textures for the CPU"),
    ("wgsl stage display_texture", "display.wgsl on devices without storage buffers"),
    ("wgsl stage output", "writes a texture of the host's"),
    ("wgsl raymarch march_distance", "the second march of march.rs"),
    ("wgsl raymarch accumulate", "part of gather.rs"),
    ("wgsl cascades probe", "part of merge.rs"),
    ("wgsl flood rays", "in mod.rs"),
    ("wgsl polar lookup", "part of shadow_map.rs"),
    ("wgsl polar shadow_bounds", "part of shadow_map.rs: needs all rays"),
    ("wgsl polar shadow_ray", "part of shadow_map.rs, imported by it and by lookup"),
    ("wgsl holographic bend", "part of extend.rs, imported by extend and merge"),
    (
        "wgsl holographic fetch_interval",
        "part of interval.rs; shaders that write have store_interval too",
    ),
    ("wgsl holographic feedback", "part of bounce.rs"),
    ("wgsl holographic footprint", "part of trace.rs, imported by trace and gather"),
    ("wgsl holographic light_pair", "how buffers store the light of cones"),
    ("wgsl holographic packed_rgb", "how buffers store radiance"),
    ("wgsl holographic quadrant", "the quadrants that share a dispatch"),
    ("wgsl holographic sky", "part of merge.rs"),
    ("wgsl holographic store_interval", "part of interval.rs, for shaders that write"),
    ("wgsl holographic sweep", "parameters of a dispatch"),
];

/// Stems below a folder, as `method stem`, without `mod` and the published cascades, which are folders of
/// their own.
fn stems(root: &Path, kind: &str, extension: &str, into: &mut BTreeSet<String>) {
    let Ok(entries) = std::fs::read_dir(root) else { return };
    for path in entries.map(|entry| entry.unwrap().path()) {
        let stem = path.file_stem().unwrap().to_string_lossy().into_owned();
        if path.extension().is_some_and(|found| found == extension) && stem != "mod" {
            into.insert(format!("{kind} {stem}"));
        }
    }
}

/// The stems of one side.
fn side(stages: &[&str], methods: &str, extension: &str) -> BTreeSet<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = BTreeSet::new();
    for stages in stages {
        stems(&root.join(stages), "stage", extension, &mut found);
    }
    for entry in std::fs::read_dir(root.join(methods)).unwrap().map(|entry| entry.unwrap()) {
        if entry.path().is_dir() {
            let method = entry.file_name().to_string_lossy().into_owned();
            stems(&entry.path(), &method, extension, &mut found);
        }
    }
    found
}

/// Files without a twin that are not in the table, and entries of the table that are not needed.
fn problems(
    cpu: &BTreeSet<String>,
    host: &BTreeSet<String>,
    wgsl: &BTreeSet<String>,
    table: &[(&str, &str)],
) -> Vec<String> {
    let mut alone = BTreeSet::new();
    for (side, files, others) in
        [("cpu", cpu, [wgsl, host]), ("host", host, [wgsl, cpu]), ("wgsl", wgsl, [cpu, cpu])]
    {
        let twin = |stem: &String| others.iter().any(|other| other.contains(stem));
        alone.extend(files.iter().filter(|stem| !twin(stem)).map(|stem| format!("{side} {stem}")));
    }
    let known = |name: &String| table.iter().any(|(known, _)| known == name);
    let missing = alone.iter().filter(|name| !known(name));
    let missing = missing.map(|name| format!("`{name}` has no twin"));
    let unneeded = table.iter().filter(|(name, _)| !alone.contains(*name));
    let unneeded =
        unneeded.map(|(name, _)| format!("`{name}` is listed, but has a twin or is gone"));
    missing.chain(unneeded).collect()
}

#[test]
fn every_stage_and_method_has_its_twins() {
    let library = "../lamplight/src";
    let [grid, filters, stages] =
        ["grid", "filters", "stages"].map(|folder| format!("{library}/{folder}"));
    let cpu = side(&[&grid, &filters, &stages], &format!("{library}/methods"), "rs");
    let host = side(&["src/stages"], "src/methods", "rs");
    let wgsl = side(&["shaders/stages"], "shaders/methods", "wgsl");
    let problems = problems(&cpu, &host, &wgsl, WITHOUT_TWIN);
    assert!(problems.is_empty(), "\n{}", problems.join("\n"));
}

#[test]
fn a_file_without_a_twin_is_found() {
    let set = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<BTreeSet<_>>();
    let both = set(&["stage seed", "polar gather"]);
    assert_eq!(problems(&both, &both, &both, &[]), [""; 0]);
    let fewer = set(&["stage seed"]);
    let found = problems(&both, &fewer, &fewer, &[("cpu stage seed", "")]);
    assert_eq!(
        found,
        ["`cpu polar gather` has no twin", "`cpu stage seed` is listed, but has a twin or is gone"]
    );
}
