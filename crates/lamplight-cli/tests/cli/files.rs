//! Output files: complete or not written, never over an input; and readers that close the pipe.

use super::sandbox::{Run, Sandbox};
use std::io::Read;
use std::process::Stdio;

#[test]
fn a_failure_keeps_the_old_picture() {
    let sandbox = Sandbox::small();
    sandbox.run("render small.toml").done();
    let old = sandbox.read("small.png");
    sandbox.write("small.toml", "size = [4, 4]\nsky = 3\n");
    sandbox.run("render small.toml").failed(2, &["small.toml", "sky"]);
    assert!(sandbox.read("small.png") == old);
    assert_eq!(sandbox.files(), ["small.png", "small.toml"]);
}

#[test]
#[cfg(unix)]
fn a_link_stays_and_the_file_behind_it_changes() {
    use std::os::unix::fs::PermissionsExt;
    let sandbox = Sandbox::small();
    std::fs::create_dir(sandbox.path("far")).unwrap();
    sandbox.write("far/real.png", "old");
    std::os::unix::fs::symlink("far/real.png", sandbox.path("link.png")).unwrap();
    sandbox.run("render small.toml -o link.png").done();
    assert!(std::fs::symlink_metadata(sandbox.path("link.png")).unwrap().is_symlink());
    assert_eq!(sandbox.picture("far/real.png").dimensions(), (32, 20));
    // As open as any other file that this user makes, not only the owner's.
    sandbox.write("other", "");
    let mode = |name| std::fs::metadata(sandbox.path(name)).unwrap().permissions().mode();
    assert_eq!(mode("far/real.png"), mode("other"));
}

#[test]
#[cfg(unix)]
fn a_link_to_a_file_that_is_yet_to_be_written_stays() {
    let sandbox = Sandbox::small();
    std::fs::create_dir(sandbox.path("far")).unwrap();
    std::os::unix::fs::symlink("far/new.png", sandbox.path("link.png")).unwrap();
    sandbox.run("render small.toml -o link.png").done();
    assert!(std::fs::symlink_metadata(sandbox.path("link.png")).unwrap().is_symlink());
    assert_eq!(sandbox.picture("far/new.png").dimensions(), (32, 20));
    std::os::unix::fs::symlink("loop.png", sandbox.path("loop.png")).unwrap();
    sandbox
        .run("render small.toml -o loop.png")
        .failed(1, &["cannot write loop.png", "its links form a circle"]);
}

#[test]
#[cfg(unix)]
fn a_read_only_file_stays_and_permissions_are_kept() {
    use std::fs::Permissions;
    use std::os::unix::fs::PermissionsExt;
    let sandbox = Sandbox::small();
    sandbox.write("mine.png", "old");
    std::os::unix::fs::symlink("mine.png", sandbox.path("link.png")).unwrap();
    let set = |mode| {
        std::fs::set_permissions(sandbox.path("mine.png"), Permissions::from_mode(mode)).unwrap();
    };
    set(0o444);
    for name in ["mine.png", "link.png"] {
        let run = sandbox.run(&format!("render small.toml -o {name}"));
        run.failed(1, &["cannot write", name, "read-only"]);
    }
    sandbox.write("new.toml", "old");
    std::fs::set_permissions(sandbox.path("new.toml"), Permissions::from_mode(0o444)).unwrap();
    sandbox.run("new new.toml --force").failed(1, &["cannot write new.toml", "read-only"]);
    assert_eq!(
        (sandbox.read("mine.png"), sandbox.read("new.toml")),
        (b"old".into(), b"old".into())
    );
    set(0o600);
    sandbox.run("render small.toml -o mine.png").done();
    let mode = std::fs::metadata(sandbox.path("mine.png")).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o600, "a private picture has become public");
}

/// A scene with a layer, a sprite and a sky, in a folder of its own.
fn scene_of_images() -> Sandbox {
    let sandbox = Sandbox::new();
    std::fs::create_dir(sandbox.path("art")).unwrap();
    let mut picture = image::RgbaImage::from_pixel(8, 8, image::Rgba([9, 8, 7, 255]));
    // `compare` wants a cell that is open.
    picture.put_pixel(0, 0, image::Rgba([0; 4]));
    for name in ["art/emission.png", "art/00.png", "art/scene.png", "art/sky.png"] {
        picture.save(sandbox.path(name)).unwrap();
    }
    let scene = "size = [8, 8]\nsky = { picture = \"sky.png\" }\n[layers]\nemission = \"emission.png\"\n\
                 [[shape]]\nsprite = { image = \"00.png\", center = [4, 4] }\n";
    sandbox.write("art/scene.toml", scene);
    sandbox
}

