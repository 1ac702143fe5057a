//! The composed picture, compared with the CPU's.

mod common;
#[path = "common/textures.rs"]
mod textures;

use common::{cells, device, frame, lighting};
use lamplight::{Cells, Display, Light, Method, Relief, Rgb, Settings, Sun, ToneMap};
use lamplight_wgpu::error::{PrepareError, RecordError};
use lamplight_wgpu::{
    Color, Compose, ComposeParams, Filter, Lighting, Target, VisibleRect, read_back,
};
use textures::{fetch, filled, float, texture, view};
use wgpu::{Device, Queue, TextureFormat, TextureUsages, TextureView};

/// Neither the grid nor the rows of a copy are a multiple of anything.
const SIZE: [u32; 2] = [67, 41];

/// A grid and its light on the GPU, with a picture that it falls on.
struct Scene {
    device: Device,
    queue: Queue,
    lighting: Lighting,
    cells: Cells,
    light: Light,
    color: TextureView,
}

fn scene() -> Scene {
    scene_of(cells(SIZE[0], SIZE[1], 17))
}

fn scene_of(mut cells: Cells) -> Scene {
    let (device, queue) = device();
    let color: Vec<[f32; 4]> = (0..cells.len())
        .map(|i| {
            let share = |period: usize| (i % period) as f32 / period as f32;
            [share(67), share(23), 1.0 - share(7), 1.0]
        })
        .collect();
    for (to, &[r, g, b, _]) in cells.color_mut().iter_mut().zip(&color) {
        *to = [r, g, b];
    }
    let format = TextureFormat::Rgba32Float;
    let color = filled(&device, &queue, SIZE, format, bytemuck::cast_slice(&color));
    let direct = Settings::direct(Method::Raymarch);
    let settings = Settings { wall_depth: 3.0, elevation: 0.6, ..direct };
    let mut lighting = lighting(&device, &queue);
    frame(&device, &queue, &mut lighting, &settings, &cells);
    let light = read_back::light(&lighting, &cells).unwrap();
    Scene { device, queue, lighting, cells, light, color }
}

impl Scene {
    /// Bytes of a target on which the light was drawn.
    fn drawn(&self, size: [u32; 2], format: TextureFormat, shown: &ComposeParams) -> Vec<u8> {
        let Self { device, queue, lighting, .. } = self;
        let target = texture(device, size, format, TextureUsages::RENDER_ATTACHMENT);
        let mut compose = Compose::new(device, queue).unwrap();
        compose.prepare(lighting, format, shown).unwrap();
        let mut encoder = device.create_command_encoder(&Default::default());
        compose.record(&mut encoder, &view(&target)).unwrap();
        queue.submit([encoder.finish()]);
        fetch(device, queue, &target)
    }

    fn shown(&self, tonemap: ToneMap, exposure: f32) -> ComposeParams<'_> {
        let display = Display { tonemap, exposure, ..Display::PLAIN };
        ComposeParams { display, color: Color::Cells(&self.color), ..ComposeParams::default() }
    }
}

/// 8-bit steps by which both may differ: rounding of values that lie between two.
const STEP: u8 = 1;

/// Bytes that differ by more, red, green and blue.
fn wrong(seen: &[u8], right: &[u8]) -> usize {
    assert_eq!(seen.len() / 4, right.len() / 3);
    let pixels = seen.chunks(4).zip(right.chunks(3));
    pixels.flat_map(|(s, r)| s.iter().zip(r)).filter(|(s, r)| s.abs_diff(**r) > STEP).count()
}

const EXPOSURES: [f32; 4] = [-4.0, 0.0, 1.5, 6.0];

