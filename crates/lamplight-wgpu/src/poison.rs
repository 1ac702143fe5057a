//! Garbage in workgroup memory, for the test that shaders which it is not cleared for write it before they read it.

use crate::programs::Program;
use crate::shaders;
use std::cell::Cell;

thread_local! {
    static POISONED: Cell<bool> = const { Cell::new(false) };
}

/// Calls a function that compiles shaders, which then begin by filling workgroup memory with garbage.
fn poisoned<T>(compile: impl FnOnce() -> T) -> T {
    POISONED.set(true);
    let compiled = compile();
    POISONED.set(false);
    compiled
}

/// The text of a program, poisoned inside [`poisoned`] if its memory is not cleared.
pub fn text(program: &Program) -> String {
    let text = shaders::text(program.shader);
    if POISONED.get() && program.writes_first() { poison(&text) } else { text }
}

/// Fills arrays in workgroup memory at the beginning of each entry point that has an index in its workgroup: others use
/// none.
fn poison(wgsl: &str) -> String {
    let fill = |line: &str| {
        let (name, array) = line.strip_prefix("var<workgroup> ")?.split_once(": array<")?;
        let (element, length) = array.strip_suffix(">;")?.split_once(", ")?;
        let garbage = if element == "vec4f" {
            "vec4f(f32(0xffffffffu))"
        } else {
            &format!("{element}(0xffffffffu)")
        };
        Some(format!("for (var i = 0u; i < {length}; i++) {{ {name}[i] = {garbage}; }}\n"))
    };
    let fills: String = wgsl.lines().filter_map(fill).collect();
    let first = |signature: &str| {
        let named = |builtin: &str| {
            let (_, rest) = signature.split_once(&format!("@builtin({builtin}) "))?;
            Some(rest.split_once(':')?.0)
        };
        let index = named("local_invocation_index").map(|name| format!("{name} == 0u"));
        index.or_else(|| {
            named("local_invocation_id").map(|name| format!("all({name} == vec3u(0u))"))
        })
    };
    let (shared, entries) = wgsl.split_at(wgsl.find("@compute").unwrap());
    let entries = entries.split_inclusive("@compute").map(|entry| {
        let Some((signature, body)) = entry.split_once(") {\n") else { return entry.to_owned() };
        let Some(first) = first(signature) else { return entry.to_owned() };
        format!("{signature}) {{\nif {first} {{\n{fills}}}\nworkgroupBarrier();\n{body}")
    });
    shared.to_owned() + &entries.collect::<String>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_back::read_back;
    use crate::{Backend, FrameInput, Lighting, LightingOptions, Stage, programs};
    use lamplight::settings::Holographic;
    use lamplight::{Bounces, Cells, Inflow, Matter, Settings};
    use wgpu::{Device, Instance, InstanceDescriptor, Queue};

    fn device() -> (Device, Queue) {
        let instance = Instance::new(InstanceDescriptor::new_without_display_handle());
        let adapter = pollster::block_on(instance.request_adapter(&Default::default()))
            .expect("no GPU; on Debian: apt-get install mesa-vulkan-drivers");
        pollster::block_on(adapter.request_device(&Default::default())).unwrap()
    }

    const SEED: u64 = 7;

    /// Walls, small lights, and glass or fog.
    fn cells(glass: bool) -> Cells {
        println!("seed {SEED}");
        let mut cells = Cells::new(59, 41).unwrap();
        let mut random = fastrand::Rng::with_seed(SEED);
        for _ in 0..50 {
            let colour = std::array::from_fn(|_| random.f32());
            let matter = match random.u32(..4) {
                0 => Matter { emission: colour, opacity: 1.0, ..Matter::EMPTY },
                1 if glass => Matter { tint: colour, ..Matter::EMPTY },
                1 => Matter { opacity: 0.2, albedo: [0.5; 3], ..Matter::EMPTY },
                _ => Matter { opacity: 1.0, albedo: colour, ..Matter::EMPTY },
            };
            cells.set(random.u32(..59), random.u32(..41), matter);
        }
        cells
    }

    #[test]
    fn nothing_is_read_from_workgroup_memory_before_it_is_written() {
        let (device, queue) = device();
        for (preset, glass) in
            [("default", true), ("fast", false), ("fast", true), ("coarse", true)]
        {
            let mut cells = cells(glass);
            if !glass {
                let inflow = Inflow::new([59, 41], 16, |_, angle| [angle as f32, 0.2, 0.1]);
                cells.set_inflow(Some(inflow.unwrap())).unwrap();
            }
            let mut settings = Settings::direct(Holographic::preset(preset).unwrap());
            settings.bounces = Bounces::Count(1);
            let light = || {
                let options = LightingOptions {
                    compile_ahead: Some(false),
                    ..LightingOptions::on(Backend::Gpu)
                };
                let mut lighting = Lighting::new(&device, &queue, &options).unwrap();
                lighting.prepare(&FrameInput::of_cells(&settings, &cells)).unwrap();
                let mut encoder = device.create_command_encoder(&Default::default());
                lighting.record(&mut encoder).unwrap();
                queue.submit([encoder.finish()]);
                let light: Vec<[f32; 4]> =
                    read_back(&device, &queue, lighting.stage(Stage::Light).unwrap()).unwrap();
                light
            };
            assert!(light() == poisoned(light), "{preset}, glass: {glass}");
        }
    }

    #[test]
    fn the_memory_of_every_shader_that_is_not_cleared_is_poisoned() {
        let uncleared: Vec<_> =
            programs::ALL.iter().filter(|program| program.writes_first()).collect();
        assert_eq!(uncleared.len(), 6);
        for program in uncleared {
            let text = shaders::text(program.shader);
            let arrays = text.matches("var<workgroup>").count();
            assert!(arrays > 0);
            let filled = poison(&text).matches("(0xffffffffu)").count();
            let entries = text.split("@compute").skip(1);
            let indexed = entries.filter(|entry| entry.contains("@builtin(local_invocation_"));
            assert_eq!(filled, arrays * indexed.count(), "{}", program.shader);
        }
    }
}
