//! Files are whole or not there, and whoever stops reading is left in peace.

use super::sandbox::Sandbox;
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

/// Ctrl-C while it works: exit code 130, nothing left behind.
#[test]
#[cfg(target_os = "linux")]
fn ctrl_c_leaves_nothing() {
    let sandbox = Sandbox::small();
    let arguments =
        ["render", "small.toml", "--method", "reference", "--samples", "1000000", "--threads", "1"];
    let mut child =
        sandbox.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // Until the program catches SIGINT: bit 1 of what /proc says. A machine may be busy.
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
    let kill = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(sandbox.files(), ["small.toml"]);
}

/// `lamplight … | head -0`.
#[test]
fn a_reader_that_leaves_is_no_error() {
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