#[test]
fn every_tone_map_shows_the_cpus_picture_on_either_kind_of_format() {
    let scene = scene();
    for &tonemap in ToneMap::ALL {
        for exposure in EXPOSURES {
            let shown = scene.shown(tonemap, exposure);
            let right = scene.light.compose(&scene.cells, &shown.display).unwrap().into_raw();
            for format in [
                TextureFormat::Rgba8Unorm,
                TextureFormat::Rgba8UnormSrgb,
                TextureFormat::Bgra8Unorm,
                TextureFormat::Bgra8UnormSrgb,
            ] {
                let mut seen = scene.drawn(SIZE, format, &shown);
                if matches!(format, TextureFormat::Bgra8Unorm | TextureFormat::Bgra8UnormSrgb) {
                    seen.chunks_mut(4).for_each(|pixel| pixel.swap(0, 2));
                }
                let wrong = wrong(&seen, &right);
                assert_eq!(wrong, 0, "{tonemap:?} at {exposure} on {format:?}");
                assert!(seen.chunks(4).all(|pixel| pixel[3] == 255));
            }
        }
    }
}

#[test]
fn one_wrong_byte_is_rejected() {
    let scene = scene();
    let shown = scene.shown(ToneMap::Aces, 0.0);
    let right = scene.light.compose(&scene.cells, &shown.display).unwrap().into_raw();
    let mut seen = scene.drawn(SIZE, TextureFormat::Rgba8Unorm, &shown);
    assert_eq!(wrong(&seen, &right), 0);
    seen[401] = right[301].wrapping_add(2);
    assert_eq!(wrong(&seen, &right), 1);
    // The picture has dark and bright parts.
    assert!(right.iter().any(|&v| v > 200) && right.iter().any(|&v| v < 50));
}

#[test]
fn float_targets_receive_linear_light() {
    let scene = scene();
    for &tonemap in ToneMap::ALL {
        let shown = scene.shown(tonemap, 0.5);
        let bytes = scene.drawn(SIZE, TextureFormat::Rgba16Float, &shown);
        let seen: &[[u16; 4]] = bytemuck::cast_slice(&bytes);
        let gain = shown.display.gain();
        for (seen, right) in
            seen.iter().zip(scene.light.radiance(&scene.cells, &Display::PLAIN).unwrap())
        {
            let right = right.map(|v| v * gain);
            let right = match tonemap {
                ToneMap::None => right,
                _ => tonemap.map(right),
            };
            for c in 0..3 {
                let seen = float(seen[c]);
                // Half floats have eleven bits.
                let near = 1e-3 * right[c].max(1.0);
                assert!((seen - right[c]).abs() < near, "{tonemap:?}: {seen}, not {right:?}");
            }
        }
    }
    // Without a tone map there is light above 1, and it is kept.
    let brightest = scene.light.pixels().as_flattened().iter().copied().fold(0.0, f32::max);
    assert!(brightest > 2.0, "{brightest}");
}

/// Radiance that each pixel of a target as large as the grid shows, in linear floats.
fn linear(scene: &Scene, shown: &ComposeParams) -> Vec<[f32; 4]> {
    let bytes = scene.drawn(SIZE, TextureFormat::Rgba32Float, shown);
    bytemuck::cast_slice(&bytes).to_vec()
}

