//! Tests of the window on a virtual display. Scripts provide the input and take screenshots.

use anyhow::{Context, Result, ensure};
use image::RgbImage;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// Settings with few rays, for software GPUs.
const LIGHT: &str = "set method=raymarch\nset raymarch.rays=6\nset bounces=1\n";
/// The largest growth of a process over 60 frames, bytes. It allows for the allocator, but not for a leak of
/// the cells (0.3 MB) every few frames.
const GROWTH: u64 = 60 * 60_000;

/// A virtual display, which ends when it is dropped.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    fn new() -> Result<Self> {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "840x560x24", "-nolisten", "tcp", "-noreset"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .context("no Xvfb; on Debian: apt-get install xvfb")?;
        let mut number = String::new();
        let output = server.stdout.take().context("Xvfb says nothing")?;
        BufReader::new(output).read_line(&mut number)?;
        Ok(Self { server, name: format!(":{}", number.trim()) })
    }

    /// Opens the sandbox with a script. Calls `heard` with each printed line and the id of the process.
    fn play(&self, args: &[&str], script: &str, heard: impl FnMut(&str, u32)) -> Result<()> {
        self.play_in(tempfile::tempdir()?.path(), args, script, heard)
    }

    /// As [`Self::play`], in a folder, where saved files go.
    fn play_in(
        &self,
        folder: &Path,
        args: &[&str],
        script: &str,
        mut heard: impl FnMut(&str, u32),
    ) -> Result<()> {
        let path = folder.join("script.txt");
        std::fs::write(&path, script)?;
        let mut sandbox = Command::new(env!("CARGO_BIN_EXE_lamplight-sandbox"))
            .args(args)
            .arg("--script")
            .arg(&path)
            .env("DISPLAY", &self.name)
            .env("XDG_RUNTIME_DIR", folder)
            .current_dir(folder)
            .stdout(Stdio::piped())
            .spawn()?;
        let said = sandbox.stdout.take().context("no output")?;
        for word in BufReader::new(said).lines() {
            heard(&word?, sandbox.id());
        }
        let status = sandbox.wait()?;
        ensure!(status.success(), "the sandbox ended with {status}");
        Ok(())
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        // This fails if the server has already ended.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Anonymous memory of a process, bytes.
fn held(process: u32) -> Result<u64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status"))?;
    let line = status.lines().find(|line| line.starts_with("RssAnon")).context("no RssAnon")?;
    let kilobytes = line.split_whitespace().nth(1).context("no number")?;
    Ok(kilobytes.parse::<u64>()? << 10)
}

fn open(path: &Path) -> Result<RgbImage> {
    Ok(image::open(path).with_context(|| path.display().to_string())?.to_rgb8())
}

/// Mean of all channels over the middle of a picture.
fn brightness(picture: &RgbImage) -> f64 {
    let (w, h) = picture.dimensions();
    let middle = |(x, y): (u32, u32)| picture.get_pixel(w / 4 + x, h / 4 + y).0;
    let pixels = (0..h / 2).flat_map(|y| (0..w / 2).map(move |x| (x, y)));
    let sum: u64 = pixels.flat_map(middle).map(u64::from).sum();
    sum as f64 / f64::from(3 * (w / 2) * (h / 2))
}

/// Mean difference of two pictures, all channels.
fn difference(a: &RgbImage, b: &RgbImage) -> f64 {
    let off = a.enumerate_pixels().map(|(x, y, pixel)| {
        let other = b.get_pixel(x, y).0;
        (0..3).map(|c| u64::from(pixel.0[c].abs_diff(other[c]))).sum::<u64>()
    });
    off.sum::<u64>() as f64 / f64::from(3 * a.width() * a.height())
}

#[test]
fn on_the_gpu_every_world_runs_without_growing() {
    let display = Display::new().unwrap();
    let folder = tempfile::tempdir().unwrap();
    for world in ["paint", "bodies", "sand", "room"] {
        let shot = folder.path().join(format!("{world}.png"));
        let script = format!(
            "{LIGHT}frames 40\nsay settled\nframes 60\nsay done\nshot {}\n",
            shot.display()
        );
        let mut bytes = Vec::new();
        let args = ["--backend", "gpu", "--size", "96x54", "--world", world];
        let heard = |word: &str, process| bytes.push((word.to_owned(), held(process).unwrap()));
        display.play(&args, &script, heard).unwrap();
        println!("{world}: {bytes:?}");
        let [(settled, before), (done, after)] = &bytes[..] else { panic!("{world}: {bytes:?}") };
        assert_eq!([settled, done], ["settled", "done"]);
        assert!(after.saturating_sub(*before) < GROWTH, "{world} grew: {bytes:?}");
        let light = brightness(&open(&shot).unwrap());
        println!("{world}: mean {light:.1}");
        assert!(light > 20.0, "{world} is dark: {light:.1}");
    }
}

