//! The window, on a display that nobody sees: it opens, worlds run, a person draws a lamp.
//!
//! The person is a script; what it saw are pictures of the window.

use anyhow::{Context, Result, ensure};
use image::RgbImage;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// Light on the window's device, few rays: a software GPU has to do it.
const LIGHT: &str = "set method=raymarch\nset raymarch.rays=6\nset bounces=1\n";
/// Bytes that a process may grow by over the last 200 frames of a world: what allocators do, not a
/// leak of a picture of cells (0.3 MB) every few frames.
const GROWTH: u64 = 12 << 20;

/// A display in memory, gone when this is.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    fn new() -> Result<Self> {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1400x900x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .context("no Xvfb; on Debian: apt-get install xvfb")?;
        let mut number = String::new();
        let told = server.stdout.take().context("Xvfb says nothing")?;
        BufReader::new(told).read_line(&mut number)?;
        Ok(Self { server, name: format!(":{}", number.trim()) })
    }

    /// Opens the sandbox and lets a script play; `heard` is told each word that it says, and the
    /// bytes that the process holds then.
    fn play(&self, args: &[&str], script: &str, mut heard: impl FnMut(&str, u64)) -> Result<()> {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("script.txt");
        std::fs::write(&path, script)?;
        let mut sandbox = Command::new(env!("CARGO_BIN_EXE_lamplight-sandbox"))
            .args(args)
            .arg("--script")
            .arg(&path)
            .env("DISPLAY", &self.name)
            .env("XDG_RUNTIME_DIR", folder.path())
            .stdout(Stdio::piped())
            .spawn()?;
        let said = sandbox.stdout.take().context("no output")?;
        for word in BufReader::new(said).lines() {
            heard(&word?, held(sandbox.id())?);
        }
        let status = sandbox.wait()?;
        ensure!(status.success(), "the sandbox ended with {status}");
        Ok(())
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        // It is gone already where this fails.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Bytes that a process holds, of its own.
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

#[test]
fn on_the_gpu_every_world_runs_without_growing() {
    let display = Display::new().unwrap();
    let folder = tempfile::tempdir().unwrap();
    for world in ["paint", "bodies", "sand", "room"] {
        let shot = folder.path().join(format!("{world}.png"));
        let script = format!(
            "{LIGHT}frames 100\nsay settled\nframes 200\nsay done\nshot {}\n",
            shot.display()
        );
        let mut bytes = Vec::new();
        let args = ["--backend", "gpu", "--size", "96x54", "--world", world];
        display.play(&args, &script, |word, held| bytes.push((word.to_owned(), held))).unwrap();
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
fn a_script_that_is_none_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("script.txt");
    std::fs::write(&path, "frames 3\ndance\n").unwrap();
    let told = Command::new(env!("CARGO_BIN_EXE_lamplight-sandbox"))
        .arg("--script")
        .arg(&path)
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&told.stderr);
    assert!(!told.status.success() && error.contains("line 2: `dance`"), "{error}");
}