#[test]
fn a_hosts_frame_is_lit_emits_and_keeps_its_alpha() {
    let scene = scene();
    let Scene { device, queue, .. } = &scene;
    let n = scene.cells.len();
    let format = TextureFormat::Rgba32Float;
    let picture =
        |texels: &[[f32; 4]]| filled(device, queue, SIZE, format, bytemuck::cast_slice(texels));
    let texel = |i: usize, period: usize| (i % period) as f32 / period as f32;
    let own: Vec<[f32; 4]> =
        (0..n).map(|i| [texel(i, 5), texel(i, 11), 0.3, texel(i, 3)]).collect();
    let glow: Vec<[f32; 4]> = (0..n).map(|i| [texel(i, 13) * 7.0, 0.0, texel(i, 2), 0.0]).collect();
    let more: Vec<[f32; 4]> = (0..n).map(|i| [0.0, texel(i, 17), 0.5, 0.0]).collect();
    let (own_view, glow_view, more_view) = (picture(&own), picture(&glow), picture(&more));
    let ambient = [0.25, 0.0, 1.5];
    let shown = ComposeParams {
        color: Color::Target(&own_view),
        emission: Some(&glow_view),
        more: Some(&more_view),
        display: Display { exposure: 1.0, ambient, ..Display::PLAIN },
        ..ComposeParams::default()
    };
    let check = |seen: &[[f32; 4]], lit: bool| {
        let mut wrong = 0;
        for (i, seen) in seen.iter().enumerate() {
            let light = scene.light.pixels()[i];
            let given = if scene.cells.is_solid(i) { scene.cells.emission()[i] } else { [0.0; 3] };
            let right = |c: usize| {
                let arrives = f32::from(lit) * (light[c] - given[c]).max(0.0) + more[i][c];
                2.0 * own[i][c] * (arrives + ambient[c] + glow[i][c])
            };
            let near = |c: usize| (seen[c] - right(c)).abs() < 1e-4 * right(c).max(1.0);
            wrong += usize::from(!(0..3).all(near) || seen[3] != own[i][3]);
        }
        wrong
    };
    let seen = linear(&scene, &shown);
    assert_eq!(check(&seen, true), 0);
    assert!(check(&seen, false) > n / 4, "a picture without the grid's light is rejected");
    let small = filled(device, queue, [3, 3], format, &[0; 9 * 16]);
    let mut compose = Compose::new(device, queue).unwrap();
    let mut refused = |shown: &ComposeParams| {
        let error = compose.prepare(&scene.lighting, format, shown);
        error.unwrap_err().to_string()
    };
    assert!(refused(&ComposeParams { more: Some(&small), ..shown }).contains("more"));
    let display = Display { ambient: [0.0, f32::NAN, 0.0], ..Display::PLAIN };
    assert!(refused(&ComposeParams { display, ..shown }).contains("ambient"));
}

/// A scene whose cells are tilted, one in ten not.
fn tilted() -> Scene {
    let mut cells = cells(SIZE[0], SIZE[1], 17);
    for (i, normal) in cells.normals_mut().iter_mut().enumerate() {
        let (turn, tilt) = (0.37 * i as f32, 0.1 * (i % 10) as f32);
        *normal = [tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), tilt.cos()];
    }
    // Lower than other light, so that the moment is longer than the light.
    let low = Sun { direction: 1.0, elevation: Some(0.2), ..Sun::default() };
    cells.suns_mut().push(low);
    scene_of(cells)
}

const RELIEF: Relief = Relief { specular: 0.7, roughness: 0.4 };

#[test]
fn tilted_cells_are_lit_as_on_the_cpu() {
    let scene = tilted();
    for specular in [0.0, 0.7] {
        let relief = Relief { specular, ..RELIEF };
        let mut shown = scene.shown(ToneMap::Agx, 0.5);
        shown.display.relief = relief;
        shown.display.ambient = [0.02, 0.05, 0.1];
        let right = scene.light.compose(&scene.cells, &shown.display).unwrap().into_raw();
        let seen = scene.drawn(SIZE, TextureFormat::Rgba8Unorm, &shown);
        assert_eq!(wrong(&seen, &right), 0, "{specular}");
        let flat = Light::from_pixels(&scene.cells, scene.light.pixels().to_vec()).unwrap();
        let flat = flat.compose(&scene.cells, &shown.display).unwrap().into_raw();
        assert!(wrong(&seen, &flat) > seen.len() / 20, "light without a moment is rejected");
        let unlit = Display { ambient: [0.0; 3], ..shown.display };
        let unlit = scene.light.compose(&scene.cells, &unlit).unwrap().into_raw();
        assert!(wrong(&seen, &unlit) > seen.len() / 20, "light without ambient is rejected");
    }
}