#[test]
fn an_input_is_never_written_over() {
    let sandbox = scene_of_images();
    std::fs::copy(sandbox.path("art/scene.toml"), sandbox.path("art/scene.png")).unwrap();
    let inputs =
        ["art/emission.png", "art/00.png", "art/scene.png", "art/scene.toml", "art/sky.png"];
    let before = inputs.map(|name| sandbox.read(name));
    let mut attempts = vec![
        "render art/scene.toml -o art/emission.png",
        "render art/scene.toml -o art/../art/00.png",
        "render art/scene.toml -o art/sky.png",
        "render art/scene.png -o art/scene.png",
        "stages art/scene.toml -o art",
        "compare art/scene.toml --report art --samples 1 --methods raymarch",
    ];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("art/emission.png", sandbox.path("link.png")).unwrap();
        std::os::unix::fs::symlink("art", sandbox.path("linked")).unwrap();
        attempts.push("render art/scene.toml -o link.png");
        attempts.push("render linked/scene.toml -o art/emission.png");
    }
    for arguments in attempts {
        let run = sandbox.run(arguments);
        run.failed(2, &["error: cannot write", "the scene reads this file", "hint: "]);
        assert!(inputs.map(|name| sandbox.read(name)) == before, "{arguments} destroys an input");
    }
    // Files beside them may be written.
    sandbox.run("render art/scene.toml -o art/picture.png").done();
}

#[test]
fn a_report_removes_the_pictures_of_the_one_before_and_nothing_else() {
    let sandbox = Sandbox::small();
    let report = "compare small.toml --samples 1 --report report --methods";
    sandbox.run(&format!("{report} raymarch,cascades")).done();
    assert!(sandbox.path("report/08-error.png").exists());
    sandbox.write("report/77.png", "mine");
    sandbox.write("report/notes.txt", "mine");
    sandbox.run(&format!("{report} raymarch")).done();
    let names = std::fs::read_dir(sandbox.path("report")).unwrap();
    let mut names: Vec<_> =
        names.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    let rows = 0..lamplight::settings::Raymarch::PRESETS.len();
    let pictures = rows.flat_map(|row| [format!("{row:02}-error.png"), format!("{row:02}.png")]);
    let others = ["77.png", "index.html", "notes.txt", "reference.png"].map(str::to_owned);
    assert_eq!(names, pictures.chain(others).collect::<Vec<_>>());
}

#[test]
#[cfg(target_os = "linux")]
fn signals_leave_nothing_and_name_themselves() {
    stopped_by("INT", 130);
    stopped_by("TERM", 143);
    stopped_by("HUP", 129);
}

/// Stops the command by a signal while it works.
fn stopped_by(signal: &str, code: i32) {
    let sandbox = Sandbox::small();
    let arguments =
        ["render", "small.toml", "--method", "reference", "--samples", "1000000", "--threads", "1"];
    let mut child =
        sandbox.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // Until the program catches SIGINT: bit 1 in /proc. A machine may be busy.
    let catches = |status: String| {
        let mask = status.split("SigCgt:").nth(1)?.split_whitespace().next()?.to_owned();
        (u64::from_str_radix(&mask, 16).ok()? & 2 != 0).then_some(())
    };
    let status = || std::fs::read_to_string(format!("/proc/{}/status", child.id())).ok();
    let tries = (0..1000).find(|_| {
        std::thread::sleep(std::time::Duration::from_millis(20));
        status().and_then(catches).is_some()
    });
    assert!(tries.is_some(), "SIGINT is never caught");
    let (flag, process) = (format!("-{signal}"), child.id().to_string());
    let kill = std::process::Command::new("kill").args([flag, process]).status();
    assert!(kill.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(code), "after {signal}");
    assert_eq!(sandbox.files(), ["small.toml"]);
}

/// `lamplight … | head -0`.
#[test]
fn a_closed_stdout_is_not_an_error() {
    let sandbox = Sandbox::small();
    for arguments in [
        &["completions", "zsh"][..],
        &["schema"],
        &["man"],
        &["--help"],
        &["probe", "small.toml", "3,3"],
        &["bench", "--size", "4x4", "--json"],
        &["render", "small.toml"],
    ] {
        let mut command = sandbox.command(arguments);
        let mut child =
            command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
        drop(child.stdout.take());
        let mut err = String::new();
        child.stderr.take().unwrap().read_to_string(&mut err).unwrap();
        assert_eq!((child.wait().unwrap().code(), err.as_str()), (Some(0), ""), "{arguments:?}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn names_that_are_not_utf_8_are_shown_in_json() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let sandbox = Sandbox::small();
    let name = OsStr::from_bytes(b"a\xff.toml");
    std::fs::copy(sandbox.path("small.toml"), sandbox.path(name)).unwrap();
    let compare = ["compare", "--samples", "1", "--cells", "1", "--methods", "polar"];
    for command in [&["render"][..], &["bake", "-o", "tiles"], &compare] {
        let run: Run = sandbox.command(command).arg("--json").arg(name).output().unwrap().into();
        assert!(run.out.contains("\"a\u{fffd}.toml\""), "{command:?}: {}", run.err);
    }
}