#[test]
fn on_the_gpu_a_lamp_that_is_drawn_lights_the_picture() {
    lamp_is_drawn("gpu");
}

#[test]
fn on_the_gpu_is_the_window_and_the_cpu_lights_it() {
    lamp_is_drawn("cpu");
}

fn lamp_is_drawn(backend: &str) {
    let display = Display::new().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let [before, after] = ["before.png", "after.png"].map(|name| folder.path().join(name));
    let script = format!(
        "{LIGHT}clear\nlamp\nframes 3\nshot {}\nmove 48 20\nframes 1\npress\nframes 1\nmove 48 27\n\
         frames 1\nrelease\nframes 2\nmove 2 2\nframes 2\nshot {}\n",
        before.display(),
        after.display()
    );
    let args = ["--backend", backend, "--size", "96x54"];
    display.play(&args, &script, |_, _| ()).unwrap();
    let [before, after] = [before, after].map(|path| brightness(&open(&path).unwrap()));
    println!("{backend}: mean {before:.1} before, {after:.1} after");
    // The sky is there before.
    assert!(after > before + 20.0, "{before:.1}, then {after:.1}");
}

#[test]
fn on_the_gpu_what_is_dropped_is_painted_or_refused_in_words() {
    let display = Display::new().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    RgbImage::from_fn(40, 20, |x, y| image::Rgb([6 * x as u8, 9 * y as u8, 0]))
        .save(at("small.png"))
        .unwrap();
    image::GrayImage::new(10_000, 10_000).save(at("huge.png")).unwrap();
    std::fs::write(at("broken.png"), b"no picture at all").unwrap();
    std::fs::write(at("broken.toml"), "size = [32, ").unwrap();
    std::fs::write(at("scene.toml"), "size = [64, 36]\n[[lamp]]\nposition = [32.0, 18.0]\n")
        .unwrap();
    std::fs::write(at("song.mp3"), b"la").unwrap();
    let cases = [
        ("small.png", "all is well"),
        ("huge.png", "10000×10000"),
        ("broken.png", "cannot be read"),
        ("broken.toml", "broken.toml"),
        ("missing.png", "missing.png"),
        ("song.mp3", "neither a picture"),
        ("scene.toml", "all is well"),
    ];
    for (name, expected) in cases {
        let script = format!("{LIGHT}frames 1\ndrop {}\nframes 3\ntell\n", at(name).display());
        let mut said = Vec::new();
        let args = ["--backend", "cpu", "--size", "96x54"];
        display.play(&args, &script, |line, _| said.push(line.to_owned())).unwrap();
        assert!(said.concat().contains(expected), "{name}: {said:?}");
    }
}

#[test]
fn on_the_gpu_a_method_that_cannot_light_says_why_until_another_does() {
    let display = Display::new().unwrap();
    let script =
        "world sand\nset method=polar\nframes 2\ntell\nset method=raymarch\nframes 2\ntell\n";
    let mut said = Vec::new();
    let args = ["--backend", "gpu", "--size", "96x54"];
    display.play(&args, script, |line, _| said.push(line.to_owned())).unwrap();
    assert!(said.len() == 2 && said[0].contains("lights lamps only"), "{said:?}");
    assert_eq!(said[1], "all is well");
}

#[test]
fn on_the_gpu_everything_that_is_asked_for_is_saved() {
    let display = Display::new().unwrap();
    for backend in ["gpu", "cpu"] {
        let folder = tempfile::tempdir().unwrap();
        // Without a frame between them, and none after the last one.
        let script = format!("{LIGHT}frames 2\nsave picture\nsave scene\nsave light\n");
        let args = ["--backend", backend, "--size", "96x54"];
        display.play_in(folder.path(), &args, &script, |_, _| ()).unwrap();
        for name in ["painting.png", "painting.toml", "painting-light.exr"] {
            assert!(folder.path().join(name).is_file(), "{backend}: {name} is missing");
        }
        assert!(brightness(&open(&folder.path().join("painting.png")).unwrap()) > 20.0);
    }
}