#[test]
fn a_hosts_normals_lie_as_its_colour_does() {
    let scene = tilted();
    let Scene { device, queue, .. } = &scene;
    let format = TextureFormat::Rgba32Float;
    let picture =
        |texels: &[[f32; 4]]| filled(device, queue, SIZE, format, bytemuck::cast_slice(texels));
    let normals = scene.cells.normals().unwrap();
    let normals: Vec<[f32; 4]> = normals.iter().map(|&[x, y, z]| [x, y, z, 1.0]).collect();
    let (normals, flat) = (picture(&normals), picture(&vec![[0.0; 4]; scene.cells.len()]));
    let display = Display { relief: RELIEF, ambient: [0.05, 0.1, 0.15], ..Display::PLAIN };
    let of_cells = ComposeParams { display, ..scene.shown(ToneMap::None, 0.0) };
    let right = linear(&scene, &of_cells);
    let differs = |a: &[[f32; 4]], b: &[[f32; 4]]| {
        let far = |a: &[f32; 4], b: &[f32; 4]| (0..3).any(|c| (a[c] - b[c]).abs() > 1e-4);
        a.iter().zip(b).filter(|(a, b)| far(a, b)).count()
    };
    for color in [Color::Cells, Color::View, Color::Target].map(|lies| lies(&scene.color)) {
        let shown = ComposeParams { color, normals: Some(&normals), ..of_cells };
        assert_eq!(differs(&linear(&scene, &shown), &right), 0, "{color:?}");
        let shown = ComposeParams { normals: Some(&flat), ..shown };
        assert!(differs(&linear(&scene, &shown), &right) > 1000, "{color:?}: flat ones pass");
    }
    let other = self::scene();
    let mut compose = Compose::new(&other.device, &other.queue).unwrap();
    let flat = filled(&other.device, &other.queue, SIZE, format, &vec![0; scene.cells.len() * 16]);
    let shown = ComposeParams { normals: Some(&flat), ..ComposeParams::default() };
    let error = compose.prepare(&other.lighting, format, &shown).unwrap_err().to_string();
    assert!(error.contains("normals") && error.contains("moment"), "{error}");
}

#[test]
fn highlights_show_on_a_colour_that_emits() {
    let scene = tilted();
    let Scene { device, queue, .. } = &scene;
    let format = TextureFormat::Rgba32Float;
    let nothing = filled(device, queue, SIZE, format, &vec![0; scene.cells.len() * 16]);
    let seen = |specular: f32, emission| {
        let display = Display { relief: Relief { specular, ..RELIEF }, ..Display::PLAIN };
        let color = Color::Target(&scene.color);
        linear(&scene, &ComposeParams { display, color, emission, ..ComposeParams::default() })
    };
    let highlights = |emission| {
        let both = [0.0, RELIEF.specular].map(|specular| seen(specular, emission));
        let added = both[0].iter().zip(&both[1]).map(|(without, with)| with[1] - without[1]);
        added.collect::<Vec<f32>>()
    };
    let (of_cells, of_color) = (highlights(None), highlights(Some(&nothing)));
    assert!(of_cells.iter().filter(|added| **added > 0.01).count() > 100, "there are some");
    for (of_cells, of_color) in of_cells.iter().zip(&of_color) {
        // The rounding of differences between values of up to ten.
        assert!((of_cells - of_color).abs() < 1e-5, "{of_cells} {of_color}");
    }
}

#[test]
fn a_rotated_visible_part_shows_the_grid_rotated() {
    let scene = scene();
    let shown = scene.shown(ToneMap::None, 0.0);
    let upright = linear(&scene, &shown);
    // A quarter turn: the picture's right is the grid's down, and its down the grid's left.
    let [width, height] = SIZE.map(|v| v as f32);
    let turned = VisibleRect { corner: [width, 0.0], right: [0.0, height], down: [-width, 0.0] };
    let bytes = scene.drawn(
        [SIZE[1], SIZE[0]],
        TextureFormat::Rgba32Float,
        &ComposeParams { visible: Some(turned), ..shown },
    );
    let seen: &[[f32; 4]] = bytemuck::cast_slice(&bytes);
    for (x, y) in (0..SIZE[0]).flat_map(|y| (0..SIZE[1]).map(move |x| (x, y))) {
        let from = [SIZE[0] - 1 - y, x];
        let right = upright[(from[1] * SIZE[0] + from[0]) as usize];
        assert_eq!(seen[(y * SIZE[1] + x) as usize], right, "({x}, {y})");
    }
}

