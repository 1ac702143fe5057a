//! The program prints shaders, as `cargo xtask test --web` reads them.

use serde_json::{Map, Value};
use std::process::{Command, Stdio};

#[test]
fn every_shader_is_printed_by_its_name() {
    let program = env!("CARGO_BIN_EXE_lamplight-generate");
    let printed = Command::new(program).arg("shaders").output().unwrap();
    assert!(printed.status.success(), "{}", String::from_utf8_lossy(&printed.stderr));
    let printed: Map<String, Value> = serde_json::from_slice(&printed.stdout).unwrap();
    let shaders: Vec<_> = lamplight_wgpu::shaders().collect();
    assert!(shaders.len() > 40 && printed.len() == shaders.len(), "{} shaders", printed.len());
    for (name, text) in shaders {
        assert_eq!(printed[name], Value::from(text), "{name}");
    }
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_lamplight-generate"))
        .arg("shaders")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let ended = child.wait_with_output().unwrap();
    assert!(ended.status.success() && ended.stderr.is_empty(), "{ended:?}");
}