#[test]
fn on_the_gpu_only_a_canvas_is_saved_as_a_scene() {
    let display = Display::new().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut said = Vec::new();
    let script = format!("{LIGHT}world sand\nsave scene\nframes 4\ntell\n");
    let args = ["--backend", "cpu", "--size", "96x54"];
    display.play_in(folder.path(), &args, &script, |line, _| said.push(line.to_owned())).unwrap();
    assert_eq!(said, ["only a canvas is saved as a scene"]);
    assert!(!folder.path().join("painting.png").exists());
}

#[test]
fn on_the_gpu_a_picture_in_coarser_light_is_saved_with_all_bounces() {
    let display = Display::new().unwrap();
    for backend in ["cpu", "gpu"] {
        let saved = [1, 2].map(|factor| {
            let folder = tempfile::tempdir().unwrap();
            let script = format!(
                "set method=holographic\nset holographic.preset=fast\nset wall_depth=16\nfactor {factor}\n\
                 frames 30\nsave picture\n"
            );
            let args = ["--backend", backend, "--size", "96x54"];
            display.play_in(folder.path(), &args, &script, |_, _| ()).unwrap();
            open(&folder.path().join("painting.png")).unwrap()
        });
        let off = difference(&saved[0], &saved[1]);
        println!("{backend}: {off:.2} apart");
        assert!(off < 0.5, "{backend}: {off:.2}");
    }
}

#[test]
fn on_the_gpu_every_view_shows_something_else() {
    let display = Display::new().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let views = [
        "picture",
        "light",
        "emission",
        "opacity",
        "albedo",
        "tint",
        "seeds",
        "voronoi",
        "distance",
        "inside 0",
        "inside 1",
        "reference",
        "error",
    ];
    let shot = |view: &str| folder.path().join(format!("{}.png", view.replace(' ', "-")));
    let looks =
        views.map(|view| format!("view {view}\nframes 12\ntell\nshot {}\n", shot(view).display()));
    let mut said = Vec::new();
    let args = ["--backend", "cpu", "--size", "96x54"];
    let script = format!("set bounces=1\n{}", looks.concat());
    display.play(&args, &script, |line, _| said.push(line.to_owned())).unwrap();
    assert_eq!(said, ["all is well"; 13]);
    let pictures = views.map(|view| open(&shot(view)).unwrap());
    for (i, (one, view)) in pictures.iter().zip(views).enumerate() {
        assert!(brightness(one) > 1.0, "{view} is dark: {}", brightness(one));
        for (other, name) in pictures.iter().zip(views).skip(i + 1) {
            let off = difference(one, other);
            assert!(off > 1.0, "{view} and {name} differ by {off:.2} only");
        }
    }
}

#[test]
fn on_the_gpu_two_methods_stand_side_by_side_and_the_divider_moves() {
    let display = Display::new().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let shot = |name: &str| folder.path().join(format!("{name}.png"));
    // One random ray is dark or bright, which is unlike cascades.
    let script = format!(
        "set method=cascades\nset cascades.preset=plain\nset bounces=0\nframes 2\nshot {}\nsplit raymarch\n\
         set raymarch.rays=1\nframes 2\nshot {}\nmove 48 27\nframes 1\npress\nframes 1\nmove 90 27\nframes 1\n\
         release\nframes 2\nmove 95 1\nframes 2\nshot {}\ntell\n",
        shot("one").display(),
        shot("two").display(),
        shot("moved").display()
    );
    let args = ["--backend", "gpu", "--size", "96x54"];
    let mut said = Vec::new();
    display.play(&args, &script, |line, _| said.push(line.to_owned())).unwrap();
    assert_eq!(said, ["all is well"]);
    let [one, two, moved] = ["one", "two", "moved"].map(|name| open(&shot(name)).unwrap());
    // The halves of the picture, which lies between the panels.
    let off = |a: &RgbImage, from: f64, to: f64| {
        let (left, width) = (170.0, f64::from(a.width()) - 500.0);
        let columns = (left + from * width) as u32..(left + to * width) as u32;
        let rows = a.height() / 2 - 60..a.height() / 2 + 60;
        let sum: f64 = rows
            .flat_map(|y| columns.clone().map(move |x| (x, y)))
            .map(|(x, y)| f64::from(one.get_pixel(x, y).0[0].abs_diff(a.get_pixel(x, y).0[0])))
            .sum();
        sum / (120.0 * (to - from) * width)
    };
    let split = [off(&two, 0.1, 0.45), off(&two, 0.55, 0.9)];
    let after = off(&moved, 0.55, 0.85);
    println!("split {split:?}, moved {after}");
    assert!(split[0] < 1.0 && split[1] > 5.0, "{split:?}");
    assert!(after < 1.0, "the left half reaches to where the divider went: {after}");
}