#[test]
fn nearest_enlarges_and_the_visible_part_cuts_out() {
    let scene = scene();
    let format = TextureFormat::Rgba8Unorm;
    let shown = scene.shown(ToneMap::Aces, 0.0);
    let once = scene.drawn(SIZE, format, &shown);
    let at = |bytes: &[u8], width: u32, x: u32, y: u32| -> [u8; 4] {
        bytes[4 * (y * width + x) as usize..][..4].try_into().unwrap()
    };
    for scale in [2, 3] {
        let [width, height] = SIZE.map(|v| v * scale);
        let seen = scene.drawn([width, height], format, &shown);
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            assert_eq!(at(&seen, width, x, y), at(&once, SIZE[0], x / scale, y / scale));
        }
    }
    let visible = Some(VisibleRect::upright([11.0, 7.0], [20.0, 15.0]));
    let part = scene.drawn([40, 30], format, &ComposeParams { visible, ..shown });
    for (x, y) in (0..30).flat_map(|y| (0..40).map(move |x| (x, y))) {
        assert_eq!(at(&part, 40, x, y), at(&once, SIZE[0], 11 + x / 2, 7 + y / 2));
    }
}

/// Linear radiance between cell centres, as the CPU would show it.
fn between(radiance: &[Rgb], x: f32, y: f32) -> Rgb {
    let [width, height] = SIZE.map(|v| v as i32);
    let (left, top) = ((x - 0.5).floor(), (y - 0.5).floor());
    let (fx, fy) = (x - 0.5 - left, y - 0.5 - top);
    let mut sum = [0.0; 3];
    for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let column = (left as i32 + dx).clamp(0, width - 1);
        let row = (top as i32 + dy).clamp(0, height - 1);
        let share = |f: f32, d: i32| if d == 0 { 1.0 - f } else { f };
        let weight = share(fx, dx) * share(fy, dy);
        let rgb = radiance[(row * width + column) as usize];
        (0..3).for_each(|c| sum[c] += weight * rgb[c]);
    }
    sum
}

#[test]
fn linear_shows_what_lies_between_cells() {
    let scene = scene();
    let radiance = scene.light.radiance(&scene.cells, &Display::PLAIN).unwrap();
    let filter = Filter::Linear;
    for (corner, extent, size) in [
        ([0.0, 0.0], SIZE.map(|v| v as f32), SIZE),
        ([0.0, 0.0], SIZE.map(|v| v as f32), SIZE.map(|v| v * 3)),
        ([10.375, 5.25], [24.0, 18.0], [48, 36]),
    ] {
        let shown = scene.shown(ToneMap::Reinhard, 0.0);
        let visible = Some(VisibleRect::upright(corner, extent));
        let shown = ComposeParams { filter, visible, ..shown };
        let seen = scene.drawn(size, TextureFormat::Rgba8Unorm, &shown);
        let place = |i: u32, a: usize| corner[a] + (i as f32 + 0.5) * extent[a] / size[a] as f32;
        let right: Vec<u8> = (0..size[0] * size[1])
            .flat_map(|i| {
                let (x, y) = (place(i % size[0], 0), place(i / size[0], 1));
                shown.display.encode(between(&radiance, x, y))
            })
            .collect();
        assert_eq!(wrong(&seen, &right), 0, "{corner:?}, {size:?}");
    }
}

#[test]
fn a_picture_of_the_hosts_takes_its_own_texels() {
    let scene = scene();
    let format = TextureFormat::Rgba8Unorm;
    let by_cells = scene.shown(ToneMap::Agx, 0.0);
    let over_view = ComposeParams { color: Color::View(&scene.color), ..by_cells };
    assert_eq!(scene.drawn(SIZE, format, &by_cells), scene.drawn(SIZE, format, &over_view));

    // Twice as fine as the cells: black but for every other column.
    let fine = SIZE.map(|v| 2 * v);
    let stripes: Vec<[u8; 4]> =
        (0..fine[0] * fine[1]).map(|i| [(i % fine[0] % 2) as u8 * 255; 4]).collect();
    let stripes = filled(&scene.device, &scene.queue, fine, format, stripes.as_flattened());
    let shown = |color| ComposeParams { color, ..scene.shown(ToneMap::Reinhard, 0.0) };
    let seen = scene.drawn(fine, format, &shown(Color::View(&stripes)));
    let white = scene.drawn(fine, format, &shown(Color::White));
    let plain =
        |i: usize| scene.cells.tint()[i] == [1.0; 3] && scene.cells.matter(i).glow == [0.0; 3];
    let open = |i: usize| scene.cells.opacity()[i] == 0.0 && plain(i);
    let mut compared = 0;
    for (i, (seen, white)) in seen.chunks(4).zip(white.chunks(4)).enumerate() {
        let (x, y) = (i % fine[0] as usize, i / fine[0] as usize);
        if open(y / 2 * SIZE[0] as usize + x / 2) {
            assert_eq!(seen[..3], if x % 2 == 0 { [0; 3] } else { [white[0], white[1], white[2]] });
            compared += 1;
        }
    }
    assert!(compared > 5000);
}