#[test]
fn on_the_gpu_normals_of_a_scene_give_relief_in_coarser_light_too() {
    let display = Display::new().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let shot = |name: &str| folder.path().join(format!("{name}.png"));
    let middle = |name: &str| {
        let picture = open(&shot(name)).unwrap();
        let (w, h) = picture.dimensions();
        image::imageops::crop_imm(&picture, w / 4, h / 4, w / 2, h / 2).to_image()
    };
    let cellar = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/cellar.toml");
    let mut pictures = Vec::new();
    for backend in ["gpu", "cpu"] {
        let script = format!(
            "drop {cellar}\nset method=polar\nset bounces=0\nfactor 1\nframes 3\nshot {}\nrelief off\n\
             frames 2\nshot {}\nfactor 2\nframes 2\nshot {}\nrelief on\nframes 2\nshot {}\ntell\n",
            shot("relief").display(),
            shot("flat").display(),
            shot("coarse-flat").display(),
            shot("coarse-relief").display()
        );
        let mut said = Vec::new();
        display
            .play(&["--backend", backend], &script, |line, _| said.push(line.to_owned()))
            .unwrap();
        assert_eq!(said, ["all is well"]);
        let [relief, flat] = ["relief", "flat"].map(middle);
        let [coarse_relief, coarse_flat] = ["coarse-relief", "coarse-flat"].map(middle);
        let lost = difference(&relief, &flat);
        let kept = difference(&relief, &coarse_relief);
        let coarse_lost = difference(&coarse_relief, &coarse_flat);
        println!("{backend}: {lost:.2} flat, {kept:.2} coarser, {coarse_lost:.2} coarser and flat");
        assert!(lost > 2.0, "{backend}: relief changes the picture by {lost:.2}");
        assert!(
            kept < 0.5 * lost && coarse_lost > 0.5 * lost,
            "{backend}: {kept:.2}, {coarse_lost:.2}"
        );
        pictures.push([relief, coarse_relief]);
    }
    let [fine, coarse] = [0, 1].map(|i| difference(&pictures[0][i], &pictures[1][i]));
    println!("the GPU and the CPU: {fine:.2} apart, {coarse:.2} in coarser light");
    assert!(fine < 1.0 && coarse < 2.0, "{fine:.2}, {coarse:.2}");
}

#[test]
fn on_the_gpu_the_benchmark_ends_with_a_table() {
    let display = Display::new().unwrap();
    let mut said = Vec::new();
    let args = ["--backend", "cpu", "--size", "96x54"];
    let script = "world sand\nset bounces=0\nbenchmark\nframes 520\ntable\n";
    display.play(&args, script, |line, _| said.push(line.to_owned())).unwrap();
    println!("{said:?}");
    let times: Vec<f64> =
        said.iter().filter_map(|line| line.split('|').nth(3)?.trim().parse().ok()).collect();
    // There are no lamps in the sand, and so nothing for polar and its presets.
    let refused = said.iter().filter(|line| line.contains("| cannot light this |")).count();
    let polar = lamplight::Method::Polar.presets().len();
    assert_eq!([times.len() + refused, refused], [said.len() - 4, polar], "{said:?}");
    assert!(times.len() > 9 && times.iter().all(|&ms| ms > 0.0), "{said:?}");
}

#[test]
fn on_the_gpu_a_window_that_loses_it_goes_on_in_another() {
    let display = Display::new().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let [before, after] = ["before.png", "after.png"].map(|name| folder.path().join(name));
    let script = format!(
        "{LIGHT}clear\nlamp\nframes 1\nmove 20 20\npress\nframes 1\nrelease\nmove 94 52\nframes 2\nshot {}\n\
         lose\nframes 3\nmove 94 52\nframes 2\nshot {}\ntell\n",
        before.display(),
        after.display()
    );
    for backend in ["gpu", "cpu"] {
        let mut said = Vec::new();
        let args = ["--backend", backend, "--size", "96x54"];
        // The first window ends well; the other one writes where it wrote.
        display.play(&args, &script, |line, _| said.push(line.to_owned())).unwrap();
        assert_eq!(said, ["The GPU was lost; this window goes on where the other one was."]);
        // The line at the bottom moves the picture, whose brightness and its place stay.
        let [before, after] = [&before, &after].map(|path| open(path).unwrap());
        let (was, is) = (brightness(&before), brightness(&after));
        println!("{backend}: mean {was:.1} before, {is:.1} after");
        assert!(was > 30.0 && (was - is).abs() < 0.1 * was, "{was:.1}, then {is:.1}");
    }
}

#[test]
fn on_the_gpu_what_was_painted_is_there_after_a_world() {
    let display = Display::new().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let shot = |name: &str| folder.path().join(format!("{name}.png"));
    let script = format!(
        "{LIGHT}clear\nlamp\nframes 1\nmove 20 20\npress\nframes 1\nrelease\nmove 94 52\nframes 2\nshot {}\n\
         world sand\nframes 2\nworld paint\nframes 2\nshot {}\nworld bodies\nframes 2\nlose\nframes 3\n\
         world paint\nmove 94 52\nframes 2\nshot {}\ntell\n",
        shot("before").display(),
        shot("after").display(),
        shot("elsewhere").display()
    );
    let mut said = Vec::new();
    let args = ["--backend", "gpu", "--size", "96x54"];
    display.play(&args, &script, |line, _| said.push(line.to_owned())).unwrap();
    assert_eq!(said, ["The GPU was lost; this window goes on where the other one was."]);
    let [before, after, elsewhere] =
        ["before", "after", "elsewhere"].map(|name| open(&shot(name)).unwrap());
    let off = difference(&before, &after);
    println!("{off:.2} apart");
    assert!(off < 5.0, "{off:.2}");
    // The line at the bottom moves the picture in the other window.
    let (was, is) = (brightness(&before), brightness(&elsewhere));
    println!("mean {was:.1} before, {is:.1} in the other window");
    assert!(was > 30.0 && (was - is).abs() < 0.1 * was, "{was:.1}, then {is:.1}");
}

#[test]
fn on_the_gpu_a_window_of_any_size_stays_open() {
    let display = Display::new().unwrap();
    let script = format!(
        "{LIGHT}size 480 320\nframes 3\nmove 48 27\npress\nframes 1\nrelease\nsize 1 1\nframes 3\n\
         size 1300 40\nframes 3\nsize 1200 800\nframes 3\ntell\n"
    );
    for world in ["paint", "room"] {
        let mut said = Vec::new();
        let args = ["--backend", "gpu", "--size", "96x54", "--world", world];
        display.play(&args, &script, |line, _| said.push(line.to_owned())).unwrap();
        assert_eq!(said, ["all is well"]);
    }
}

#[test]
fn on_the_gpu_a_half_that_is_dark_leaves_the_other_lit() {
    let display = Display::new().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let [whole, split] = ["whole.png", "split.png"].map(|name| folder.path().join(name));
    let script = format!(
        "{LIGHT}world bodies\nframes 2\nshot {}\nsplit polar\nframes 2\ntell\nshot {}\n",
        whole.display(),
        split.display()
    );
    let mut said = Vec::new();
    let args = ["--backend", "cpu", "--size", "96x54"];
    display.play(&args, &script, |line, _| said.push(line.to_owned())).unwrap();
    let said = said.concat();
    assert!(said.contains("on the right") && said.contains("lights lamps only"), "{said}");
    // Half of the middle of the window is dark.
    let [whole, split] = [whole, split].map(|path| brightness(&open(&path).unwrap()));
    assert!((0.3..0.8).contains(&(split / whole)), "{split:.1} of {whole:.1}");
}

#[test]
fn a_script_that_is_none_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("script.txt");
    std::fs::write(&path, "frames 3\ndance\n").unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_lamplight-sandbox"))
        .arg("--script")
        .arg(&path)
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && error.contains("line 2: `dance`"), "{error}");
}