#[test]
fn passes_may_have_depth_and_samples() {
    let scene = scene();
    let Scene { device, queue, lighting, .. } = &scene;
    let color = TextureFormat::Rgba8UnormSrgb;
    let many = |format| {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 4,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        view(&texture)
    };
    let (samples, depth) = (many(color), many(TextureFormat::Depth32Float));
    let resolved = texture(device, SIZE, color, TextureUsages::RENDER_ATTACHMENT);
    let mut compose = Compose::new(device, queue).unwrap();
    let target = Target { format: color, samples: 4, depth: Some(TextureFormat::Depth32Float) };
    let shown = scene.shown(ToneMap::Aces, 0.0);
    compose.prepare(lighting, target, &shown).unwrap();
    let mut encoder = device.create_command_encoder(&Default::default());
    {
        let (single, ops) = (view(&resolved), wgpu::Operations::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &samples,
                depth_slice: None,
                resolve_target: Some(&single),
                ops,
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                depth_ops: Some(wgpu::Operations::default()),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        compose.draw(&mut pass).unwrap();
    }
    queue.submit([encoder.finish()]);
    let right = scene.light.compose(&scene.cells, &shown.display).unwrap().into_raw();
    assert_eq!(wrong(&fetch(device, queue, &resolved), &right), 0);
}

#[test]
fn invalid_targets_and_parameters_are_rejected() {
    let scene = scene();
    let Scene { device, queue, lighting, .. } = &scene;
    let mut compose = Compose::new(device, queue).unwrap();
    let mut refused = |format: TextureFormat, shown: ComposeParams| {
        compose.prepare(lighting, format, &shown).unwrap_err().to_string()
    };
    let format = TextureFormat::Rgba8Unorm;
    for bad in [TextureFormat::Rgba8Uint, TextureFormat::Depth32Float, TextureFormat::R8Unorm] {
        let error = refused(bad, ComposeParams::default());
        assert!(error.starts_with("the texture `target` has the format"), "{error}");
    }
    let exposure = Display { exposure: f32::NAN, ..Display::default() };
    let error = refused(format, ComposeParams { display: exposure, ..ComposeParams::default() });
    assert!(error.contains("from -32 to 32"), "{error}");
    let small = texture(device, [3, 5], format, TextureUsages::TEXTURE_BINDING);
    let error = refused(
        format,
        ComposeParams { color: Color::Cells(&view(&small)), ..ComposeParams::default() },
    );
    assert_eq!(error, "the texture `color` is 3×5, but the grid is 67×41");

    let rejected = compose.prepare(lighting, TextureFormat::Rgba8Snorm, &ComposeParams::default());
    assert!(matches!(rejected, Err(PrepareError::Texture { name: "target", .. })), "{rejected:?}");
}

#[test]
fn nothing_is_drawn_before_the_first_frame() {
    let (device, queue) = device();
    let dark = lighting(&device, &queue);
    let mut compose = Compose::new(&device, &queue).unwrap();
    let format = TextureFormat::Rgba8Unorm;
    let rejected = compose.prepare(&dark, format, &ComposeParams::default());
    assert!(matches!(rejected, Err(PrepareError::NothingLit)), "{rejected:?}");
    let target = texture(&device, SIZE, format, TextureUsages::RENDER_ATTACHMENT);
    let mut encoder = device.create_command_encoder(&Default::default());
    let rejected = compose.record(&mut encoder, &view(&target));
    assert_eq!(rejected, Err(RecordError::NotPrepared));
}
